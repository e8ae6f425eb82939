"""An effect in milled doors with the course of its size over them."""

from __future__ import annotations

from doormill_ros.diagnosis.core.course import OverTime
from doormill_ros.diagnosis.parts.effects.effect import Effect


class InTime(OverTime[Effect]):
    """An effect in milled doors with a course; not all of its columns are derivatives, see `Effect`."""
