"""Wrong recipes are refused by an error of their own that names the field, one table row a recipe."""

import copy
import math

import pytest

from doormill_ros.recipes import errors as e
from doormill_ros.recipes.recipe import Recipe
from support.source_tree import ROOT

GONE = object()  # the field is taken out
MAX = 3.5e38

# What is changed in the good document, the expected error, and the field it names
# (None: the one changed last).
BAD = [
    # the document itself
    ({"schema": GONE}, e.MissingField, "schema"),
    ({"schema": "doormill/recipe/2"}, e.NotAChoice, None),
    ({"colour": "red"}, e.UnknownField, "colour"),
    ({"width": 800}, e.UnknownField, "width"),
    ({"height_m": 2.0}, e.UnknownField, "height_m"),
    ({5: 1}, e.WrongType, ""),
    # door id, bar code, who and when
    ({"door_id": GONE}, e.MissingField, None),
    ({"door_id": None}, e.MissingField, None),
    ({"door_id": 17}, e.WrongType, None),
    ({"door_id": ""}, e.BadText, None),
    ({"door_id": "a b"}, e.BadText, None),
    ({"door_id": "../etc/passwd"}, e.BadText, None),
    ({"door_id": ".hidden"}, e.BadText, None),
    ({"door_id": "d" * 65}, e.BadText, None),
    ({"door_id": "dør"}, e.BadText, None),
    ({"bar_code": GONE}, e.MissingField, None),
    ({"bar_code": 7040000000017}, e.WrongType, None),
    ({"bar_code": "47 11"}, e.BadText, None),
    ({"bar_code": "4" * 65}, e.BadText, None),
    ({"version": -1}, e.OutOfRange, None),
    ({"version": 1.5}, e.WrongType, None),
    ({"version": True}, e.WrongType, None),
    ({"author": "a\nb"}, e.BadText, None),
    ({"author": "x" * 101}, e.BadText, None),
    ({"created": "yesterday"}, e.BadText, None),
    ({"created": "2026-01-31T12:00:00"}, e.BadText, None),
    ({"created": 5}, e.WrongType, None),
    # the robot's program; the good document has five features
    ({"program": "path_20"}, e.UnfitForProgram, None),
    ({"program": "path_30"}, e.NotAChoice, None),
    ({"program": 20}, e.WrongType, None),
    # the door
    ({"height_mm": GONE}, e.MissingField, None),
    ({"height_mm": 999.9}, e.OutOfRange, None),
    ({"height_mm": 3000.1}, e.OutOfRange, None),
    ({"height_mm": "2000"}, e.WrongType, None),
    ({"height_mm": math.nan}, e.NotFinite, None),
    ({"height_mm": [2000]}, e.WrongType, None),
    ({"width_mm": 189.9}, e.OutOfRange, None),
    ({"width_mm": 1350.1}, e.OutOfRange, None),
    ({"width_mm": math.inf}, e.NotFinite, None),
    ({"width_mm": True}, e.WrongType, None),
    ({"thickness_mm": 29.9}, e.OutOfRange, None),
    ({"thickness_mm": 100.1}, e.OutOfRange, None),
    ({"thickness_mm": -math.inf}, e.NotFinite, None),
    ({"thickness_mm": MAX}, e.OutOfRange, None),
    ({"mass_kg": 125.1}, e.OutOfRange, None),
    ({"mass_kg": 0}, e.OutOfRange, None),
    ({"mass_kg": 1}, e.ImplausibleMass, None),
    ({"mass_kg": 120}, e.ImplausibleMass, None),
    ({"hinge_side": "top"}, e.NotAChoice, None),
    ({"hinge_side": 1}, e.WrongType, None),
    ({"material": "steel"}, e.NotAChoice, None),
    ({"placement": 3}, e.WrongType, None),
    ({"placement": {"x_mm": 1}}, e.UnknownField, "placement.x_mm"),
    ({"placement": {"y_mm": 10.1}}, e.OutOfRange, "placement.y_mm"),
    ({"placement": {"rotation_deg": -2.1}}, e.OutOfRange, "placement.rotation_deg"),
    # tools
    ({"tools": GONE}, e.MissingField, None),
    ({"tools": []}, e.WrongType, None),
    ({"tools.mill_16": 16}, e.WrongType, None),
    ({"tools.bad name": {}}, e.BadText, None),
    ({"tools.mill_16.name": "mill_16"}, e.DuplicateName, None),
    ({"tools.mill_16.flutes": 0}, e.OutOfRange, None),
    ({"tools.mill_16.flutes": 2.5}, e.WrongType, None),
    ({"tools.mill_16.diameter_mm": 0}, e.OutOfRange, None),
    ({"tools.mill_16.diameter_mm": -16}, e.OutOfRange, None),
    ({"tools.mill_16.diameter_mm": math.nan}, e.NotFinite, None),
    ({"tools.mill_16.cutting_length_mm": GONE}, e.MissingField, None),
    ({"tools.mill_16.max_spindle_speed_rpm": 99999}, e.OutOfRange, None),
    ({"tools.mill_16.coating": "TiN"}, e.UnknownField, None),
    # the list of features
    ({"features": GONE}, e.MissingField, None),
    ({"features": []}, e.OutOfRange, None),
    ({"features": {}}, e.WrongType, None),
    ({"features.0": "hinge"}, e.WrongType, None),
    ({"features.0.kind": GONE}, e.MissingField, None),
    ({"features.0.kind": "window"}, e.NotAChoice, None),
    ({"features.0.kind": 3}, e.WrongType, None),
    ({"features.1.id": "hinge_1"}, e.DuplicateName, None),
    ({"features.1.id": "Ø"}, e.BadText, None),
    # one feature
    ({"features.0.depth_mm": GONE}, e.MissingField, None),
    ({"features.0.depth_mm": 0}, e.OutOfRange, None),
    ({"features.0.depth_mm": -5}, e.OutOfRange, None),
    ({"features.0.depth_mm": math.nan}, e.NotFinite, None),
    ({"features.0.points": 7}, e.NotAChoice, None),
    ({"features.0.points": "6"}, e.WrongType, None),
    ({"features.0.corner_radius_mm": 3}, e.UnknownField, None),
    ({"features.1.points": 6}, e.UnknownField, None),
    ({"features.0.side": "lock_edge"}, e.NotAChoice, None),
    ({"features.2.side": "front"}, e.NotAChoice, None),
    ({"features.0.side": "bottom"}, e.NotAChoice, None),
    ({"features.0.height_from": "middle"}, e.NotAChoice, None),
    ({"features.0.direction": "up"}, e.NotAChoice, None),
    ({"features.0.force_displacement_mm": 1}, e.WrongType, None),
    ({"features.0.force_displacement_mm": [[0.1, 0.1]] * 5}, e.OutOfRange, None),
    ({"features.0.force_displacement_mm": [[0.1]] * 6}, e.WrongType, "features.0.force_displacement_mm.0"),
    (
        {"features.0.force_displacement_mm": [[0.1, 5.1]] * 6},
        e.OutOfRange,
        "features.0.force_displacement_mm.0.1",
    ),
    ({"features.1.corner_radius_mm": 15.1}, e.OutOfRange, None),
    ({"features.1.corner_radius_mm": -1}, e.OutOfRange, None),
    ({"features.4.from_both_sides": "yes"}, e.WrongType, None),
    ({"features.4.depth_mm": 40}, e.UnknownField, None),
    # speeds, passes, wrenches
    ({"features.0.cutting": GONE}, e.MissingField, None),
    ({"features.0.cutting": {}}, e.MissingField, "features.0.cutting.spindle_speed_rpm"),
    ({"features.0.cutting.feed_mm_s": GONE}, e.MissingField, None),
    ({"features.0.cutting.feed_mm_s": 0}, e.OutOfRange, None),
    ({"features.0.cutting.chip_load_mm": 0.2}, e.ConflictingFields, None),
    (
        {"features.0.cutting": {"surface_speed_m_min": 300}},
        e.MissingField,
        "features.0.cutting.chip_load_mm",
    ),
    ({"features.0.cutting.spindle_speed_rpm": 18001}, e.SpindleTooFast, None),
    (
        {"features.0.cutting": {"surface_speed_m_min": 1000, "chip_load_mm": 0.2}},
        e.SpindleTooFast,
        "features.0.cutting.surface_speed_m_min",
    ),
    ({"features.0.cutting.feed_mm_s": 121}, e.ChipTooThick, None),
    (
        {"features.0.cutting": {"surface_speed_m_min": 300, "chip_load_mm": 0.61}},
        e.ChipTooThick,
        "features.0.cutting.chip_load_mm",
    ),
    ({"features.0.passes.depth_step_mm": 0}, e.OutOfRange, None),
    ({"features.0.passes.finish_allowance_mm": -0.1}, e.OutOfRange, None),
    ({"tools.mill_16.diameter_mm": 8, "features.0.passes.finish_allowance_mm": 4.1}, e.OutOfRange, None),
    ({"features.0.wrench_n_nm": GONE}, e.MissingField, None),
    ({"features.0.wrench_n_nm": [1, 2, 3, 4, 5, 6]}, e.WrongType, None),
    ({"features.0.wrench_n_nm": {"left_line": [0] * 6}}, e.MissingField, "features.0.wrench_n_nm.top_turn"),
    ({"features.0.wrench_n_nm.top_line": [0] * 6}, e.UnknownField, None),
    ({"features.0.wrench_n_nm.default": [1, 2, 3]}, e.WrongType, None),
    (
        {"features.0.wrench_n_nm.default": [5001, 0, 0, 0, 0, 0]},
        e.OutOfRange,
        "features.0.wrench_n_nm.default.0",
    ),
    (
        {"features.0.wrench_n_nm.default": [0, 0, math.nan, 0, 0, 0]},
        e.NotFinite,
        "features.0.wrench_n_nm.default.2",
    ),
    ({"features.0.wrench_point_mm": -1}, e.OutOfRange, None),
    # tools that do not fit
    ({"features.0.tool": "mill_99"}, e.UnknownReference, None),
    ({"features.0.tool": {"diameter_mm": 16}}, e.WrongType, None),
    ({"tools.mill_16.diameter_mm": 29.5}, e.ToolTooWide, "features.0.tool"),
    ({"features.0.width_mm": 16.9}, e.ToolTooWide, "features.0.tool"),
    ({"features.1.corner_radius_mm": 7.9}, e.ToolTooWide, "features.1.tool"),
    ({"features.1.corner_radius_mm": 0}, e.ToolTooWide, "features.1.tool"),
    ({"features.3.tool": "mill_16"}, e.ToolTooWide, "features.3.tool"),
    ({"features.4.diameter_mm": 16.5}, e.ToolTooWide, "features.4.tool"),
    ({"features.2.depth_mm": 100.1}, e.ToolTooShort, "features.2.tool"),
    ({"tools.mill_16.cutting_length_mm": 39}, e.ToolTooShort, "features.2.tool"),
    ({"thickness_mm": 100, "tools.mill_16.cutting_length_mm": 100.9}, e.ToolTooShort, "features.4.tool"),
    # features that leave the wood
    ({"features.0.backset_mm": 16.9}, e.LeavesWood, None),
    ({"features.0.backset_mm": 790}, e.LeavesWood, None),
    ({"features.0.height_mm": 61.9}, e.LeavesWood, None),
    ({"features.0.height_mm": 1990}, e.LeavesWood, None),
    ({"features.1.height_mm": 10}, e.LeavesWood, None),
    ({"features.2.offset_mm": 10}, e.LeavesWood, None),
    ({"features.2.width_mm": 37}, e.LeavesWood, "features.2.offset_mm"),
    ({"features.4.backset_mm": 12.9}, e.LeavesWood, None),
    ({"features.0.depth_mm": 37.1}, e.ThinFloor, None),
    # features that meet, or miss each other
    ({"features.1.height_from": "bottom"}, e.FeaturesMeet, "features.1"),
    ({"features.1.height_from": "bottom", "features.1.height_mm": 321.9}, e.FeaturesMeet, "features.1"),
    ({"features.4.lock_case": GONE}, e.FeaturesMeet, "features.4"),
    ({"features.3.lock_case": GONE}, e.FeaturesMeet, "features.3"),
    (
        {"features.0.backset_mm": 703.1, "features.0.height_mm": 1000, "features.0.depth_mm": 15},
        e.FeaturesMeet,
        "features.2",
    ),
    (
        {"features.0.backset_mm": 760, "features.0.height_mm": 900, "features.0.depth_mm": 9.1},
        e.FeaturesMeet,
        "features.2",
    ),
    # The hinge begins 0.5 mm below the round top of the mortise (radius 9 mm, middle of the door at
    # 20 mm); 2 mm further down the mortise is sqrt(9^2 - 6.5^2) = 6.22 mm to either side, so that
    # the hinge may be 20 - 6.22 - 2 = 11.78 mm deep.
    (
        {"features.0.backset_mm": 760, "features.0.height_mm": 1139.5, "features.0.depth_mm": 11.9},
        e.FeaturesMeet,
        "features.2",
    ),
    ({"features.4.lock_case": "plate"}, e.UnknownReference, None),
    ({"features.4.lock_case": "nothing"}, e.UnknownReference, None),
    ({"features.4.height_mm": 1200, "features.4.lock_case": "case"}, e.FeaturesApart, None),
    ({"features.4.backset_mm": 200, "features.4.lock_case": "case"}, e.FeaturesApart, None),
    ({"features.3.side": "hinge_edge", "features.3.lock_case": "case"}, e.FeaturesApart, None),
    ({"features.3.length_mm": 150, "features.3.lock_case": "case"}, e.FeaturesApart, None),
]


def changed(document, changes):
    """A copy of the document with the dotted paths set, or taken out."""
    document = copy.deepcopy(document)
    for path, value in changes.items():
        *parents, leaf = path.split(".") if isinstance(path, str) else [path]
        place = document
        for parent in parents:
            place = place[int(parent)] if isinstance(place, list) else place[parent]
        leaf = int(leaf) if isinstance(place, list) else leaf
        if value is GONE:
            del place[leaf]
        else:
            place[leaf] = value
    return document


def test_the_good_document_is_good(document):
    assert [feature.id for feature in Recipe.from_document(document).features] == [
        "hinge_1",
        "hinge_2",
        "case",
        "plate",
        "hole",
    ]


def test_the_table_holds_enough_different_recipes():
    assert len({repr(changes) for changes, _, _ in BAD}) == len(BAD) >= 60


@pytest.mark.parametrize(("changes", "error", "field"), BAD, ids=[f"{i}" for i in range(len(BAD))])
def test_bad_recipe(document, changes, error, field):
    with pytest.raises(e.RecipeError) as caught:
        Recipe.from_document(changed(document, changes))
    assert type(caught.value) is error
    assert caught.value.field == (list(changes)[-1] if field is None else field)
    assert 100 <= caught.value.code < 200
    message = str(caught.value)
    assert message.startswith(caught.value.field or "recipe")
    assert "\n" not in message
    assert "allowed" in message or error in (e.MissingField, e.FeaturesApart, e.DuplicateName)


@pytest.mark.parametrize("whole", [None, 5, "text", [], [1], True, math.nan])
def test_what_is_no_document_at_all(whole):
    with pytest.raises(e.WrongType):
        Recipe.from_document(whole)


# The same wall, floor or limit, just kept: the refusals above are not refusals of everything.
GOOD = [
    {"height_mm": 3000, "mass_kg": 40},
    {"width_mm": 1350, "mass_kg": 40},
    {"thickness_mm": 100, "mass_kg": 40, "tools.mill_16.cutting_length_mm": 101},
    {"features.0.backset_mm": 17},
    {"features.0.height_mm": 62},
    {"features.0.width_mm": 17},
    {"features.1.corner_radius_mm": 15},
    {"features.1.height_from": "bottom", "features.1.height_mm": 322},
    {"features.0.depth_mm": 37},
    {"features.2.depth_mm": 100},
    {"features.0.cutting.spindle_speed_rpm": 18000},
    {"features.0.cutting.feed_mm_s": 120},
    {"features.4.backset_mm": 16, "features.4.diameter_mm": 18},
    {"features.0.backset_mm": 760, "features.0.height_mm": 900, "features.0.depth_mm": 9},
    {"features.0.backset_mm": 703, "features.0.height_mm": 1000, "features.0.depth_mm": 15},
    {"placement": {"y_mm": -10, "z_mm": 10, "rotation_deg": 2}},
    {"features.0.backset_mm": 760, "features.0.height_mm": 1139.5, "features.0.depth_mm": 11.7},
    {"features.0.points": 9},
    {"features.0.side": "rear"},
]


@pytest.mark.parametrize("changes", GOOD, ids=[f"{i}" for i in range(len(GOOD))])
def test_recipe_at_the_limit(document, changes):
    """The limit itself is not refused."""
    Recipe.from_document(changed(document, changes))


def test_error_codes_are_unique_and_in_range():
    def leaves(kind):
        return [leaf for sub in kind.__subclasses__() for leaf in leaves(sub)] or [kind]

    codes = [leaf.code for leaf in leaves(e.RecipeError)]
    assert len(codes) == len(set(codes)) > 25
    assert all(100 <= code < 200 for code in codes)
    documented = (ROOT / "docs" / "errors.md").read_text(encoding="utf-8")
    assert all(f"| {leaf.code} | `{leaf.__name__}` |" in documented for leaf in leaves(e.RecipeError))
