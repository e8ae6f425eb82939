"""Errors of recipes, codes 100 to 199."""

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


class RecipeGeometryError(FieldError):
    """Features do not go with the door or with each other."""


class DatabaseError(RecipeError):
    """The database lacks what was asked for, or cannot be used."""


class ExchangeError(RecipeError):
    """An exchange file cannot be read or written."""


UnknownField = FieldError.row("UnknownField", 101, "A field that no recipe has.")
MissingField = FieldError.row("MissingField", 102, "A field without a default is absent.")
WrongType = FieldError.row("WrongType", 103, "A value of another type, such as text where a number belongs.")
NotFinite = FieldError.row("NotFinite", 104, "A number is NaN or infinite.")
OutOfRange = FieldError.row("OutOfRange", 105, "A number or a count beyond its limits.")
NotAChoice = FieldError.row("NotAChoice", 106, "A word outside the list of allowed words.")
BadText = FieldError.row("BadText", 107, "A text with characters or a length that is not allowed.")
DuplicateField = FieldError.row("DuplicateField", 108, "A field is given twice.")
DuplicateName = FieldError.row("DuplicateName", 109, "Two features or two tools have one name.")
UnknownReference = FieldError.row("UnknownReference", 110, "A name that stands for nothing in the recipe.")
ConflictingFields = FieldError.row("ConflictingFields", 111, "Fields that exclude each other are both given.")
ImplausibleMass = FieldError.row("ImplausibleMass", 112, "No wood has the density that mass and size give.")
UnfitForProgram = FieldError.row(
    "UnfitForProgram", 113, "The robot's program asked for cannot mill this door."
)
UnknownTool = FieldError.row("UnknownTool", 114, "A tool that neither the recipe nor the table of tools has.")
LeavesWood = RecipeGeometryError.row(
    "LeavesWood", 120, "A feature reaches beyond an edge or face of the door."
)
FeaturesMeet = RecipeGeometryError.row("FeaturesMeet", 121, "Two features touch or leave too thin a wall.")
FeaturesApart = RecipeGeometryError.row(
    "FeaturesApart", 122, "A feature misses the lock case that it belongs to."
)
ThinFloor = RecipeGeometryError.row("ThinFloor", 123, "A pocket leaves too little wood under its floor.")
ToolTooWide = FieldError.row("ToolTooWide", 130, "The tool does not fit into the outline or a corner.")
ToolTooShort = FieldError.row("ToolTooShort", 131, "The tool cannot cut as deep as the feature is.")
SpindleTooFast = FieldError.row("SpindleTooFast", 132, "The spindle speed is beyond the tool's limit.")
ChipTooThick = FieldError.row("ChipTooThick", 133, "The chip load is beyond the tool's limit.")
UnknownDoor = DatabaseError.row("UnknownDoor", 140, "No recipe with this door id.")
UnknownVersion = DatabaseError.row("UnknownVersion", 141, "The door has no such version.")
UnknownBarCode = DatabaseError.row("UnknownBarCode", 142, "No recipe with this bar code.")
BarCodeTaken = DatabaseError.row("BarCodeTaken", 143, "Another door has this bar code.")
SchemaTooNew = DatabaseError.row("SchemaTooNew", 144, "The database was written by a later release.")
DatabaseUnreachable = DatabaseError.row("DatabaseUnreachable", 145, "The database cannot be opened.")
DamagedRecord = DatabaseError.row("DamagedRecord", 146, "A stored recipe or tool is not what was stored.")
NotInTable = DatabaseError.row("NotInTable", 147, "The table of tools has no tool of this name.")
WornTool = DatabaseError.row("WornTool", 148, "A tool has cut as far as it may.")
BrokenTool = DatabaseError.row("BrokenTool", 149, "A tool is marked as broken.")
UnreadableFile = ExchangeError.row("UnreadableFile", 150, "A file is absent or is not what its name says.")
UnknownFileType = ExchangeError.row("UnknownFileType", 151, "A file name that stands for no exchange format.")
NotExpressible = ExchangeError.row("NotExpressible", 152, "The format has no place for a part of the recipe.")
BadTable = ExchangeError.row("BadTable", 153, "A row or a column of a table is wrong.")
