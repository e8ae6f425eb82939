"""Errors of recipes, codes 100 to 199.

RecipeError
|-- FieldError                    one field of a document is wrong; `field` is its dotted path
|   |-- 101 UnknownField          |-- 102 MissingField       |-- 103 WrongType
|   |-- 104 NotFinite             |-- 105 OutOfRange         |-- 106 NotAChoice
|   |-- 107 BadText               |-- 108 DuplicateField     |-- 109 DuplicateName
|   |-- 110 UnknownReference      |-- 111 ConflictingFields  |-- 112 ImplausibleMass
|   `-- 113 UnfitForProgram
|-- GeometryError                 the fields are right one by one, the door is not
|   |-- 120 LeavesWood            |-- 121 FeaturesMeet
|   `-- 122 FeaturesApart         `-- 123 ThinFloor
|-- ToolError                     the tool cannot make the feature
|   |-- 130 ToolTooWide           |-- 131 ToolTooShort
|   `-- 132 SpindleTooFast        `-- 133 ChipTooThick
|-- DatabaseError
|   |-- 140 UnknownDoor           |-- 141 UnknownVersion     |-- 142 UnknownBarCode
|   |-- 143 BarCodeTaken          |-- 144 SchemaTooNew       |-- 145 DatabaseUnreachable
|   `-- 146 DamagedRecord
`-- ExchangeError
    |-- 150 UnreadableFile        |-- 151 UnknownFileType
    `-- 152 NotExpressible        `-- 153 BadTable
"""

from __future__ import annotations

from typing import Any

from doormill_ros.errors import DoormillError


class RecipeError(DoormillError):
    """A recipe, the recipe database or an exchange file is wrong."""


class FieldError(RecipeError):
    """One field is wrong.

    Attributes:
        field: Dotted path of the field, for example `features.0.depth_mm`; empty for the whole document.
    """

    def __init__(self, field: str, message: str, **data: Any) -> None:
        """Put the field's path in front of the sentence."""
        super().__init__(f"{field or 'recipe'}: {message}", field=field, **data)
        self.field = field


class UnknownField(FieldError):
    """A field that no recipe has."""

    code = 101


class MissingField(FieldError):
    """A field without a default is absent."""

    code = 102


class WrongType(FieldError):
    """A value of another type, such as text where a number belongs."""

    code = 103


class NotFinite(FieldError):
    """A number is NaN or infinite."""

    code = 104


class OutOfRange(FieldError):
    """A number or a count beyond its limits."""

    code = 105


class NotAChoice(FieldError):
    """A word outside the list of allowed words."""

    code = 106


class BadText(FieldError):
    """A text with characters or a length that is not allowed."""

    code = 107


class DuplicateField(FieldError):
    """A field is given twice."""

    code = 108


class DuplicateName(FieldError):
    """Two features or two tools have one name."""

    code = 109


class UnknownReference(FieldError):
    """A name that stands for nothing in the recipe."""

    code = 110


class ConflictingFields(FieldError):
    """Fields that exclude each other are both given."""

    code = 111


class ImplausibleMass(FieldError):
    """No wood has the density that mass and size give."""

    code = 112


class UnfitForProgram(FieldError):
    """The robot's program that the recipe asks for cannot mill this door."""

    code = 113


class GeometryError(FieldError):
    """Features do not go with the door or with each other."""


class LeavesWood(GeometryError):
    """A feature reaches beyond an edge or face of the door."""

    code = 120


class FeaturesMeet(GeometryError):
    """Two features touch or leave too thin a wall between them."""

    code = 121


class FeaturesApart(GeometryError):
    """A feature misses the lock case that it belongs to."""

    code = 122


class ThinFloor(GeometryError):
    """A pocket leaves too little wood under its floor."""

    code = 123


class ToolError(FieldError):
    """The tool cannot make the feature."""


class ToolTooWide(ToolError):
    """The tool does not fit into the outline or into its corners."""

    code = 130


class ToolTooShort(ToolError):
    """The tool cannot cut as deep as the feature is."""

    code = 131


class SpindleTooFast(ToolError):
    """The spindle speed is beyond the tool's limit."""

    code = 132


class ChipTooThick(ToolError):
    """The chip load is beyond the tool's limit."""

    code = 133


class DatabaseError(RecipeError):
    """The database lacks what was asked for, or cannot be used."""


class UnknownDoor(DatabaseError):
    """No recipe with this door id."""

    code = 140


class UnknownVersion(DatabaseError):
    """The door has no such version."""

    code = 141


class UnknownBarCode(DatabaseError):
    """No recipe with this bar code."""

    code = 142


class BarCodeTaken(DatabaseError):
    """Another door has this bar code."""

    code = 143


class SchemaTooNew(DatabaseError):
    """The database was written by a later release."""

    code = 144


class DatabaseUnreachable(DatabaseError):
    """The database cannot be opened."""

    code = 145


class DamagedRecord(DatabaseError):
    """A stored recipe is not what was stored."""

    code = 146


class ExchangeError(RecipeError):
    """An exchange file cannot be read or written."""


class UnreadableFile(ExchangeError):
    """A file is absent or is not what its name says."""

    code = 150


class UnknownFileType(ExchangeError):
    """A file name ending that stands for no exchange format."""

    code = 151


class NotExpressible(ExchangeError):
    """The format has no place for something in the recipe."""

    code = 152


class BadTable(ExchangeError):
    """A row or a column of a table is wrong."""

    code = 153
