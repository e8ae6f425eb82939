"""A page in one HTML file without anything from outside: a heading, and sections made of blocks.

All texts are plain text and are escaped; only drawings (SVG or <img> elements) go in as they are.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar, Literal

from jinja2 import Environment, PackageLoader, StrictUndefined


@dataclass(frozen=True)
class Paragraphs:
    """Paragraphs; as notes in a lighter colour."""

    kind: ClassVar[str] = "text"
    lines: Sequence[str]
    note: bool = False


@dataclass(frozen=True)
class Tiles:
    """Figures in large print, each with what it is."""

    kind: ClassVar[str] = "tiles"
    entries: Sequence[tuple[str, str]]


@dataclass(frozen=True)
class Bar:
    """A cell of a table with a bar below its text.

    Attributes:
        text: The text.
        share: Length of the bar as a share of the cell, 0 to 1.
        colour: CSS colour.
    """

    text: str
    share: float
    colour: str


@dataclass(frozen=True)
class Table:
    """A table with a line of headings.

    Attributes:
        head: The headings.
        rows: Cells, one to a heading.
        marked: Row in bold print, or None.
        name: CSS class that others find the table by.
    """

    kind: ClassVar[str] = "table"
    head: Sequence[str]
    rows: Sequence[Sequence[str | Bar]]
    marked: int | None = None
    name: str = ""


@dataclass(frozen=True)
class Facts:
    """Lines of a heading and its values.

    Attributes:
        rows: Heading and values of each line.
        numbers: Whether the first value is a number that must not be broken.
    """

    kind: ClassVar[str] = "facts"
    rows: Sequence[tuple[str, *tuple[str, ...]]]
    numbers: bool = False


@dataclass(frozen=True)
class Charts:
    """Drawings, as elements of HTML.

    Attributes:
        drawings: <svg> or <img> elements.
        layout: "thirds", "halves" or "wide": how many fit into a row of a full page.
    """

    kind: ClassVar[str] = "charts"
    drawings: Sequence[str]
    layout: Literal["thirds", "halves", "wide"] = "thirds"


@dataclass(frozen=True)
class Listing:
    """Text as it stands, in its own lines and blanks."""

    kind: ClassVar[str] = "listing"
    text: str


@dataclass(frozen=True)
class Picture:
    """A picture from a data URL, with the words that stand for it."""

    kind: ClassVar[str] = "picture"
    url: str
    words: str


Block = Paragraphs | Tiles | Table | Facts | Charts | Listing | Picture


@dataclass(frozen=True)
class PageSection:
    """Blocks below a heading; without a title they stand at the top of the page."""

    title: str
    blocks: Sequence[Block]


@dataclass(frozen=True)
class Page:
    """What a page says.

    Attributes:
        heading: The verdict, first line of the page.
        sections: What follows.
        lead: A sentence below the heading, or empty.
        title: Of the window; empty for the heading.
        good: Whether the heading is shown as a success (True) or a failure (False), or as neither.
    """

    heading: str
    sections: Sequence[PageSection]
    lead: str = ""
    title: str = ""
    good: bool | None = None


_ENVIRONMENT = Environment(
    loader=PackageLoader("doormill_ros.pages"),
    autoescape=True,
    undefined=StrictUndefined,
    trim_blocks=True,
    lstrip_blocks=True,
)


def render(page: Page) -> str:
    """The page as text of an HTML file."""
    return _ENVIRONMENT.get_template("page.html.j2").render(page=page)
