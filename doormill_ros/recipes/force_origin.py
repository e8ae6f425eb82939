"""Where the process force of a feature comes from: measured or not, in which axes, how far to be trusted."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any

import numpy as np
from pydantic import GetCoreSchemaHandler, model_validator
from pydantic_core import CoreSchema

from doormill_ros.arrays import FloatArray
from doormill_ros.recipes.door import R_FEATURE_TOOL
from doormill_ros.recipes.errors import ConflictingFields, MissingField, OutOfRange, WrongType
from doormill_ros.recipes.quantities import GRID_DECIMALS, Choice, complaint, number, schema
from doormill_ros.recipes.wrench import LIMITS, Six
from doormill_ros.values import Section


class ForceModel(str, Choice):
    """What the correction takes for the force on the tool."""

    TABLE = "table"  #: the recipe's own wrench of each segment, the thesis' way
    ENGAGEMENT = (
        "engagement"  #: the wood that each cut really removes, `doormill_ros.correction.cutting_force`
    )


class ForceAxes(str, Choice):
    """Axes in which a recipe's wrenches stand; z of both goes into the wood.

    Table 4.8 of the thesis stands in FEATURE axes as far as that can be settled: x across, y up.

    * Appendix A.16 plots Fy from -350 to -170 N and Mx up to 75 N m, which is a weight of some 26 kg at 0.2 m on the
      sensor's y. So y was vertical while it was milled, and x horizontal.
    * In a full slot (the left line was cut first) the mean force square to the feed goes with the coefficient along
      the cutting speed, the one along the feed with the smaller radial one. With x horizontal the left line, cut
      upwards, has 209 N square to the feed and 29 N along it; with x vertical it would be the other way round.
    * The reading of the weight also gives the sign: if the sensor reads what acts on the robot, its y pointed up, if it
      reads the reaction, down, and in both cases Fx of the table is the force on the tool along the feature's x.
      The sign of Fz stays open.

    What speaks against the sign: a spindle turning clockwise is pushed to the left of its feed, so the two lines
    should push in opposite directions, away from the wall. Theirs push one way, and the mean of the four segments,
    -96 N, is what no force that turns with the feed can have: an offset of the sensor or a share of the weight. Hence
    the standard deviation that shipped recipes give.

    TOOL is how recipes without `forces` are read: x along the feature's -y, y along its x.
    """

    TOOL = "tool"
    FEATURE = "feature"

    @property
    def R_tool_axes(self) -> FloatArray:
        """These axes in the tool's nominal ones, shape (3, 3)."""
        return np.eye(3) if self is ForceAxes.TOOL else R_FEATURE_TOOL.T


class SixNumbers:
    """Annotation of six standard deviations [N, N m], in the document a list."""

    def key(self, name: str) -> str:
        """Name in the document."""
        return f"{name}_n_nm"

    def read(self, value: Any) -> Six:
        """The six numbers; raises `complaint`."""
        if not isinstance(value, list | tuple) or len(value) != 6:
            raise complaint(WrongType, f"found {value!r:.80}, allowed are six numbers", found=value)
        numbers = [number(cell, inside=(index,)) for index, cell in enumerate(value)]
        for index, (found, limit) in enumerate(zip(numbers, LIMITS, strict=True)):
            if not 0.0 <= found <= limit:
                raise complaint(
                    OutOfRange, f"found {found:g}, allowed are 0 to {limit:g}", (index,), found=found
                )
        fx, fy, fz, mx, my, mz = (round(cell, GRID_DECIMALS) + 0.0 for cell in numbers)
        return fx, fy, fz, mx, my, mz

    def write(self, value: Six) -> list[float]:
        """The document's list."""
        return list(value)

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return schema(source, self.read, self.write)


class Source:
    """Annotation of a text that says who measured, or what was assumed."""

    def read(self, value: Any) -> str:
        """The text; raises `complaint`."""
        if not isinstance(value, str):
            raise complaint(WrongType, f"found {value!r:.80}, allowed is text", found=value)
        if len(value) > 400 or not value.isprintable():
            raise complaint(
                WrongType, "allowed are at most 400 printable characters in one line", found=value
            )
        return value

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return schema(source, self.read)


@dataclass(frozen=True)
class ForceOrigin(Section):
    """What is known of a feature's process forces.

    Attributes:
        model: What the correction takes for the force.
        axes: Axes of the recipe's wrenches and of `std`.
        measured: Whether somebody measured them in a cut like this one. The correction for a force that nobody
            measured is bounded, so that it can never do much harm.
        std: Standard deviation of each component at the tip of the tool, the same for every segment [N, N m]; None
            where unknown.
        source: Who measured, or what was assumed.
    """

    model: ForceModel = ForceModel.TABLE
    axes: ForceAxes = ForceAxes.TOOL
    measured: bool = False
    std: Annotated[Six | None, SixNumbers()] = None
    source: Annotated[str, Source()] = ""

    @model_validator(mode="after")
    def _measured_has_its_spread(self) -> ForceOrigin:
        """Who measured says how well; a model was not measured in this cut."""
        if self.measured and self.model is ForceModel.ENGAGEMENT:
            raise complaint(
                ConflictingFields,
                "found true for a force that the model 'engagement' computes, allowed is false; give the measured "
                "wrenches with the model 'table'",
                ("measured",),
                found=True,
            )
        if self.measured and (self.std is None or not self.source):
            missing = "std_n_nm" if self.std is None else "source"
            raise complaint(MissingField, "is missing, a measured force has one", (missing,), found=None)
        return self

    def spread(self, wrench: FloatArray) -> FloatArray:
        """Standard deviations of wrenches of the recipe's table, its own axes, shape (..., 6) [N, N m].

        A force of which nothing is known but somebody's figure may be off by its own size, in any direction.
        """
        if self.std is not None:
            return np.broadcast_to(np.array(self.std), wrench.shape)
        sizes = np.linalg.norm(wrench.reshape(*wrench.shape[:-1], 2, 3), axis=-1)
        spread: FloatArray = np.repeat(sizes, 3, axis=-1) / np.sqrt(3.0)
        return spread
