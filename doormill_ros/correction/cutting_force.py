"""Mean force on a mill from the wood that it really removes.

Every edge takes a chip of thickness h = f_z (e . t) at the rim direction e, with the feed per edge f_z and the
direction of feed t. Per length of edge it meets k h + k_e along its motion (wood separated, and the edge's own rubbing)
and the share `radial` of that towards the axis. The mean over a turn, for the directions at which there is wood, is the
force that bends the robot; it turns with the feed and vanishes with the wood.

One figure is sourced: the specific force of chipboard, 32.0 N/mm2 (40 m/s) to 37.6 N/mm2 (60 m/s) in Palubicki,
Materials 14 (2021) 2208. All others, every edge force and every radial share are assumptions of that order, held by
what papers say without a number that was at hand here:
- MDF takes more power than spruce in edge milling (Sedlecky and Gasparik, BioResources 12 (2017) 7413); its constants
  follow its density, which changes through the board (Engin et al., Forest Products Journal, 2000), while the
  cutting speed hardly matters (Coatings 14 (2024) 1085).
- Pine: cutting along the grain takes 33 % more force in mature than in juvenile wood, across it 12 % (Pinus taeda,
  Scientia Agricola). How to predict a force is "far from solved" (Porankiewicz et al., BioResources 6 (2011)), density
  alone is a rough measure (Chuchala et al., BioResources 9 (2014) 5349), and woods of one density can differ
  completely (Eyma et al., Annals of Forest Science 62 (2005) 441). Hence half of the force as the spread of solid wood.
- Oak takes more than beech (Moradpour et al., Drvna industrija 67 (2016)); no figure stood beside it.
- Plywood and honeycomb: nothing was found. A hollow core has no force at all, so the spread is the whole of it.
Wear is not in the spread.
"""

from __future__ import annotations

import functools
from dataclasses import dataclass

import numpy as np

from doormill_ros.arrays import BoolArray, FloatArray
from doormill_ros.recipes.door import Material

DIRECTIONS = 72  #: rim directions of a turn that are looked at
AXIAL_SHARE = 0.5  #: of the specific force, along the axis, under a mill that is plunged


@dataclass(frozen=True)
class CuttingCoefficients:
    """What a material does to an edge.

    Attributes:
        specific: Along the motion of the edge, by cross-section of the chip [N/m^2].
        edge: The same by length of the edge, however thin the chip [N/m].
        radial: Force towards the axis as a share of that along the motion.
        spread: Standard deviation of the force as a share of it.
    """

    specific: float
    edge: float
    radial: float
    spread: float


COEFFICIENTS = {
    Material.SOFTWOOD: CuttingCoefficients(30e6, 2.0e3, 0.3, 0.5),  # along and across the grain
    Material.HARDWOOD: CuttingCoefficients(50e6, 3.0e3, 0.3, 0.5),
    Material.PLYWOOD: CuttingCoefficients(40e6, 3.0e3, 0.4, 0.7),  # nothing found
    Material.CHIPBOARD: CuttingCoefficients(35e6, 3.0e3, 0.4, 0.4),  # specific: sourced
    Material.MDF: CuttingCoefficients(40e6, 3.0e3, 0.4, 0.6),  # by its density, too
    Material.HONEYCOMB: CuttingCoefficients(
        35e6, 3.0e3, 0.4, 1.0
    ),  # of a skin: nothing where the core is hollow
}


@functools.cache
def rim_directions() -> FloatArray:
    """Unit vectors round the tool axis at which chips are looked at, shape (DIRECTIONS, 2); locked."""
    angle = 2.0 * np.pi * (np.arange(DIRECTIONS) + 0.5) / DIRECTIONS
    directions = np.column_stack([np.cos(angle), np.sin(angle)])
    directions.setflags(write=False)
    return directions


def advance(feed: FloatArray) -> FloatArray:
    """Share of the feed along each of `rim_directions`, shapes (..., 2) -> (..., DIRECTIONS).

    Where it is not above 0 no chip is taken, whether there is wood or not.
    """
    return feed @ rim_directions().T


def mean_force(
    engaged: BoolArray, feed: FloatArray, chip: float, flutes: int, material: CuttingCoefficients
) -> FloatArray:
    """Mean force on a mill that moves across its axis, by depth of the cut.

    Args:
        engaged: Whether there is wood at each of `rim_directions`, shape (..., DIRECTIONS).
        feed: Unit direction of the feed, shape (..., 2) that fits; the first axis turned into the second is the sense
            in which the spindle turns, clockwise seen from the spindle and so positive about an axis into the wood.
        chip: Feed per edge [m].
        flutes: Number of edges.
        material: What is cut.

    Returns:
        Force on the tool in the axes of `feed`, shape (..., 2) [N per m of depth].
    """
    ahead = advance(feed)
    by_edge = np.where(ahead > 0.0, material.specific * chip * ahead + material.edge, 0.0)  # [N/m]
    force: FloatArray = flutes * ((engaged * by_edge) @ _on_tool(material.radial)) / DIRECTIONS
    return force


@functools.cache
def _on_tool(radial: float) -> FloatArray:
    """What an edge at each of `rim_directions` does to the tool for a force of 1 along it, shape (DIRECTIONS, 2)."""
    rim = rim_directions()
    motion = np.column_stack([-rim[:, 1], rim[:, 0]])
    return -(motion + radial * rim)


def plunge_force(
    share: float, radius: float, chip: float, flutes: int, material: CuttingCoefficients
) -> float:
    """Force along the axis, out of the wood, on a mill that moves along its axis [N].

    Args:
        share: Of the area under the mill on which there is wood.
        radius: Of the mill [m].
        chip: Feed per edge [m].
        flutes: Number of edges.
        material: What is cut.
    """
    return share * flutes * radius * AXIAL_SHARE * (material.specific * chip + material.edge)


def wrench_std(wrench: FloatArray, material: CuttingCoefficients) -> FloatArray:
    """Standard deviations of computed wrenches along any axes, shapes (n, 6) [N, N m].

    As wide in every direction: grain and wear turn the force as much as they change it.
    """
    sizes = np.linalg.norm(wrench.reshape(-1, 2, 3), axis=2)
    spread: FloatArray = np.repeat(material.spread * sizes, 3, axis=1) / np.sqrt(3.0)
    return spread
