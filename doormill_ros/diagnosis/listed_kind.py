"""What is known of a kind of data before it is made, and its options of the command line."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from doormill_ros.diagnosis.core.kind import Kind


@dataclass(frozen=True)
class FurtherOption:
    """An option that goes with that of a kind, and tells the kind something.

    Attributes:
        name: Of the argument that the kind takes; with dashes on the command line.
        metavar: Its value in the help.
        help: What it is for.
        read: Makes the argument of the text that was given.
        allowed: Numbers that it may be; None: whatever was read.
    """

    name: str
    metavar: str
    help: str
    read: Callable[[str], Any] = str
    allowed: range | None = None

    @property
    def flag(self) -> str:
        """As it is given."""
        return f"--{self.name.replace('_', '-')}"


@dataclass(frozen=True)
class ListedKind:
    """What is known of a kind of data before it is made.

    Attributes:
        schema: Of set.yaml; `--data` takes folders with it.
        make: Imports and makes it; what a kind can be told goes in.
        option: Of the command line, without dashes, where the kind has one of its own; else empty.
        help: What that option takes.
        further: What goes with that option.
    """

    schema: str
    make: Callable[..., Kind[Any, Any]]
    option: str = ""
    help: str = ""
    further: tuple[FurtherOption, ...] = ()

    def add_option(self, parser: argparse._ActionsContainer) -> None:
        """Let a command line take the kind's own option, where it has one."""
        if self.option:
            parser.add_argument(f"--{self.option}", metavar="DIR", type=Path, help=self.help)

    def add_further(self, parser: argparse._ActionsContainer) -> None:
        """Let it take what goes with that option."""
        for one in self.further:
            about = f"of --{self.option}: {one.help}"
            parser.add_argument(one.flag, dest=one.name, metavar=one.metavar, type=one.read, help=about)

    def folder(self, chosen: argparse.Namespace) -> Path | None:
        """What the kind's own option was given, None where it was not."""
        given: Path | None = getattr(chosen, self.option) if self.option else None
        return given

    def refusal(self, chosen: argparse.Namespace) -> str | None:
        """Why what was given with its options is of no use, None where it is."""
        told = self._told(chosen)
        if told and self.folder(chosen) is None:
            flags = " or ".join(one.flag for one in self.further)
            return f"{flags} was given without --{self.option}; leave it out"
        for one in self.further:
            if one.allowed is not None and one.name in told and told[one.name] not in one.allowed:
                low, high = one.allowed[0], one.allowed[-1]
                return f"{one.flag} is {told[one.name]}, allowed are {low} to {high}"
        return None

    def made(self, chosen: argparse.Namespace) -> Kind[Any, Any]:
        """The kind, told what was given with its options."""
        return self.make(**self._told(chosen))

    def _told(self, chosen: argparse.Namespace) -> dict[str, Any]:
        values = {one.name: getattr(chosen, one.name) for one in self.further}
        return {name: value for name, value in values.items() if value is not None}
