"""Plans that are given the world's own figures: what planner and program leave of a world that nothing hides.

No diagnosis and no model of the project is asked: the world's own arm says where the loaded tool stands. What such a
plan leaves, no better figures would mend.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from doormill_ros.frames import inverse, rotation_from_vector, transform, twist_between
from doormill_ros.localization.camera import load_camera
from doormill_ros.pipeline.plan import MillingSetup
from doormill_ros.recipes.recipe import Recipe
from doormill_ros.robot.kinematics import Kinematics
from doormill_ros.robot_model.elastic.compliance import StandingSpread
from doormill_ros.robot_model.elastic.knowledge import MeasuredForce, ModelKnowledge
from doormill_ros.simulation.world.door_truth import DoorTruth
from doormill_ros.simulation.world.robot import WorldRobot


def told(setup: MillingSetup, truth: DoorTruth, recipe: Recipe) -> MillingSetup:
    """The setup that is told everything of a door."""
    return replace(setup, model=ToldWorld(truth, setup, recipe))


class ToldWorld:
    """The tool of one door of a shift, as the world has it (implements StandingModel and KnowingModel).

    The growth is that of the door's begin. Corners that a controller cuts, what is drawn for each door and forces of
    the engaged wood are no figures of a world, and told to nobody.
    """

    def __init__(self, truth: DoorTruth, setup: MillingSetup, recipe: Recipe) -> None:
        """Take what holds for a door.

        Args:
            truth: Of the door.
            setup: Whose published geometry world and planner share.
            recipe: The door.
        """
        self._truth, self._tool = truth, setup.layout.T_flange_tool
        self._force = truth.world.force
        assert self._force.law == "recipe"
        self._kinds = tuple(dict.fromkeys(feature.kind for feature in recipe.features))
        self._robot = WorldRobot(setup.robot.dh, truth.world.robot, truth.world.tool, truth.world.links)
        self._kinematics = Kinematics(setup.robot)
        moved, turned = truth.camera_moved
        eye = transform(translation=load_camera().position - [0.0, recipe.width / 2.0, 0.0])
        seen = transform(translation=moved) @ eye @ transform(turned) @ inverse(eye)
        self._from_door = inverse(truth.T_base_door(seen))
        self._stiffness = setup.robot.stiffness * np.array(truth.world.robot.stiffness_factor)

    def felt(self, q: np.ndarray, wrench: np.ndarray) -> np.ndarray:
        """The wrench that the wood has, as `KnowingModel.felt`."""
        force = self._force
        factor = force.factor * (1.0 + force.wear_per_door * self._truth.number)
        turn = rotation_from_vector(force.angle * self._commanded(q)[:, :3, 2])
        parts = [np.einsum("nij,nj->ni", turn, part) for part in (wrench[:, :3], wrench[:, 3:])]
        return factor * np.concatenate(parts, axis=1)

    def knowledge(self) -> ModelKnowledge:
        """Everything for certain."""
        force = MeasuredForce(self._kinds, 0.0, 0.0)
        return ModelKnowledge(self._stiffness, np.zeros(6), np.zeros(6), force)

    def deflection(self, q, wrench, load_point, direction=None) -> np.ndarray:
        """Of the tool against where it was sent, seen from where the door was seen; as `ComplianceModel.deflection`."""
        q = np.atleast_2d(q)
        felt = self.felt(q, np.broadcast_to(wrench, (len(q), 6)))
        direction = np.zeros(q.shape) if direction is None else np.broadcast_to(direction, q.shape)
        sent = self._commanded(q)
        actual = self._robot.flange(q, felt, load_point, direction) @ self._tool
        actual[:, :3, 3] += self._truth.bent(felt[:, :3], sent[:, :3, 2])
        actual[:, :3, 3] += self._truth.grown(
            np.zeros(len(q)), sent[:, :3, 3], (sent @ inverse(self._tool))[:, :3, 3]
        )
        return twist_between(sent, self._from_door @ actual)

    def standing(self, q, load_point, direction=None) -> np.ndarray:
        """Without a load, as `StandingModel.standing`."""
        return self.deflection(q, np.zeros(6), load_point, direction)

    def standing_spread(self, q, load_point, relative) -> StandingSpread:
        """None."""
        return StandingSpread(np.zeros((len(q), 6, 3)), np.zeros(len(q)))

    def _commanded(self, q: np.ndarray) -> np.ndarray:
        return self._kinematics.forward(q) @ self._tool
