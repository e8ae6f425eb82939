"""The ROS 2 nodes: the only folder that imports rclpy and messages. Parameters, convert, call, publish.

Beside the executables that `ros2 run` starts stand the rooms of their parts.
"""
