"""A line that loses pictures, a camera that is restarted and one that is gone, as the library tells of them."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from doormill_ros.localization.gige.device import Limits
from doormill_ros.localization.gige.errors import CameraAbsent, CameraUnfit, PictureLost
from doormill_ros.localization.gige.line import TRIES, CameraLine

PICTURE = np.arange(6, dtype=np.uint8).reshape(2, 3)
WHOLE, LOST, GONE, FORGOTTEN = "whole", "lost", "gone", "forgotten"


class Line:
    """Plays cameras: of each one reached what becomes of its pictures, `None` for one that cannot be reached."""

    exposures = Limits(1e-5, 1.0)

    def __init__(self, *cameras: list[str] | None) -> None:
        self._cameras = list(cameras)
        self.line = CameraLine(self._connect)
        self.open = 0
        self.pictures = 0

    def _connect(self) -> Line:
        camera = self._cameras.pop(0)
        if camera is None:
            raise CameraAbsent("nobody answers")
        assert self.open == 0, "the one before was not let go of"
        self.open, self._fates, self._alive = 1, camera, True
        return self

    def take(self, exposure: float, gain: float) -> np.ndarray:
        assert (exposure, gain) == (0.01, 3.0)
        self.pictures += 1
        fate = self._fates.pop(0) if len(self._fates) > 1 else self._fates[0]
        if fate == WHOLE:
            return PICTURE
        if fate == GONE:
            raise CameraAbsent("it does not answer")
        self._alive = fate != FORGOTTEN
        raise PictureLost("packets are missing")

    def alive(self) -> bool:
        return self._alive

    def die(self) -> None:
        self._alive = False

    def close(self) -> None:
        self.open -= 1


def shoot(played: Line) -> Callable[[], np.ndarray]:
    return lambda: played.line.take(0.01, 3.0)


def test_what_is_lost_is_taken_again() -> None:
    played = Line([LOST, LOST, WHOLE])
    assert shoot(played)() is PICTURE
    assert (played.pictures, played.line.lost, played.line.reached, played.open) == (3, 2, 1, 1)


def test_a_camera_that_is_gone_is_reached_anew_for_the_same_picture() -> None:
    played = Line([GONE], [WHOLE])
    assert shoot(played)() is PICTURE
    assert (played.line.lost, played.line.reached, played.open) == (0, 2, 1)


def test_a_camera_that_was_restarted_is_set_up_again() -> None:
    """It answers, but sends nothing and obeys nobody."""
    played = Line([FORGOTTEN], [WHOLE])
    assert shoot(played)() is PICTURE
    assert (played.line.lost, played.line.reached, played.open) == (1, 2, 1)


def test_one_that_stays_away_is_said_and_comes_back_later() -> None:
    played = Line([WHOLE, GONE], None, None, [WHOLE])
    shoot(played)()
    for _ in range(2):
        with pytest.raises(CameraAbsent, match="nobody answers"):
            shoot(played)()
        assert played.open == 0
    assert shoot(played)() is PICTURE
    assert played.line.reached == 2


def test_one_that_goes_as_often_as_it_comes_is_left_for_the_next_call() -> None:
    played = Line([GONE], [GONE], [WHOLE])
    with pytest.raises(CameraAbsent, match="it does not answer"):
        shoot(played)()
    assert shoot(played)() is PICTURE


def test_a_line_that_loses_everything_is_said_and_begun_anew() -> None:
    played = Line([LOST], [WHOLE])
    with pytest.raises(PictureLost, match=f"none of {TRIES} pictures .* packets are missing; check cable"):
        shoot(played)()
    assert (played.pictures, played.line.lost, played.open) == (TRIES, TRIES, 0)
    assert shoot(played)() is PICTURE
    assert played.line.reached == 2


def test_who_watches_reaches_it_before_a_picture_is_wanted() -> None:
    played = Line([WHOLE], None, [WHOLE])
    played.line.watch()
    played.line.watch()
    assert (played.line.reached, played.pictures) == (1, 0)
    played.die()
    with pytest.raises(CameraAbsent):
        played.line.watch()
    played.line.watch()
    assert (played.line.reached, played.open, played.line.exposures) == (2, 1, Line.exposures)


def test_a_camera_that_cannot_be_set_so_is_no_reason_to_reach_it_again() -> None:
    played = Line([WHOLE])

    def refuse(exposure: float, gain: float) -> np.ndarray:
        raise CameraUnfit("gain is 3 dB")

    played.take = refuse  # type: ignore[method-assign]
    with pytest.raises(CameraUnfit):
        shoot(played)()
    assert (played.line.reached, played.open) == (1, 1)


def test_letting_go_twice_is_no_harm() -> None:
    played = Line([WHOLE])
    played.line.watch()
    played.line.close()
    played.line.close()
    assert played.open == 0
