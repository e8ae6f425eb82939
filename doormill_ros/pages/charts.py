"""Charts as SVG elements for a page, and figures as PNG files; every unit stands in a label.

No state is kept between two charts: settings hold while one is drawn. Matplotlib takes half a second to import: here
and wherever else something is drawn the function that draws imports it, so that nobody waits who only has the words.
"""

from __future__ import annotations

import functools
import io
import xml.etree.ElementTree as ElementTree
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple, ParamSpec, TypeVar

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.pages.inline_svg import inline

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

RED, BLUE, GREEN, GREY, DARK = "#c2562d", "#1f6f8b", "#3b7d4f", "#8a8f98", "#555555"
THIRD, HALF, WIDE = 380, 560, 1132  #: widths of charts, three or two in a row and alone, as on the page [px]
_HEIGHT = 250  # px
_BAND = "#dfe7ea"
_PIXELS = 96.0  # an inch
_DPI = 110.0  # of PNG files
_RASTER = 100.0  # dpi of clouds that are embedded as pictures
_PAD = 3.0  # around labels [pt]
_MEASURED = (0.15, 0.2, 0.8, 0.6)  #: axes while their labels are measured, as shares of the figure
_LABELS = 0.28  # share of the width that the labels of bars may take
_LETTER = 6.3  # width of a letter [px], nearly
_MANY = 1500  # dots from which a cloud is embedded as a picture: smaller, and quicker to show
_STYLE = {
    "font.size": 8.0,
    "axes.titlesize": 9.0,
    "axes.titlelocation": "left",
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.edgecolor": GREY,
    "axes.grid": True,
    "axes.axisbelow": True,
    "grid.color": "#e6e9ec",
    "text.parse_math": False,  # names come from files
    "svg.fonttype": "none",  # text stays text: to be searched, and to be checked by tests
    "svg.hashsalt": "doormill",
}


P = ParamSpec("P")
R = TypeVar("R")


def styled(draw: Callable[P, R]) -> Callable[P, R]:
    """Decorate whatever draws a chart: the settings hold while it is drawn."""

    @functools.wraps(draw)
    def drawn(*args: P.args, **kwargs: P.kwargs) -> R:
        import matplotlib

        with matplotlib.rc_context(_STYLE):
            return draw(*args, **kwargs)

    return drawn


class Curve(NamedTuple):
    """Points of one colour; curves of one name share a line of the legend.

    Attributes:
        name: For the legend; empty for none.
        colour: CSS colour.
        x, y: Shape (n,).
    """

    name: str
    colour: str
    x: FloatArray
    y: FloatArray


class BarRow(NamedTuple):
    """One line of a bar chart: its label, and a value and a colour for each of its bars."""

    label: str
    values: Sequence[float]
    colours: Sequence[str]


@styled
def scatter(
    title: str,
    x_label: str,
    y_label: str,
    dots: Sequence[Curve] = (),
    lines: Sequence[Curve] = (),
    *,
    band: float | None = None,
    square: bool = False,
    width: int = THIRD,
    limits: tuple[float, float] | None = None,
) -> str:
    """Clouds of dots and lines over two axes, as an <svg> element.

    Args:
        title: Text above.
        x_label: With unit.
        y_label: With unit.
        dots: The clouds.
        lines: The lines.
        band: Half height of a shaded band around zero, or None.
        square: Whether both axes show the same range.
        width: Of the drawing [px]; give what the page gives it, or texts are blown up.
        limits: Range of the second axis, or None for that of the data.
    """
    axes = _axes(_HEIGHT, width)
    if band is not None:
        axes.axhspan(-band, band, color=_BAND, linewidth=0.0, zorder=0)
    for curve in dots:
        size = 6.0 if len(curve.x) < 10 else 3.2 if len(curve.x) < 400 else 2.2
        axes.plot(
            curve.x, curve.y, "o", color=curve.colour, alpha=0.65, markersize=size, markeredgewidth=0.0,
            label=curve.name, rasterized=len(curve.x) > _MANY,
        )  # fmt: skip
    for curve in lines:
        axes.plot(curve.x, curve.y, color=curve.colour, linewidth=1.3, label=curve.name)
    axes.margins(0.05, 0.06)
    if limits is not None:
        margin = 0.06 * (limits[1] - limits[0])
        axes.set_ylim(limits[0] - margin, limits[1] + margin)
    if square:
        both = np.array([axes.get_xlim(), axes.get_ylim()])
        axes.set(xlim=(both.min(), both.max()), ylim=(both.min(), both.max()))
    axes.locator_params(nbins=6)
    axes.set_xlabel(x_label)
    axes.set_ylabel(y_label)
    handles, names = axes.get_legend_handles_labels()
    known = {name: handle for handle, name in zip(handles, names, strict=True) if name}
    if known:
        axes.legend(
            known.values(), known.keys(), ncols=len(known), loc="lower right", bbox_to_anchor=(1.0, 1.0),
            borderaxespad=0.1, frameon=False, fontsize=7.5, handlelength=1.0, columnspacing=1.0,
        )  # fmt: skip
    return _titled(axes, title)


@styled
def bars(
    title: str, unit: str, rows: Sequence[BarRow], mark: tuple[str, float] | None = None, width: int = THIRD
) -> str:
    """Horizontal bars, one or two a row, with their values behind them; as an <svg> element.

    Args:
        title: Text above.
        unit: Behind each value.
        rows: From top to bottom.
        mark: Name and value of a line across all rows, or None.
        width: Of the drawing [px].
    """
    step = 22.0 if max((len(row.values) for row in rows), default=1) == 1 else 26.0
    axes = _axes(64.0 + step * len(rows), width)
    axes.grid(visible=False)
    top = max([v for row in rows for v in row.values] + [mark[1] if mark else 0.0, 1e-12])
    behind = [" \N{RIGHTWARDS ARROW} ".join(f"{v:.3g}" for v in row.values) + f" {unit}" for row in rows]
    for place, (row, text) in enumerate(zip(rows, behind, strict=True)):
        thick = 0.72 / len(row.values)
        for number, (value, colour) in enumerate(zip(row.values, row.colours, strict=True)):
            off = (number - (len(row.values) - 1) / 2.0) * thick
            axes.barh(place + off, value, height=0.9 * thick, color=colour)
        axes.annotate(
            text, (max(row.values), place), (4.0, 0.0), textcoords="offset points", va="center_baseline"
        )
    # Room for the longest text at the end of the longest bar, beside a column of labels.
    labels = [_short(row.label, int(_LABELS * width / _LETTER)) for row in rows]
    inner = width - 30.0 - _LETTER * max(map(len, labels), default=0)
    room = 10.0 + _LETTER * max(map(len, behind), default=0)
    axes.set_xlim(0.0, top * inner / max(inner - room, 0.3 * inner))
    axes.set_yticks(range(len(rows)), labels)
    axes.tick_params(axis="y", length=0.0)
    axes.set_ylim(len(rows) - 0.4, -0.6)
    if mark:
        axes.axvline(mark[1], color=DARK, linestyle=(0, (3, 3)), linewidth=1.0)
        axes.set_xticks([mark[1]], [mark[0]])
    else:
        axes.set_xticks([])
    axes.spines["bottom"].set_visible(False)
    return _titled(axes, title)


def sheet(height: float, width: float = WIDE) -> Figure:
    """An empty figure for `svg`, height x width [px]; to be made and filled in a function that is `styled`."""
    from matplotlib.figure import Figure

    return Figure(figsize=(width / _PIXELS, height / _PIXELS), layout="constrained")


def _axes(height: float, width: float) -> Axes:
    """The axes of a chart, height x width [px], for `_titled`."""
    from matplotlib.figure import Figure

    return Figure(figsize=(width / _PIXELS, height / _PIXELS)).add_axes(_MEASURED)


def _short(label: str, longest: int) -> str:
    return label if len(label) <= longest else label[: longest - 1] + "…"


def _titled(axes: Axes, title: str) -> str:
    """The figure of these axes alone with its title, as an <svg> element.

    The labels are measured once and the axes take the room that is left; constrained layout measures them twice.
    """
    from matplotlib.backends.backend_svg import RendererSVG

    figure = axes.figure
    figure.dpi = 72.0  # what SVG files are drawn with: lengths are in points
    width, height = figure.bbox.size
    heading = figure.suptitle(
        title, x=0.01, y=1.0 - _PAD / height, ha="left", fontsize=9.5, fontweight="bold"
    )
    pen = RendererSVG(width, height, io.StringIO())
    inside, outside = axes.get_window_extent(pen), axes.get_tightbbox(pen, for_layout_only=True)
    left, bottom = inside.x0 - outside.x0 + _PAD, inside.y0 - outside.y0 + _PAD
    right = width - (outside.x1 - inside.x1 + _PAD)
    top = heading.get_window_extent(pen).y0 - _PAD - (outside.y1 - inside.y1 + _PAD)
    axes.set_position((left / width, bottom / height, (right - left) / width, (top - bottom) / height))
    figure.dpi = _RASTER
    return svg(figure, title)


@styled
def svg(figure: Figure, words: str = "") -> str:
    """The figure as an <svg> element; `words` say what it shows to those who cannot see it."""
    from matplotlib.backends.backend_svg import FigureCanvasSVG

    buffer = io.StringIO()
    # savefig would draw the whole figure once more, for the layout alone.
    FigureCanvasSVG(figure).print_svg(buffer, metadata={"Date": None})
    element = inline(buffer.getvalue())
    if words:
        element.attrib |= {"role": "img", "aria-label": words}
    return ElementTree.tostring(element, encoding="unicode")


def import_matplotlib() -> None:
    """Import what charts are drawn with now: an interrupt amid an import may be swallowed or become another error."""
    import matplotlib.backends.backend_agg
    import matplotlib.backends.backend_svg
    import matplotlib.figure  # noqa: F401


def png_figure(width: float, height: float) -> Figure:
    """An empty figure for `save_png`, width x height [inch]."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(width, height), layout="constrained")
    FigureCanvasAgg(figure)  # contours ask for a renderer while they are drawn
    return figure


def save_png(figure: Figure, path: Path) -> None:
    """Write the figure as a PNG file; raises OSError when it cannot be written."""
    figure.savefig(path, dpi=_DPI, format="png")
