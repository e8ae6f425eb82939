"""What every feature of a door has."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, Any, ClassVar

import numpy as np
from pydantic import GetCoreSchemaHandler
from pydantic_core import CoreSchema, core_schema

from doormill_ros.arrays import FloatArray
from doormill_ros.frames import rotate_wrench, shift_wrench, transform
from doormill_ros.recipes.cutting import Cutting, Direction, Passes
from doormill_ros.recipes.door import R_DOOR_FEATURE, DoorSize, Side
from doormill_ros.recipes.errors import UnknownReference, WrongType
from doormill_ros.recipes.features.time_budget import TimeBudget
from doormill_ros.recipes.force_origin import ForceModel, ForceOrigin
from doormill_ros.recipes.outline import Outline, RoundedRectangle
from doormill_ros.recipes.quantities import (
    Choice,
    Name,
    Quantity,
    complaint,
)
from doormill_ros.recipes.tool import Tool
from doormill_ros.recipes.wrench import WrenchRows, WrenchTable
from doormill_ros.values import Section

PLUNGE = "plunge"  #: segment name of the way into the wood along the tool axis
CLEARING = "clearing"  #: segment name of cuts that do not touch the outline
BREAKTHROUGH = 0.001  #: how far the tool comes out behind a through hole [m]
OVERLAP = 0.001  #: how far two half holes from either side overlap [m]


class HeightFrom(str, Choice):
    """The edge from which a height is measured."""

    BOTTOM = "bottom"
    TOP = "top"


class ToolName:
    """A tool by the name under which the recipe's `tools` list it; the context of the reading holds them."""

    def read(self, value: Any, info: core_schema.ValidationInfo) -> Tool:
        """The tool; raises `complaint`."""
        if not isinstance(value, str):
            raise complaint(WrongType, f"found {value!r}, allowed is the name of a tool", found=value)
        tools: Mapping[str, Tool] = (info.context or {})["tools"]
        if value not in tools:
            raise complaint(
                UnknownReference,
                f"found {value!r}, allowed is one of {sorted(tools)} listed in tools",
                found=value,
            )
        return tools[value]

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.with_info_plain_validator_function(
            self.read,
            serialization=core_schema.plain_serializer_function_ser_schema(lambda tool: tool.name),
        )


@dataclass(frozen=True, kw_only=True)
class Feature(Section):
    """A pocket or hole with a rounded rectangular outline.

    The feature frame lies in the surface that the tool enters: origin in the centre of the
    outline, x to the right and y up as in the thesis' figures, z into the wood along the tool axis.

    Attributes:
        id: Name within the recipe.
        side: Surface of the door.
        height: Distance of the centre from the bottom or the top edge [m].
        height_from: The edge that `height` counts from.
        tool: Mill.
        cutting: Speed and feed.
        passes: Depth steps and finishing.
        direction: Climb or conventional milling.
        wrench_table: Process wrench by segment; None where a model computes it.
        wrench_point: How far behind the tool centre point, along the tool axis, the wrenches of
            the table are given [m].
        forces: What is known of the process force; None reads as a table in tool axes that nobody measured.
    """

    kind: ClassVar[str] = ""
    sides: ClassVar[tuple[Side, ...]] = tuple(Side)
    budget: ClassVar[TimeBudget | None] = None  #: None: its time counts to the door's alone
    is_lock_case: ClassVar[bool] = False  #: others may belong to it
    surrounds: ClassVar[bool] = False  #: round the mouth of the lock case that it belongs to, not through it
    # Keys in the document that the checks of a recipe name where a feature does not fit; empty: the feature as a whole.
    across_key: ClassVar[str] = ""  #: of what `across` follows from
    depth_key: ClassVar[str] = ""  #: of what `cut_depth` follows from
    radius_key: ClassVar[str] = ""  #: of the radius of the corners of `shape`
    case_key: ClassVar[str] = ""  #: of what `belongs_to` is

    id: Name
    side: Side
    height: Annotated[float, Quantity("mm", 0.0, 3000.0)]
    height_from: HeightFrom = HeightFrom.BOTTOM
    tool: Annotated[Tool, ToolName()]
    cutting: Cutting
    passes: Passes
    direction: Direction = Direction.CLIMB
    wrench_table: Annotated[WrenchTable | None, WrenchRows()] = None
    wrench_point: Annotated[float, Quantity("mm", 0.0, 1000.0)] = 0.0
    forces: ForceOrigin | None = None

    @property
    def shape(self) -> RoundedRectangle:
        """Outline shape in the feature's xy plane."""
        raise NotImplementedError

    @property
    def split_lines(self) -> bool:
        """True when the side lines have a point in the middle."""
        return False

    def across(self, door: DoorSize) -> float:
        """Distance of the centre from the front face (edge features) or hinge edge (others) [m]."""
        raise NotImplementedError

    def cut_depth(self, door: DoorSize) -> float:
        """How far the outline reaches into the wood [m]."""
        raise NotImplementedError

    @property
    def belongs_to(self) -> str | None:
        """Identifier of the lock case that the feature opens into, None when it stands for itself."""
        return None

    @property
    def through(self) -> bool:
        """True when the feature comes out on the other side."""
        return False

    @property
    def halved(self) -> bool:
        """True when each of two robots mills half of it, where there are two."""
        return False

    def tip_depth(self, door: DoorSize, half: bool = False) -> float:
        """How far the tip of the tool goes below the surface that it enters [m]; `half`: for one half of two."""
        depth = self.cut_depth(door)
        if half:
            return depth / 2.0 + OVERLAP
        return depth + BREAKTHROUGH if self.through else depth

    def outline(self, inset: float = 0.0, corner: float = 0.0) -> Outline:
        """The contour in the feature's xy plane, in climb order.

        Args:
            inset: How far inside the finished wall [m]; the tool radius gives the tool centre's path.
            corner: Smallest radius of its corners, as far as there is room for it [m].
        """
        return self.shape.inset(inset).rounded(corner).outline(self.split_lines)

    def centre_height(self, door: DoorSize) -> float:
        """Height of the centre above the bottom edge of the door as it will hang [m]."""
        return self.height if self.height_from is HeightFrom.BOTTOM else door.height - self.height

    def T_door_feature(self, door: DoorSize) -> FloatArray:
        """Feature frame in the door frame, shape (4, 4)."""
        height = self.centre_height(door)
        z = door.height - height if door.head_down else height
        across = self.across(door)
        origin = {
            Side.FRONT: [0.0, across, z],
            Side.REAR: [door.thickness, across, z],
            Side.HINGE_EDGE: [across, 0.0, z],
            Side.LOCK_EDGE: [across, door.width, z],
        }[self.side]
        return transform(R_DOOR_FEATURE[self.side], np.array(origin))

    @property
    def force_origin(self) -> ForceOrigin:
        """What is known of the process force."""
        return self.forces or ForceOrigin()

    def wrench(self, segment: str) -> FloatArray:
        """Wrench on the tool at the tool centre point, nominal tool axes, shape (6,) [N, N m].

        A wrench known at p becomes M_tcp = M_p + (p - tcp) x F. Zero where no table but a model gives it.
        """
        if self.wrench_table is None:
            return np.zeros(6)
        at_tip = shift_wrench(self.wrench_table.get(segment), np.array([0.0, 0.0, self.wrench_point]))
        return rotate_wrench(self.force_origin.axes.R_tool_axes, at_tip)

    def wrench_std(self, segment: str) -> FloatArray:
        """Standard deviations of `wrench` along nominal tool axes, shape (6,) [N, N m]."""
        return self.std_of(self.wrench(segment))

    def std_of(self, wrench: FloatArray) -> FloatArray:
        """Standard deviations of wrenches as the table has them, nominal tool axes, shapes (..., 6) [N, N m]."""
        if self.wrench_table is None:
            return np.zeros(wrench.shape)
        axes = self.force_origin.axes.R_tool_axes
        spread = self.force_origin.spread(rotate_wrench(axes.T, wrench))
        return rotate_wrench(np.abs(axes), spread)

    @property
    def computes_force(self) -> bool:
        """True when the force follows from the wood that each cut removes."""
        return self.force_origin.model is ForceModel.ENGAGEMENT

    @property
    def segment_names(self) -> tuple[str, ...]:
        """Names of the segments for which a wrench may be given, in the order of the outline."""
        names = dict.fromkeys(segment.name for segment in self.outline().segments)
        return (*names, PLUNGE, CLEARING)
