"""Why the readings of a door sensor give no pose."""

from __future__ import annotations

from doormill_ros.localization.errors import LocalizationError


class SensorError(LocalizationError):
    """Base of what can go wrong with a door sensor."""

    code = 220


BadSensorFile = SensorError.row("BadSensorFile", 221, "The sensor's file lacks a key or is out of bounds.")
BadReading = SensorError.row("BadReading", 222, "A reading of the wrong shape or size.")
BeamMissed = SensorError.row("BeamMissed", 223, "A distance sensor has nothing inside its range.")
Undetermined = SensorError.row("Undetermined", 224, "The readings leave a freedom open that the sensor sees.")
NotConverged = SensorError.row("NotConverged", 225, "No door pose explains the readings.")
Contradiction = SensorError.row(
    "Contradiction", 226, "The readings contradict each other beyond their noise."
)
PoseOutOfRange = SensorError.row("PoseOutOfRange", 227, "The pose lies beyond what the clamp can hold.")
EdgeNotFound = SensorError.row("EdgeNotFound", 228, "A picture shows no edge of the door where one must be.")
SensorsDisagree = SensorError.row(
    "SensorsDisagree", 229, "Two sensors find the door in different places beyond what they state."
)
