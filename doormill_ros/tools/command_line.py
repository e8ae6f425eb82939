"""What the tools' command lines share."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import NoReturn

from rich.console import Console
from rich.progress import Progress


class OneLineParser(argparse.ArgumentParser):
    """Complains of a wrong command line in one line and with status 2."""

    def error(self, message: str) -> NoReturn:
        """Leave with the complaint."""
        self.exit(2, f"{self.prog}: {message}\n")


def add_database(parser: argparse.ArgumentParser, variable: str) -> None:
    """The option that names a database, which an environment variable names too."""
    parser.add_argument(
        "--database",
        metavar="URL",
        help="sqlite:///FILE, a file name, or postgresql://USER:PASSWORD@HOST/NAME; "
        f"default is ${variable}, else a SQLite file in the site's folder",
    )


@contextmanager
def counted(what: str, total: int) -> Iterator[Callable[[int], None]]:
    """A bar on the terminal for the time that something takes; gives what is called with how much more is done."""
    bar = Progress(console=Console(stderr=True), transient=True, redirect_stdout=sys.stdout.isatty())
    with bar:
        task = bar.add_task(what, total=total)
        yield lambda more: bar.advance(task, more)
