"""The lines that the search saw beside an edge, judged once more from where the edges were found to be.

Where a strip ends tells whether it lies on the face, and from a place that is a pixel or a narrow strip off that cannot
be told.
"""

from __future__ import annotations

from doormill_ros.arrays import ByteArray
from doormill_ros.localization.search.edge_line import EdgeLine, meet
from doormill_ros.localization.search.layers import choose
from doormill_ros.localization.view import BOTTOM, HINGE, FaceView

_OWN = 0.8e-3  # what the search saw so near to an edge is that, or was looked at from closer by [m]


def check_again(
    picture: ByteArray, view: FaceView, edges: dict[str, EdgeLine], seen: dict[str, list[EdgeLine]]
) -> None:
    """Whether the same lines are chosen from where they were found to be.

    Args:
        picture: Grey picture, shape (h, w), uint8.
        view: The camera before the face.
        edges: Where the edges were found.
        seen: The lines that the search saw along each of them, from the inside outwards.

    Raises:
        WrongEdge: Another line may be the edge.
    """
    corner = meet(edges[HINGE], edges[BOTTOM])[:2]
    lines = {}
    for edge, at in ((HINGE, corner[1]), (BOTTOM, corner[0])):
        own = edges[edge]
        others = [line for line in seen[edge] if abs(line.at(at) - own.at(at)) > _OWN]
        lines[edge] = sorted([*others, own], key=lambda line: -line.at(at))
    if all(len(one) == 1 for one in lines.values()):
        return
    layers = choose(picture, view, lines, corner)
    layers.check_are(edges)
    layers.check()
