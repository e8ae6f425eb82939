"""What a controller's path planner says to a target file: motions too short, bends too tight, stops in the wood.

It looks at the file alone and knows nothing of the planner: targets, motions, and what RAPID's predefined zones are.
"""

from dataclasses import dataclass

import numpy as np

from support.file_run import read_file

SHORTEST = 0.025  #: s; controllers sample motions every 12 to 24 ms
ZONE = {"z0": 0.3, "z1": 1.0, "z5": 5.0}  #: pzone_tcp of the predefined zones, mm
ROUNDING = 1.01  #: lengths and speeds of the file are rounded


@dataclass(frozen=True)
class PathFaults:
    """Findings in the wood, as (number of the motion, figure)."""

    short: list  # time of the motion, s
    tight: list  # acceleration across the path, m/s^2
    stops: list  # angle between the directions before and after, degrees

    def in_a_row(self):
        """Most short motions one after the other."""
        numbers, longest, row = {number for number, _ in self.short}, 0, 0
        for number in range(max(numbers, default=0) + 1):
            row = row + 1 if number in numbers else 0
            longest = max(longest, row)
        return longest


def path_faults(text, acceleration):
    """Everything that is wrong with the path of a file, for a robot with an acceleration across its path [m/s^2]."""
    program = read_file(text)
    places = np.array([target[0] for target in program.targets])
    ways = ways_of(program, places)
    short, tight, stops = [], [], []
    for number, (motion, way) in enumerate(zip(program.motions, ways, strict=True)):
        following = program.motions[number + 1] if number + 1 < len(ways) else None
        if way is None:
            continue
        length, radius, _, leaving = way
        if motion.cutting:
            time = length / motion.speed
            if time * ROUNDING < SHORTEST:
                short.append((number, time))
            if motion.speed**2 / radius * 1e-3 > acceleration * ROUNDING:
                tight.append((number, motion.speed**2 / radius * 1e-3))
        after = ways[number + 1] if following is not None else None
        if after is None or not (motion.cutting or following.cutting):
            continue
        turn = angle(leaving, after[2])
        if motion.zone == "fine":
            if motion.cutting:
                stops.append((number, float(np.degrees(turn))))
            continue
        leg = min(ZONE[motion.zone], length / 2, after[0] / 2)
        found = max(motion.speed, following.speed) ** 2 * parabola_curvature(turn, leg) * 1e-3
        if turn > 1e-6 and found > acceleration * ROUNDING:
            tight.append((number, found))
    return PathFaults(short, tight, stops)


def ways_of(program, places):
    """Of every MoveL and MoveC from a target: length, radius (mm), directions at begin and end; None of others."""
    ways, at = [], None
    for motion in program.motions:
        if motion.kind not in "LC" or at is None:
            ways.append(None)
        elif motion.kind == "L":
            way = places[motion.target - 1] - at
            length = np.linalg.norm(way)
            ways.append((length, np.inf, way / length, way / length))
        else:
            ways.append(circle(at, places[motion.via - 1], places[motion.target - 1]))
        at = None if motion.kind == "A" else places[motion.target - 1]
    return ways


def circle(start, via, end):
    """Length, radius and directions of travel of the arc through three points."""
    x = (via - start) / np.linalg.norm(via - start)
    z = np.cross(x, end - start)
    z /= np.linalg.norm(z)
    y = np.cross(z, x)
    half, (ex, ey) = np.linalg.norm(via - start) / 2, ((end - start) @ x, (end - start) @ y)
    rise = (ex**2 + ey**2 - 2 * half * ex) / (2 * ey)  # the centre lies over the middle of the first chord
    centre = start + half * x + rise * y
    turn = 1.0  # x, y, z are right-handed, and the way goes from x towards y
    arms = [point - centre for point in (start, via, end)]
    angles = [np.arctan2(arm @ y, arm @ x) for arm in arms]
    swept = (angles[2] - angles[0]) % (2 * np.pi)
    if (angles[1] - angles[0]) % (2 * np.pi) > swept:
        swept, turn = 2 * np.pi - swept, -1.0
    radius = np.linalg.norm(arms[0])
    return radius * swept, radius, *(turn * np.cross(z, arm) / radius for arm in (arms[0], arms[2]))


def angle(a, b):
    return float(np.arccos(np.clip(a @ b, -1.0, 1.0)))


def parabola_curvature(turn, leg):
    """Largest curvature (1/mm) of a parabola that leaves one line and enters another a leg from their corner."""
    u = np.linspace(0.0, 1.0, 201)
    p0, p2 = np.array([-leg, 0.0]), leg * np.array([np.cos(turn), np.sin(turn)])
    first = np.outer(1 - u, -2 * p0) + np.outer(u, 2 * p2)  # the corner is the origin
    second = 2 * (p0 + p2)
    speed = np.maximum(np.linalg.norm(first, axis=1), 1e-9)
    return float(np.max(np.abs(first[:, 0] * second[1] - first[:, 1] * second[0]) / speed**3))
