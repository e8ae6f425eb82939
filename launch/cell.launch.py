"""The whole cell, one process a node: `ros2 launch doormill_ros cell.launch.py`."""

from pathlib import Path

from ament_index_python.packages import get_package_share_directory
from launch.actions import DeclareLaunchArgument
from launch.conditions import IfCondition
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node

from launch import LaunchDescription

NODES = ("recipe_database", "door_localizer", "path_generator", "abb_bridge", "bag_recorder")


def generate_launch_description():
    share = Path(get_package_share_directory("doormill_ros"))
    parameters = [LaunchConfiguration("parameters"), {"autostart": LaunchConfiguration("autostart")}]
    return LaunchDescription(
        [
            DeclareLaunchArgument(
                "parameters",
                default_value=str(share / "config" / "nodes.yaml"),
                description="YAML file with the parameters of the nodes",
            ),
            DeclareLaunchArgument(
                "autostart", default_value="true", description="bring the nodes up; false: an operator does"
            ),
            DeclareLaunchArgument(
                "simulate", default_value="true", description="simulated camera, controller and robot"
            ),
            DeclareLaunchArgument("rviz", default_value="false", description="show the runs in RViz"),
            *[
                Node(package="doormill_ros", executable=name, output="screen", parameters=parameters)
                for name in NODES
            ],
            Node(
                package="doormill_ros",
                executable="cell_simulator",
                output="screen",
                parameters=parameters,
                condition=IfCondition(LaunchConfiguration("simulate")),
            ),
            Node(
                package="rviz2",
                executable="rviz2",
                arguments=["-d", str(share / "config" / "cell.rviz")],
                condition=IfCondition(LaunchConfiguration("rviz")),
            ),
        ]
    )
