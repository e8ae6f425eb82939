import math

import numpy as np
import pytest
import shapely.affinity
import yaml

from doormill_ros.recipes import door
from doormill_ros.recipes.documents import load_recipe, parse_yaml, shipped_recipes
from doormill_ros.recipes.door import R_DOOR_FEATURE, R_FEATURE_TOOL, DoorSize, HingeSide, Side
from doormill_ros.recipes.errors import DuplicateField, FieldError, UnreadableFile
from doormill_ros.recipes.recipe import Recipe
from doormill_ros.recipes.solid import prism
from support.source_tree import DATA
from support.tool_poses import T_door_tool


@pytest.fixture(scope="module")
def facts():
    return yaml.safe_load((DATA / "thesis" / "facts.yaml").read_text(encoding="utf-8"))


def test_door_limits_are_those_of_the_thesis(facts):
    doors = facts["doors"]
    assert list(door.HEIGHT_MM) == doors["height_mm"]
    assert list(door.WIDTH_MM) == doors["width_mm"]
    assert list(door.THICKNESS_MM) == doors["thickness_mm"]
    assert door.MASS_KG[1] == doors["max_mass_kg"]


def test_shipped_thesis_doors_are_those_of_figure_4_4(facts):
    shipped = shipped_recipes()
    assert len(facts["verified_paths"]) == 4
    for path in facts["verified_paths"]:
        recipe = shipped[f"thesis_{path['width_mm']}_{path['rotation_deg']}deg"]
        assert recipe.width == path["width_mm"] / 1000
        assert math.degrees(recipe.placement.rotation) == pytest.approx(path["rotation_deg"])
        assert (recipe.placement.y, recipe.placement.z) == (0, 0)
        assert (recipe.height, recipe.thickness) == (2.5, 0.05)
        assert [feature.kind for feature in recipe.features] == ["hinge_oblong"] * 2
        heights = [feature.centre_height(recipe.size) for feature in recipe.features]
        assert heights == pytest.approx([0.15, 2.35])


def test_shipped_thesis_doors_are_milled_as_the_thesis_did(facts):
    milling = facts["milling"]
    feature = load_recipe("thesis_190_0deg").features[0]
    for name, row in milling["forces_N_Nm"].items():
        np.testing.assert_array_equal(feature.wrench_table.get(name), row)
    assert feature.tool.diameter == pytest.approx(milling["tool"]["diameter_mm"] / 1000)
    assert feature.tool.flutes == milling["tool"]["flutes"]
    assert feature.tool.max_spindle_speed == pytest.approx(milling["tool"]["max_rpm"] * 2 * math.pi / 60)
    assert feature.tool.max_chip_load == pytest.approx(milling["tool"]["chip_load_inch"][1] * 0.0254)
    assert feature.cutting.spindle(feature.tool) == pytest.approx(milling["final"]["rpm"] * 2 * math.pi / 60)
    assert feature.cutting.feed_rate(feature.tool) == pytest.approx(milling["final"]["feed_mm_s"] / 1000)


def test_standard_door_is_the_standard_job(facts):
    job = facts["doors"]["standard_job"]
    kinds = [feature.kind for feature in load_recipe("standard_door").features]
    assert kinds.count("hinge_oblong") == job["hinges"]
    assert kinds.count("lock_case") == job["lock_case"]
    assert kinds.count("handle_hole") == job["handle_holes"]


def test_wrench_point_of_the_thesis_is_the_least_squares_lever(facts):
    """M = r x F with r = (0, 0, d), that is Mx = -d Fy and My = d Fx, over the four rows of table 4.8."""
    rows = np.array(list(facts["milling"]["forces_N_Nm"].values()), dtype=float)
    a = np.concatenate([-rows[:, 1], rows[:, 0]])
    b = np.concatenate([rows[:, 3], rows[:, 4]])
    lever = np.linalg.lstsq(a[:, None], b, rcond=None)[0][0]
    assert load_recipe("thesis_190_0deg").features[0].wrench_point == pytest.approx(lever, abs=0.5e-3)


def test_a_force_at_the_tool_centre_point_has_no_moment_there():
    """A sensor 0.208 m behind the point sees M = (0, 0, d) x F; moved back nothing must remain."""
    feature = load_recipe("thesis_190_0deg").features[0]
    force = np.array([-209.0, 29.0, 12.0])
    seen = np.cross([0, 0, feature.wrench_point], force)
    table = type(feature.wrench_table)((("default", (*force, *seen)),))
    moved = type(feature)(**{**vars(feature), "wrench_table": table, "forces": None}).wrench("left_line")
    np.testing.assert_allclose(moved, [*force, 0, 0, 0], atol=1e-12)


def test_speeds_follow_the_equations_of_the_thesis(document):
    """Section 3.9: 300 m/min for a 19 mm mill gives 5025 rpm; 0.019 inch a tooth gives about 80 mm/s."""
    document["tools"]["mill_16"] |= {"diameter_mm": 19, "max_chip_load_mm": 0.635}
    document["features"] = document["features"][:1]
    document["features"][0]["cutting"] = {"surface_speed_m_min": 300, "chip_load_mm": 0.019 * 25.4}
    feature = Recipe.from_document(document).features[0]
    assert feature.cutting.spindle(feature.tool) * 60 / (2 * math.pi) == pytest.approx(5025, abs=1.5)
    assert feature.cutting.feed_rate(feature.tool) == pytest.approx(0.080, abs=1e-3)
    assert feature.cutting.chip(feature.tool) == pytest.approx(0.019 * 0.0254, rel=1e-6)


@pytest.mark.parametrize("side", Side)
def test_feature_frames_point_into_the_wood(document, side):
    R = R_DOOR_FEATURE[side]
    np.testing.assert_allclose(R.T @ R, np.eye(3), atol=0)
    assert np.linalg.det(R) == pytest.approx(1)
    np.testing.assert_array_equal(R[:, 1], [0, 0, 1])
    size = DoorSize(2.0, 0.8, 0.04)
    index = 2 if side.is_edge else 0
    document["features"] = [document["features"][index]]
    document["features"][0]["side"] = side.value
    feature = Recipe.from_document(document).features[0]
    T = feature.T_door_feature(size)
    inside, outside = (T @ [0, 0, depth, 1] for depth in (1e-6, -1e-6))

    def in_wood(p):
        return 0 < p[0] < 0.04 and 0 < p[1] < 0.8 and 0 < p[2] < 2.0

    assert in_wood(inside)
    assert not in_wood(outside)


def test_tool_at_a_hinge_stands_as_at_home(facts):
    """On the front of a door whose axes are the base's the flange has the home pose's rotation."""
    home = np.array(facts["robot"]["home_flange"]["rotation"], dtype=float)
    np.testing.assert_array_equal(R_DOOR_FEATURE[Side.FRONT] @ R_FEATURE_TOOL, home)
    recipe = load_recipe("thesis_190_0deg")
    T = T_door_tool(recipe.features[0], recipe.size, 0.001, 0.002, 0.003)
    np.testing.assert_allclose(T[:3, 3], [0.003, 0.026, 0.152], atol=1e-12)
    np.testing.assert_array_equal(T[:3, :3], home)


def test_heights_and_offsets_count_from_the_named_edges(document):
    recipe = Recipe.from_document(document)
    centres = {feature.id: recipe.T_door_feature(feature)[:3, 3] for feature in recipe.features}
    np.testing.assert_allclose(centres["hinge_1"], [0, 0.025, 0.2], atol=1e-12)
    np.testing.assert_allclose(centres["hinge_2"], [0, 0.025, 1.8], atol=1e-12)
    np.testing.assert_allclose(centres["case"], [0.02, 0.8, 1.0], atol=1e-12)
    np.testing.assert_allclose(centres["hole"], [0, 0.75, 1.04], atol=1e-12)


def test_recipe_does_not_change_with_its_document(document):
    recipe = Recipe.from_document(document)
    before = recipe.to_document()
    document["features"][0]["wrench_n_nm"]["default"][0] = 999
    document["tools"]["mill_16"]["diameter_mm"] = 3
    assert recipe.to_document() == before


@pytest.mark.parametrize(
    ("text", "error"),
    [
        ("a: 1\na: 2\n", DuplicateField),
        ("a: {b: 1, b: 2}\n", DuplicateField),
        ("a: [1\n", UnreadableFile),
        ("a: !!python/object/apply:os.getcwd []\n", UnreadableFile),
        ("? [a]\n: 1\n", UnreadableFile),
        ("\x00", UnreadableFile),
    ],
)
def test_bad_yaml(text, error):
    with pytest.raises(error):
        parse_yaml(text)


def test_file_name_stands_before_the_field(tmp_path, document):
    path = tmp_path / "bad.yaml"
    document["width_mm"] = 5
    path.write_text(yaml.safe_dump(document))
    with pytest.raises(FieldError, match=r"bad\.yaml: width_mm: found 5 mm, allowed are 190 to 1350 mm"):
        load_recipe(path)


def test_unknown_shipped_recipe():
    with pytest.raises(UnreadableFile, match="no such recipe"):
        load_recipe("nothing_like_it")


def test_a_left_hung_door_is_the_upright_one_turned_in_its_plane(document):
    """Seen from the side it opens to, its hinges are on the left: the side of +y, looking along +x with z up.

    Half a turn about the middle of its face brings them to the edge that the clamp holds, and the top down.
    """
    left = Recipe.from_document({**document, "hinge_side": "left"})
    width, height = 0.8, 2.0
    upright = {  # x into the wood, y towards the viewer's left, z up
        "hinge_1": [0.0, width - 0.025, 0.2],
        "hinge_2": [0.0, width - 0.025, 1.8],
        "case": [0.02, 0.0, 1.0],  # on the lock edge, now on the viewer's right
        "plate": [0.02, 0.0, 1.0],
        "hole": [0.0, 0.05, 1.04],
    }
    half_turn = np.diag([1.0, -1.0, -1.0])
    stands = {name: half_turn @ at + [0.0, width, height] for name, at in upright.items()}
    found = {feature.id: left.T_door_feature(feature)[:3, 3] for feature in left.features}
    assert found.keys() == stands.keys()
    for name, at in stands.items():
        np.testing.assert_allclose(found[name], at, atol=1e-12, err_msg=name)
    right = Recipe.from_document({**document, "hinge_side": "right"})
    for feature in left.features:
        body, upright_body = prism(feature, left.size), prism(feature, right.size)
        turned = shapely.affinity.scale(upright_body.polygon, 1.0, -1.0, origin=(0.0, height / 2.0))
        assert body.polygon.symmetric_difference(turned).area < 1e-12
        assert (body.low, body.high) == (upright_body.low, upright_body.high)


def test_the_hinges_of_every_shipped_door_lie_on_the_side_it_opens_to():
    """The clamp shows that side, the front, to the robot, whatever the hand of the door."""
    hands = set()
    for recipe in shipped_recipes().values():
        hands.add(recipe.hinge_side)
        hinges = [feature for feature in recipe.features if feature.kind.startswith("hinge")]
        assert hinges
        assert {feature.side for feature in hinges} == {Side.FRONT}
    assert hands == set(HingeSide)
