"""Commands, options, parameters, targets and paths of every page are there as the page says."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from doormill_ros.backup.errors import BackupEntryError, NewerBackupError, TornBackupError
from doormill_ros.cell.graph.readiness import SILENCE
from support.commands import TOOLS, Command, commands_of, complaint, parser_of
from support.package_nodes import reporting_nodes
from support.source_tree import ROOT

PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]
COMMANDS = [command for page in PAGES for command in commands_of(page)]
SOURCES = (
    "bags",
    "bench",
    "config",
    "deploy",
    "docs",
    "doormill_interfaces",
    "doormill_ros",
    "launch",
    "rapid",
    "scripts",
    "test",
)
PLACE = re.compile(rf"(?<![\w./$-])((?:{'|'.join(SOURCES)}|\.ci)/[\w./*<>-]*[\w*/])")
#: A path in another project's repository, which is named just before it.
FOREIGN = re.compile(r"[\w-]+/[\w-]+ \(`[^`]+`\)")


def of_tool(tool: str) -> list[Command]:
    starts = re.compile(rf"(?:python -m doormill_ros\.tools\.)?{tool} (?=\S)")
    return [
        Command(c.page, starts.sub(f"{tool} ", c.text, count=1), c.typed)
        for c in COMMANDS
        if starts.match(c.text)
    ]


def test_there_are_pages_and_commands() -> None:
    assert len(PAGES) > 20
    assert len(COMMANDS) > 500
    assert sum(len(of_tool(tool)) for tool in TOOLS) >= 40


@pytest.mark.parametrize("tool", [tool for tool in TOOLS if of_tool(tool)])
def test_its_tool_takes_every_command(tool: str) -> None:
    commands = of_tool(tool)
    assert commands
    assert [said for command in commands if (said := complaint(parser_of(tool), command))] == []


def test_a_wrong_command_is_seen() -> None:
    parser = parser_of("recipes")
    for text in ("recipes list --colour red", "recipes shovel standard_door", "recipes show"):
        assert complaint(parser, Command("page", text, True))
    assert complaint(parser, Command("page", "recipes draw ID --colour", False))
    assert complaint(parser, Command("page", "recipes list --prefix oak  # all of oak", True)) == ""


def scripts() -> list[tuple[str, Path, set[str]]]:
    """Scripts of this repository that pages tell to run, with the options that they give."""
    found = []
    for command in COMMANDS:
        if match := re.match(r"python ((?:bench|bags|scripts)/\S+\.py)(.*)", command.text):
            found.append(
                (command.text, ROOT / match[1], set(re.findall(r"--?[a-z][\w-]+", match[2].split(" #")[0])))
            )
    return found


def test_scripts_are_there_and_know_their_options() -> None:
    told = scripts()
    assert len(told) > 10
    for text, path, options in told:
        assert path.is_file(), text
        # A fuzzer's own options are read by its library.
        mine = {option for option in options if option.startswith("--")}
        assert mine <= set(re.findall(r'"(--[\w-]+)"', path.read_text(encoding="utf-8"))), text


def test_targets_of_make_are_there() -> None:
    told = {c.text.split()[1] for c in COMMANDS if re.fullmatch(r"make [a-z]+( \w+=\w+)*", c.text)}
    known = set(re.findall(r"^([a-z]+):", (ROOT / "Makefile").read_text(encoding="utf-8"), re.MULTILINE))
    assert {"run", "test"} <= told <= known


def parameters() -> set[str]:
    """Every parameter that a node of the cell declares."""
    names = {"autostart", "use_sim_time"}
    for node in reporting_nodes():
        names |= {parameter.name for parameter in node.PARAMETERS}
    return names


def test_parameters_are_declared() -> None:
    told = {
        match[1]: page.name
        for page in PAGES
        for match in re.finditer(r"-p (?:\w+:)?([\w.]+):=", page.read_text(encoding="utf-8"))
    }
    assert {"autostart", "frames"} <= set(told)
    assert {name: page for name, page in told.items() if name not in parameters()} == {}


@pytest.mark.parametrize("page", PAGES, ids=lambda p: p.name)
def test_paths_are_there(page: Path) -> None:
    text = page.read_text(encoding="utf-8")
    missing = []
    # What follows the name of another project's repository lies there.
    for name in PLACE.findall(FOREIGN.sub("", text)):
        # A placeholder such as <scenario> or NAME stands for any; types go without the ending of their file.
        pattern = re.sub(r"<\w+>|(?<=/)[A-Z]+(?=[./])", "*", name).rstrip("/")
        if not [*ROOT.glob(pattern), *ROOT.glob(f"{pattern}.*")]:
            missing.append(name)
    links = re.findall(r"\]\((?!http)([^)#\s]+)(?:#[^)]*)?\)", text)
    missing += [link for link in links if not (page.parent / link).exists()]
    assert missing == []


def test_figures_of_living_are_those_of_code_and_units() -> None:
    text = " ".join((ROOT / "docs" / "living.md").read_text(encoding="utf-8").split())
    units = ROOT / "deploy" / "systemd"
    journal = (units / "journald@doormill.conf").read_text(encoding="utf-8")
    ages = dict(
        re.findall(
            r"^d (\S+) .* (\d+)d$", (units / "doormill.tmpfiles").read_text(encoding="utf-8"), re.MULTILINE
        )
    )
    node = (units / "doormill@.service").read_text(encoding="utf-8")
    retain = (units / "doormill-retain.service").read_text(encoding="utf-8")
    codes = [error.code for error in (TornBackupError, NewerBackupError, BackupEntryError)]
    for words in (
        f"not heard of for {SILENCE:g} s",
        f"which {re.search(r'SystemMaxUse=(.*)M', journal)[1]} MB and",
        f"{re.search(r'MaxRetentionSec=(.*)day', journal)[1]} days are kept",
        f"in `out/` are kept for {ages['/var/lib/doormill/out/targets']} days",
        f"Every night `catalogue retain --days {re.search(r'--days (.*)', retain)[1]}`",
        f"`/var/backups/doormill` for {ages['/var/backups/doormill']}",
        f"started again after {re.search(r'RestartSec=(.*)', node)[1]} s",
        f"(status {re.search(r'RestartPreventExitStatus=(.*)', node)[1]})",
        *(f"({code})" for code in codes),
    ):
        assert words in text, words
