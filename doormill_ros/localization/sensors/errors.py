"""Why the readings of a door sensor give no pose.

LocalizationError
`-- 220 SensorError
    |-- 221 BadSensorFile   the sensor's file lacks a key or holds a value out of bounds
    |-- 222 BadReading      a reading of the wrong shape or size
    |-- 223 BeamMissed      a distance sensor has nothing inside its range
    |-- 224 Undetermined    the readings leave a degree of freedom open
    |-- 225 NotConverged    no door pose explains the readings
    |-- 226 Contradiction   the readings contradict each other
    |-- 227 PoseOutOfRange  the pose lies beyond what the clamp can hold
    `-- 228 EdgeNotFound    a picture shows no edge where one must be
"""

from __future__ import annotations

from doormill_ros.localization.errors import LocalizationError


class SensorError(LocalizationError):
    """Base of what can go wrong with a door sensor."""

    code = 220


class BadSensorFile(SensorError):
    """The sensor's file lacks a key or holds a value out of bounds."""

    code = 221


class BadReading(SensorError):
    """A reading of the wrong shape or size."""

    code = 222


class BeamMissed(SensorError):
    """A distance sensor has nothing inside its range."""

    code = 223


class Undetermined(SensorError):
    """The readings leave a degree of freedom open that the sensor claims to see."""

    code = 224


class NotConverged(SensorError):
    """No door pose explains the readings."""

    code = 225


class Contradiction(SensorError):
    """The readings contradict each other by more than their noise."""

    code = 226


class PoseOutOfRange(SensorError):
    """The pose lies beyond what the clamp can hold."""

    code = 227


class EdgeNotFound(SensorError):
    """A picture shows no edge of the door where one must be."""

    code = 228
