"""Steps that run side by side along an edge: which of them is the edge of the face, which a strip on it or behind it.

Grooves, lippings, edge bands and shadows lie on the face, whose edge is then the outermost step; a rebate's lip, a
bevel, a rail or another door lie behind it, and the face's edge is the innermost. Told apart by brightness, by where
a strip ends at the other edge - on the face it ends with the face - and by what happens where two strips cross.
"""

from __future__ import annotations

from dataclasses import dataclass

from doormill_ros.arrays import ByteArray, FloatArray
from doormill_ros.localization.errors import WrongEdge
from doormill_ros.localization.search.edge_layers import EdgeLayers
from doormill_ros.localization.search.edge_line import EdgeLine
from doormill_ros.localization.search.face_edge import check_agrees, settle
from doormill_ros.localization.search.shade import Surfaces, shaded
from doormill_ros.localization.search.strip_doubts import check_told, ends_face
from doormill_ros.localization.view import BOTTOM, HINGE, FaceView


@dataclass(frozen=True, eq=False)
class Chosen:
    """The line of each edge that is the edge of the face, and what was read of the others."""

    lines: dict[str, EdgeLine]
    read: tuple[EdgeLayers, ...] = ()

    def check(self) -> None:
        """Whether brightness and end of every strip tell where it lies; by now nothing else spoke against the lines.

        Raises:
            WrongEdge: One does not.
        """
        for edge, other in zip(self.read, self.read[::-1], strict=True):
            check_told(edge, other)
            for k in range(edge.lines.index(self.lines[edge.edge])):
                if edge.mitred(k, other) and not edge.drawn(k, other, max(other.first - 1, 0)):
                    raise edge.doubt(k, k + 1)

    def check_are(self, edges: dict[str, EdgeLine]) -> None:
        """Whether these lines were chosen.

        Raises:
            WrongEdge: Another one was.
        """
        for read in self.read:
            mine, its = read.lines.index(edges[read.edge]), read.lines.index(self.lines[read.edge])
            if mine != its:
                raise read.doubt(min(mine, its), max(mine, its))


def choose(
    picture: ByteArray, view: FaceView, lines: dict[str, list[EdgeLine]], corner: FloatArray
) -> Chosen:
    """Tell the edges of the face from the lines beside them.

    Args:
        picture: Grey picture, shape (h, w), uint8.
        view: The camera before the face.
        lines: Parallels of each edge, from the inside outwards.
        corner: Where the innermost of them meet, y and z [m].

    Raises:
        WrongEdge: More than one of them may be it.
    """
    sight = Surfaces(picture, view)
    place = {HINGE: float(corner[1]), BOTTOM: float(corner[0])}
    if all(len(found) == 1 for found in lines.values()):
        return Chosen({edge: found[0] for edge, found in lines.items()})
    real = {}
    for edge, other in ((HINGE, BOTTOM), (BOTTOM, HINGE)):
        end = lines[other][-1].at(lines[edge][-1].at(place[edge]))
        shadows = [shaded(sight, edge, line, place[edge], end) for line in lines[edge]]
        real[edge] = [line for line, dark in zip(lines[edge], shadows, strict=True) if not dark]
        if not real[edge] or (any(shadows) and not ends_face(sight, edge, real[edge][-1], place[edge], end)):
            raise WrongEdge(
                f"what runs along the {edge} edge goes on beyond the door: a shadow's border, and outside of it no "
                "step is to be seen; change the light",
                edge=edge,
            )
    read = {
        edge: EdgeLayers(sight, edge, real[edge], place[edge], real[other])
        for edge, other in ((HINGE, BOTTOM), (BOTTOM, HINGE))
    }
    for edge, other in ((HINGE, BOTTOM), (BOTTOM, HINGE)):
        read[edge].judge(read[other])
    found = {edge: settle(read[edge], read[HINGE if edge == BOTTOM else BOTTOM]) for edge in read}
    check_agrees(read[HINGE], read[BOTTOM], found)
    return Chosen(found, (read[HINGE], read[BOTTOM]))
