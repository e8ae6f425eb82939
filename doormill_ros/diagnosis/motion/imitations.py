"""What named causes of a joint may imitate, though it may not enter a model: few recordings tell them apart."""

from __future__ import annotations

import numpy as np

from doormill_ros.diagnosis.core.words.verdict import AT_NOISE
from doormill_ros.diagnosis.motion.model import JointFit
from doormill_ros.diagnosis.motion.search import ENTRY, EQUAL, JointSearch
from doormill_ros.robot_model.motion.causes.cause import DELAY, MotionCause
from doormill_ros.robot_model.motion.causes.encoder_scale import EncoderScale
from doormill_ros.robot_model.motion.causes.joint_periodic_error import MotionPeriodicError
from doormill_ros.robot_model.motion.causes.motor_inertia import MotorInertia

#: What acceleration is left where a lag T is taken for a delay, in T^2 / 2: 1 of a filter of first order and of a motor
#: encoder that is late itself, 1/2 of one of second order.
_LEFT = (0.3, 1.5)


def part_of_a_wave(search: JointSearch, best: JointFit, cause: MotionCause) -> bool:
    """Whether less than half of one wave a turn does as well as a scale and the slow waves beside it.

    An encoder off its axis makes such a wave. It may not enter a model itself: gravity makes one too.
    """
    scale = next((one for one in best.members if isinstance(one, EncoderScale)), None)
    if scale is None or not (cause is scale or cause.slow):
        return False
    beside = [one for one in best.members if one.slow]
    fit = slow_wave_instead(search, best, scale, *beside)
    return fit is not None and search.gain(best, fit).score > (-EQUAL if beside else ENTRY)


def slow_wave_instead(search: JointSearch, best: JointFit, *gone: MotionCause) -> JointFit | None:
    """A model with one wave a turn for some members; None where the joint turns so far that it may enter anyway."""
    low, high = (end([end(motion.motor) for motion in search.problem.motions]) for end in (np.min, np.max))
    if high - low > np.pi:
        return None
    rest = search.without(best, *gone)
    return search.problem.fit((*rest.members, MotionPeriodicError(search.problem.where, 1.0)), rest.delay)


def in_place_of_scale(
    search: JointSearch, model: JointFit, cause: MotionCause
) -> list[tuple[MotionCause, JointFit]]:
    """What may look like a scale besides what enters models as freely, each with the model: both leave more noise.

    A part of a wave has one number more, and the acceleration, which is the angle again where a joint swings evenly, is
    a motor's with its noise.
    """
    if not isinstance(cause, EncoderScale):
        return []
    found = [slow_wave_instead(search, model, cause)]
    found += [fit for other, fit in search.rivals(model, cause) if isinstance(other, MotorInertia)]
    return [(fit.members[-1], fit) for fit in found if fit is not None]


def lag_beyond_delay(search: JointSearch, best: JointFit, cause: MotionCause) -> bool:
    """Whether the acceleration that a filter's lag leaves beside a delay does as well as a spring.

    Where all torque of a joint speeds it up, a spring looks so too.
    """
    lag = _lag(best)
    if not cause.of_spring or lag == 0.0:
        return False
    rest = search.without(best, cause)
    fit = search.problem.settled((*rest.members, MotorInertia(search.problem.where)), rest.delay)
    left = float(fit.x[-1][0]) / (0.5 * lag**2)
    at_noise = search.problem.rmse(fit.held_out) < AT_NOISE * search.problem.floor
    return _LEFT[0] < left < _LEFT[1] and (at_noise or search.gain(best, fit).score > -EQUAL)


def _lag(best: JointFit) -> float:
    """By how much a joint's encoders are apart in a model, one way or the other [s]."""
    damped = sum(
        float(x[0])
        for one, x in zip(best.members, best.x, strict=True)
        if one.acts_on == DELAY and not one.of_delay
    )
    return best.late - damped
