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
ControllerLimitsError = DoormillError.row(
    "ControllerLimitsError", 856, "The file with the limits of the simulated controller cannot be used."
)
WoodOutsideFeatures = DoormillError.row(
    "WoodOutsideFeatures", 853, "A simulated run took wood that belongs to no feature of the recipe."
)
BodyTouched = DoormillError.row(
    "BodyTouched", 854, "In a simulated run robot, spindle or standing mill touched door or cell."
)
BodiesError = DoormillError.row(
    "BodiesError", 855, "The files that say what can be touched in the simulated cell cannot be used."
)
WorldFileError = DoormillError.row(
    "WorldFileError", 857, "The world file of a simulated shift cannot be used."
)
WoodTornOut = DoormillError.row(
    "WoodTornOut", 858, "In a simulated run the mill came out of the wood where nothing backed it."
)
PlungedDown = DoormillError.row(
    "PlungedDown", 859, "In a simulated run a mill that does not cut with its middle went straight down."
)
MilledWrongWay = DoormillError.row(
    "MilledWrongWay", 870, "In a simulated run a wall was not milled the way round that its recipe says."
)
RunMessageError = DoormillError.row(
    "RunMessageError", 871, "A message of what a simulated robot did, or to which door, cannot be judged."
)
