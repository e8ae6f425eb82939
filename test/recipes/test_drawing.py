import xml.etree.ElementTree as ET

import numpy as np
import pytest

from doormill_ros.recipes.documents import shipped_recipes
from doormill_ros.recipes.drawing import HEIGHT, PANEL, draw_recipe
from doormill_ros.recipes.errors import UnreadableFile
from doormill_ros.recipes.recipe import Recipe
from support.full_disk import room_for

SVG = "{http://www.w3.org/2000/svg}"


@pytest.fixture
def recipe(document):
    return Recipe.from_document(document)


def group(svg, name):
    (found,) = [item for item in ET.fromstring(svg).iter(f"{SVG}g") if item.get("id") == name]
    return found


def pixels(element):
    return np.array([[float(v) for v in pair.split(",")] for pair in element.get("points").split()])


@pytest.mark.parametrize("recipe", shipped_recipes().values(), ids=shipped_recipes())
def test_every_shipped_door_can_be_drawn(recipe):
    svg = draw_recipe(recipe).to_svg()
    root = ET.fromstring(svg)
    _, _, width, height = map(float, root.get("viewBox").split())
    shapes = [element for element in root.iter() if element.get("points")]
    assert len(shapes) >= 2 * len(recipe.features) > 0  # each is drawn in a view and in a section
    for element in shapes:
        points = pixels(element)
        assert points.min() >= 0
        assert points[:, 0].max() <= width
        assert points[:, 1].max() <= height
    texts = [text.text for text in root.iter(f"{SVG}text")]
    for feature in recipe.features:
        assert any(feature.id in text for text in texts)


def test_features_are_drawn_to_scale_where_they_are(recipe):
    """Hinge 1 is 30 x 120 mm about (25, 200) mm from the lower left corner of an 800 x 2000 mm door."""
    drawing = draw_recipe(recipe)
    svg = drawing.to_svg()
    scale = HEIGHT / 2000
    front = [r for r in group(svg, "wood") if r.get("class") == "wood"][1]
    left, top = float(front.get("x")), float(front.get("y"))
    assert float(front.get("width")) == pytest.approx(800 * scale, abs=0.02)
    bottom = top + float(front.get("height"))
    hinge = pixels(group(svg, "features")[0])
    low, high = hinge.min(axis=0), hinge.max(axis=0)
    np.testing.assert_allclose((high - low) / scale, [30, 120], atol=0.05)
    centre = (low + high) / 2
    np.testing.assert_allclose(
        [(centre[0] - left) / scale, (bottom - centre[1]) / scale], [25, 200], atol=0.05
    )


def test_an_overlay_lands_on_its_feature_in_view_and_panel(recipe):
    drawing = draw_recipe(recipe)
    for feature in recipe.features:
        T = recipe.T_door_feature(feature)
        outline = feature.outline().points(step=0.002)
        points = np.column_stack([outline, np.zeros(len(outline)), np.ones(len(outline))]) @ T.T
        drawing.overlay(f"path {feature.id}", points[:, :3], feature.id)
    svg = drawing.to_svg()
    shapes = list(group(svg, "features"))
    assert len(shapes) == 2 * len(recipe.features)
    for index, feature in enumerate(recipe.features):
        lines = list(group(svg, f"path {feature.id}"))
        assert len(lines) == 2
        for line, shape in zip(lines, shapes[2 * index : 2 * index + 2], strict=True):
            a, b = pixels(line), pixels(shape)
            np.testing.assert_allclose([a.min(0), a.max(0)], [b.min(0), b.max(0)], atol=0.5)
        assert np.ptp(pixels(lines[1]), axis=0).max() == pytest.approx(0.72 * PANEL, abs=0.5)


def test_exaggeration_multiplies_the_distance(recipe):
    drawing = draw_recipe(recipe)
    nominal = np.array([[0, 0.1, 0.5], [0, 0.2, 0.5]])
    shifted = np.add(nominal, [0, 0, 0.0003])
    drawing.overlay("nominal", nominal)
    drawing.overlay("corrected", nominal + 200.0 * (shifted - nominal))
    svg = drawing.to_svg()
    a, b = (pixels(group(svg, name)[0]) for name in ("nominal", "corrected"))
    np.testing.assert_allclose((a - b)[:, 1] / (HEIGHT / 2.0), 0.06, atol=1e-3)
    np.testing.assert_allclose((a - b)[:, 0], 0, atol=0.02)


def test_text_from_a_recipe_cannot_break_the_drawing(document):
    document["bar_code"] = "<script>&\"'"
    drawing = draw_recipe(Recipe.from_document(document))
    drawing.note("5 < 6 & more")
    root = ET.fromstring(drawing.to_svg())
    assert not list(root.iter(f"{SVG}script"))
    assert any("<script>&\"'" in (text.text or "") for text in root.iter(f"{SVG}text"))


def test_overlay_of_an_unknown_feature(recipe):
    with pytest.raises(KeyError):
        draw_recipe(recipe).overlay("path", np.zeros((2, 3)), "nothing")


def test_drawing_that_cannot_be_written(recipe, tmp_path):
    with pytest.raises(UnreadableFile, match="cannot be written"):
        draw_recipe(recipe).save(tmp_path / "none" / "x.svg")


def test_a_full_disk_leaves_the_drawing_that_was_there(recipe, tmp_path):
    path = tmp_path / "x.svg"
    path.write_text("earlier")
    with room_for(100), pytest.raises(UnreadableFile, match="cannot be written"):
        draw_recipe(recipe).save(path)
    assert path.read_text() == "earlier"
