"""What pages tell to type, and where it is run."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

import yaml

from support.commands import Command, commands_of
from support.source_tree import ROOT

FOLDER = ROOT / "test" / "page_commands"
#: Programs of others that pages call.
OTHERS = (
    "dask",
    "docker",
    "duckdb",
    "install",
    "journalctl",
    "make",
    "python",
    "python3",
    "rm",
    "ros2",
    "runuser",
    "systemctl",
)
#: Pages of which `test_readme.py` runs the shell blocks as they stand.
IN_BLOCKS = ("README.md", "living.md")
#: What a reader replaces or may leave out: words in capitals, options in brackets, all but the first choice.
_LEFT_OUT = re.compile(r"\[[^\]]*\]|\|\s*[^|)\s]+(?:\s+[A-Z.]+)*")
_WORD = re.compile(r"[^A-Z()|.\s][^()|\s]*")


def tools() -> set[str]:
    """Nodes and tools by the name that is typed."""
    files = [file for room in ("nodes", "tools") for file in (ROOT / "doormill_ros" / room).glob("[a-z]*.py")]
    return {file.stem for file in files if "def main(" in file.read_text(encoding="utf-8")}


def calls_of(page: Path) -> list[Command]:
    """The commands of a page that call a program with something behind its name, each once."""
    programs = (*tools(), *OTHERS)
    blocks = "\n".join(re.findall(r"```bash\n(.*?)```", page.read_text(encoding="utf-8"), re.DOTALL))
    run_as_blocks = page.name in IN_BLOCKS
    found = {
        bare(command): command
        for command in commands_of(page)
        if command.text.split()[0] in programs
        and len(bare(command).split()) > 1
        and not (run_as_blocks and command.typed and command.text in blocks)
    }
    return list(found.values())


def bare(command: Command) -> str:
    """A command without its comment and without what sends it to the background."""
    return " ".join(command.text.split(" #")[0].rstrip("& ").split())


def literal_words(text: str) -> list[str]:
    """The words of a command that a reader types as they stand."""
    return _WORD.findall(_LEFT_OUT.sub("", text))


def is_run_by(text: str, script: str) -> bool:
    """A script has a command as it stands, or one line its literal words in their order, with any whole numbers."""
    if text in script:
        return True
    words = literal_words(text)
    for line in script.replace("\\\n", " ").splitlines():
        rest = iter(line.split())
        if all(any(_same_word(word, other) for other in rest) for word in words):
            return True
    return False


def _same_word(word: str, other: str) -> bool:
    return word == other or (word.isdecimal() and other.isdecimal())


@dataclass(frozen=True)
class Page:
    """A page's script, empty where it has none, and what is told of its other commands."""

    path: Path
    script: str
    elsewhere: dict[str, str]
    everywhere: dict[str, str]

    def missing(self) -> list[str]:
        """Commands that nothing runs and nothing is told of."""
        return [
            bare(command)
            for command in calls_of(self.path)
            if not is_run_by(bare(command), self.script)
            and not any(is_same(row, bare(command)) for row in (*self.elsewhere, *self.everywhere))
            and not is_kept(bare(command))
        ]

    def stale(self) -> list[str]:
        """Rows of commands that the page does not have."""
        calls = [bare(command) for command in calls_of(self.path)]
        return [row for row in self.elsewhere if not any(is_same(row, call) for call in calls)]


def is_same(row: str, call: str) -> bool:
    """A row stands for a command that begins with it."""
    return call == row or call.startswith(f"{row} ")


def is_kept(call: str) -> bool:
    """It is a bench, and what it printed is kept with the command that it was started by."""
    match = re.match(r"python (bench/(\w+)\.py)", call)
    kept = ROOT / "bench" / "results" / f"{match[2]}.txt" if match else None
    return bool(match and kept and kept.exists() and f"command: python {match[1]}" in kept.read_text("utf-8"))


def script_of(page: Path) -> Path:
    """Where the script of a page lies, if it has one."""
    return FOLDER / f"{page.stem}.sh"


def load_page(page: Path) -> Page:
    """A page with its script and rows."""
    rows = yaml.safe_load((FOLDER / "elsewhere.yaml").read_text(encoding="utf-8"))
    script = script_of(page)
    text = script.read_text(encoding="utf-8") if script.exists() else ""
    return Page(page, text, rows.get(page.name, {}), rows["every page"])
