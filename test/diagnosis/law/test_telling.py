"""What would tell what a law is: every driver has a test of its own."""

from __future__ import annotations

import pytest

from doormill_ros.diagnosis.law.telling import TESTS
from doormill_ros.diagnosis.law.telling import test_of as told_by
from doormill_ros.robot_model.elastic.causes.registry import LIBRARY
from doormill_ros.robot_model.elastic.law import drivers as elastic
from doormill_ros.robot_model.motion.law import drivers as motion
from doormill_ros.robot_model.pose.law import drivers as pose


@pytest.mark.parametrize("kind", [elastic, motion, pose])
def test_every_driver_of_every_kind_of_data_has_a_test_of_its_own(kind):
    spoken = {name.partition(" (")[0] for name in kind.DRIVERS.named}
    assert spoken <= set(TESTS)
    for name in kind.DRIVERS.of_joint:  # "speed (of joint 2)" is spoken of as "speed"
        assert name in TESTS or f"{name} of joint k" in TESTS


def test_so_has_every_driver_of_a_cause():
    assert {cause.driver for cause in LIBRARY} <= set(TESTS)


def test_another_joint_is_named():
    assert "all joints but joint 4" in told_by("angle of joint 4")


def test_what_nobody_thought_of_is_asked_for_in_general_words():
    assert "the tide alone" in told_by("tide")
