"""Turns of a joint under weight that may hang in any direction, with a load at the flange that nobody stated."""

from __future__ import annotations

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.robot_model.candidate import number
from doormill_ros.robot_model.pose.causes.cause import Coefficient, Columns, PoseCause
from doormill_ros.robot_model.pose.chain import joint_turn
from doormill_ros.robot_model.pose.link_masses import LinkMass, gravity_moment
from doormill_ros.robot_model.pose.view import SetView

#: Of what turns a joint for a gravity along x, y or z: the links, a kilogram at the flange, its moments about that.
PARTS = 5
DIRECTIONS = 3
#: Largest plausible compliance [rad / (N m)], mass [kg] and distance from the flange [m].
COMPLIANCE, MASS, ARM = 1e-4, 100.0, 0.5


class FreeWeight(PoseCause):
    """Sag of a joint whose coefficients are a compliance times every component of gravity times every part of the load.

    The torque of gravity is linear in its direction and in mass and first moments of a load; as products with one
    compliance they hang together, which whoever fits this cause has to see to.
    """

    name = "joint_sag"

    @property
    def coefficients(self) -> tuple[Coefficient, ...]:
        """By the direction of gravity, and by part."""
        sizes = [COMPLIANCE, COMPLIANCE * MASS, *[COMPLIANCE * MASS * ARM] * 3]
        units = ["rad / (N m)", "rad kg / (N m)", *["rad kg / N"] * 3]
        names = ["links", "mass", "moment_x", "moment_y", "moment_z"]
        return tuple(
            Coefficient(f"{axis}_{name}", unit, f"weight {self.where} {axis} {name}", size)
            for axis in "xyz"
            for name, unit, size in zip(names, units, sizes, strict=True)
        )

    def columns(self, view: SetView) -> list[Columns]:
        """Torques about the axis of the joint, as they would be along each axis of the base."""
        k = number(self.where)
        at_flange = [
            _alone(view.joints, np.zeros(3)),
            *(_alone(view.joints, along) for along in np.eye(DIRECTIONS)),
        ]
        found = []
        for down in np.eye(DIRECTIONS):
            own, mass, *moments = (
                gravity_moment(view.T_base_frames, links, down)[:, k - 1, 2]
                for links in (view.links, *at_flange)
            )
            found += [own, mass, *(moment - mass for moment in moments)]
        basis: FloatArray = np.column_stack(found)
        return [Columns(joint_turn(k), 0, basis)]


def _alone(joints: int, com: FloatArray) -> tuple[LinkMass, ...]:
    """A kilogram at a place in the frame of the flange, (3,) [m], on links without weight."""
    return (*[LinkMass(0.0, np.zeros(3))] * (joints - 1), LinkMass(1.0, com))
