"""What can be wrong with the inputs of the simulation; codes 850..899."""

from __future__ import annotations

from doormill_ros.errors import DoormillError

EffectsFileError = DoormillError.row(
    "EffectsFileError", 850, "The file with the hidden effects cannot be used."
)
SceneFileError = DoormillError.row(
    "SceneFileError", 852, "The camera file of a simulated scene cannot be used."
)
WebServicesError = DoormillError.row(
    "WebServicesError", 851, "The simulated controller's web services cannot be served."
)
