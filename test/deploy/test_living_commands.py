"""What docs/living.md has an administrator type, against the units, the user and the files that it is about."""

from __future__ import annotations

import fnmatch
import os
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import yaml

from doormill_ros.cell.graph.readiness import BESIDE, NEEDED
from support.commands import Command, commands_of
from support.page_commands import bare
from support.source_tree import ROOT
from support.waiting import LIMIT

UNITS = ROOT / "deploy" / "systemd"
INSTALLED = "/opt/doormill/"
#: Prints the files of shared memory that a process with a node has open or mapped; tracing's are not of DDS.
SHARED = """
import os, re
import rclpy
rclpy.init()
node = rclpy.create_node("sharing")
descriptors = (f"/proc/self/fd/{number}" for number in os.listdir("/proc/self/fd"))
names = {os.readlink(path) for path in descriptors if os.path.exists(path)}
names |= set(re.findall(r" (/dev/shm/\\S+)", open("/proc/self/maps").read()))
print(*(name for name in names if name.startswith("/dev/shm/") and "lttng" not in name), sep="\\n")
rclpy.shutdown()
"""
#: Stands for docker: runs here what a container would, the image's places and the volume's put where they are here.
ENGINE = """#!/bin/bash
set -euo pipefail
[[ "$1 $2 $4 $5" == "compose -f exec -T" && -f $3 && " $SERVICES " == *" $6 "* ]] || { echo "docker $*" >&2; exit 64; }
shift 6
mapped=()
for word in "$@"; do
    case $word in
        /opt/doormill/*) word=$ROOT/${word#/opt/doormill/} ;;
        /var/lib/doormill/*) word=$SITE/${word#/var/lib/doormill/} ;;
    esac
    mapped+=("$word")
done
cd "$SITE" && DOORMILL_SITE=$SITE exec "${mapped[@]}"
"""


def told(program: str) -> list[Command]:
    """The page's commands of a program."""
    found = {
        bare(command): command
        for command in commands_of(ROOT / "docs" / "living.md")
        if command.words[0] == program and len(command.words) > 1
    }
    assert found, f"the page has no {program}"
    return list(found.values())


def test_all_that_services_need_is_installed_where_it_is_read(tmp_path: Path) -> None:
    """The commands run as they stand, in the folder that the page names, into another root."""
    folders = ("usr/lib/sysusers.d", "usr/lib/tmpfiles.d", "etc/systemd/system")
    for folder in folders:
        (tmp_path / folder).mkdir(parents=True)
    for command in told("install"):
        line = re.sub(r" /", f" {tmp_path}/", bare(command).split(" && ")[0])
        done = subprocess.run(shlex.split(line), cwd=UNITS, capture_output=True, text=True, timeout=LIMIT)
        assert (done.returncode, done.stderr) == (0, ""), line
    units = {path.name for path in UNITS.iterdir() if path.suffix in (".service", ".target", ".timer")}
    installed = {str(path.relative_to(tmp_path)) for path in tmp_path.rglob("*") if path.is_file()}
    assert installed == {
        "usr/lib/sysusers.d/doormill.conf",
        "usr/lib/tmpfiles.d/doormill.conf",
        "etc/systemd/journald@doormill.conf",
        *(f"etc/systemd/system/{name}" for name in units),
    }
    assert len(list(UNITS.iterdir())) == len(installed)
    assert {path.stat().st_mode & 0o777 for path in tmp_path.rglob("*") if path.is_file()} == {0o644}


def test_a_log_is_looked_for_where_the_node_writes_it() -> None:
    (command,) = told("journalctl")
    namespace, unit = re.fullmatch(r"journalctl --namespace=(\w+) -u doormill@(\w+)", bare(command)).groups()
    assert f"\nLogNamespace={namespace}\n" in (UNITS / "doormill@.service").read_text(encoding="utf-8")
    assert (UNITS / f"journald@{namespace}.conf").is_file()
    assert unit in (*NEEDED, *BESIDE)


def test_orders_are_given_as_the_user_whom_the_nodes_have() -> None:
    (command,) = told("runuser")
    user, program = re.fullmatch(r"runuser -u (\w+) -- (\S+) NAME", bare(command)).groups()
    assert re.search(rf"^u {user} ", (UNITS / "doormill.sysusers").read_text(encoding="utf-8"), re.MULTILINE)
    node = (UNITS / "doormill@.service").read_text(encoding="utf-8")
    assert f"\nUser={user}\n" in node
    assert f"\nExecStart={program} %i\n" in node
    assert (ROOT / program.removeprefix(INSTALLED)).stat().st_mode & 0o111


def test_all_that_dds_leaves_in_shared_memory_is_taken_away_and_nothing_else() -> None:
    (command,) = [command for command in told("rm") if "/dev/shm" in command.text]
    patterns = [word for word in command.words[1:] if word != "-f"]
    done = subprocess.run(
        [sys.executable, "-c", SHARED], capture_output=True, text=True, timeout=LIMIT, check=True
    )
    shared = done.stdout.split()
    assert shared
    assert [name for name in shared if not any(fnmatch.fnmatch(name, p) for p in patterns)] == []
    assert all(Path(pattern).name.removeprefix("sem.").startswith("fastdds_") for pattern in patterns)


def test_orders_of_cron_take_the_backup_out_of_the_containers_and_clear_their_bags(tmp_path: Path) -> None:
    """The block runs as it stands, twice, since the second finds what the first has left."""
    page = (ROOT / "docs" / "living.md").read_text(encoding="utf-8")
    (block,) = [text for text in re.findall(r"^```sh\n(.*?)^```$", page, re.M | re.S) if "$site" in text]
    engine, site, kept = tmp_path / "bin" / "docker", tmp_path / "site", tmp_path / "backups"
    for folder in (engine.parent, site / "config", kept):
        folder.mkdir(parents=True)
    engine.write_text(ENGINE)
    engine.chmod(0o755)
    (site / "config" / "nodes.yaml").write_text("{}\n")
    services = yaml.safe_load((ROOT / "deploy" / "container" / "compose.yaml").read_text())["services"]
    environment = {
        **os.environ,
        "PATH": f"{engine.parent}:{os.environ['PATH']}",
        "SERVICES": " ".join(services),
        "ROOT": str(ROOT),
        "SITE": str(site),
        "DOORMILL_DATABASE": f"sqlite:///{site / 'recipes.sqlite'}",
    }
    shutil.copytree(ROOT / "bags" / "thesis_190_0deg", site / "out" / "bags" / "recorded")
    rebuild = ["catalogue", "rebuild", site / "out"]
    subprocess.run(rebuild, env={**environment, "DOORMILL_SITE": str(site)}, timeout=LIMIT, check=True)
    run = ["bash", "-euo", "pipefail", "-c", block.replace("/var/backups", str(kept))]
    cleared = 0
    for _ in range(2):
        done = subprocess.run(run, cwd=ROOT, env=environment, capture_output=True, text=True, timeout=LIMIT)
        assert (done.returncode, done.stderr) == (0, "")
        # It asks the site's catalogue, which knows of one; in some weeks that one is too old.
        went, stay = re.fullmatch(
            r"(\d) bags? with .* went, (\d) stays?", done.stdout.splitlines()[-1]
        ).groups()
        cleared += int(went)
        assert cleared + int(stay) == 1
        assert (site / "out" / "bags" / "recorded").exists() == bool(int(stay))
    (backup,) = kept.iterdir()
    assert backup.name == "doormill.tar"
    looked = subprocess.run(
        ["restore", "--check", backup], env=environment, capture_output=True, text=True, timeout=LIMIT
    )
    assert (looked.returncode, looked.stderr) == (0, "")
