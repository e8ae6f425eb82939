"""An SVG file as an element of a page: nothing in it refers to anything, inside or outside.

Ids of several drawings on one page would be taken for each other's, and a page that holds no reference at all is
seen at a glance to need nothing from outside.
"""

from __future__ import annotations

import re
import xml.etree.ElementTree as ElementTree

_SVG, _XLINK = "{http://www.w3.org/2000/svg}", "{http://www.w3.org/1999/xlink}href"
#: The round marker: eight curves about the origin.
_CIRCLE = re.compile(r"M 0 ([\d.]+) (?:C [-\d. ]+){8} ?z?")
#: What a line may reach over the edge of the axes before it is cut off [pt].
_LINE = 0.5
_LEFT_OUT = {"metadata", "defs", "clipPath"}


def inline(text: str) -> ElementTree.Element:
    """The element of an SVG file as matplotlib writes it, with what it refers to put in its place.

    Pictures stay in `data:` addresses.
    """
    root = ElementTree.fromstring(text)
    known = {e.get("id", ""): e for e in root.iter() if e.get("id")}
    styles = list(root.iter(f"{_SVG}style"))
    inlined = _copied(root, known)
    for style in reversed(styles):
        inlined.insert(0, _bare(style))
    inlined.attrib.pop("version", None)
    return inlined


def _bare(element: ElementTree.Element) -> ElementTree.Element:
    """The element alone, without namespace and id."""
    made = ElementTree.Element(element.tag.removeprefix(_SVG))
    for name, value in element.attrib.items():
        if name == _XLINK:
            made.set("href", value)
        elif name != "id" and not name.startswith("{"):
            made.set(name, " ".join(value.split()))
    made.text = element.text if element.text and element.text.strip() else None
    return made


def _copied(element: ElementTree.Element, known: dict[str, ElementTree.Element]) -> ElementTree.Element:
    if element.tag == f"{_SVG}use":
        return _used(element, known[element.get(_XLINK, "").removeprefix("#")])
    made = _bare(element)
    for child in element:
        # matplotlib's comments have no tag of their own; what is defined stands where it is used.
        if isinstance(child.tag, str) and child.tag.removeprefix(_SVG) not in _LEFT_OUT | {"style"}:
            made.append(_copied(child, known))
    clip = re.fullmatch(r"url\(#(.+)\)", made.attrib.pop("clip-path", ""))
    return _clipped(made, known[clip[1]][0]) if clip else made


def _used(use: ElementTree.Element, target: ElementTree.Element) -> ElementTree.Element:
    """A copy of what `use` shows, moved to where it is shown."""
    shown = _bare(target)
    round_marker = _CIRCLE.fullmatch(shown.get("d", ""))
    if round_marker and not use.get("transform"):
        place = {"cx": use.get("x", "0"), "cy": use.get("y", "0"), "r": round_marker[1]}
        return ElementTree.Element("circle", {**place, "style": use.get("style", "")})
    group = ElementTree.Element("g")
    x, y = use.get("x", "0"), use.get("y", "0")
    turns = [use.get("transform", ""), f"translate({x} {y})" if (x, y) != ("0", "0") else ""]
    if any(turns):
        group.set("transform", " ".join(turn for turn in turns if turn))
    if use.get("style"):
        group.set("style", use.get("style", ""))
    group.append(shown)
    return group


def _clipped(element: ElementTree.Element, rectangle: ElementTree.Element) -> ElementTree.Element:
    """The element, where it needs one in a frame that hides what lies beyond a rectangle."""
    left, top, width, height = (float(rectangle.get(name, "0")) for name in ("x", "y", "width", "height"))
    points = [point for part in element.iter() for point in _points(part)]
    if points and all(
        -_LINE <= x - left <= width + _LINE and -_LINE <= y - top <= height + _LINE for x, y in points
    ):
        return element
    right, bottom = left + width, top + height
    corners = ((left, top), (right, top), (right, bottom), (left, bottom))
    outline = ", ".join(f"{x:.7g}px {y:.7g}px" for x, y in corners)
    # Around it, not on it: what moves the element must not move the frame.
    frame = ElementTree.Element("g", {"style": f"clip-path: polygon({outline}) view-box"})
    frame.append(element)
    return frame


def _points(element: ElementTree.Element) -> list[tuple[float, float]]:
    """Corners of a path, the centre of a circle or the place of a moved group."""
    if element.tag == "circle":
        return [(float(element.get("cx", "0")), float(element.get("cy", "0")))]
    numbers = [float(number) for number in re.findall(r"-?[\d.]+(?:e-?\d+)?", element.get("d", ""))]
    return list(zip(numbers[::2], numbers[1::2], strict=True))
