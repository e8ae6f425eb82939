"""What a robot really did while it ran a milling program."""

from __future__ import annotations

from dataclasses import dataclass, field, fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

from doormill_ros.arrays import BoolArray, FloatArray, IntArray

_WATCHED = ("spindle_on", "at_speed", "guard_closed", "driven")
_UNWATCHED = np.ones(0, dtype=bool)


@dataclass(frozen=True, eq=False)
class ExecutedPath:
    """Samples of one executed program in the order of time; arrays are copied and read-only.

    Between two samples of the same motion the tool moved on a straight line, so arcs must be
    sampled finely enough for the purpose.

    Attributes:
        time: Seconds since the start, shape (n,), never decreasing.
        T_base_tool: Where the tool really was, shape (n, 4, 4).
        T_base_tool_commanded: Where the controller believed the tool was, shape (n, 4, 4).
        q: Commanded joint angles, shape (n, 6) [rad].
        motion: Index of the executed motion instruction, shape (n,), int.
        cutting: Whether the motion cuts wood, shape (n,), bool.
        feature: Feature that is being milled, empty between features, shape (n,), str.
        wrench: Process wrench on the tool at the tool centre point, base axes, shape (n, 6) [N, N m].
        spindle_on: Whether the spindle was told to turn, shape (n,), bool; as the three that follow true
            throughout where nobody watched it.
        at_speed: Whether the spindle said that it was at speed, shape (n,), bool.
        guard_closed: Whether the door circuit was closed, shape (n,), bool.
        driven: False while the arm ran on without power, shape (n,), bool.
        tool: Tool that the rack's plant had in the spindle, empty for none, shape (n,), str; None where nobody watched.
    """

    time: FloatArray
    T_base_tool: FloatArray
    T_base_tool_commanded: FloatArray
    q: FloatArray
    motion: IntArray
    cutting: BoolArray
    feature: NDArray[np.str_]
    wrench: FloatArray
    spindle_on: BoolArray = field(default_factory=lambda: _UNWATCHED)
    at_speed: BoolArray = field(default_factory=lambda: _UNWATCHED)
    guard_closed: BoolArray = field(default_factory=lambda: _UNWATCHED)
    driven: BoolArray = field(default_factory=lambda: _UNWATCHED)
    tool: NDArray[np.str_] | None = None

    def __post_init__(self) -> None:
        """Copy, check shapes and freeze.

        Raises:
            ValueError: An array has the wrong shape, is not finite, or time runs backwards.
        """
        n = len(np.asarray(self.time))
        shapes = {
            "time": (n,),
            "T_base_tool": (n, 4, 4),
            "T_base_tool_commanded": (n, 4, 4),
            "q": (n, 6),
            "motion": (n,),
            "cutting": (n,),
            "feature": (n,),
            "wrench": (n, 6),
        }
        kinds = {"motion": int, "feature": str, **dict.fromkeys(("cutting", *_WATCHED), bool)}
        shapes.update(dict.fromkeys(_WATCHED, (n,)))
        shapes["tool"], kinds["tool"] = (n,), str
        for item in fields(self):
            given = getattr(self, item.name)
            if given is None:
                continue
            given = np.ones(n, dtype=bool) if given is _UNWATCHED else given
            values: NDArray[Any] = np.array(given, dtype=kinds.get(item.name, float))
            if values.shape != shapes[item.name]:
                raise ValueError(f"{item.name} has shape {values.shape}, allowed is {shapes[item.name]}")
            if values.dtype.kind == "f" and not np.all(np.isfinite(values)):
                raise ValueError(f"{item.name} holds values that are not finite")
            values.setflags(write=False)
            object.__setattr__(self, item.name, values)
        if np.any(np.diff(self.time) < 0.0):
            raise ValueError("time runs backwards, allowed is a time that never decreases")

    def __len__(self) -> int:
        """Number of samples."""
        return len(self.time)
