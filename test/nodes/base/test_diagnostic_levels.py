"""Levels on /diagnostics: green means that nobody has to look."""

from __future__ import annotations

import itertools
from pathlib import Path

import pytest
from diagnostic_msgs.msg import DiagnosticStatus

from doormill_ros.abb.handshake.state import HandshakeSnapshot, HandshakeState
from doormill_ros.abb.link_errors import MillingFaultError
from doormill_ros.nodes.abb_bridge import code_of, level_of
from doormill_ros.nodes.one_process.cell import CellOptions, run_once
from doormill_ros.recording.bag_reader import read_bag


@pytest.mark.parametrize("state", HandshakeState)
def test_the_handshake_is_green_only_where_nothing_went_wrong(state: HandshakeState) -> None:
    without, because = (HandshakeSnapshot(state, "why", 0.0, code) for code in (0, 404))
    green = DiagnosticStatus.ERROR if state is HandshakeState.FAILED else DiagnosticStatus.OK
    assert level_of(without) == green
    assert level_of(because) == DiagnosticStatus.WARN
    assert code_of(without) == (MillingFaultError.code if green == DiagnosticStatus.ERROR else 0)
    assert code_of(because) == 404


def test_a_fault_while_milling_is_an_error_in_the_bag(tmp_path: Path) -> None:
    options = CellOptions(
        {"controller_simulator": {"spindle_works": False}, "door_localizer": {"overlay_step": 0}}
    )
    run_once("thesis_190_0deg", tmp_path, options)
    told = [
        (
            status.message.split(":")[0],
            status.level,
            {pair.key: pair.value for pair in status.values}.get("error_code"),
        )
        for item in read_bag(tmp_path / "bag", ["/diagnostics"])
        for status in item.message.status
        if status.name == "abb_bridge"
    ]
    course = [state for state, _ in itertools.groupby(told)]
    after = course[course.index(("milling", DiagnosticStatus.OK[0], "0")) + 1 :]
    assert after[0] == ("failed", DiagnosticStatus.ERROR[0], str(MillingFaultError.code))
