"""What a cell of services has to stand, by the commands of docs/living.md, one check after the other."""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass

from doormill_ros.cell.graph.readiness import BESIDE, NEEDED
from support.booted.machine import Machine
from support.source_tree import ROOT

PAGE = ROOT / "docs" / "living.md"
#: What the target starts, and what stands for camera, controller and robot here.
NODES = (*NEEDED, *BESIDE)
SIMULATOR = "cell_simulator"
DOOR = "standard_door"
RUN = "/opt/doormill/deploy/doormill-run"
#: DDS' shared memory carries nothing between users.
AS_NODES = "cd /var/lib/doormill && HOME=$PWD runuser -u doormill --"
STARTED = 120.0  # s, with two cores for all
WRONG = "-p limit.recipe:=-1.0"


@dataclass(frozen=True)
class Checked:
    """One check: what was wanted, and what came instead, empty where it came."""

    what: str
    instead: str = ""


def commands_of_page() -> str:
    """The shell block of the section on services, as it stands.

    Raises:
        ValueError: The page has no such block.
    """
    section = PAGE.read_text(encoding="utf-8").partition("## As services")[2].partition("\n## ")[0]
    block = re.search(r"```sh\n(.*?)```", section, re.DOTALL)
    if block is None:
        raise ValueError(f"{PAGE} has no block of commands under 'As services'")
    return block[1]


def journal_of_page() -> str:
    """The command that shows a node's log, as it stands on the page."""
    found = re.search(r"`(journalctl [^`]+)`", PAGE.read_text(encoding="utf-8"))
    if found is None:
        raise ValueError(f"{PAGE} does not say how a log is read")
    return found[1]


def play(machine: Machine) -> Iterator[Checked]:
    """Install the units and have the cell live through an ordinary year."""
    checks: list[tuple[str, Callable[[Machine], None]]] = [
        ("the page's commands run", lambda m: _run(m, commands_of_page())),
        ("its nodes are up", lambda m: _active(m, NODES)),
        ("with the simulated cell beside them it is ready", _simulated),
        ("a door is milled", _mill),
        ("the operator's page answers", _page),
        ("a node's log is read by the page's command", _journal),
        ("the backup is made, and due every night", _backup),
        ("a node whose parameters cannot be is not started again", _wrong_parameter),
    ]
    checks += [
        (f"{node}, killed, is there again, and a door is milled", lambda m, node=node: _killed(m, node))
        for node in (*NODES, SIMULATOR)
    ]
    checks += [
        ("the target, stopped, stops all its nodes", _stopped),
        ("after a reboot the cell is there by itself, with its recipes and runs", _rebooted),
    ]
    for what, check in checks:
        try:
            check(machine)
        except (RuntimeError, TimeoutError, AssertionError) as error:
            yield Checked(what, str(error) or type(error).__name__)
        else:
            yield Checked(what)


def _run(machine: Machine, commands: str) -> None:
    machine.run(commands)


def _active(machine: Machine, nodes: tuple[str, ...]) -> None:
    for node in nodes:
        machine.wait_for(f"systemctl is-active doormill@{node}", "active", STARTED)


def _ready(machine: Machine) -> None:
    machine.wait_for(f"{AS_NODES} {RUN} health --wait 20", "ready", STARTED)


def _simulated(machine: Machine) -> None:
    machine.run(f"systemctl start doormill@{SIMULATOR}")
    _ready(machine)


def _mill(machine: Machine) -> None:
    said = machine.run(f"{AS_NODES} {RUN} python /opt/doormill/test/support/booted/goal.py {DOOR}")
    result = json.loads(said.splitlines()[-1])
    assert result["success"], said
    assert result["measured"], said


def _page(machine: Machine) -> None:
    asked = "import urllib.request as u; print(u.urlopen('http://127.0.0.1:8080/state').status)"
    status = machine.run(f'python3 -c "{asked}"')
    assert status == "200", status


def _journal(machine: Machine) -> None:
    log = machine.run(journal_of_page())
    assert "[abb_bridge]: active" in log, log


def _backup(machine: Machine) -> None:
    machine.run("systemctl start doormill-backup.service")
    made = machine.run("ls /var/backups/doormill")
    assert re.fullmatch(r"\d{8}T\d{6}Z\.tar", made), made
    due = machine.run("systemctl list-timers --no-pager doormill-backup.timer")
    assert "doormill-backup.service" in due, due


def _wrong_parameter(machine: Machine) -> None:
    machine.run(f"echo 'DOORMILL_ARGUMENTS={WRONG}' >/etc/doormill/cell.env")
    machine.run("systemctl restart doormill@abb_bridge", check=False)
    try:
        machine.wait_for("systemctl is-active doormill@abb_bridge", "failed", STARTED)
        status = machine.run("systemctl show -P ExecMainStatus doormill@abb_bridge")
        assert status == "2", f"status {status}"
    finally:
        machine.run("rm /etc/doormill/cell.env; systemctl restart doormill@abb_bridge")
    _ready(machine)


def _killed(machine: Machine, node: str) -> None:
    process = f"systemctl show -P MainPID doormill@{node}"
    before = machine.run(process)
    machine.run(f"systemctl kill --signal=KILL doormill@{node}")
    machine.wait_for(
        f'test "$({process})" != {before} && systemctl is-active doormill@{node}', "active", STARTED
    )
    after = machine.run(process)
    assert after not in (before, "0"), f"process {before} before, {after} after"
    _ready(machine)
    _mill(machine)


def _stopped(machine: Machine) -> None:
    machine.run("systemctl stop doormill.target")
    for node in NODES:
        # The target is gone at once, what is part of it when it has closed its files.
        machine.wait_for(f"systemctl is-active doormill@{node}", "inactive", STARTED)


def _rebooted(machine: Machine) -> None:
    runs = machine.run("ls /var/lib/doormill/out/bags | wc -l")
    machine.reboot()
    _active(machine, NODES)
    _simulated(machine)
    _mill(machine)
    kept = machine.run("ls /var/lib/doormill/out/bags | wc -l")
    assert int(kept) > int(runs) > 0, f"{runs} bags before, {kept} after"
