"""A cell that warms up: the law that its doors leave, what it is worth at once and in the morning, and its proposal."""

import itertools

import numpy as np
import pytest

from doormill_ros.diagnosis.parts.correction.in_use import in_use_document
from doormill_ros.diagnosis.parts.correction.warming import growth_told
from doormill_ros.robot_model.warmth.growth import REACH
from doormill_ros.robot_model.warmth.work_times import WorkTimes
from doormill_ros.simulation.world.door_truth import TAKT
from doormill_ros.simulation.world.gauge import NOISE
from support.gauged_shift import HINGE_DOORS
from support.shift_loop import loop_worth, setup_with, untroubled
from support.shift_worlds import DrawnShift, diagnosed

SEED, COUNT = 23, 12
RISE, GROWTH = 20.0, 1e-5
#: No time constant that the diagnosis tries.
HOURS = 0.72
END = TAKT * COUNT


@pytest.fixture(scope="module", params=[False, True], ids=["one length grows", "the whole arm grows"])
def arm(request):
    """Whether all lengths of the arm grow."""
    return request.param


@pytest.fixture(scope="module")
def shift(tmp_path_factory, arm):
    """Folder and diagnosis of doors of a cell that warms up."""
    folder = tmp_path_factory.mktemp("warming") / "shift"
    grows = {"expansion": GROWTH / REACH} if arm else {"growth": GROWTH}
    world = {"seed": SEED, "temperature": {"rise": RISE, "hours": HOURS, **grows}}
    doors = tuple(itertools.islice(itertools.cycle(HINGE_DOORS), COUNT))
    return folder, diagnosed(folder, DrawnShift(world, (), doors), SEED)


@pytest.fixture(scope="module")
def knowing(tmp_path_factory):
    """The setup of a shift in which all is as assumed."""
    return untroubled(tmp_path_factory.mktemp("untroubled"))


def truth(seconds):
    return RISE * GROWTH * -np.expm1(-seconds / 3600.0 / HOURS)


def test_the_law_tells_the_growth_of_the_next_doors_as_well_as_it_says(shift, arm):
    _, diagnosis = shift
    growth = growth_told(diagnosis)
    assert growth.arm == arm
    assert growth.seen == pytest.approx((COUNT - 1) * TAKT / 3600.0)
    assert growth.takt == pytest.approx(TAKT)
    for seconds in np.linspace(0.0, 2.0 * growth.seen * 3600.0, 12)[1:]:
        size, std = growth.after(seconds / 3600.0)
        # Doors count from the end of the first one here, and the arm warms up from its begin.
        assert abs(size - truth(seconds)) < 3.0 * std + truth(TAKT)
    size, std = growth.after(END / 3600.0)
    assert std < 0.1 * size


def test_the_next_doors_come_out_as_assumed_while_it_is_warm_and_in_the_morning(shift, knowing):
    folder, diagnosis = shift
    warm = loop_worth(folder, diagnosis, COUNT, SEED, knowing)
    cold = loop_worth(folder, diagnosis, COUNT, SEED, knowing, morning=True)
    assert warm.kept
    assert not warm.worse
    assert cold.kept
    assert not cold.worse
    # The world's own figures leave no less; what the gauge adds by chance is its noise.
    assert warm.after < warm.told + 0.5 * NOISE


def test_a_plan_undoes_the_growth_of_its_time(shift, tmp_path):
    setup = setup_with(tmp_path / "model.yaml", shift[1])
    work = WorkTimes([TAKT * number for number in range(COUNT)])
    assert setup.growth is None
    assert setup.warm(WorkTimes(), END).growth == 0.0
    assert setup.warm(work, END).growth == pytest.approx(truth(END), abs=1e-5)
    assert setup.warm(work, END + 12 * 3600.0).growth < 1e-7


def test_a_growth_alone_is_reason_to_propose_a_model_and_one_that_has_it_is_not_improved(shift, tmp_path):
    _, diagnosis = shift
    springs = in_use_document(diagnosis, "", 0)
    assert springs["difference"] > NOISE
    assert springs["expected_error_extended"] < springs["expected_error"]
    setup_with(tmp_path / "model.yaml", diagnosis)
    own = in_use_document(diagnosis, str(tmp_path / "model.yaml"), 0)
    assert own["difference"] < 1e-9
    assert own["expected_error"] == pytest.approx(springs["expected_error_extended"])


def test_doors_of_a_cell_that_keeps_its_temperature_tell_no_law(tmp_path):
    doors = tuple(itertools.islice(itertools.cycle(HINGE_DOORS), 6))
    diagnosis = diagnosed(tmp_path / "shift", DrawnShift({"seed": SEED}, (), doors), SEED)
    assert growth_told(diagnosis) is None


@pytest.mark.parametrize(("count", "hours"), [(25, 0.28), (40, 0.71)])
def test_a_time_constant_between_those_that_are_tried_is_named_and_nothing_beside_it(tmp_path, count, hours):
    world = {"seed": 3, "temperature": {"rise": RISE, "hours": hours, "growth": GROWTH}}
    doors = tuple(itertools.islice(itertools.cycle(HINGE_DOORS), count))
    diagnosis = diagnosed(tmp_path / "shift", DrawnShift(world, (), doors), 3)
    (finding,) = diagnosis.findings
    assert finding.cause.key == ("thermal_growth", "cell")
    assert finding.values[1] == pytest.approx(hours, rel=0.15)
    assert finding.values[0] == pytest.approx(RISE * GROWTH, rel=0.1)
