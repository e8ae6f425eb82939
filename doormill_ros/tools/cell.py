"""Tool `cell`: run the whole cell in one process on simulated hardware and mill one door."""

from __future__ import annotations

import argparse
import sys
from datetime import UTC, datetime
from pathlib import Path

from doormill_ros.cell.run_folder import point_latest
from doormill_ros.units import deg_to_rad, m_to_mm, mm_to_m, rad_to_deg


def parse(arguments: list[str] | None) -> argparse.Namespace:
    """Read the command line."""
    parser = argparse.ArgumentParser(prog="cell", description=__doc__)
    parser.add_argument("--door", required=True, metavar="ID", help="door to mill, for example standard_door")
    parser.add_argument(
        "--out", type=Path, metavar="DIR", help="where the run's files go; default: out/latest"
    )
    parser.add_argument("--seed", type=int, default=0, help="of the door's placement and the picture's noise")
    parser.add_argument(
        "--offset",
        nargs=3,
        type=float,
        metavar=("Y", "Z", "DEG"),
        help="place the door this far off: mm, mm, degrees",
    )
    parser.add_argument("--robot-model", metavar="YAML", help="model.yaml of a diagnosis for the correction")
    parser.add_argument(
        "--effects", metavar="YAML", help="what the simulated robot hides, see docs/diagnosis.md"
    )
    parser.add_argument("--no-pictures", action="store_true", help="simulate a broken camera")
    parser.add_argument(
        "--ui",
        nargs="?",
        type=int,
        const=8080,
        metavar="PORT",
        help="serve the operator's page and keep the cell up after the door; default port: 8080, 0: any",
    )
    parser.add_argument("--ui-host", metavar="HOST", help="address of that page; default: 127.0.0.1")
    parser.add_argument(
        "--control", action="store_true", help="print a token with which that page starts and cancels runs"
    )
    options = parser.parse_args(arguments)
    if options.ui is None and (options.control or options.ui_host):
        parser.error("--control and --ui-host belong to the operator's page: add --ui")
    return options


def main(arguments: list[str] | None = None) -> int:
    """Run; 0 when the door was milled, 1 when it was refused."""
    options = parse(arguments)
    # Late, so that --help answers at once.
    from doormill_ros.cell.summary import RunSummary
    from doormill_ros.nodes.cell import CellOptions, run_once
    from doormill_ros.nodes.run import interrupt_once
    from doormill_ros.operator.token import new_token
    from doormill_ros.report.run_report import write_report

    if arguments is None:
        interrupt_once()
    camera: dict[str, object] = {"seed": options.seed, "pictures": not options.no_pictures}
    if options.offset is not None:
        y, z, rotation = options.offset
        camera |= {"offset_y": mm_to_m(y), "offset_z": mm_to_m(z), "offset_rotation": deg_to_rad(rotation)}
    parameters: dict[str, dict[str, object]] = {"camera_simulator": camera}
    if options.robot_model:
        parameters["path_generator"] = {"robot_model": Path(options.robot_model).resolve()}
    if options.effects:
        parameters["controller_simulator"] = {"effects": Path(options.effects).resolve()}
    latest = Path("out/latest")
    folder = options.out or Path("out/runs") / datetime.now(UTC).strftime("%Y%m%dT%H%M%S%fZ")

    def progress(stage: str, share: float) -> None:
        print(f"[{share:4.0%}] {stage}", file=sys.stderr, flush=True)

    token = None
    if options.ui is not None:
        page: dict[str, object] = {"port": options.ui}
        if options.out is None:
            page["history"] = folder.parent.resolve()
        if options.ui_host:
            page["host"] = options.ui_host
        parameters["operator_page"] = page
        if options.control:
            token = new_token()
            print(f"operator's token  {token}", flush=True)

    def milled(summary: RunSummary) -> None:
        print(f"{summary.message}\nthe cell stays up for the operator's page; end it with Ctrl-C", flush=True)

    cell = CellOptions(parameters, page=options.ui is not None, token=token)
    summary = run_once(options.door, folder, cell, progress, milled)
    write_report(Path(summary.bag), Path(summary.report))
    if options.out is None:
        point_latest(folder, latest)
        folder = latest
    print(summary.message)
    if summary.success:
        error, feature = summary.localization_error, summary.feature_error
        print(
            f"localization error {m_to_mm(error.y):+.4f} mm, {m_to_mm(error.z):+.4f} mm, "
            f"{rad_to_deg(error.rotation):+.4f} degrees; feature error {m_to_mm(feature.corrected_max):.3f} mm "
            f"(uncorrected {m_to_mm(feature.uncorrected_max):.3f}, tolerance {m_to_mm(feature.tolerance):.1f})"
        )
        print(f"RAPID file  {folder / 'targets' / Path(summary.target_file).name}")
    print(f"bag         {folder / 'bag'}")
    print(f"report      {folder / 'report.html'}")
    print(f"summary     {folder / 'summary.json'}")
    return 0 if summary.success else 1


if __name__ == "__main__":
    sys.exit(main())
