"""What counts as the same answer, where the recorded numbers alone do not decide it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from doormill_ros.localization.camera import load_camera
from doormill_ros.localization.checks import check_input
from doormill_ros.localization.errors import StalePicture
from doormill_ros.localization.settings import shipped_settings
from doormill_ros.recording.replay.tolerance import equal


def told(age: float, max_age: float = 2.0) -> str:
    """What is said of a picture of this age [s]."""
    camera = load_camera()
    picture = np.zeros(camera.size[::-1], np.uint8)
    with pytest.raises(StalePicture) as refused:
        check_input(picture, camera, age, replace(shipped_settings(), max_age=max_age))
    return refused.value.message


@pytest.mark.parametrize("path", ["reason", "message"])
def test_a_picture_may_be_older_when_it_is_looked_at_again(path: str) -> None:
    """A busy machine looks later at it, and the bag has the time of the answer, not that of the look."""
    assert equal(path, f"door oak: {told(2.38)}", f"door oak: {told(7.02)}")


def test_what_is_allowed_is_compared_and_so_is_a_stamp_of_the_future() -> None:
    assert not equal("reason", told(7.0, 2.0), told(7.0, 3.0))
    assert not equal("reason", told(7.0), told(-7.0))
    assert not equal("reason", told(-7.0), told(-9.0))
