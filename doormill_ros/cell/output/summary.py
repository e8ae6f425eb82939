"""summary.json: how one simulated run ended, in numbers (schema doormill/run/1)."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass, field
from pathlib import Path

from doormill_ros.cell.output.schemas import RUN
from doormill_ros.cell.places.layout import DoorOffset
from doormill_ros.cell.places.tolerance import TOLERANCE
from doormill_ros.files import write_atomically


@dataclass(frozen=True)
class StageDurations:
    """How long each stage took [s]; zero for a stage that was not reached."""

    picture_to_pose: float = 0.0
    pose_to_targets: float = 0.0
    targets_to_ready: float = 0.0
    request_to_ready: float = 0.0


@dataclass(frozen=True)
class FeatureError:
    """Largest distance of contours and floors from the recipe on the true door [m], and of which feature as milled."""

    uncorrected_max: float = 0.0
    corrected_max: float = 0.0
    tolerance: float = TOLERANCE
    feature: str = ""


@dataclass(frozen=True)
class TouchedBody:
    """Something that was touched in a run and must not be; see doormill_interfaces/Touch; place in the door frame."""

    body: str
    obstacle: str
    motion: int
    feature: str
    time: float
    depth: float
    volume: float
    samples: int
    place: tuple[float, float, float]


@dataclass(frozen=True)
class Touched:
    """What the judge of the simulated run found; samples of the executed path and volume of wood [m^3]."""

    known: bool = False
    judged: int = 0
    samples: int = 0
    volume: float = 0.0
    message: str = ""
    bodies: tuple[TouchedBody, ...] = ()


@dataclass(frozen=True)
class CycleTime:
    """How long the door takes with finding it, as predicted [s]; zeros where no program was made.

    Attributes:
        one: By one robot.
        allowed: By appendix A.1 of the thesis.
        two: By two robots that mill at once; 0 where one keeps what is allowed, or two cannot mill the door.
        reason: Why two cannot.
    """

    one: float = 0.0
    allowed: float = 0.0
    two: float = 0.0
    reason: str = ""

    @property
    def sentence(self) -> str:
        """For whoever reads the report."""
        text = f"{self.one:.1f} s with finding the door, allowed are {self.allowed:.1f} s: "
        if self.one <= self.allowed:
            return text + "kept"
        if self.reason:
            return text + f"exceeded by one robot, and two cannot mill it: {self.reason}"
        return text + f"exceeded by one robot; two that mill at once would need {self.two:.1f} s"


@dataclass(frozen=True)
class RunSummary:
    """Content of summary.json; metres, seconds, radians.

    `outcome` is "milled", "milled, out of tolerance", "milled, not measured" or "refused (CODE)". `model_version` is
    that of the robot model in the store of models, 0 for the one that the path generator was started with.
    """

    door_id: str
    success: bool
    message: str
    error_code: int = 0
    run_id: str = ""
    recipe_version: int = 0
    target_file: str = ""
    sha256: str = ""
    bag: str = ""
    report: str = ""
    largest_correction: float = 0.0
    expected_error: float = 0.0
    robot_model: str = ""
    model_version: int = 0
    times: StageDurations = field(default_factory=StageDurations)
    localization_error: DoorOffset = field(default_factory=DoorOffset)
    feature_error: FeatureError = field(default_factory=FeatureError)
    touched: Touched = field(default_factory=Touched)
    cycle: CycleTime = field(default_factory=CycleTime)
    measured: bool = False
    outcome: str = ""

    def write(self, path: Path) -> None:
        """Write the file at once, so that no reader sees half of it."""
        write_atomically(path, json.dumps({"schema": RUN, **asdict(self)}, indent=2) + "\n")


def localization_error(found: DoorOffset, true: DoorOffset) -> DoorOffset:
    """Localized minus true offset."""
    return DoorOffset(found.y - true.y, found.z - true.z, found.rotation - true.rotation)
