"""The parser of every tool's command line."""

from __future__ import annotations

import argparse
import re
from typing import NoReturn

_NAMESPACE = re.compile(r"(/[A-Za-z_][A-Za-z0-9_]*)+")


class OneLineParser(argparse.ArgumentParser):
    """Complains of a wrong command line in one line and with status 2."""

    def error(self, message: str) -> NoReturn:
        """Leave with the complaint."""
        self.exit(2, f"{self.prog}: {message}\n")


def namespace(text: str) -> str:
    """A ROS namespace of a command line, with its first slash and without a last one; empty for none.

    Raises:
        argparse.ArgumentTypeError: It is none.
    """
    full = f"/{text.strip('/')}" if text.strip("/") else ""
    if full and not _NAMESPACE.fullmatch(full):
        raise argparse.ArgumentTypeError(
            f"found {text!r}, allowed are slashes with names of letters, digits and _: /cell1"
        )
    return full
