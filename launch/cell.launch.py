"""The whole cell, one process a node: `ros2 launch doormill_ros cell.launch.py`.

A second cell beside it: `namespace:=/cell2 out:=out/cell2`. What dies is started again.
"""

from pathlib import Path

from ament_index_python.packages import get_package_share_directory
from launch.actions import DeclareLaunchArgument, OpaqueFunction
from launch.conditions import IfCondition
from launch.substitutions import LaunchConfiguration, PathJoinSubstitution, PythonExpression
from launch_ros.actions import Node
from launch_ros.parameter_descriptions import ParameterValue

from launch import LaunchDescription

NODES = (
    "recipe_database",
    "door_localizer",
    "path_generator",
    "abb_bridge",
    "bag_recorder",
    "model_monitor",
    "operator_page",
    "cell_simulator",
    "folder_camera",
    "gige_camera",
    "door_sensors",
)
#: Topics of one name for a whole network; a cell in a namespace has its own.
GLOBAL = ("tf", "tf_static", "diagnostics")
RESPAWN_DELAY = 1.0  # s
#: Of each of two robots, in a namespace of its own, and whose share of a door it mills.
ROBOTS = {"robot1": "first", "robot2": "second"}
#: Names that their nodes share with the cell, as doormill_ros/nodes/base/robots.py has them.
OF_THE_CELL = (
    "door/recipe",
    "door/pose",
    "door/localization",
    "sensors/localization",
    "simulation/door_placement",
    "recipes/get",
    "_alive/recipe_database",
    "_alive/camera_simulator",
    "_alive/sensor_simulator",
    "_alive/door_shares",
    "_alive/door_localizer",
)
ARGUMENTS = {
    "namespace": ("", "namespace of every node, for example /cell1; cells in different ones share nothing"),
    "out": (
        "out",
        "folder of bags, target files, models, inspections, audit log and the simulated controller; each cell needs "
        "its own",
    ),
    "autostart": ("true", "bring the nodes up; false: an operator does"),
    "simulate": ("true", "simulated camera, controller and robot"),
    "pictures": ("", "folder of pictures in place of the simulated camera"),
    "camera": (
        "",
        "gige: a GenICam camera in place of the simulated one, see docs/gige-camera.md; its parameters stand in the "
        "file `parameters`",
    ),
    "page": ("true", "serve the operator's page"),
    "page_host": ("127.0.0.1", "address of that page, unencrypted"),
    "page_port": ("8080", "TCP port of that page; each cell needs its own"),
    "page_tokens": (
        "",
        "file with the tokens of who may give orders there, made where there is none; empty: nobody",
    ),
    "door_sensors": ("false", "also the nodes of the sensors that config/cell.yaml names beside the camera"),
    "respawn": ("true", "start what died again"),
    "log_level": ("info", "of every node: debug, info, warn, error"),
    "use_sim_time": ("false", "take the time from /clock"),
    "robots": ("1", "2: one on either side of the door, each mills its share"),
    "rviz": ("false", "show the runs in RViz"),
}


def in_out(*parts):
    return PathJoinSubstitution([LaunchConfiguration("out"), *parts])


#: What an argument may be where not everything will do.
CHOICES = {"camera": ["", "gige"]}


def is_given(argument):
    return PythonExpression(["'", LaunchConfiguration(argument), "' != ''"])


def drawn():
    """Whether the simulated camera draws the pictures."""
    given = [["'", LaunchConfiguration(name), "'"] for name in ("pictures", "camera")]
    return PythonExpression([*given[0], " == '' == ", *given[1]])


def robots(number, *others):
    """Whether there are so many robots, and all other arguments that are named are true."""
    terms = ["'", LaunchConfiguration("robots"), f"' == '{number}'"]
    for other in others:
        terms += [" and '", LaunchConfiguration(other), "'.lower() in ('true', '1')"]
    return IfCondition(PythonExpression(terms))


def make_homes(context):
    """The simulated controllers' folders: a bridge that is up first would not find its own."""
    given = context.launch_configurations
    if given["simulate"].lower() in ("true", "1"):
        own = ROBOTS if given["robots"] == "2" else ("",)
        for robot in own:
            Path(given["out"], "controller", robot, "HOME").mkdir(parents=True, exist_ok=True)


def robot_node(name, robot):
    """A node of one of two robots."""
    chosen = {key: LaunchConfiguration(key) for key in ("autostart", "use_sim_time")}
    own = {
        "path_generator": {"models": in_out("models"), "share": ROBOTS[robot]},
        "abb_bridge": {
            "address": in_out("controller", robot, "HOME"),
            "archive": in_out("targets", robot),
            "shared": True,
        },
    }[name]
    shared = [(topic, [LaunchConfiguration("namespace"), f"/{topic}"]) for topic in OF_THE_CELL]
    return Node(
        package="doormill_ros",
        executable=name,
        namespace=[LaunchConfiguration("namespace"), f"/{robot}"],
        output="screen",
        parameters=[own, LaunchConfiguration("parameters"), chosen],
        remappings=[*shared, ("run/result", "share/result"), *[(f"/{topic}", topic) for topic in GLOBAL[:2]]],
        arguments=["--ros-args", "--log-level", LaunchConfiguration("log_level")],
        respawn=LaunchConfiguration("respawn"),
        respawn_delay=RESPAWN_DELAY,
        condition=robots(2),
    )


def cell_node(name, both=False):
    chosen = {name: LaunchConfiguration(name) for name in ("autostart", "use_sim_time")}
    folders = {
        "abb_bridge": {"address": in_out("controller", "HOME"), "archive": in_out("targets")},
        "door_shares": {"note": in_out("targets")},
        "bag_recorder": {"folder": in_out("bags")},
        "path_generator": {"models": in_out("models")},
        "model_monitor": {
            "inspections": in_out("inspections"),
            "bags": in_out("bags"),
            "models": in_out("models"),
        },
        "operator_page": {
            "history": in_out("runs"),
            "audit": in_out("audit"),
            "host": ParameterValue(LaunchConfiguration("page_host"), value_type=str),
            "port": LaunchConfiguration("page_port"),
            "tokens": ParameterValue(LaunchConfiguration("page_tokens"), value_type=str),
            "robots": LaunchConfiguration("robots"),
        },
        "cell_simulator": {"home": in_out("controller", "HOME"), "gauged": True},
        "folder_camera": {"folder": LaunchConfiguration("pictures")},
    }
    conditions = {
        "operator_page": IfCondition(LaunchConfiguration("page")),
        "cell_simulator": robots(2 if both else 1, "simulate"),
        "path_generator": robots(1),
        "abb_bridge": robots(1),
        "door_shares": robots(2),
        "folder_camera": IfCondition(is_given("pictures")),
        "gige_camera": IfCondition(is_given("camera")),
        "door_sensors": IfCondition(LaunchConfiguration("door_sensors")),
    }
    simulated = ["-p", ["camera_simulator:pictures:=", drawn()]] if name == "cell_simulator" else []
    shared = ["--robots", "2", "--controllers", in_out("controller")] if both else []
    return Node(
        package="doormill_ros",
        executable=name,
        namespace=LaunchConfiguration("namespace"),
        output="screen",
        # What comes later wins: a file may name another controller than the simulated folder.
        parameters=[LaunchConfiguration("parameters"), folders[name], chosen]
        if name == "folder_camera"
        else [folders.get(name, {}), LaunchConfiguration("parameters"), chosen],
        remappings=[(f"/{topic}", topic) for topic in GLOBAL],
        arguments=[*shared, "--ros-args", "--log-level", LaunchConfiguration("log_level"), *simulated],
        respawn=LaunchConfiguration("respawn"),
        respawn_delay=RESPAWN_DELAY,
        condition=conditions.get(name),
    )


def generate_launch_description():
    share = Path(get_package_share_directory("doormill_ros"))
    return LaunchDescription(
        [
            DeclareLaunchArgument(
                "parameters",
                default_value=str(share / "config" / "nodes.yaml"),
                description="YAML file with the parameters of the nodes",
            ),
            *[
                DeclareLaunchArgument(
                    name, default_value=default, description=description, choices=CHOICES.get(name)
                )
                for name, (default, description) in ARGUMENTS.items()
            ],
            OpaqueFunction(function=make_homes),
            *[cell_node(name) for name in (*NODES, "door_shares")],
            cell_node("cell_simulator", both=True),
            *[robot_node(name, robot) for robot in ROBOTS for name in ("path_generator", "abb_bridge")],
            Node(
                package="rviz2",
                executable="rviz2",
                arguments=["-d", str(share / "config" / "cell.rviz")],
                condition=IfCondition(LaunchConfiguration("rviz")),
            ),
        ]
    )
