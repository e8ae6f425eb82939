"""What radial distortion coefficients do inside a picture, and whether a lens can do that."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from doormill_ros.arrays import FloatArray

_NODES, _MOST_NODES = 60, 600  # grid points along the picture's height, and at most along its width


@dataclass(frozen=True)
class LensCheck:
    """Findings about r' = r (1 + k1 r^2 + k2 r^4 + k3 r^6), r at unit focal length.

    Attributes:
        fold: Smallest r > 0 at which r' stops growing; inf when it never does.
        reach: r' there: no ideal ray lands further out before the picture turns back on itself.
        corner: r' of the picture's farthest corner.
        blind_share: Share of the picture's area beyond `reach`, where a pixel has no ray of its own.
        corner_shift: How far an ideal ray to the farthest corner is moved by the lens, outwards [px].
        usable: Largest r up to which the coefficients stay below 2 % and grow.
    """

    fold: float
    reach: float
    corner: float
    blind_share: float
    corner_shift: float
    usable: float


def check_lens(k: FloatArray, size: tuple[int, int], radial: tuple[float, float, float]) -> LensCheck:
    """Examine radial coefficients.

    Args:
        k: Camera matrix [px], shape (3, 3).
        size: Picture width and height [px].
        radial: k1, k2, k3.
    """
    fold = fold_radius(radial)
    reach = float(distorted_radius(fold, radial)) if np.isfinite(fold) else float("inf")
    v, u = np.meshgrid(
        np.linspace(0, size[1] - 1, _NODES),
        np.linspace(0, size[0] - 1, min(max(_NODES * size[0] // size[1], 2), _MOST_NODES)),
        indexing="ij",
    )
    r = np.hypot((u - k[0, 2]) / k[0, 0], (v - k[1, 2]) / k[1, 1])
    corner, focal = float(r.max()), float(np.sqrt(k[0, 0] * k[1, 1]))
    steps = np.linspace(1e-4, min(fold, 2 * corner), 4000)
    off = np.abs(distorted_radius(steps, radial) / steps - 1.0) > 0.02
    return LensCheck(
        fold=fold,
        reach=reach,
        corner=corner,
        blind_share=float(np.mean(r > reach)),
        corner_shift=float(distorted_radius(corner, radial) - corner) * focal,
        usable=float(steps[np.argmax(off)]) if off.any() else float(steps[-1]),
    )


def distorted_radius(r: FloatArray | float, radial: tuple[float, float, float]) -> FloatArray | float:
    """Radius r' in the picture of ideal radius r, both of the same shape, at unit focal length."""
    s = np.square(r)
    return r * (1.0 + s * (radial[0] + s * (radial[1] + s * radial[2])))


def fold_radius(radial: tuple[float, float, float]) -> float:
    """Smallest r > 0 at which dr'/dr = 1 + 3 k1 r^2 + 5 k2 r^4 + 7 k3 r^6 vanishes; inf when nowhere."""
    k1, k2, k3 = radial
    # Of 1 / r^2, whose highest power keeps its factor of one where coefficients are next to nothing.
    roots = np.roots([1.0, 3.0 * k1, 5.0 * k2, 7.0 * k3])
    real = roots[np.abs(roots.imag) < 1e-9 * np.abs(roots)].real
    real = real[real > 0]
    return float(1.0 / np.sqrt(real.max())) if real.size else float("inf")
