"""What README.md prints: how much further off the door stands than in the thesis."""

from __future__ import annotations

from doormill_ros.cell.places.layout import load_layout
from support.page_figures import number_of

#: Flange x of a door without thickness in table 4.4 of the thesis [m].
THESIS_FLANGE = 1.400


def further_off() -> float:
    """Rear face of the door, less that of the thesis' region [m]."""
    return load_layout().rear_face_x - THESIS_FLANGE - number_of("config/cell.yaml#tool.position.2")
