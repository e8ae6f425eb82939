"""Every command of every page is run: here by the page's script, or where a row of `elsewhere.yaml` tells."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
import yaml

from support.commands import Command
from support.page_commands import FOLDER, calls_of, is_run_by, literal_words, load_page
from support.shell import output_of
from support.source_tree import ROOT

PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]
SCRIPTS = sorted(FOLDER.glob("*.sh"))
LIMIT = 1800  # s; of a machine with other work


def test_no_command_is_left_out() -> None:
    pages = [load_page(page) for page in PAGES]
    assert sum(len(calls_of(page)) for page in PAGES) > 100
    assert {page.path.name: missing for page in pages if (missing := page.missing())} == {}
    assert {page.path.name: stale for page in pages if (stale := page.stale())} == {}
    assert {script.stem for script in SCRIPTS} <= {page.stem for page in PAGES}


def test_what_is_run_elsewhere_is_there() -> None:
    """A test that a row names has the words of the command: subcommand and options."""
    rows = yaml.safe_load((FOLDER / "elsewhere.yaml").read_text(encoding="utf-8"))
    named = 0
    for commands in rows.values():
        for command, told in commands.items():
            for place in re.findall(r"test/[\w/]+", told):
                path = ROOT / (f"{place}.py" if (ROOT / f"{place}.py").exists() else place)
                assert path.exists(), told
            if match := re.match(r"test/\S+\.py", told):
                text = (ROOT / match[0].rstrip(",")).read_text(encoding="utf-8")
                words = [] if command.startswith(("make ", "python bench/")) else literal_words(command)
                assert [word for word in words[1:] if word not in text] == [], command
                named += 1
    assert named > 20


def test_a_command_that_no_line_has_is_seen() -> None:
    script = "recipes list\nreplay --many bags --workers 2\n"
    assert is_run_by("replay --many DIR ... [--scheduler ADDRESS]", script)
    assert is_run_by("recipes list", script)
    assert not is_run_by("recipes list --prefix oak", script)
    assert not is_run_by("recipes show ID", script)
    assert literal_words(Command("page", "locate (--door DOOR | --size W H) FILE ...", True).text) == [
        "locate",
        "--door",
    ]


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda path: path.stem)
def test_its_script_runs(script: Path, tmp_path: Path) -> None:
    before = f"set -uo pipefail\nROOT={ROOT}\nexport XDG_DATA_HOME=$PWD/site\n. ./activate\n"
    output_of(before + script.read_text(encoding="utf-8"), tmp_path, LIMIT)
