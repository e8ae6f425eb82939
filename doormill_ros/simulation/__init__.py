"""What stands for the robot, the camera, the controller and the door: the truth that the project is judged by."""
