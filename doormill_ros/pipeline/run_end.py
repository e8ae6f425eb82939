"""How a run ended, as far as it got."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from doormill_ros.cell.errors import OutOfToleranceError
from doormill_ros.cell.output.inspection import MeasuredDoor
from doormill_ros.cell.output.summary import StageDurations
from doormill_ros.units import m_to_mm, s_to_ms


@dataclass
class RunEnd:
    """How a run ended; what it did not reach stays empty.

    Attributes:
        run_id: Which run.
        door_id: Its door.
        success: The door is milled, and within tolerance wherever it was measured.
        milled: The robot milled it to its end, well or not.
        error_code: Code of what ended it, 0 on success.
        message: What happened; for a refusal what is wrong and what to do.
        target_file: Path of the copy; empty after a refusal.
        sha256: Of the target file; empty after a refusal.
        recipe_version: Of the recipe that was milled.
        largest_correction: Of the program [m].
        robot_model: That the targets were corrected with.
        model_version: Of it in the store of models; 0 for the model that the path generator was started with.
        inspection: How the door came out.
        times: How long each stage took.
    """

    run_id: str
    door_id: str
    success: bool = False
    milled: bool = False
    error_code: int = 0
    message: str = ""
    target_file: str = ""
    sha256: str = ""
    recipe_version: int = 0
    largest_correction: float = 0.0
    robot_model: str = ""
    model_version: int = 0
    inspection: MeasuredDoor = field(default_factory=MeasuredDoor)
    times: StageDurations = field(default_factory=StageDurations)

    def refuse(self, error_code: int, reason: str) -> None:
        """The run came to nothing."""
        self.success = False
        self.error_code = error_code
        self.message = f"door {self.door_id}: {reason}"
        self.target_file = self.sha256 = ""

    def note_milled(self, targets: int, data: bytes, path: Path, inspection: MeasuredDoor) -> None:
        """The robot milled the door to its end; a success unless it was measured and found out of tolerance.

        Args:
            targets: How many the program has.
            data: The target file.
            path: Its copy.
            inspection: How the door came out.
        """
        self.target_file = str(path)
        self.sha256 = hashlib.sha256(data).hexdigest()
        self._note(
            inspection,
            f"{targets} targets, largest correction {m_to_mm(self.largest_correction):.3f} mm, ready "
            f"{s_to_ms(self.times.request_to_ready):.0f} ms after the request",
        )

    def note_shares_milled(self, files: Mapping[str, str], inspection: MeasuredDoor) -> None:
        """The robots milled their shares to the end.

        Args:
            files: Copy of the target file of each robot that had something to mill, by the robot's name.
            inspection: How the door came out.
        """
        said = ", ".join(f"{robot} robot by {Path(file).name}" for robot, file in files.items())
        self._note(inspection, f"{said}, largest correction {m_to_mm(self.largest_correction):.3f} mm")

    def note_unseen_milling(self, inspection: MeasuredDoor) -> None:
        """The same of a run whose bridge was started again while the robot milled.

        Args:
            inspection: How the door came out.
        """
        self._note(inspection, "the bridge ended in the middle of the run, the robot did not")

    def _note(self, inspection: MeasuredDoor, how: str) -> None:
        self.milled = True
        self.inspection = inspection
        self.success = not inspection.out_of_tolerance
        self.message = inspection.told_of(self.door_id, how)
        if not self.success:
            self.error_code = OutOfToleranceError.code
