"""Node /path_generator: door pose and recipe in, corrected robot targets out, or why there are none."""

from __future__ import annotations

import sys
import time
from contextlib import suppress
from typing import Any

from geometry_msgs.msg import PoseStamped
from rclpy.serialization import deserialize_message, serialize_message
from sensor_msgs.msg import JointState
from std_msgs.msg import Header, String

from doormill_interfaces.msg import DoorRecipe, TargetArray
from doormill_ros.arrays import FloatArray
from doormill_ros.cell.graph.node_names import PATH_GENERATOR
from doormill_ros.cell.run.clock import FUTURE
from doormill_ros.errors import DoormillError
from doormill_ros.frames import BASE_FRAME, TOOL_FRAME
from doormill_ros.messages.from_message import door_pose_of, recipe_of
from doormill_ros.messages.stamps import nanoseconds_of, seconds_of
from doormill_ros.models.store import store_folder
from doormill_ros.nodes.base import topics
from doormill_ros.nodes.base.frame_publisher import FramePublisher
from doormill_ros.nodes.base.managed_node import ManagedNode
from doormill_ros.nodes.base.node_parameter import NodeParameter
from doormill_ros.nodes.base.reporting_node import OK, WARN
from doormill_ros.nodes.base.robots import ROBOTS
from doormill_ros.nodes.convert.geometry import path_message, pose_message
from doormill_ros.nodes.convert.markers import body_markers, no_markers, program_markers
from doormill_ros.nodes.convert.program import Nested, program_into
from doormill_ros.nodes.convert.recipe import recipe_message
from doormill_ros.nodes.process.run import run_nodes
from doormill_ros.pipeline.model_in_use import SetupInUse, VersionedSetup
from doormill_ros.pipeline.plan import plan, prepare, rehearse
from doormill_ros.recipes.recipe import Recipe
from doormill_ros.robot.urdf import LinkPose, joint_names, link_poses
from doormill_ros.robot_model.extended_model import unknown_on_path
from doormill_ros.robot_model.warmth.grown_model import growth_in
from doormill_ros.robot_model.warmth.work_times import WorkTimes
from doormill_ros.toolpath.program import MillingProgram
from doormill_ros.units import m_to_um


class PathGenerator(ManagedNode):
    """Generates a program for each door pose that belongs to the recipe in hand."""

    PARAMETERS = (
        NodeParameter("robot", "", "robot description in config/robots; empty: the one of config/cell.yaml"),
        NodeParameter(
            "robot_model", "", "model.yaml of a diagnosis used for the correction; empty: joint springs"
        ),
        NodeParameter(
            "models",
            "",
            "folder of the store of models; one in use there takes the place of robot_model; empty: models in the "
            "site's folder; none: no store",
        ),
        NodeParameter(
            "share",
            "",
            "of two robots, whose share of each door; empty: one robot, whole doors",
            choices=("", *ROBOTS),
        ),
        NodeParameter(
            "frames",
            True,
            "publish frames of the robot at its first target; false where its driver does that",
        ),
    )

    def __init__(self, **kwargs: Any) -> None:
        super().__init__(PATH_GENERATOR, **kwargs)

    def setup(self) -> None:
        """Load robot and compliance model; subscribe."""
        store = self.value("models")
        self._in_use = SetupInUse(
            self.value("robot"),
            self.value("robot_model"),
            None if store == "none" else store_folder(store),
            self.value("share"),
        )
        self._setup = self._in_use.now
        self._work = WorkTimes()
        self._unfit: Exception | None = None
        self._recipe: DoorRecipe | None = None
        self._door: Recipe | None = None
        self._early: PoseStamped | None = None
        self._nested = Nested()
        self._targets = self.publisher(topics.PATH_TARGETS)
        self._nominal = self.publisher(topics.PATH_NOMINAL)
        self._corrected = self.publisher(topics.PATH_CORRECTED)
        self._markers = self.publisher(topics.PATH_MARKERS)
        self._joints = self.publisher(topics.PATH_JOINT_STATES)
        self._description = self.publisher(topics.ROBOT_DESCRIPTION)
        self._bodies = self.publisher(topics.CELL_BODIES)
        self._frames = FramePublisher(self) if self.value("frames") else None
        self.subscribe(topics.DOOR_RECIPE, self._take_recipe)
        self.subscribe(topics.DOOR_POSE, self._take_pose)

    def rehearse(self) -> None:
        """Plan a shipped door, and carry it there and back as its messages."""
        recipe, T_base_door, planned = rehearse(self._setup.setup)
        recipe_of(recipe_message(recipe, "", Header()))
        door_pose_of(pose_message(T_base_door))
        answer = program_into(TargetArray(), planned.program, self._nested)
        deserialize_message(serialize_message(answer), TargetArray)
        share = self._setup.setup.shared(recipe, T_base_door)
        program_markers(planned.program, recipe, share.T_base_door, Header())

    def start(self) -> None:
        """Describe the robot to who draws it."""
        setup = self._setup.setup
        self._description.publish(String(data=setup.robot.urdf.read_text(encoding="utf-8")))
        self._bodies.publish(body_markers(setup.robot, setup.layout, setup.settings))
        self._tell_of(self._setup)

    def _tell_of(self, used: VersionedSetup) -> None:
        name = used.setup.model_name
        self.get_logger().info(f"targets are corrected by version {used.version} of the model, {name}")
        for sentence in unknown_on_path(used.setup.model):
            self.get_logger().info(f"robot model {name}: {sentence}")
        growth = growth_in(used.setup.model)
        if growth is not None:
            way, _ = growth.at(self._work, seconds_of(self.get_clock().now().to_msg()))
            self.get_logger().info(
                f"robot model {name}: its growth, {m_to_um(way):.0f} um now, is undone by the {self._work.doors} doors "
                "that this node has begun; of a cell whose work it has not seen none is undone"
            )

    def _choose_model(self) -> None:
        """Take the model in use for the run that begins; what is wrong with it is said when the pose comes."""
        before, self._unfit = self._setup, None
        try:
            self._setup = self._in_use.for_next_run()
        except Exception as error:
            self._unfit = error
        if self._setup is not before:
            self._tell_of(self._setup)

    def _take_recipe(self, recipe: DoorRecipe) -> None:
        if self._recipe is not None and self._recipe.run_id != recipe.run_id:
            # What is shown belongs to the door before; it must not stand for a door that is refused.
            header = Header(stamp=recipe.header.stamp, frame_id=BASE_FRAME)
            self.later("show", lambda: self._clear(header))
        if self._recipe is None or self._recipe.run_id != recipe.run_id:
            self._choose_model()
        self._recipe, self._door = recipe, None
        with suppress(DoormillError):  # said when the pose comes
            self._door = recipe_of(recipe)
        if self._early is not None:
            pose, self._early = self._early, None
            self._take_pose(pose)
        elif self._door is not None:
            with suppress(DoormillError):  # likewise
                prepare(self._door, self._setup.setup)

    def _take_pose(self, pose: PoseStamped) -> None:
        recipe, now = self._recipe, self.get_clock().now().to_msg()
        ahead = seconds_of(pose.header.stamp) - seconds_of(now)
        if ahead > FUTURE:
            # Kept, it would pass for the pose of every door to come.
            self.report(WARN, f"a pose came with a stamp {ahead:.1f} s in the future; set the clocks")
            return
        # The stamp of a recipe from the future, as is left where the clock was set back, tells of no order.
        if recipe is None or (
            nanoseconds_of(pose.header.stamp) < nanoseconds_of(recipe.header.stamp)
            and seconds_of(recipe.header.stamp) - seconds_of(now) <= FUTURE
        ):
            # Topics have no common order: the pose may overtake the recipe it was measured for.
            self._early = pose
            return
        answer = TargetArray(
            run_id=recipe.run_id,
            door_id=recipe.door_id,
            recipe_version=recipe.version,
            robot_model=self._setup.setup.model_name,
            model_version=self._setup.version,
            header=Header(stamp=pose.header.stamp, frame_id=BASE_FRAME),
        )
        begun, moment = time.perf_counter(), seconds_of(now)
        try:
            if self._unfit is not None:
                raise self._unfit
            door = self._door if self._door is not None else recipe_of(recipe)
            T_cell_door = door_pose_of(pose.pose)
            share = self._setup.setup.shared(door, T_cell_door)
            if self.value("share") and not share.operations:
                self.report(OK, f"door {recipe.door_id} has nothing for this robot")
                return
            setup = self._setup.setup.warm(self._work, moment)
            planned = plan(door, T_cell_door, setup)
        except Exception as unexpected:  # whatever it is, the run waits for an answer
            error = self.as_refusal(unexpected)
            answer.duration = time.perf_counter() - begun
            answer.error_code = error.code
            answer.reason = error.message
            self._targets.publish(answer)
            self.report(WARN, f"door {recipe.door_id}: {error.message}", error_code=error.code)
            return
        self._work.worked(moment)
        program = planned.program
        answer.accepted = True
        answer.cycle_time = planned.time
        program_into(answer, program, self._nested)
        answer.duration = time.perf_counter() - begun
        self._targets.publish(answer)
        undone = {} if setup.growth is None else {"growth_undone": setup.growth}
        self.report(OK, "path generated", door_id=recipe.door_id, targets=len(program.targets), **undone)
        self.later("show", lambda: self._show(answer.header, program, door, share.T_base_door))

    def _show(self, header: Header, program: MillingProgram, door: Recipe, T_base_door: FloatArray) -> None:
        targets = program.targets
        self._nominal.publish(path_message(header, [t.T_base_tool_nominal for t in targets]))
        self._corrected.publish(path_message(header, [t.T_base_tool_corrected for t in targets]))
        self._markers.publish(program_markers(program, door, T_base_door, header))
        if program.targets:
            self._show_robot(header, program.targets[0].q)

    def _clear(self, header: Header) -> None:
        self._nominal.publish(path_message(header, []))
        self._corrected.publish(path_message(header, []))
        self._markers.publish(no_markers(header))

    def _show_robot(self, header: Header, q: FloatArray) -> None:
        """The robot in the posture of the program's first target."""
        setup = self._setup.setup
        urdf = setup.robot.urdf
        # Joint states have no use for a frame, but viewers report an empty one as missing.
        self._joints.publish(
            JointState(header=header, name=joint_names(urdf), position=[float(v) for v in q])
        )
        if self._frames is not None:
            links = link_poses(urdf, q)
            self._frames.show(links)
            self._frames.show_static([LinkPose(links[-1].child, TOOL_FRAME, setup.layout.T_flange_tool)])


def main() -> int:
    """Run the node."""
    return run_nodes(PathGenerator)


if __name__ == "__main__":
    sys.exit(main())
