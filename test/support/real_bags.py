"""Bags as a cell with a real controller records them: nobody tells there what a simulation knows."""

from __future__ import annotations

from pathlib import Path

from doormill_ros.monitor.recorded_runs import SIMULATED_TOPICS
from doormill_ros.recording.bag_reader import read_bag
from doormill_ros.recording.bag_writer import BagWriter


def as_real(bag: Path, folder: Path, close: bool = True) -> Path:
    """Copy a bag without its topics of the simulation; unless closed it is still being recorded."""
    writer = BagWriter(folder)
    messages = [item for item in read_bag(bag) if SIMULATED_TOPICS not in item.topic]
    for item in messages:
        writer.add_topic(item.topic, item.type_name)
    for item in messages:
        writer.write(item.topic, item.data, item.stamp_ns)
    if close:
        writer.close()
    else:
        writer.flush(force=True)
    return folder
