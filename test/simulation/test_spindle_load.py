"""The simulated drive gives what idle spindle and cut take, in the simulated time that its controller plays."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from doormill_ros.abb import signals
from doormill_ros.simulation import spindle_load
from doormill_ros.simulation.controller.moves import MotionContext
from doormill_ros.simulation.controller.records.recording import MotionRecording, Surroundings
from doormill_ros.simulation.spindle_load import IDLE, NOISE, NOMINAL, SpindleDrive, SpindleWork
from doormill_ros.simulation.world.cutting_power import SPECIFIC

RATE = 2e-5  # m^3/s
STEP = 0.02  # s


class Plank:
    """Wood that gives the same volume at every sample of a cut."""

    def take(self, feature: str, tip: np.ndarray, tool: str = "") -> float:
        return RATE * STEP if feature else 0.0


class Plant:
    """A controller that is at some time, with a spindle that turns, and its signals."""

    def __init__(self, turning: float = 1.0, kinds: tuple[str, ...] = (signals.SPINDLE_LOAD,)) -> None:
        self.recording, self.time, self.turning, self.shown = MotionRecording(), 0.0, turning, []
        self.cell = SimpleNamespace(
            kinds=kinds,
            spindle_drive="doSpindleOn",
            read=lambda name: self.turning,
            set_input=lambda name, value: self.shown.append((name, value)),
        )

    def now(self) -> float:
        return self.time

    def play(self, drive: SpindleDrive, seconds: float, feature: str = "") -> float:
        """Let time pass, and give the load that is shown then."""
        for _ in range(round(seconds / STEP)):
            self.time += STEP
            context = MotionContext(0, feature, bool(feature))
            self.recording.add(self.time, np.eye(4), np.zeros(6), context, Surroundings())
            drive.advance(self)  # type: ignore[arg-type]
        return self.shown[-1][1] / 100.0


@pytest.fixture
def drive(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> SpindleDrive:
    monkeypatch.setattr(spindle_load, "SHOWN", 0.0)
    (tmp_path / signals.IO_FOLDER).mkdir()
    return SpindleDrive(tmp_path)


def work(factor: float = 1.0) -> SpindleWork:
    return SpindleWork(Plank(), factor, np.random.default_rng(4))  # type: ignore[arg-type]


def test_a_spindle_that_stands_takes_nothing_and_one_in_the_air_its_idle_share(drive: SpindleDrive) -> None:
    plant = Plant(turning=0.0)
    drive.work = work()
    assert plant.play(drive, 1.0, "pocket") < 6.0 * NOISE
    plant.turning = 1.0
    assert plant.play(drive, 1.0) == pytest.approx(IDLE, abs=6.0 * NOISE)


@pytest.mark.parametrize("factor", [1.0, 1.6])
def test_the_cut_takes_its_volume_times_its_work(drive: SpindleDrive, factor: float) -> None:
    plant, drive.work = Plant(), work(factor)
    cut = factor * SPECIFIC * RATE / NOMINAL
    assert plant.play(drive, 1.0, "pocket") == pytest.approx(IDLE + cut, abs=6.0 * NOISE)
    assert plant.play(drive, 1.0) == pytest.approx(IDLE, abs=6.0 * NOISE)


def test_the_converter_smooths_over_a_tenth_of_a_second(drive: SpindleDrive) -> None:
    plant, drive.work = Plant(), work()
    plant.play(drive, 1.0)
    cut = SPECIFIC * RATE / NOMINAL
    assert plant.play(drive, 0.1, "pocket") == pytest.approx(
        IDLE + (1.0 - np.exp(-1.0)) * cut, abs=6.0 * NOISE
    )


def test_the_file_of_the_signal_says_the_same(drive: SpindleDrive, tmp_path: Path) -> None:
    file = tmp_path / signals.IO_FOLDER / signals.SPINDLE_LOAD
    assert float(file.read_text()) == 0.0
    plant, drive.work = Plant(), work()
    told = plant.play(drive, 0.2, "pocket")
    assert plant.shown[-1][0] == signals.SPINDLE_LOAD
    assert float(file.read_text()) == pytest.approx(100.0 * told, abs=0.01)


def test_the_next_door_begins_with_a_spindle_that_stands(drive: SpindleDrive) -> None:
    first, second = Plant(), Plant(turning=0.0)
    drive.work = work()
    first.play(drive, 1.0, "pocket")
    drive.work = None
    assert second.play(drive, STEP) == 0.0


def test_a_controller_without_the_signal_is_told_nothing(drive: SpindleDrive) -> None:
    plant = Plant(kinds=())
    drive.work = work()
    plant.time = 1.0
    drive.advance(plant)  # type: ignore[arg-type]
    assert plant.shown == []


def test_a_door_that_nobody_knows_is_air(drive: SpindleDrive) -> None:
    assert Plant().play(drive, 1.0, "pocket") == pytest.approx(IDLE, abs=1e-3)
