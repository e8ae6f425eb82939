"""Write report.html of a run."""

from __future__ import annotations

import base64
import json
from html import escape
from pathlib import Path
from typing import Any

from doormill_ros import __version__
from doormill_ros.cell.errors import OutOfToleranceError
from doormill_ros.cell.graph import topic_names
from doormill_ros.cell.output.inspection import MILLED, NOT_MEASURED, OUT_OF_TOLERANCE, MeasuredDoor, outcome
from doormill_ros.cell.places.layout import load_layout
from doormill_ros.files import write_atomically
from doormill_ros.localization.errors import BadPicture
from doormill_ros.messages.from_message import gauged_of, inspection_of, program_of, recipe_of, transform_of
from doormill_ros.pages.page import Charts, Facts, Listing, Page, PageSection, Paragraphs, Picture, render
from doormill_ros.pipeline.cycle import cycle_time
from doormill_ros.recipes.drawing import draw_recipe
from doormill_ros.recipes.recipe import Recipe
from doormill_ros.report.figures import (
    correction_figure,
    deflection_figure,
    deviation_figure,
    handshake_figure,
    picture_url,
    pose_figure,
)
from doormill_ros.report.run_record import RunRecord, read_run
from doormill_ros.robot.description import load_robot
from doormill_ros.toolpath.drawing import draw_program, draw_ways
from doormill_ros.toolpath.program import AT_POINTS, MillingProgram
from doormill_ros.units import m_to_mm, rad_to_deg, s_to_ms

TOUCHED = "touched what it must not"
TARGET_LINES = 400  # of the RAPID file that the page shows


def _expected(program: MillingProgram) -> str:
    """Expected error of each feature's walls, as springs and forces are known."""
    by_feature: dict[str, float] = {}
    start = None
    for motion in program.motions:
        if motion.kind in AT_POINTS:
            continue
        if motion.feature and motion.cutting:
            # A wall is finished from where the motion begins.
            passed = [i for i in (start, motion.via, motion.target) if i is not None]
            errors = [program.targets[i].expected_error for i in passed]
            by_feature[motion.feature] = max(by_feature.get(motion.feature, 0.0), *errors)
        start = motion.target
    if not any(by_feature.values()):
        return "not told: the run is older than this figure"
    return ", ".join(f"{name} {m_to_mm(error):.3f} mm" for name, error in by_feature.items())


def _facts(record: RunRecord) -> dict[str, str]:
    """Label and value of the table at the top."""
    result, recipe = record.get(topic_names.RUN_RESULT), record.get(topic_names.DOOR_RECIPE)
    found, true = record.get(topic_names.DOOR_LOCALIZATION), record.get(topic_names.DOOR_PLACEMENT)
    targets, milled = record.get(topic_names.PATH_TARGETS), record.get(topic_names.MILLED_DOOR)
    facts = {"run": result.run_id, "software": f"doormill_ros {__version__}"}
    if recipe is not None:
        facts["recipe"] = (
            f"{recipe.door_id}, version {recipe.version}, saved by {recipe.author} {recipe.created}"
        )
        facts["door"] = (
            f"{m_to_mm(recipe.width):.0f} x {m_to_mm(recipe.height):.0f} x {m_to_mm(recipe.thickness):.0f} mm, "
            f"{recipe.material}, {recipe.mass:g} kg"
        )
    if found is not None and found.accepted:
        sigma = [found.pose.covariance[7 * i] ** 0.5 for i in (1, 2, 3)]
        facts["found at"] = (
            f"y {m_to_mm(found.offset_y):+.3f} ± {m_to_mm(sigma[0]):.4f} mm, "
            f"z {m_to_mm(found.offset_z):+.3f} ± {m_to_mm(sigma[1]):.4f} mm, "
            f"rotation {rad_to_deg(found.offset_rotation):+.4f} ± {rad_to_deg(sigma[2]):.4f} degrees "
            f"(residual {m_to_mm(found.residual):.4f} mm, quality {found.quality:.2f})"
        )
    if true is not None:
        facts["stood at"] = (
            f"y {m_to_mm(true.offset_y):+.3f} mm, z {m_to_mm(true.offset_z):+.3f} mm, "
            f"rotation {rad_to_deg(true.offset_rotation):+.4f} degrees (simulation's truth)"
        )
    if targets is not None and targets.accepted:
        facts["path"] = (
            f"{len(targets.targets)} targets, {len(targets.motions)} motions, {targets.cycle_time:.1f} s, "
            f"largest correction {m_to_mm(targets.largest_correction):.3f} mm by model {targets.robot_model}"
        )
        facts["expected error"] = _expected(program_of(targets))
        if record.shared:
            facts["robots"] = "two; path and handshake are those of the first"
        elif recipe is not None:
            facts["cycle"] = cycle_time(recipe_of(recipe), targets.cycle_time).sentence
    inspection = _inspection(record)
    if inspection.out_of_tolerance:
        facts["milled"] = f"out of tolerance: {inspection.sentence}"
    elif _handed_over(result) and not inspection.measured:
        facts["milled"] = "not measured"
    elif milled is not None:
        facts["milled"] = (
            f"within {m_to_mm(milled.corrected_max):.3f} mm of the recipe, {m_to_mm(milled.uncorrected_max):.3f} mm "
            f"without correction, tolerance {m_to_mm(milled.tolerance):.1f} mm"
        )
    elif inspection.measured:
        facts["milled"] = inspection.sentence
    verdict = record.get(topic_names.RUN_VERDICT)
    if verdict is not None:
        facts["touched"] = verdict.message
    if result.target_file:
        facts["RAPID file"] = f"{result.target_file} (sha256 {result.sha256})"
    if targets is not None:
        version = getattr(targets, "model_version", 0)  # bags of older software have none
        facts["robot model"] = f"{targets.robot_model}, " + (
            f"version {version}" if version else "as the path generator was started"
        )
    return facts


def _handed_over(result: Any) -> bool:
    """The door was milled; only then does a result name its file."""
    return bool(result.sha256)


def _inspection(record: RunRecord) -> MeasuredDoor:
    """How the door came out."""
    milled, gauged = record.get(topic_names.MILLED_DOOR), record.inspection
    if milled is not None:
        return inspection_of(milled)
    return MeasuredDoor() if gauged is None else gauged_of(gauged)


def _outcome(record: RunRecord) -> str:
    """What the run came to in a few words, from what was measured: bags of older software call every end a success."""
    result, inspection = record.get(topic_names.RUN_RESULT), _inspection(record)
    if _handed_over(result) and inspection.out_of_tolerance:
        return OUT_OF_TOLERANCE
    judged = record.get(topic_names.RUN_VERDICT)
    if result.success and judged is not None and not judged.success:
        return TOUCHED
    return outcome(result.success, result.error_code, inspection.measured)


def _target_lines(record: RunRecord) -> list[str]:
    """The RAPID file as recorded, also of a run that failed once it was handed over; of older bags from the disk."""
    message, result = record.get(topic_names.ABB_TARGET_FILE), record.get(topic_names.RUN_RESULT)
    if message is not None and result.run_id in message.data:
        text = message.data
    elif result.target_file and Path(result.target_file).is_file():
        text = Path(result.target_file).read_text(encoding="ascii", errors="replace")
    else:
        return []
    lines = text.splitlines()
    left = len(lines) - TARGET_LINES
    return [*lines[:TARGET_LINES], f"... {left} more lines"] if left > 0 else lines


def _door(recipe: Any, targets: Any, pose: Any) -> str:
    """The drawing of the recipe as an <img> element; with targets and a pose also the paths.

    Args:
        recipe: doormill_interfaces/DoorRecipe.
        targets: Accepted doormill_interfaces/TargetArray, or None.
        pose: geometry_msgs/Pose of the door in base_link, or None.
    """
    content = Recipe.from_document(json.loads(recipe.document))
    if targets is None or pose is None:
        drawing = draw_recipe(content)
    else:
        program, layout = program_of(targets), load_layout()
        drawing = draw_program(content, program, transform_of(pose))
        draw_ways(drawing, program, transform_of(pose), load_robot(layout.robot), layout.T_flange_tool)
    # As a picture of its own: the drawing's style sheet must not reach the rest of the page.
    data = base64.b64encode(drawing.to_svg().encode()).decode("ascii")
    words = escape(f"Door {recipe.door_id} with its features")
    return f'<img src="data:image/svg+xml;base64,{data}" alt="{words}">'


def _figures(record: RunRecord) -> dict[str, str]:
    """Heading and drawing of every picture that the record allows."""
    recipe, found = record.get(topic_names.DOOR_RECIPE), record.get(topic_names.DOOR_LOCALIZATION)
    targets, executed = record.get(topic_names.PATH_TARGETS), record.get(topic_names.EXECUTED_PATH)
    milled, true = record.get(topic_names.MILLED_DOOR), record.get(topic_names.DOOR_PLACEMENT)
    accepted = targets if targets is not None and targets.accepted else None
    localized = found if found is not None and found.accepted else None
    figures = {}
    if recipe is not None:
        pose = localized.pose.pose if localized is not None else None
        figures["Door and path"] = _door(recipe, accepted, pose)
    if localized is not None:
        figures["Pose and uncertainty"] = pose_figure(localized, true, load_layout().limits)
    if milled is not None:
        figures["Milled contour against the recipe"] = deviation_figure(milled)
    if accepted is not None and executed is not None and len(executed.time):
        figures["Predicted and executed deflection"] = deflection_figure(accepted, executed)
    if accepted is not None:
        figures["Correction at the targets"] = correction_figure(accepted)
    return figures


def _picture(record: RunRecord) -> str:
    """URL of the overlay, else of the camera's picture; empty when there is none that can be read."""
    message = record.get(topic_names.DOOR_OVERLAY) or record.get(topic_names.IMAGE)
    try:
        return "" if message is None else picture_url(message)
    except BadPicture:
        return ""


def _stage_times(result: Any) -> Facts:
    names = ("picture_to_pose", "pose_to_targets", "targets_to_ready", "request_to_ready")
    times = {name.replace("_", " "): s_to_ms(getattr(result.times, name)) for name in names}
    return Facts(
        [(name, f"{value:.1f} ms" if value > 0 else "not reached") for name, value in times.items()],
        numbers=True,
    )


def _refusal(code: int, handed_over: bool) -> Paragraphs:
    left = (
        "The target file was handed over before; none was left" if handed_over else "No target file was left"
    )
    return Paragraphs([f"Error code {code}. {left} for the controller."])


def render_report(record: RunRecord) -> str:
    """The whole page, self-contained."""
    result, recipe = record.get(topic_names.RUN_RESULT), record.get(topic_names.DOOR_RECIPE)
    picture, target_lines = _picture(record), _target_lines(record)
    judged, came_to = record.get(topic_names.RUN_VERDICT), _outcome(record)
    top = []
    if came_to == OUT_OF_TOLERANCE:
        top.append(Paragraphs([f"Error code {OutOfToleranceError.code}. {_inspection(record).sentence}."]))
    elif not result.success:
        top.append(_refusal(result.error_code, bool(target_lines)))
    if judged is not None and not judged.success:
        top.append(Paragraphs([f"Error code {judged.error_code}. {judged.message}."]))
    sections = [PageSection("", [*top, Facts(list(_facts(record).items()))])]
    if picture:
        sections.append(PageSection("Picture", [Picture(picture, "Picture of the door with found edges")]))
    sections += [
        PageSection(title, [Charts([drawing], "wide")]) for title, drawing in _figures(record).items()
    ]
    steps = [(step.state, f"{step.begun:.3f} s", step.reason) for step in record.handshake]
    timeline = [Charts([handshake_figure(record.handshake)], "wide")] if record.handshake else []
    sections += [
        PageSection("Stage times", [_stage_times(result)]),
        PageSection("Handshake with the controller", [*timeline, Facts(steps, numbers=True)]),
    ]
    if target_lines:
        sections.append(PageSection("RAPID target file", [Listing("\n".join(target_lines))]))
    if recipe is not None:
        document = json.dumps(json.loads(recipe.document), indent=2)
        sections.append(PageSection("Recipe", [Listing(document)]))
    counts = [(topic, str(count)) for topic, count in sorted(record.counts.items())]
    sections.append(PageSection("Recorded topics", [Facts(counts, numbers=True)]))
    title = f"Door {result.door_id}: {came_to}"
    return render(Page(result.message, sections, title=title, good=came_to in (MILLED, NOT_MEASURED)))


def write_report(bag: Path, path: Path) -> None:
    """Write the report of a bag's last run.

    Raises:
        BagError: The bag cannot be read or holds no run.
    """
    write_atomically(path, render_report(read_run(bag)))
