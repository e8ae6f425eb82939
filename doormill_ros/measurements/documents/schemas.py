"""Schemas of the folders with measured data, as their descriptions name them."""

from __future__ import annotations

MEASUREMENT_SET = "doormill/measurement-set/1"  #: loading tests
POSE_SET = "doormill/pose-set/1"
MOTION_SET = "doormill/motion-set/1"
PICTURE_SET = "doormill/picture-set/1"
INSPECTION = "doormill/inspection/1"
RAW_LOADING_TESTS = "doormill/raw-loading-tests/1"
