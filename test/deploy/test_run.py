"""The starter of services and containers, from a shell that knows nothing."""

from __future__ import annotations

import os
import subprocess
from pathlib import Path

from support.source_tree import ROOT

RUN = ROOT / "deploy" / "doormill-run"


def run(folder: Path, *arguments: str, **environment: str) -> subprocess.CompletedProcess[str]:
    known = {name: os.environ[name] for name in ("HOME", "ROS_DOMAIN_ID") if name in os.environ}
    if "ROS_DISTRO" in os.environ and "DOORMILL_WHEELS" not in os.environ:
        known["PATH"] = os.environ["PATH"]
    return subprocess.run(
        [RUN, *arguments],
        cwd=folder,
        env={"PATH": "/usr/local/bin:/usr/bin:/bin", **known, **environment},
        capture_output=True,
        text=True,
        timeout=240,
    )


def test_a_tool_runs_on_the_site(tmp_path: Path) -> None:
    done = run(tmp_path, "recipes", "list", DOORMILL_SITE=str(tmp_path / "site"))
    assert done.returncode == 0, done.stderr
    assert "standard_door" in done.stdout
    assert (tmp_path / "site" / "recipes.sqlite").is_file()


def test_a_node_takes_the_parameters_of_the_site_and_says_what_is_wrong_with_them(tmp_path: Path) -> None:
    """With the status after which the service does not start it again."""
    (tmp_path / "config").mkdir()
    (tmp_path / "config" / "nodes.yaml").write_text(
        "/**/door_localizer:\n  ros__parameters:\n    overlay_step: 77\n"
    )
    done = run(tmp_path, "door_localizer", DOORMILL_SITE=str(tmp_path))
    assert done.returncode == 2
    assert "overlay_step of /door_localizer is 77" in done.stdout + done.stderr


def test_what_is_not_there_is_named(tmp_path: Path) -> None:
    assert run(tmp_path).returncode == 2
    done = run(tmp_path, "no_such_node")
    assert (done.returncode, done.stderr) == (2, "doormill-run: there is no node or tool no_such_node\n")
