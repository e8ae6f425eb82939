"""The plant about the spindle: its drawbar, the rack whose tools it takes, and the gauge that they press."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.cell.places.rack import Rack
from doormill_ros.units import m_to_mm

DRAWBAR_OPEN, RELEASED, CLAMPED = "doDrawbarOpen", "diToolReleased", "diToolClamped"
#: Output to the drawbar's valve, where the cell has one of its own behind a cross connection.
DRAWBAR_RUN = "doDrawbarRun"
GAUGE = "aiToolGauge"
DRAWBAR_TIME = 0.4  #: in which the drawbar opens or closes [s]
SEATED = 1e-3  #: a spindle this close to the seat of a place holds or leaves the tool there [m]
TILTED = 2e-3  #: and by no more than this beside its direction, as the sine
BESIDE = 5e-3  #: a tool that comes down further beside the gauge does not press it [m]
PRESSED, STROKE = 0.010, 0.020  #: of the gauge at the end of the way to it, and at most [m]


@dataclass(eq=False)
class RackFaults:
    """What may be wrong with the tools; set by whoever tries a program.

    Attributes:
        missing: Tools that do not stand in their places.
        drawbar_opens: False for a drawbar that stays closed.
        drawbar_holds: False for one that closes without holding a tool.
        longer: By how much tools stand out further than they should [m].
        gauge_stuck: What the gauge reads whatever presses it [mm]; None for one that moves.
    """

    missing: set[str] = field(default_factory=set)
    drawbar_opens: bool = True
    drawbar_holds: bool = True
    longer: dict[str, float] = field(default_factory=dict)
    gauge_stuck: float | None = None


class ToolRack:
    """Which tool is where.

    Attributes:
        carried: Tool in the spindle, empty for none.
        standing: Tool in each place, empty for none.
        faults: What is wrong with them.
        harm: What went wrong, in sentences: tools that fell, two tools in one place.
    """

    def __init__(self, rack: Rack | None, forward: Callable[[FloatArray], FloatArray]) -> None:
        """Hold the tool of the first place in the spindle and the others in theirs.

        Args:
            rack: Where tools stand; None for a spindle whose tool people change.
            forward: T_base_flange of joint angles, (6,) [rad] -> (4, 4).
        """
        places = () if rack is None else rack.places
        self.carried = places[0].tool if places else ""
        self.standing = ["", *(place.tool for place in places[1:])] if places else []
        self.faults = RackFaults()
        self.harm: list[str] = []
        self._seats = [] if rack is None else [_ahead(forward(p.front), rack.depth) for p in places]
        self._gauge = None if rack is None else _ahead(forward(rack.gauge.front), rack.gauge.depth)
        self._open = False
        self._due: float | None = None

    @property
    def longer(self) -> float:
        """How much further the tool in the spindle stands out than it should [m]."""
        return self.faults.longer.get(self.carried, 0.0)

    def order(self, now: float) -> None:
        """The drawbar was told to open or to close at simulated time `now` [s]."""
        self._due = now + DRAWBAR_TIME

    @property
    def next_event(self) -> float | None:
        """When the drawbar has moved [s]; None while it does not."""
        return self._due

    def advance(self, now: float, opened: bool, T_base_flange: FloatArray, turning: bool) -> None:
        """Let the drawbar come to where it was told to, once it is due.

        Args:
            now: Simulated time [s].
            opened: It was told to open.
            T_base_flange: Where the spindle is, shape (4, 4).
            turning: The spindle turns.
        """
        if self._due is None or now < self._due:
            return
        self._due = None
        if opened and turning:
            self.harm.append("the drawbar opened while the spindle turned")
        if opened and self.faults.drawbar_opens and not self._open:
            self._open = True
            self._let_go(self._seat_at(T_base_flange))
        elif not opened and self._open:
            self._open = False
            self._grip(self._seat_at(T_base_flange))

    def hold(self, place: int | None) -> None:
        """Somebody puts the tool back, and that of a place into the spindle; None for no other."""
        tools = [tool or self.carried for tool in self.standing]
        self.carried = "" if place is None else tools[place]
        self.standing = ["" if number == place else tool for number, tool in enumerate(tools)]

    @property
    def opened(self) -> bool:
        """Whether the drawbar is open."""
        return self._open

    def signals(self) -> Mapping[str, float]:
        """What the drawbar's sensors say."""
        return {RELEASED: float(self._open), CLAMPED: float(not self._open and bool(self.carried))}

    def gauge(self, T_base_flange: FloatArray) -> float:
        """How far the gauge is pressed [mm] by the tool at a flange pose of shape (4, 4)."""
        if self.faults.gauge_stuck is not None:
            return self.faults.gauge_stuck
        if self._gauge is None or not self.carried:
            return 0.0
        axis = self._gauge[:3, 2]
        off = T_base_flange[:3, 3] - self._gauge[:3, 3]
        along = float(off @ axis)
        if float(np.linalg.norm(off - along * axis)) > BESIDE:
            return 0.0
        return float(m_to_mm(np.clip(PRESSED + along + self.longer, 0.0, STROKE)))

    def _seat_at(self, T_base_flange: FloatArray) -> int | None:
        for number, seat in enumerate(self._seats):
            near = float(np.linalg.norm(T_base_flange[:3, 3] - seat[:3, 3])) < SEATED
            if near and float(np.linalg.norm(np.cross(T_base_flange[:3, 2], seat[:3, 2]))) < TILTED:
                return number
        return None

    def _let_go(self, place: int | None) -> None:
        if not self.carried:
            return
        if place is None:
            self.harm.append(f"tool {self.carried!r} fell")
        elif self.standing[place]:
            self.harm.append(f"tool {self.carried!r} met {self.standing[place]!r} in place {place + 1}")
        else:
            self.standing[place] = self.carried
        self.carried = ""

    def _grip(self, place: int | None) -> None:
        if place is None or not self.standing[place] or not self.faults.drawbar_holds:
            return
        if self.standing[place] not in self.faults.missing:
            self.carried, self.standing[place] = self.standing[place], ""


def _ahead(T: FloatArray, depth: float) -> FloatArray:
    """A pose further along its own z axis [m]."""
    ahead = T.copy()
    ahead[:3, 3] += depth * T[:3, 2]
    return ahead
