"""Nodes that stand for camera, sensors and controller, and that judge what they did."""
