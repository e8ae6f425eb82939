"""What can be wrong with the store of models, and with an order to it; codes of the run as a whole."""

from __future__ import annotations

from doormill_ros.cell.errors import CellError

ModelStoreError = CellError.row(
    "ModelStoreError", 830, "The store of models cannot be read or written, or a model in it was changed."
)
UnknownVersionError = CellError.row(
    "UnknownVersionError", 831, "A model that no version has, or whose proposal is outdated."
)
VersionInUseError = CellError.row(
    "VersionInUseError", 832, "A model that is in use already, or to be taken back and is not in use."
)
OrderNotSignedError = CellError.row(
    "OrderNotSignedError", 833, "An order to the store of models that nobody put a name to."
)
MillingStoppedError = CellError.row(
    "MillingStoppedError", 834, "The error that is expected of the next door is beyond its limit."
)
