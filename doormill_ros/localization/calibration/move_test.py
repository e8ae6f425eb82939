"""Whether a single move of the list is not what the picture shows.

One move that is wrong is lost in the chi-square of hundreds of edge points; held against its own deviation it is not.
"""

from __future__ import annotations

import numpy as np
from scipy.special import ndtri

from doormill_ros.arrays import FloatArray
from doormill_ros.localization.calibration.errors import PoorlySpread
from doormill_ros.localization.calibration.moved_door import MovedDoor
from doormill_ros.localization.sensors.fit import Linearised, whiten
from doormill_ros.units import m_to_mm

FALSE_ALARMS = 1.0e-3  #: Share of lists without a wrong move that are refused.
_BLIND = 1.0e-6  # share of a shift's effect that is left once the camera may follow it


def check_moves(moved: list[MovedDoor], shares: FloatArray, model: Linearised) -> None:
    """Refuse a list in which a door stands elsewhere along an axis than its entry says.

    Args:
        moved: The pictures.
        shares: What a shift of each picture's door along base x, y, z does to all misses, shape (n, pictures, 3).
        model: The misses against the mounting that was found, its covariance with all that is not known.

    Raises:
        PoorlySpread: One does.
    """
    columns = shares.reshape(len(shares), -1)
    residual, jacobian = whiten(model)
    effects = whiten(Linearised(model.residual, columns, model.covariance))[1]
    base = np.linalg.qr(jacobian)[0]
    left = effects - base @ (base.T @ effects)
    weight = np.sum(left**2, axis=0)
    told = weight > _BLIND * np.sum(effects**2, axis=0)
    shift = np.divide(left.T @ residual, weight, out=np.zeros_like(weight), where=told)
    score = np.abs(shift) * np.sqrt(weight)
    most = -ndtri(FALSE_ALARMS / 2.0 / max(1, int(np.count_nonzero(told))))
    worst = int(np.argmax(score))
    if score[worst] <= most:
        return
    picture, axis = divmod(worst, 3)
    move = ", ".join(f"{m_to_mm(v):g}" for v in moved[picture].move)
    raise PoorlySpread(
        f"picture {picture + 1}, moved by x, y, z = {move} mm, shows its door {m_to_mm(shift[worst]):+.3f} mm along "
        f"{'xyz'[axis]} from there, {score[worst]:.1f} standard deviations, allowed are {most:.1f}; check the list of "
        "moves against the pictures and the gauge blocks",
    )
