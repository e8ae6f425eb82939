"""Inspected doors, each measured point with the state of the robot that cut it."""
