"""Calibrating the camera: intrinsics from chessboards, mounting from a door moved a known way."""
