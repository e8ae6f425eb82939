"""What can touch and what can be touched: bodies of robot and spindle, obstacles of the cell."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Literal

import numpy as np

from doormill_ros.arrays import BoolArray, FloatArray
from doormill_ros.config import check, read_document
from doormill_ros.resources import resource
from doormill_ros.simulation.errors import BodiesError
from doormill_ros.simulation.judge.boards import SolidBoard
from doormill_ros.simulation.judge.links import BASE, FLANGE, Links, pose
from doormill_ros.simulation.judge.shapes import box_gap, segment_gap
from doormill_ros.values import Name, Positive, Section, Vector3

CELL, PATH = "config/cell.yaml", "config/toolpath.yaml"
LEVEL = np.zeros(3)


@dataclass(frozen=True, eq=False)
class Capsule:
    """All points within a radius of a line.

    Attributes:
        name: What it is called in a verdict.
        link: Link whose frame the coordinates are in.
        start: End of the line, shape (3,) [m].
        end: Its other end, shape (3,) [m].
        radius: [m].
    """

    name: str
    link: str
    start: FloatArray
    end: FloatArray
    radius: float

    @property
    def extent(self) -> float:
        """How far its farthest point is from the link's origin [m]."""
        return float(max(np.linalg.norm(self.start), np.linalg.norm(self.end)) + self.radius)

    def gap(self, T_box_link: FloatArray, half: FloatArray) -> FloatArray:
        """Gap to a box of half extents (3,) [m] at poses (n, 4, 4) of the link in the box's frame, shape (n,) [m]."""
        return segment_gap(_at(T_box_link, self.start), _at(T_box_link, self.end), self.radius, half)

    def reaches(self, T_any_link: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Lowest and highest coordinates it reaches at poses (n, 4, 4), shape (n, 3) each [m]."""
        ends = np.stack([_at(T_any_link, self.start), _at(T_any_link, self.end)])
        return ends.min(axis=0) - self.radius, ends.max(axis=0) + self.radius

    def holds(self, points: FloatArray) -> BoolArray:
        """Which points (n, 3) [m] of the link's frame lie in it, shape (n,)."""
        along = self.end - self.start
        share = np.clip((points - self.start) @ along / max(float(along @ along), 1e-18), 0.0, 1.0)
        held: BoolArray = np.linalg.norm(points - self.start - share[:, None] * along, axis=1) < self.radius
        return held


@dataclass(frozen=True, eq=False)
class Box:
    """A box; `at` is the pose of its centre in the link, shape (4, 4), `half` half its extents, shape (3,) [m]."""

    name: str
    link: str
    at: FloatArray
    half: FloatArray

    @property
    def extent(self) -> float:
        """How far its farthest point is from the link's origin [m]."""
        return float(np.linalg.norm(self.at[:3, 3]) + np.linalg.norm(self.half))

    def gap(self, T_box_link: FloatArray, half: FloatArray) -> FloatArray:
        """See `Capsule.gap`."""
        centre = T_box_link @ self.at
        return box_gap(centre[:, :3, 3], centre[:, :3, :3], self.half, half)

    def reaches(self, T_any_link: FloatArray) -> tuple[FloatArray, FloatArray]:
        """See `Capsule.reaches`."""
        centre = T_any_link @ self.at
        span = np.abs(centre[:, :3, :3]) @ self.half
        return centre[:, :3, 3] - span, centre[:, :3, 3] + span

    def holds(self, points: FloatArray) -> BoolArray:
        """See `Capsule.holds`."""
        own = (points - self.at[:3, 3]) @ self.at[:3, :3]
        held: BoolArray = np.all(np.abs(own) < self.half, axis=1)
        return held


Body = Capsule | Box


@dataclass(frozen=True, eq=False)
class JudgedPlace:
    """A place of a rack.

    Attributes:
        tool: Name of the tool that stands in it.
        T_base_seat: The flange where the tool is seated, shape (4, 4).
        depth: How far the spindle goes along its axis to get there [m].
        holder: What holds the tool.
    """

    tool: str
    T_base_seat: FloatArray
    depth: float
    holder: Box


@dataclass(frozen=True, eq=False)
class JudgedCell:
    """One robot with its spindle among what stands in the cell, in the robot's base frame.

    Attributes:
        links: The arm.
        bodies: Of arm and spindle, those that move.
        obstacles: What stands still beside the door; boxes in base_link.
        T_flange_tool: Tool centre point in the flange, shape (4, 4).
        nose: How far the mill reaches out of the spindle [m].
        home: Where the robot stands between doors, shape (6,) [rad].
        boards: What is pressed against the rear face of a door.
        rooted: Bodies of the arm that stand on the floor: for another robot they are in the way, too.
        with_second: Boxes about a second robot, where there is one, in its base frame.
        widest: Radius of the widest mill that stands in a rack [m].
        rack: Places from which the robot takes tools, the first one's in the spindle between doors.
        rack_of_second: Those of a second robot, in its base frame.
    """

    links: Links
    bodies: tuple[Body, ...]
    obstacles: tuple[Box, ...]
    T_flange_tool: FloatArray
    nose: float
    home: FloatArray
    boards: tuple[SolidBoard, ...] = ()
    rooted: tuple[Body, ...] = ()
    with_second: tuple[Box, ...] = ()
    widest: float = 0.0
    rack: tuple[JudgedPlace, ...] = ()
    rack_of_second: tuple[JudgedPlace, ...] = ()

    def of_two(self, T_base_second: FloatArray) -> JudgedCell:
        """The cell with a second robot, base of shape (4, 4): its obstacles are there, the boards are not."""
        placed = [replace(box, at=T_base_second @ box.at) for box in self.with_second]
        return replace(self, obstacles=(*self.obstacles, *placed), boards=())


@dataclass(frozen=True, kw_only=True, eq=False)
class _Shape(Section):
    name: Name
    shape: Literal["capsule", "box"]
    link: str = FLANGE
    radius: Positive | None = None
    start: Vector3 | None = None
    end: Vector3 | None = None
    size: Vector3 | None = None
    position: Vector3 | None = None
    rotation: Vector3 = field(default_factory=lambda: LEVEL)

    def body(self, path: Path, link: str) -> Body:
        if self.shape == "capsule" and self.radius and self.start is not None and self.end is not None:
            return Capsule(self.name, link, self.start, self.end, self.radius)
        if self.shape == "box" and self.size is not None and self.position is not None:
            return Box(self.name, link, pose(self.position, self.rotation), self.size / 2.0)
        needed = "radius, start and end" if self.shape == "capsule" else "size and position"
        raise BodiesError(f"{path}: {self.name} is a {self.shape}, allowed is one with {needed}: add them")


def load_cell(robot: str | None = None, cell: Path | None = None, robots: Path | None = None) -> JudgedCell:
    """Read arm, spindle and obstacles of the cell.

    Args:
        robot: Name of the robot's folder; None for the one of the cell's file.
        cell: Cell file; None for config/cell.yaml.
        robots: Folder of robots; None for config/robots.

    Raises:
        BodiesError: A file is missing, or a body has no shape that is known.
    """
    path = cell or resource(CELL)
    content = read_document(path, BodiesError)
    try:
        folder = (robots or resource("config/robots")) / (robot or content["robot"])
        own = read_document(folder / "bodies.yaml", BodiesError)["bodies"]
        spindle, obstacles = content["spindle"]["bodies"], content["obstacles"]
        T_flange_tool = pose(np.array(content["tool"]["position"], dtype=float), LEVEL)
        home = np.array(content["home"]["joints"], dtype=float).reshape(6)
        boards = (content.get("backing") or {"boards": []})["boards"]
        second = content.get("second_robot") or {"obstacles": []}
        approach = read_document(resource(PATH), BodiesError)["approach"]
        nose, widest = float(approach["nose"]), float(approach["mill_radius"])
        links = Links.read(folder / "robot.urdf")
        racks = [_places(part.get("rack"), path, links) for part in (content, second)]
    except (KeyError, TypeError, ValueError, OSError) as cause:
        raise BodiesError(
            f"{path} and the robot's bodies.yaml do not say what can touch ({cause!r}); allowed are files with robot, "
            "tool, home, spindle, obstacles and bodies: compare them with the shipped ones"
        ) from cause
    bodies = [
        *_shapes(own, folder / "bodies.yaml"),
        *(s for s in _shapes(spindle, path)),
    ]
    for body in bodies:
        if body.link not in links.names:
            raise BodiesError(
                f"{folder / 'bodies.yaml'}: {body.name} is on link {body.link!r}, allowed is one of {links.names}"
            )
    return JudgedCell(
        links,
        tuple(b for b in bodies if b.link != BASE),
        _boxes(obstacles, path),
        T_flange_tool,
        nose,
        home,
        tuple(check(boards, list[SolidBoard], BodiesError, str(path))),
        tuple(b for b in bodies if b.link == BASE),
        _boxes(second["obstacles"], path),
        widest,
        *racks,
    )


def _boxes(content: Any, path: Path) -> tuple[Box, ...]:
    shapes = _shapes(content, path, BASE)
    boxes = tuple(body for body in shapes if isinstance(body, Box))
    if len(boxes) != len(shapes):
        raise BodiesError(f"{path}: obstacles hold a capsule, allowed are boxes: enclose it in one")
    return boxes


def _places(rack: Any, path: Path, links: Links) -> tuple[JudgedPlace, ...]:
    if rack is None:
        return ()
    (holder,) = _boxes([rack["holder"]], path)
    depth, found = float(rack["depth"]), []
    for place in rack["places"]:
        T_base_seat = links.frames(np.array([place["front"]], dtype=float))[FLANGE][0]
        T_base_seat = T_base_seat @ pose(np.array([0.0, 0.0, depth]), LEVEL)
        held = Box(f"holder of {place['tool']}", BASE, T_base_seat @ holder.at, holder.half)
        found.append(JudgedPlace(str(place["tool"]), T_base_seat, depth, held))
    return tuple(found)


def _shapes(content: Any, path: Path, link: str | None = None) -> list[Body]:
    shapes = check(content, list[_Shape], BodiesError, str(path))
    return [shape.body(path, link or shape.link) for shape in shapes]


def _at(T: FloatArray, point: FloatArray) -> FloatArray:
    at: FloatArray = T[:, :3, :3] @ point + T[:, :3, 3]
    return at
