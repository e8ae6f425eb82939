"""Marks in the cell that tell whether the camera has moved."""
