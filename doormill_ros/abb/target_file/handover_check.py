"""The handshake's look into the file before it is announced: complete, of this run, for this door."""

from __future__ import annotations

from doormill_ros.abb.errors import StaleRunError
from doormill_ros.abb.target_file.target_file import read_target_file


def check_handover(data: bytes, run_id: str, door_id: str) -> None:
    """Refuse what the robot program would refuse; for `Handshake(check=...)`.

    Args:
        data: The target file as read back from the controller.
        run_id: The run that was submitted.
        door_id: The door it was submitted for.

    Raises:
        AbbError: The file is cut short, changed, of another run or for another door.
    """
    target_file = read_target_file(data)
    target_file.check_for(door_id)
    if target_file.run_id != run_id:
        raise StaleRunError(
            f"the target file is of run {target_file.run_id!r}, submitted was run {run_id!r}: "
            "generate the path again",
            found=target_file.run_id,
            allowed=run_id,
        )
