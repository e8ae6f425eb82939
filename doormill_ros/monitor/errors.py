"""What can be wrong with inspections that come while the cell mills; codes of the run as a whole."""

from __future__ import annotations

from doormill_ros.cell.errors import CellError

UnknownRunError = CellError.row(
    "UnknownRunError", 840, "An inspection is of a run that no bag holds; it waits for that bag."
)
InspectionMessageError = CellError.row(
    "InspectionMessageError", 841, "A message of an inspected door contradicts itself or names no run."
)
QuestionError = CellError.row(
    "QuestionError", 842, "The diagnosis of the inspected doors ended without a verdict."
)
KeepingError = CellError.row("KeepingError", 843, "An inspection cannot be kept on the disk.")
RunsQuestionError = CellError.row(
    "RunsQuestionError", 844, "The diagnosis of the bags of the last runs ended without a verdict."
)
