"""What the thesis prints of its milling: cutter, prescribed ranges, mean process wrenches."""

from __future__ import annotations

from doormill_ros.recipes.tool import Tool
from doormill_ros.units import MM, RPM

INCH = 25.4e-3  #: metres in an inch
FOOT = 12.0 * INCH  #: metres in a foot
SURFACE_FOOT_PER_MINUTE = FOOT / 60.0  #: metres per second in a surface foot per minute (SFM)
#: The cutter of section 3.9: 19 mm, two flutes, 18000 rpm; chip load of similar tools, softwood.
THESIS_MILL = Tool("19 mm two-flute straight wood mill", 19.0 * MM, 2, 0.1, 18000.0 * RPM)
THESIS_CHIP_LOAD = (0.019 * INCH, 0.025 * INCH)  #: lowest and highest feed per tooth [m]
#: Lowest and highest surface speed in softwood [m/s].
THESIS_SURFACE_SPEED = (700.0 * SURFACE_FOOT_PER_MINUTE, 900.0 * SURFACE_FOOT_PER_MINUTE)

#: Table 4.8: flange axes [N, N m], in the order of milling.
THESIS_FORCES: dict[str, tuple[float, ...]] = {
    "left_line": (-209.0, 29.0, 12.0, -5.0, -43.0, 3.0),
    "top_turn": (-100.0, 13.0, 25.0, -3.0, -26.0, 2.0),
    "right_line": (-62.0, 3.0, -11.0, -1.0, -8.0, 2.0),
    "bottom_turn": (-13.0, 2.0, -22.0, -1.0, 4.0, 0.0),
}
