"""Doors count in the order in which they were milled, whenever they were gauged."""

import itertools
from dataclasses import replace

import pytest

from doormill_ros.diagnosis.parts.doors.order import in_order
from doormill_ros.diagnosis.parts.kind import Inspections
from support.gauged_shift import HINGE_DOORS, gauged_shift
from support.shift_worlds import inspected

KIND = Inspections()
COUNT, STEP = 8, 5
#: When each door was gauged [s], by what the workshop did with its pallet.
GAUGED = {
    "one by one": lambda k: 1e9 + 180.0 * k,
    "last door first": lambda k: 1e9 + 180.0 * (COUNT - k),
    "one stamp a pallet": lambda k: 1e9,
    "one stamp for four": lambda k: 1e9 + 180.0 * (k // 4),
}


@pytest.fixture(scope="module")
def shift(tmp_path_factory):
    """Doors of a shift in which a gap opens, each milled by a run of its own."""
    world = {"seed": 5, "change": [{"from_door": STEP, "robot": {"gap": [1.2e-4, 0.0, 0.0, 0.0, 0.0, 0.0]}}]}
    turns = tuple(itertools.islice(itertools.cycle(HINGE_DOORS[:2]), COUNT))
    found = inspected(gauged_shift(tmp_path_factory.mktemp("doors"), world, turns, 5))
    return [
        replace(one, door=replace(one.door, run_id=f"run {k}", milled=9e8 + 6.0 * k))
        for k, one in enumerate(found)
    ]


def gauged(shift, when, **changes):
    return [replace(one.door, time=when(k), **changes) for k, one in enumerate(shift)]


@pytest.mark.parametrize("how", GAUGED)
def test_doors_stand_as_they_were_milled_with_times_that_grow(shift, how):
    doors = in_order(gauged(shift, GAUGED[how])[::-1])
    assert [door.name for door in doors] == [f"door_00{k}" for k in range(COUNT)]
    assert all(before.time < after.time for before, after in itertools.pairwise(doors))
    took = 180.0 if how == "one by one" else 6.0
    assert doors[-1].time - doors[0].time == pytest.approx(took * (COUNT - 1))


@pytest.mark.parametrize(
    "changes", [{"milled": None}, {"run_id": "one for all"}], ids=lambda one: next(iter(one))
)
def test_where_bags_do_not_tell_doors_stand_as_they_were_gauged_and_named(shift, changes):
    doors = in_order(gauged(shift, GAUGED["one stamp for four"], **changes)[::-1])
    assert [door.name for door in doors] == [f"door_00{k}" for k in range(COUNT)]
    assert all(before.time < after.time for before, after in itertools.pairwise(doors))
    doors = in_order(gauged(shift, GAUGED["last door first"], **changes))
    assert [door.name for door in doors] == [f"door_00{k}" for k in reversed(range(COUNT))]


@pytest.mark.parametrize("how", ["last door first", "one stamp a pallet"])
def test_a_gap_that_opens_is_told_with_its_door_however_the_pallet_was_gauged(shift, how):
    doors = gauged(shift, GAUGED[how])
    sets = [replace(one, door=door) for one, door in zip(shift, doors, strict=True)]
    diagnosis = KIND.diagnose(sets, lambda line: None)
    account = KIND.account(diagnosis, sets, [], lambda line: None)
    [change] = account.sections["changes"]
    assert (change["what"], change["where"], change["from_door"]) == (
        "joint_backlash",
        "joint 1",
        f"door_00{STEP}",
    )
    assert change["before"] == {}
    assert change["after"]["gap"] == pytest.approx(1.2e-4, rel=0.1)
