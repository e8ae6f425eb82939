"""What can be wrong with the catalogue of runs; codes 860..869."""

from __future__ import annotations

from doormill_ros.errors import DoormillError


class CatalogueError(DoormillError):
    """Base of the errors of the catalogue."""


CatalogueUnreachableError = CatalogueError.row(
    "CatalogueUnreachableError", 860, "The catalogue of runs cannot be opened or is damaged."
)
CatalogueTooNewError = CatalogueError.row(
    "CatalogueTooNewError", 861, "The catalogue of runs was made by another release."
)
BadRunRecordError = CatalogueError.row(
    "BadRunRecordError", 862, "A bag or an inspection tells of a run what no catalogue can hold."
)
UnknownRunError = CatalogueError.row("UnknownRunError", 863, "No run of this name is in the catalogue.")
BadRetentionError = CatalogueError.row(
    "BadRetentionError", 864, "How long bags stay is not given, or is no sensible number."
)
ColumnsFileError = CatalogueError.row(
    "ColumnsFileError", 865, "The file for the catalogue's columns cannot be written."
)
