"""Two sensors that say how sure they are: by how far they may differ, and what is said when it is further."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.special import gammaincc
from scipy.stats import binom

from doormill_ros.cell.places.layout import load_layout
from doormill_ros.frames import apply_twist
from doormill_ros.localization.sensors.agreement import CHANCE, check_agreement
from doormill_ros.localization.sensors.errors import SensorsDisagree
from doormill_ros.localization.sensors.sensed_door import SensedDoor

NOMINAL = load_layout().T_base_door(0.826, 0.040)
CAMERA = (False, True, True, True, False, False)
ALL = (True,) * 6
DRAWS, OFTEN = 2000, 0.05  # a chance that shows in so few draws


def covariance(seed: int) -> np.ndarray:
    """Of no particular shape: 0.1 mm and 0.1 mrad, all freedoms correlated."""
    root = 1e-4 * np.random.default_rng(seed).normal(size=(6, 6))
    return root @ root.T + 1e-10 * np.eye(6)


def sensed(name: str, twist: np.ndarray, sees: tuple[bool, ...], seed: int) -> SensedDoor:
    return SensedDoor(name, apply_twist(NOMINAL, twist), covariance(seed), sees)


def refused(*doors: SensedDoor) -> bool:
    try:
        check_agreement(doors)
    except SensorsDisagree:
        return True
    return False


@pytest.mark.parametrize("sees", [CAMERA, ALL])
def test_honest_sensors_are_stopped_as_rarely_as_is_stated(
    sees: tuple[bool, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("doormill_ros.localization.sensors.agreement.CHANCE", OFTEN)
    rng = np.random.default_rng(3)
    first, second = (
        rng.multivariate_normal(np.zeros(6), covariance(seed), DRAWS, method="cholesky") for seed in (1, 2)
    )
    count = sum(
        refused(sensed("camera", a, sees, 1), sensed("probe", b, ALL, 2))
        for a, b in zip(first, second, strict=True)
    )
    low, high = binom.ppf([0.0005, 0.9995], DRAWS, OFTEN)
    assert low <= count <= high


@pytest.mark.parametrize(("sees", "freedoms"), [(CAMERA, 3), (ALL, 6)])
def test_the_limit_is_where_chance_ends(sees: tuple[bool, ...], freedoms: int) -> None:
    """At the length at which the chi-square's tail holds CHANCE, by another function than the code's."""
    both = (covariance(1) + covariance(2))[np.ix_(sees, sees)]
    direction = np.linalg.cholesky(both)[:, 0]  # one standard deviation long
    lengths = np.linspace(1.0, 10.0, 9001)
    limit = lengths[np.argmin(np.abs(gammaincc(freedoms / 2.0, lengths**2 / 2.0) - CHANCE))]
    for share, stopped in ((0.99, False), (1.01, True)):
        twist = np.zeros(6)
        twist[list(sees)] = share * limit * direction
        assert refused(sensed("camera", np.zeros(6), sees, 1), sensed("probe", twist, ALL, 2)) is stopped


def test_what_one_of_them_does_not_see_is_not_compared() -> None:
    twist = np.array([5e-3, 0.0, 0.0, 0.0, 5e-3, 5e-3])
    assert not refused(sensed("camera", np.zeros(6), CAMERA, 1), sensed("probe", twist, ALL, 2))
    assert refused(sensed("beams", np.zeros(6), ALL, 1), sensed("probe", twist, ALL, 2))
    blind = (True, False, False, False, True, True)
    assert not refused(sensed("camera", np.zeros(6), CAMERA, 1), sensed("x", twist, blind, 2))


def test_the_sentence_names_both_the_difference_and_its_size() -> None:
    small = SensedDoor("camera", NOMINAL, np.diag([1e-8] * 6), CAMERA)
    moved = apply_twist(NOMINAL, np.array([0.0, 1e-3, 0.0, 0.0, 0.0, 0.0]))
    with pytest.raises(SensorsDisagree) as caught:
        check_agreement([small, SensedDoor("touch_probe", moved, np.diag([1e-8] * 6), ALL)])
    size = 1e-3 / np.sqrt(2e-8)
    for part in ("camera and touch_probe", "y +1.000 mm", "z +0.000 mm", f"{size:.1f} standard deviations"):
        assert part in caught.value.message
    assert caught.value.data["deviations"] == pytest.approx(size, rel=1e-6)


@pytest.mark.parametrize("broken", [np.zeros((6, 6)), np.full((6, 6), np.nan), -np.eye(6)])
def test_a_covariance_that_is_none_agrees_with_nothing(broken: np.ndarray) -> None:
    one = SensedDoor("camera", NOMINAL, broken, ALL)
    assert refused(one, SensedDoor("probe", apply_twist(NOMINAL, np.full(6, 1e-5)), broken, ALL))


def test_of_three_any_two_may_disagree_and_these_are_named() -> None:
    doors = [sensed(name, np.zeros(6), ALL, 1) for name in ("camera", "beams")]
    check_agreement(doors)
    with pytest.raises(SensorsDisagree, match="camera and probe"):
        check_agreement([*doors, sensed("probe", np.full(6, 3e-3), ALL, 1)])
