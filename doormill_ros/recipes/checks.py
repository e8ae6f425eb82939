"""Checks of a whole recipe: does everything fit into the wood, past each other, and the tools."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations

from doormill_ros.recipes.door import DENSITY, DoorSize
from doormill_ros.recipes.errors import (
    ChipTooThick,
    ConflictingFields,
    FeaturesApart,
    FeaturesMeet,
    ImplausibleMass,
    LeavesWood,
    MissingField,
    NotAChoice,
    OutOfRange,
    SpindleTooFast,
    ThinFloor,
    ToolTooShort,
    ToolTooWide,
    UnknownReference,
)
from doormill_ros.recipes.features.base import Feature
from doormill_ros.recipes.solid import Prism, prism
from doormill_ros.recipes.wrench import check_segments
from doormill_ros.units import m_to_mm, rad_s_to_rpm

MIN_WALL = 2e-3  #: m of wood between features, and between a feature and an edge of the door
MIN_FLOOR = 3e-3  #: m of wood under a pocket
MIN_TURN = 0.5e-3  #: m, smallest radius of the tool centre's path round a half-turn
ROUNDING = 1e-9  #: m; the grid of a recipe is 1 nm


def check_geometry(size: DoorSize, mass: float, features: Sequence[Feature]) -> None:
    """Refuse features that do not go with the door, each other or their tools.

    Args:
        size: The door [m].
        mass: Its mass before milling [kg].
        features: What is milled into it.

    Raises:
        FieldError: The leaf class says what is wrong, `field` where.
    """
    _check_mass(size, mass)
    for index, feature in enumerate(features):
        path = f"features.{index}"
        _check_outline(feature, path)
        _check_forces(feature, path)
        _check_tool(feature, feature.tip_depth(size, feature.halved), path)
        _check_allowance(feature, path)
        _check_wood(size, feature, path)
    prisms = {feature.id: prism(feature, size) for feature in features}
    for index, feature in enumerate(features):
        if feature.belongs_to is not None:
            where = _field(f"features.{index}", feature.case_key)
            _check_reference(features, feature, feature.belongs_to, prisms, where)
    _check_walls(features, prisms)


def _field(path: str, key: str) -> str:
    """A field of a feature, or the feature where none is to blame."""
    return f"{path}.{key}" if key else path


def _check_forces(feature: Feature, path: str) -> None:
    """A table for the features that use one, none for those whose force a model computes."""
    table, where = feature.wrench_table, f"{path}.wrench_n_nm"
    if feature.computes_force and table is not None:
        raise ConflictingFields(
            where,
            "is given beside forces.model 'engagement', which computes the force; leave one of them out",
        )
    if table is None and not feature.computes_force:
        raise MissingField(
            where,
            "is missing, a wrench must be given, or forces.model 'engagement' that computes it",
            found=None,
        )
    if table is not None:
        check_segments(table, feature.segment_names, where)


def _check_mass(size: DoorSize, mass: float) -> None:
    volume = size.height * size.width * size.thickness
    density, (low, high) = mass / volume, DENSITY
    if not low <= density <= high:
        raise ImplausibleMass(
            "mass_kg",
            f"found {mass:g} kg, that is {density:.0f} kg/m^3 for a door of this size, allowed are "
            f"{low * volume:.1f} to {high * volume:.1f} kg",
            found=mass,
        )


def _check_outline(feature: Feature, path: str) -> None:
    if feature.side not in feature.sides:
        allowed = [side.value for side in feature.sides]
        raise NotAChoice(
            f"{path}.side", f"found {feature.side.value!r}, allowed for a {feature.kind} is one of {allowed}"
        )
    shape = feature.shape
    largest = min(shape.width, shape.length) / 2.0
    if shape.radius > largest + ROUNDING:
        raise OutOfRange(
            _field(path, feature.radius_key),
            f"found {m_to_mm(shape.radius):g} mm, allowed is at most {m_to_mm(largest):g} mm, half the "
            "shorter side of the outline",
            found=shape.radius,
        )


def _check_tool(feature: Feature, depth: float, path: str) -> None:
    tool, shape = feature.tool, feature.shape
    narrow = min(shape.width, shape.length)
    round_end = abs(shape.radius - narrow / 2.0) < ROUNDING
    widest = narrow - 2.0 * MIN_TURN if round_end else min(narrow, 2.0 * shape.radius)
    if tool.diameter > widest + ROUNDING:
        reason = (
            "the outline is too narrow"
            if round_end or narrow <= 2 * shape.radius
            else "the corners are too sharp"
        )
        raise ToolTooWide(
            f"{path}.tool",
            f"found {tool.name!r} with a diameter of {m_to_mm(tool.diameter):g} mm, allowed is at most "
            f"{m_to_mm(max(widest, 0.0)):g} mm: {reason}",
            found=tool.diameter,
        )
    if depth > tool.cutting_length + ROUNDING:
        raise ToolTooShort(
            f"{path}.tool",
            f"found {tool.name!r}, which cuts {m_to_mm(tool.cutting_length):g} mm deep, allowed is at least "
            f"{m_to_mm(depth):g} mm: so far its tip goes",
            found=tool.cutting_length,
        )
    _check_speeds(feature, path)


def _check_allowance(feature: Feature, path: str) -> None:
    """One pass along the wall has to take all that the clearing left, in sharp corners too.

    There the two contours are sqrt(2) times as far apart as along the sides.
    """
    allowance, radius = feature.passes.finish_allowance, feature.tool.radius
    if allowance > radius + ROUNDING:
        raise OutOfRange(
            f"{path}.passes.finish_allowance_mm",
            f"found {m_to_mm(allowance):g} mm, allowed are at most {m_to_mm(radius):g} mm, the radius of "
            f"{feature.tool.name!r}: wood would be left between the finishing pass and the others",
            found=allowance,
        )


def _check_speeds(feature: Feature, path: str) -> None:
    tool, cutting = feature.tool, feature.cutting
    spindle = cutting.spindle(tool)
    if spindle > tool.max_spindle_speed * (1.0 + 1e-9):
        key = "spindle_speed_rpm" if cutting.spindle_speed is not None else "surface_speed_m_min"
        raise SpindleTooFast(
            f"{path}.cutting.{key}",
            f"found {rad_s_to_rpm(spindle):.0f} rpm for {tool.name!r}, allowed are at most "
            f"{rad_s_to_rpm(tool.max_spindle_speed):.0f} rpm",
            found=spindle,
        )
    chip = cutting.chip(tool)
    if tool.max_chip_load is not None and chip > tool.max_chip_load * (1.0 + 1e-9):
        key = "feed_mm_s" if cutting.feed is not None else "chip_load_mm"
        raise ChipTooThick(
            f"{path}.cutting.{key}",
            f"found a chip load of {m_to_mm(chip):.3f} mm for {tool.name!r}, allowed is at most "
            f"{m_to_mm(tool.max_chip_load):.3f} mm",
            found=chip,
        )


def _check_wood(size: DoorSize, feature: Feature, path: str) -> None:
    """The outline stays inside its surface, the floor inside the wood."""
    shape = feature.shape
    extent = size.thickness if feature.side.is_edge else size.width
    spans = (
        (_field(path, feature.across_key), feature.across(size), shape.width, extent, "across"),
        (f"{path}.height_mm", feature.centre_height(size), shape.length, size.height, "along the height"),
    )
    for field, centre, length, available, where in spans:
        low, high = centre - length / 2.0, centre + length / 2.0
        if low < MIN_WALL - ROUNDING or high > available - MIN_WALL + ROUNDING:
            raise LeavesWood(
                field,
                f"the outline reaches from {m_to_mm(low):.1f} to {m_to_mm(high):.1f} mm {where}, allowed are "
                f"{m_to_mm(MIN_WALL):.1f} to {m_to_mm(available - MIN_WALL):.1f} mm on this door",
                found=(low, high),
            )
    if feature.through:
        return
    wood = size.width if feature.side.is_edge else size.thickness
    depth = feature.cut_depth(size)
    if depth > wood - MIN_FLOOR + ROUNDING:
        raise ThinFloor(
            _field(path, feature.depth_key),
            f"found {m_to_mm(depth):g} mm, allowed are at most {m_to_mm(wood - MIN_FLOOR):g} mm on this door",
            found=depth,
        )


def _check_reference(
    features: Sequence[Feature], feature: Feature, name: str, prisms: dict[str, Prism], path: str
) -> None:
    cases = {item.id: item for item in features if item.is_lock_case}
    if name not in cases:
        raise UnknownReference(
            path, f"found {name!r}, allowed is one of the lock cases {sorted(cases)}", found=name
        )
    case = cases[name]
    if feature.surrounds:
        apart = feature.side is not case.side or not prisms[feature.id].polygon.contains(prisms[name].polygon)
        wish = "surround the mouth of the lock case on the same edge"
    else:
        apart = not prisms[feature.id].meets(prisms[name])
        wish = "lead through the lock case"
    if apart:
        raise FeaturesApart(path, f"{feature.id!r} must {wish} {name!r}, and does not", found=name)


def _check_walls(features: Sequence[Feature], prisms: dict[str, Prism]) -> None:
    for (_, first), (index, second) in combinations(enumerate(features), 2):
        if first.belongs_to == second.id or second.belongs_to == first.id:
            continue
        if prisms[first.id].meets(prisms[second.id], MIN_WALL - ROUNDING):
            raise FeaturesMeet(
                f"features.{index}",
                f"{second.id!r} meets {first.id!r}; allowed is at least {m_to_mm(MIN_WALL):g} mm of wood "
                "between two features, move one of them",
                found=(first.id, second.id),
            )
