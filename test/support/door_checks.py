"""What shows each cause in milled doors without another door, of everything that doors are asked for."""

from __future__ import annotations

import numpy as np

from doormill_ros.diagnosis.parts.effects.registry import effects
from doormill_ros.diagnosis.parts.telling.next_door import checks_of

CHECKS = checks_of(effects(("hinge", "lock_case"), ("a", "b"), np.zeros((1, 6)), True, 99))
