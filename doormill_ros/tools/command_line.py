"""What the tools' command lines share."""

from __future__ import annotations

import argparse
import getpass
import sys
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path

from rich.console import Console
from rich.progress import Progress

from doormill_ros.files import is_same


def add_database(parser: argparse.ArgumentParser, variable: str) -> None:
    """The option that names a database, which an environment variable names too."""
    parser.add_argument(
        "--database",
        metavar="URL",
        help="sqlite:///FILE, a file name, or postgresql://USER:PASSWORD@HOST/NAME; "
        f"default is ${variable}, else a SQLite file in the site's folder",
    )


def written_over(outputs: Iterable[Path], inputs: Iterable[Path]) -> str:
    """What to say of an output that is one of the inputs, or another output too; empty where none is."""
    known = [(path, "is read as well") for path in inputs]
    for path in outputs:
        for other, what in known:
            if is_same(path, other):
                return f"{path} is to be written and {what}, allowed is a file of its own; give another name"
        known.append((path, "is named twice for that"))
    return ""


def plain_text(text: str) -> str:
    """The type of an argument that a database is asked for or keeps."""
    try:
        text.encode()
    except UnicodeEncodeError:
        raise argparse.ArgumentTypeError(f"found {text!r}, allowed is text in UTF-8") from None
    return text


def in_a_column(text: object) -> str:
    """As it stands in a line of columns: what would end one of them, or order the terminal, is written out."""
    return "".join(
        letter if letter.isprintable() else letter.encode("unicode_escape").decode() for letter in str(text)
    )


def user_name() -> str:
    """Name of the user, for what is stored with an author."""
    try:
        return getpass.getuser()
    except (KeyError, OSError):  # a user id without a name, as in some containers
        return "unknown"


@contextmanager
def counted(what: str, total: int) -> Iterator[Callable[[int], None]]:
    """A bar on the terminal for the time that something takes; gives what is called with how much more is done."""
    bar = Progress(console=Console(stderr=True), transient=True, redirect_stdout=sys.stdout.isatty())
    with bar:
        task = bar.add_task(what, total=total)
        yield lambda more: bar.advance(task, more)
