"""Judge a place of the robot by the programs it makes possible: doors of a whole range, with all their ways."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.cell.graph.two_robots import FIRST, SECOND
from doormill_ros.cell.places.layout import CellLayout, DoorOffset
from doormill_ros.errors import DoormillError
from doormill_ros.frames import transform
from doormill_ros.recipes.features.hinge_pocket import HingePocket
from doormill_ros.recipes.recipe import Recipe
from doormill_ros.robot.description import Robot
from doormill_ros.toolpath.air.route import route
from doormill_ros.toolpath.beside import place_of
from doormill_ros.toolpath.door_plan import whole_door
from doormill_ros.toolpath.mills.waiting_tools import beside_rack
from doormill_ros.toolpath.settings import PathSettings
from doormill_ros.toolpath.split import Share, split
from doormill_ros.units import m_to_mm
from doormill_ros.workspace.doors import DoorRange

WIDTHS = 3  #: doors of so many widths between the narrowest and the widest
THINNEST = 0.030  #: a door needs wood to be milled; the range may begin at none [m]
HINGES = 5  #: along the height, so that one of them meets whatever lies badly there
LARGEST_CLAMP = 2.0  #: larger things under the door's place are floor, not clamp [m]

#: Shares of a door that stands at a pose in the first robot's base frame, shape (4, 4), each with the cell about who
#: mills it.
SharesOf = Callable[[Recipe, FloatArray], Sequence[tuple[Share, CellLayout]]]


@dataclass(frozen=True)
class PlannedDoors:
    """Doors planned at one place.

    Attributes:
        planned: How many.
        refused: How many of them cannot be milled there.
        reason: Why the first of those cannot; empty when all can.
    """

    planned: int
    refused: int
    reason: str


def layout_at(layout: CellLayout, corner: FloatArray, doors: DoorRange) -> CellLayout:
    """The cell with the door where the flange's box begins at `corner`, its clamp moved along.

    Args:
        layout: The cell.
        corner: Smallest flange coordinates of the box, base frame, shape (3,) [m].
        doors: Range of doors that the box was made for.
    """
    tool = float(layout.T_flange_tool[2, 3])
    to = np.array(
        [
            corner[0] + doors.thickness[1] + tool,
            corner[1] + doors.width[1] / 2.0,
            corner[2] - doors.hinge_end,
        ]
    )
    by = to - [layout.rear_face_x, layout.centre_y, layout.bottom_z]
    # What touches the door's place stands with it; floor and pedestal with the robot.
    with_door = np.array([layout.rear_face_x, layout.centre_y])
    obstacles = []
    for body in layout.obstacles:
        low, high = body.corners.min(axis=0) - body.margin, body.corners.max(axis=0) + body.margin
        touches = np.all(low[:2] <= with_door) and np.all(with_door <= high[:2])
        near = bool(touches and (high - low).max() < LARGEST_CLAMP)
        obstacles.append(body.mapped(transform(translation=by)) if near else body)
    x, y, z = to.tolist()
    return replace(layout, rear_face_x=x, centre_y=y, bottom_z=z, obstacles=tuple(obstacles))


def sample_doors(template: Recipe, doors: DoorRange, everything: bool) -> list[Recipe]:
    """Doors from all over a range.

    Args:
        template: Whose hinges, tools and forces they have, and whose other features if `everything`.
        doors: The range.
        everything: With lock case and holes, for one robot alone; False for hinges.
    """
    hinge = next(feature for feature in template.features if isinstance(feature, HingePocket))
    others = [feature for feature in template.features if not isinstance(feature, HingePocket)]
    heights = np.linspace(doors.hinge_end, doors.height - doors.hinge_end, HINGES)
    hinges = [replace(hinge, id=f"hinge_{i + 1}", height=float(h)) for i, h in enumerate(heights)]
    found = []
    for width in np.linspace(*doors.width, WIDTHS):
        for thickness in {max(THINNEST, doors.thickness[0]), doors.thickness[1]}:
            features = [*hinges, *others] if everything else hinges
            found.append(
                replace(
                    template,
                    width=float(width),
                    thickness=float(thickness),
                    height=doors.height,
                    features=tuple(features),
                )
            )
    return found


def plan_doors(
    recipes: Sequence[Recipe],
    layout: CellLayout,
    robot: Robot,
    settings: PathSettings,
    most: int | None = None,
) -> PlannedDoors:
    """How many doors can be milled at a place, displaced as far as the cell accepts.

    Args:
        recipes: The doors.
        layout: The cell with the door at that place.
        robot: Who mills.
        settings: Values of config/toolpath.yaml.
        most: Refusals after which the rest is not looked at; None for all doors.
    """
    about = beside_rack(layout, robot, settings, {})

    def whole(recipe: Recipe, T_base_door: FloatArray) -> list[tuple[Share, CellLayout]]:
        return [(Share(FIRST, tuple(whole_door(recipe)), T_base_door), about)]

    return _planned(recipes, layout, robot, settings, whole, most)


def plan_shares(
    recipes: Sequence[Recipe], layout: CellLayout, robot: Robot, settings: PathSettings
) -> PlannedDoors:
    """How many doors two robots can mill, each its share; a door is refused when one of them cannot.

    Each is planned while the other one waits at home.

    Args:
        recipes: The doors.
        layout: The cell with the door at its place before the first robot.
        robot: Both of them.
        settings: Where the second one stands in that cell.
    """
    places = {
        name: beside_rack(place_of(name, layout, robot, settings), robot, settings, {})
        for name in (FIRST, SECOND)
    }

    def halves(recipe: Recipe, T_base_door: FloatArray) -> list[tuple[Share, CellLayout]]:
        return [(share, places[share.robot]) for share in split(recipe, T_base_door, settings)]

    return _planned(recipes, layout, robot, settings, halves, None)


def _planned(
    recipes: Sequence[Recipe],
    layout: CellLayout,
    robot: Robot,
    settings: PathSettings,
    shares_of: SharesOf,
    most: int | None,
) -> PlannedDoors:
    """As `plan_doors`, for however many robots."""
    refused, planned, reason = 0, 0, ""
    limits = layout.limits
    for recipe, sign in itertools.product(recipes, (-1.0, 1.0)):
        offset = DoorOffset(sign * limits.y, sign * limits.z, sign * limits.rotation)
        planned += 1
        who = ""
        try:
            shares = shares_of(recipe, layout.T_base_door(recipe.width, recipe.thickness, offset))
            for share, about in shares:
                who = f", {share.robot} robot" if len(shares) > 1 else ""
                if share.operations:
                    route(recipe, share.operations, share.T_base_door, about, robot, settings)
        except DoormillError as error:
            refused += 1
            size = f"{m_to_mm(recipe.width):.0f} x {m_to_mm(recipe.thickness):.0f} mm"
            reason = reason or f"{size}{who}: {error.message}"
            if most is not None and refused > most:
                break
    return PlannedDoors(planned, refused, reason)


def second_at(settings: PathSettings, layout: CellLayout, moved: CellLayout) -> PathSettings:
    """The settings with the second robot as far beyond a moved door as it stands beyond the cell's.

    Args:
        settings: For the cell as it is.
        layout: The cell as it is.
        moved: The cell with the door at another place before the first robot.
    """
    second = settings.second_robot
    by = np.array([moved.rear_face_x - layout.rear_face_x, moved.centre_y - layout.centre_y, 0.0])
    return replace(settings, second_robot=replace(second, position=second.position + 2.0 * by))


def best_place(
    corners: Iterable[FloatArray],
    recipes: Sequence[Recipe],
    doors: DoorRange,
    layout: CellLayout,
    robot: Robot,
    settings: PathSettings,
) -> tuple[int, PlannedDoors] | None:
    """The first of the places at which the fewest doors are refused, by its number, and those doors.

    Args:
        corners: Smallest flange coordinates of the places, the best by another measure first, each of shape (3,) [m].
        recipes: The doors.
        doors: Their range.
        layout: The cell.
        robot: Who mills.
        settings: Values of config/toolpath.yaml.

    Returns:
        None where there is no place.
    """
    best: tuple[int, PlannedDoors] | None = None
    for number, corner in enumerate(corners):
        most = None if best is None else best[1].refused - 1
        found = plan_doors(recipes, layout_at(layout, corner, doors), robot, settings, most)
        if best is None or found.refused < best[1].refused:
            best = number, found
        if not best[1].refused:
            break
    return best
