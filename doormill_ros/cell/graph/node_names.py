"""Names of the nodes; that of a sensor beside the camera has the sensor's name."""

from __future__ import annotations

RECIPE_DATABASE = "recipe_database"
DOOR_LOCALIZER = "door_localizer"
PATH_GENERATOR = "path_generator"
ABB_BRIDGE = "abb_bridge"
BAG_RECORDER = "bag_recorder"
MODEL_MONITOR = "model_monitor"
OPERATOR_PAGE = "operator_page"
DOOR_SHARES = "door_shares"
CAMERA_SIMULATOR = "camera_simulator"
SENSOR_SIMULATOR = "sensor_simulator"
CONTROLLER_SIMULATOR = "controller_simulator"
SHARED_DOOR_JUDGE = "shared_door_judge"
FOLDER_CAMERA = "folder_camera"
GIGE_CAMERA = "gige_camera"
