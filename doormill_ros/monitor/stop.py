"""Why no door is milled before somebody decides, and what helps."""

from __future__ import annotations

from doormill_ros.units import m_to_mm

_REPAIR = "put right what model/verdict names, then name the first run after that in since of /model_monitor"


def stop_sentence(expected: float, limit: float, version: int, proposed: int, left: float) -> str:
    """The sentence under which milling is stopped.

    Args:
        expected: Error of the next door with the model in use [m].
        limit: Beyond which no door is milled [m].
        version: Of the model in use.
        proposed: Version of a better model; 0: none.
        left: Error of the next door with the better one [m]; negative: not known.
    """
    would = f"version {proposed} of the model would leave {m_to_mm(left):.2f} mm"
    if 0.0 <= left <= limit:
        helps = f"{would}: accept it (model/accept)"
    else:
        helps = f"{would}, too much as well: {_REPAIR}" if left >= 0.0 else _REPAIR
    return (
        f"the next door is expected to be {m_to_mm(expected):.2f} mm off where {m_to_mm(limit):.2f} mm are "
        f"allowed, by the last inspected doors and version {version} of the model; {helps}"
    )
