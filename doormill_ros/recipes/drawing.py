"""Draw a door with its features as SVG, with layers for what others want to lay over it.

The front view is drawn like the thesis' figures: hinge edge on the left, height upwards (the
robot sees its mirror image). Beside it stand the two edges, and a magnified panel for each
feature in the feature's own xy plane.
"""

from __future__ import annotations

from dataclasses import dataclass
from html import escape
from pathlib import Path

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.files import write_atomically
from doormill_ros.frames import apply, inverse
from doormill_ros.recipes.door import Side
from doormill_ros.recipes.errors import UnreadableFile
from doormill_ros.recipes.features.base import Feature
from doormill_ros.recipes.recipe import Recipe
from doormill_ros.recipes.solid import prism
from doormill_ros.units import m_to_mm

HEIGHT, MARGIN, GAP, PANEL = 900.0, 80.0, 50.0, 270.0  # pixels
LAYERS = ("wood", "hidden", "features", "dimensions", "labels")
STYLE = """
.wood{fill:#f3e5c8;stroke:#6b4f2a;stroke-width:1.5}
.feature{fill:#c99f5f;stroke:#3d2b12;stroke-width:1}
.hidden{fill:none;stroke:#8a6d3b;stroke-width:.8;stroke-dasharray:4 3}
.panel{fill:#fff;stroke:#bbb}
.dimension{stroke:#555;stroke-width:.8;fill:none}
text{font:12px sans-serif;fill:#222}
.title{font-weight:bold;font-size:15px}
.overlay{fill:none}
"""


@dataclass(frozen=True, eq=False)
class Panel:
    """A place on the sheet with a projection of its own.

    Attributes:
        axes: Rows that project homogeneous door coordinates to right and up [m], shape (2, 4).
        origin: Pixel of the projected origin.
        scale: Pixels per metre.
    """

    axes: FloatArray
    origin: tuple[float, float]
    scale: float

    def pixels(self, points_door: FloatArray) -> FloatArray:
        """Pixels, shape (n, 2), of points in the door frame, shape (n, 3) [m]."""
        points = np.asarray(points_door, dtype=float)
        flat = points @ self.axes[:, :3].T + self.axes[:, 3]
        return np.array(self.origin) + flat * [self.scale, -self.scale]


class DoorDrawing:
    """A drawing of one recipe; add overlays, then `to_svg` or `save`."""

    def __init__(self, recipe: Recipe) -> None:
        """Draw the door and its features."""
        self.recipe = recipe
        self.layers: dict[str, list[str]] = {name: [] for name in LAYERS}
        self.panels = self._layout()
        self._draw_views()
        self._draw_features()
        self._draw_title()

    def overlay(
        self,
        layer: str,
        points_door: FloatArray,
        feature: str | None = None,
        colour: str = "#c00",
        width: float = 1.2,
        dashed: bool = False,
    ) -> None:
        """Draw a line in a layer of its own, in the view it belongs to and in the feature's panel.

        Args:
            layer: Name of the layer; made when it is new, drawn above those made earlier.
            points_door: Points in the door frame, shape (n, 3) [m].
            feature: Feature whose view and panel are meant; None for the front view.
            colour: SVG colour.
            width: Line width [px].
            dashed: Dashed instead of solid.

        Raises:
            KeyError: The recipe has no such feature.
        """
        style = f'stroke="{escape(colour)}" stroke-width="{width:g}"' + (
            ' stroke-dasharray="5 3"' if dashed else ""
        )
        elements = self.layers.setdefault(layer, [])
        names = [Side.FRONT.value]
        if feature is not None:
            names = [_view_of(self.recipe.feature(feature)), f"feature:{feature}"]
        for name in names:
            points = _points(self.panels[name].pixels(points_door))
            elements.append(f'<polyline class="overlay" {style} points="{points}"/>')

    def note(self, text: str, layer: str = "labels") -> None:
        """Add a line of text under the title, for example what an overlay shows."""
        count = sum('class="note"' in element for elements in self.layers.values() for element in elements)
        y = 44 + HEIGHT + MARGIN + 16 * count
        self.layers.setdefault(layer, []).append(
            f'<text class="note" x="{MARGIN:g}" y="{y:g}">{escape(text)}</text>'
        )

    def to_svg(self) -> str:
        """The SVG text; every layer is a group with its name as id."""
        width, height = self.sheet
        groups = [
            f'<g id="{escape(name)}">' + "".join(elements) + "</g>" for name, elements in self.layers.items()
        ]
        body = "\n".join(groups)
        return (
            f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width:.0f} {height:.0f}" '
            f'width="{width:.0f}" height="{height:.0f}">\n<style>{STYLE}</style>\n'
            f'<rect width="100%" height="100%" fill="#fff"/>\n{body}\n</svg>\n'
        )

    def save(self, path: str | Path) -> Path:
        """Write the SVG file; raises UnreadableFile when it cannot be written."""
        path = Path(path)
        try:
            write_atomically(path, self.to_svg())
        except OSError as error:
            raise UnreadableFile(f"{path}: cannot be written, {error.strerror}") from error
        return path

    def _layout(self) -> dict[str, Panel]:
        size = self.recipe.size
        scale = HEIGHT / size.height
        bottom = MARGIN + HEIGHT
        thick, wide = size.thickness * scale, size.width * scale
        y_up = np.array([0.0, 0.0, 1.0, 0.0])
        left = MARGIN + GAP
        front = left + thick + GAP
        right = front + wide + GAP

        def view(axis: list[float], x: float) -> Panel:
            return Panel(np.array([axis, y_up]), (x, bottom), scale)

        panels = {
            Side.HINGE_EDGE.value: view([-1.0, 0.0, 0.0, 0.0], left + thick),
            Side.FRONT.value: view([0.0, 1.0, 0.0, 0.0], front),
            Side.LOCK_EDGE.value: view([1.0, 0.0, 0.0, 0.0], right),
        }
        rows = max(1, int((HEIGHT + GAP) // (PANEL + 20.0)))
        start = right + thick + GAP + 30.0
        for index, feature in enumerate(self.recipe.features):
            column, row = divmod(index, rows)
            centre = (start + column * (PANEL + 20.0) + PANEL / 2, MARGIN + row * (PANEL + 20.0) + PANEL / 2)
            largest = max(feature.shape.width, feature.shape.length)
            axes = inverse(self.recipe.T_door_feature(feature))[:2]
            panels[f"feature:{feature.id}"] = Panel(axes, centre, 0.72 * PANEL / largest)
        columns = -(-len(self.recipe.features) // rows)
        self.sheet = (start + columns * (PANEL + 20.0) + MARGIN, HEIGHT + 2 * MARGIN + 90.0)
        return panels

    def _draw_views(self) -> None:
        size = self.recipe.size
        corners = np.array(
            [[x, y, z] for x in (0, size.thickness) for y in (0, size.width) for z in (0, size.height)]
        )
        for side in (Side.HINGE_EDGE, Side.FRONT, Side.LOCK_EDGE):
            pixels = self.panels[side.value].pixels(corners)
            (x, y), (width, height) = pixels.min(axis=0), np.ptp(pixels, axis=0)
            self.layers["wood"].append(
                f'<rect class="wood" x="{x:.2f}" y="{y:.2f}" width="{width:.2f}" height="{height:.2f}"/>'
            )
            name = side.value.replace("_", " ")
            self._text(x + width / 2, y - 8, name, "middle")
            extent = size.width if side is Side.FRONT else size.thickness
            self._text(x + width / 2, y + height + 18, f"{m_to_mm(extent):g}", "middle")
        x, y = self.panels[Side.HINGE_EDGE.value].pixels(corners).min(axis=0)
        self.layers["dimensions"].append(f'<path class="dimension" d="M{x - 14:.1f} {y:.1f}v{HEIGHT:.1f}"/>')
        self._text(x - 20, y + HEIGHT / 2, f"{m_to_mm(size.height):g}", "end")

    def _draw_features(self) -> None:
        for feature in self.recipe.features:
            T_door_feature = self.recipe.T_door_feature(feature)
            outline = feature.outline().points(step=np.inf, chord_error=2e-5)
            points = apply(T_door_feature, np.column_stack([outline, np.zeros(len(outline))]))
            panel = self.panels[f"feature:{feature.id}"]
            x, y = panel.origin[0] - PANEL / 2, panel.origin[1] - PANEL / 2
            self.layers["wood"].append(
                f'<rect class="panel" x="{x:.1f}" y="{y:.1f}" width="{PANEL:g}" height="{PANEL:g}"/>'
            )
            style = "hidden" if feature.side is Side.REAR else "feature"
            layer = "hidden" if feature.side is Side.REAR else "features"
            self._polygon(layer, style, self.panels[_view_of(feature)].pixels(points))
            self._polygon("features", "feature", panel.pixels(points))
            self._draw_hidden(feature)
            shape, depth = feature.shape, feature.cut_depth(self.recipe.size)
            measure = f"{m_to_mm(shape.width):g} x {m_to_mm(shape.length):g}, depth {m_to_mm(depth):g}"
            self._text(x + 6, y + 16, f"{feature.id} ({feature.kind})")
            self._text(x + 6, y + PANEL - 22, measure)
            where = f"height {m_to_mm(feature.centre_height(self.recipe.size)):g}, tool {feature.tool.name}"
            self._text(x + 6, y + PANEL - 7, where)
            pixels = self.panels[_view_of(feature)].pixels(points)
            if not feature.side.is_edge and feature.across(self.recipe.size) > self.recipe.width / 2:
                self._text(pixels[:, 0].min() - 4, pixels[:, 1].max(), feature.id, "end")
            else:
                self._text(pixels[:, 0].max() + 4, pixels[:, 1].max(), feature.id)

    def _draw_hidden(self, feature: Feature) -> None:
        """Where the feature's depth shows as a dashed box in the view across it."""
        body = prism(feature, self.recipe.size)
        (across_low, z_low, across_high, z_high), axis = body.polygon.bounds, body.axis
        corners = np.zeros((2, 3))
        corners[:, axis] = body.low, body.high
        corners[:, 1 - axis] = across_low, across_high
        corners[:, 2] = z_low, z_high
        middle = self.recipe.width / 2
        if axis == 1:
            views = [Side.FRONT]
        else:
            views = [Side.HINGE_EDGE if feature.across(self.recipe.size) < middle else Side.LOCK_EDGE]
        for view in views:
            (x0, y0), (x1, y1) = self.panels[view.value].pixels(corners)
            box = np.array([[x0, y0], [x1, y0], [x1, y1], [x0, y1]])
            self._polygon("hidden", "hidden", box)

    def _draw_title(self) -> None:
        recipe = self.recipe
        self._text(
            MARGIN, 24, f"{recipe.door_id}, version {recipe.version}, bar code {recipe.bar_code}", css="title"
        )
        facts = (
            f"{recipe.material.value}, {recipe.mass:g} kg, hinges {recipe.hinge_side.value}"
            f"{', stands on its head' if recipe.size.head_down else ''}, "
            f"{len(recipe.features)} features; millimetres"
        )
        self._text(MARGIN, 42, facts)

    def _polygon(self, layer: str, css: str, pixels: FloatArray) -> None:
        self.layers[layer].append(f'<polygon class="{css}" points="{_points(pixels)}"/>')

    def _text(self, x: float, y: float, text: str, anchor: str = "start", css: str = "") -> None:
        name = f' class="{css}"' if css else ""
        self.layers["labels"].append(
            f'<text{name} x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}">{escape(text)}</text>'
        )


def _view_of(feature: Feature) -> str:
    return feature.side.value if feature.side.is_edge else Side.FRONT.value


def _points(pixels: FloatArray) -> str:
    return " ".join(f"{x:.2f},{y:.2f}" for x, y in pixels)


def draw_recipe(recipe: Recipe) -> DoorDrawing:
    """The drawing of a recipe, ready for overlays."""
    return DoorDrawing(recipe)
