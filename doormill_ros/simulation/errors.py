"""What can be wrong with the inputs of the simulation; codes 850..899."""

from __future__ import annotations

from doormill_ros.errors import DoormillError


class SimulationError(DoormillError):
    """Base of the errors of the simulation's inputs."""


class EffectsFileError(SimulationError):
    """The file with the simulated robot's hidden effects cannot be used."""

    code = 850
