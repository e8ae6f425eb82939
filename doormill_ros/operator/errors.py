"""What can go wrong with the operator's page; codes of the run as a whole."""

from __future__ import annotations

from doormill_ros.cell.errors import CellError

PageAddressError = CellError.row("PageAddressError", 880, "The page cannot be served at its address.")
AuditError = CellError.row("AuditError", 881, "The audit log of orders cannot be written.")
TokenFileError = CellError.row(
    "TokenFileError", 882, "The file with the tokens of the operator's page cannot be used."
)
