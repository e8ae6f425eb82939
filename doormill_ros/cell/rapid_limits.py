"""Sizes of the arrays of our RAPID modules: what a controller keeps of a door, whoever writes it down."""

from __future__ import annotations

MAX_TARGETS = 2000  #: targets of a program (rapid/DoorPath.mod, and likewise the next three)
MAX_MOTIONS = 2000
MAX_FEATURES = 40
MAX_POINTS = 500  #: points of joint space
MAX_ESCAPE = 20  #: points of one way home (rapid/DoorStop.mod)
MAX_PLACES = 8  #: places of the rack (rapid/DoorTool.mod)
