"""Signals of a controller: what its configuration may say."""

from __future__ import annotations

from functools import partial

import pytest

from doormill_ros.simulation.controller.cabinet.io_port import FolderIo, MemoryIo
from doormill_ros.simulation.controller.configuration.io_configuration import read_io_configuration
from doormill_ros.simulation.controller.rapid.errors import SignalError

HEAD = "EIO:CFG_1.0:6:1::\n#\nEIO_SIGNAL:\n\n"


@pytest.fixture
def read(read_configuration):
    return partial(read_configuration, read_io_configuration)


def test_signals_and_their_limits(read):
    found = read(
        HEAD
        + """      -Name "doA" -SignalType "DO" -Default 1 -SafeLevel "SafetySafeLevel"

      -Name "aoB" -SignalType "AO" -Access "All" -Label "Speed, rev/min - not the feed"\\
      -MinLog -10 -MaxLog 24000

      -Name "goC" -SignalType "GO" -Device "plc" -DeviceMap "0-3,8"

      -Name "giD" -SignalType "GI" -Size 16
"""
    ).signals
    assert [(s.name, s.kind, s.lowest, s.largest) for s in found.values()] == [
        ("doA", "signaldo", 0.0, 1.0),
        ("aoB", "signalao", -10.0, 24000.0),
        ("goC", "signalgo", 0.0, 31.0),
        ("giD", "signalgi", 0.0, 65535.0),
    ]
    assert (found["doA"].default, found["doA"].safe_level) == (1.0, "SafetySafeLevel")
    assert found["aoB"].label == "Speed, rev/min - not the feed"


def test_access_levels_say_who_may_write(read):
    text = 'EIO_ACCESS:\n -Name "Net" -RemoteAuto\n#\n'
    names = ("Default", "All", "ReadOnly", "Internal", "Net")
    lines = "".join(f' -Name "do{n}" -SignalType "DO" -Access "{n}"\n' for n in names)
    found = read(HEAD + lines + ' -Name "doNone" -SignalType "DO"\n' + text).signals
    writers = {name: found[f"do{name}"].access.writers for name in (*names, "None")}
    assert writers["Default"] == writers["None"] == {"rapid", "local_manual"}
    assert writers["All"] == {"rapid", "local_manual", "local_auto", "remote_manual", "remote_auto"}
    assert writers["ReadOnly"] == writers["Internal"] == frozenset()
    assert writers["Net"] == {"remote_auto"}


def test_the_newer_form_is_read(read):
    assert read('EIO:CFG_1.0:7:0::\nEIO_SIGNAL:\n -Name "doA" -SignalType "DO"\n').version == 7


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("SYS:CFG_1.0:6:1::\n", "line 1: found 'SYS:CFG"),
        (HEAD, "configures no signal"),
        (HEAD + '-Name "a" -SignalType "DX"\n', "line 5: -SignalType is 'DX'"),
        (HEAD + '-Name "a"\n', "-SignalType is ''"),
        (HEAD + '-Name "1a" -SignalType "DO"\n', "the name is '1a'"),
        (HEAD + f'-Name "{"a" * 33}" -SignalType "DO"\n', "at most 32"),
        (
            HEAD + '-Name "a" -SignalType "DO"\n-Name "A" -SignalType "DI"\n',
            "line 6: signal 'A' stands here a second",
        ),
        (HEAD + '-Name "a" -SignalType "DO" -Acces "All"\n', "found the key -Acces"),
        (HEAD + '-Name "a" -SignalType "DO" -Access "Everybody"\n', "-Access is 'Everybody'"),
        (HEAD + '-Name "a" -SignalType "DO" -SafeLevel "Low"\n', "-SafeLevel is 'Low'"),
        (HEAD + '-Name "a" -SignalType "DO" -DeviceMap "3"\n', "-DeviceMap without -Device"),
        (HEAD + '-Name "a" -SignalType "DO" -Default 2\n', "the default of a is 2"),
        (HEAD + '-Name "a" -SignalType "AO" -MinLog 5 -MaxLog 5\n', "-MinLog below -MaxLog"),
        (HEAD + '-Name "a" -SignalType "AO" -MaxLog "high"\n', "-MaxLog is 'high'"),
        (HEAD + '-Name "a" -SignalType "GO"\n', "group a has 0 bits"),
        (HEAD + '-Name "a" -SignalType "GO" -Size 33\n', "group a has 33 bits"),
        (
            HEAD + '-Name "a" -SignalType "GO" -Device "d" -DeviceMap "a-b"\n',
            "-DeviceMap of a cannot be read",
        ),
        (HEAD + f'-Name "a" -SignalType "DO" -Label "{"x" * 81}"\n', "the label has 81"),
        (HEAD + '-Name "a" -SignalType "DO" -Label\n', "-Label has no value"),
        (HEAD + '-Name "a" -Name "b" -SignalType "DO"\n', "-Name stands here twice"),
        (HEAD + '-Name "a" "b" -SignalType "DO"\n', "allowed is -Key value"),
        (HEAD + '-Name "a -SignalType "DO"\n', "a quotation mark without its partner"),
        (HEAD + "doA\n", "found 'doA'"),
        ('EIO:CFG_1.0:6:1::\n-Name "a"\n', "allowed is a section"),
        (HEAD + 'EIO_ACCESS:\n -Name "All" -Rapid\n', "access level All is changed"),
        (HEAD + 'EIO_ACCESS:\n -Name "Mine" -Robot\n', "found Robot"),
    ],
)
def test_what_a_controller_would_not_load(read, text, words):
    with pytest.raises(SignalError, match=words):
        read(text)


def test_ports_hold_groups(tmp_path):
    for port in (MemoryIo(largest={"goRequest": 255}), FolderIo(tmp_path, largest={"goRequest": 255})):
        port.write("goRequest", 255)
        assert port.read("goRequest") == 255
        with pytest.raises(SignalError, match="allowed are 0 to 255"):
            port.write("goRequest", 256)
        with pytest.raises(SignalError, match="allowed are '0' and '1'"):
            port.write("doPathReady", 2)
