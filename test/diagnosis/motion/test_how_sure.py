"""What is said of a wave or a spring holds in another recording, or what else it may be stands beside it."""

import numpy as np
import pytest

from doormill_ros.diagnosis.core.telling.document import cause_entry
from doormill_ros.diagnosis.motion.account import named_causes
from doormill_ros.diagnosis.motion.diagnosis import diagnose_motions
from doormill_ros.diagnosis.motion.laws import with_laws
from doormill_ros.measurements.sets.motion_set import read_motion_set
from support.motion_world import Recording, record
from support.source_tree import ROOT


def wave_of(folder, seconds, height, waves):
    hidden = Recording(seconds=seconds).with_gear(1, ruler=(height, 0.4, waves))
    (named,) = named_causes(diagnose_motions([read_motion_set(record(folder / "set", hidden, 2))]))
    return cause_entry(named)


@pytest.mark.parametrize("waves", [24.0, 25.0])
def test_orders_that_a_short_way_does_not_tell_apart_stand_beside_a_wave(tmp_path, waves):
    entry = wave_of(tmp_path, 5.0, 8e-6, waves)
    beside = entry["confusable_with"]
    assert {(one["cause"], one["where"]) for one in beside} == {("joint_periodic_error", "joint 1")}
    told = {one["variant"] for one in beside} | {
        f"order {name.removeprefix('joint_order_')} of the joint" for name in entry["parameters"]
    }
    assert f"order {waves:g} of the joint" in told
    assert len(told) == len(beside) + 1 <= 5


@pytest.mark.parametrize("waves", [24.0, 25.0])
def test_a_longer_way_leaves_a_wave_its_order_alone(tmp_path, waves):
    entry = wave_of(tmp_path, 10.0, 3e-5, waves)
    assert list(entry["parameters"]) == [f"joint_order_{waves:g}"]
    assert entry["confusable_with"] == []


def test_springs_told_from_one_measured_recording_hold_in_the_other():
    told = []
    for name in ("A", "B"):
        diagnosis = with_laws(diagnose_motions([read_motion_set(ROOT / "test" / "data" / "kr300" / name)]))
        named = [one for one in named_causes(diagnosis) if one.cause == "joint_stiffness"]
        told.append({one.where: one.parameters["stiffness"] for one in named})
    assert set(told[0]) == set(told[1]) == {"joint 1", "joint 2", "joint 3"}
    for where in told[0]:
        # Compliances: a stiffness is told by what gives way, and has no upper end where next to nothing does.
        value, std = np.array([[1.0 / one[where]["value"], one[where]["std"]] for one in told]).T
        assert abs(value[0] - value[1]) < 2.0 * np.hypot(*(std * value**2)), where
