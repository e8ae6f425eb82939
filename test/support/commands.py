"""The commands that documents give, and the parsers that would read them."""

from __future__ import annotations

import argparse
import importlib
import re
import shlex
from dataclasses import dataclass
from pathlib import Path

from support.source_tree import ROOT

TOOLS = tuple(sorted(p.stem for p in (ROOT / "doormill_ros" / "tools").glob("*.py") if p.stem[0] != "_"))
#: What blocks of commands are marked with; an unmarked one may be one.
SHELL = ("", "bash", "sh")
#: What a reader has to replace: words in capitals, lists, choices and what may be left out.
OPEN = re.compile(r"(?<![\w$-])[A-Z][A-Z0-9]*(?![\w=])|\.\.\.|[\[\]()|*$]|MOVES")


@dataclass(frozen=True)
class Command:
    """A command of a document; `typed` where it stands in a block of commands rather than in a sentence."""

    page: str
    text: str
    typed: bool

    @property
    def words(self) -> list[str]:
        return shlex.split(self.text, comments=True)

    @property
    def whole(self) -> bool:
        """It can be typed as it stands."""
        return self.typed and not OPEN.search(self.text.split(" #")[0])


def commands_of(page: Path) -> list[Command]:
    """What a page tells to type: lines of its blocks, and code in its sentences."""
    text = page.read_text(encoding="utf-8")
    blocks = re.findall(r"^ *```(\w*)\n(.*?)^ *```", text, re.DOTALL | re.MULTILINE)
    fenced = [block for language, block in blocks if language in SHELL]
    indented = re.findall(r"^ {4}(\S.*)$", re.sub(r"```.*?```", "", text, flags=re.DOTALL), re.MULTILINE)
    typed = [line.strip() for block in fenced for line in block.replace("\\\n", " ").splitlines()] + indented
    inline = [
        " ".join(code.split())
        for code in re.findall(r"`([^`]+)`", re.sub(r"```.*?```", "", text, flags=re.DOTALL))
    ]
    both = [Command(page.name, line, True) for line in typed] + [
        Command(page.name, line, False) for line in inline
    ]
    return [command for command in both if command.text]


class _Caught(Exception):
    """The parser that a tool reads its command line with."""


def parser_of(tool: str) -> argparse.ArgumentParser:
    """The parser of a tool, caught when it is about to read."""
    module = importlib.import_module(f"doormill_ros.tools.{tool}")
    original = argparse.ArgumentParser.parse_args

    def catch(self: argparse.ArgumentParser, *_: object, **__: object) -> None:
        raise _Caught(self)

    argparse.ArgumentParser.parse_args = catch  # type: ignore[method-assign]
    try:
        module.main([])
    except _Caught as caught:
        parser: argparse.ArgumentParser = caught.args[0]
        return parser
    finally:
        argparse.ArgumentParser.parse_args = original  # type: ignore[method-assign]
    raise AssertionError(f"{tool} reads no command line")


def complaint(parser: argparse.ArgumentParser, command: Command) -> str:
    """What is wrong with a command for its tool; empty when nothing is."""
    words = [word for word in command.words[1:] if word not in ("||", "true", "&&", "&")]
    if command.whole:
        try:
            parser.parse_args(words)
        except SystemExit:
            return f"{command.page}: {command.text}: its tool refuses it"
        return ""
    for word in words:
        below = next((a.choices for a in parser._actions if isinstance(a, argparse._SubParsersAction)), None)
        if below and word in below:
            parser = below[word]
    known = {option for action in parser._actions for option in action.option_strings}
    unknown = set(re.findall(r"(?<![\w-])--[\w-]+", command.text)) - known
    return f"{command.page}: {command.text}: no option {', '.join(sorted(unknown))}" if unknown else ""
