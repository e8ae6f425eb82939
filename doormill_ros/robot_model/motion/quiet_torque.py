"""A torque with less noise: as a regressor, noise makes springs look harder than they are.

Of a torque with the variance v and the noise s^2 a fit sees the spring's compliance times v / (v + s^2) (errors in
variables; Fuller, Measurement Error Models, 1987, chapter 1). Where that matters the torque is filtered as far as it
shows nothing but noise.
"""

from __future__ import annotations

import numpy as np
from scipy.ndimage import uniform_filter1d
from scipy.signal import butter, sosfiltfilt

from doormill_ros.arrays import FloatArray
from doormill_ros.statistics import NORMAL_STD, median

MATTERS = 0.03  #: noise over the torque's own deviation from which on a spring is off by a thousandth
#: Correlation of white noise's third differences with the next and the next but one, and how far from it is chance: a
#: drive's ripple is no noise, and the link feels it.
_WHITE, _CHANCE = (-15.0 / 20.0, 6.0 / 20.0), 0.06
_WILD = 6.0  #: deviations beyond which a difference is a jump
_BAND = 41  #: frequencies whose powers are averaged to be compared with the noise
_ABOVE = 2.0  #: times the noise's power, from which on a band holds more than noise
_WIDER = 1.5  #: times the last such frequency is let through
_ORDER = 4
#: Deviations of the noise by which the torque moves faster than the filter: there it stays as it is.
_FAST = 2.0
_NEAR = 9  #: samples over which that is looked at
_SHORT = 200  #: samples below which nothing is filtered


def quiet_torque(torque: FloatArray) -> tuple[FloatArray, float | None]:
    """The torque of a recording with less noise, shape (n,), and the standard deviation of what is left of it [N m].

    The second is None where the torque stays as it is.

    Args:
        torque: At even times, shape (n,) [N m].
    """
    if len(torque) < _SHORT:
        return torque, None
    noise = white_noise(torque)
    # A torque that never changes has neither noise nor anything that a filter could spare.
    if noise <= MATTERS * float(np.std(torque)) or not _white(torque, noise):
        return torque, None
    # A line from end to end: else the ends of a recording, put together, are a jump with all frequencies.
    line = np.linspace(torque[0], torque[-1], len(torque))
    power = np.abs(np.fft.rfft(torque - line)) ** 2 / len(torque)
    more = np.flatnonzero(uniform_filter1d(power, _BAND) > _ABOVE * noise**2)
    passed = _WIDER * (more[-1] if len(more) else 1) / (len(power) - 1)
    if passed >= 1.0:
        return torque, None
    smooth = sosfiltfilt(butter(_ORDER, passed, output="sos"), torque - line) + line
    beside = np.sqrt(uniform_filter1d((torque - smooth) ** 2, _NEAR))
    return np.where(beside > _FAST * noise, torque, smooth), noise * float(np.sqrt(passed))


def white_noise(values: FloatArray) -> float:
    """Standard deviation of white noise in a smooth row of values, shape (n,).

    In third differences it grows by the root of 1 + 9 + 9 + 1, and whatever is smooth vanishes.
    """
    return float(NORMAL_STD * median(np.abs(np.diff(values, 3))) / np.sqrt(20.0))


def _white(torque: FloatArray, noise: float) -> bool:
    """Whether what changes from sample to sample is white noise of some size."""
    limit = _WILD * noise * np.sqrt(20.0)
    change = np.clip(np.diff(torque, 3), -limit, limit)
    alike = [float(np.mean(change[lag:] * change[:-lag])) / float(np.var(change)) for lag in (1, 2)]
    return bool(np.all(np.abs(np.subtract(alike, _WHITE)) < _CHANCE))
