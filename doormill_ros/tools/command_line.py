"""What the tools' command lines share."""

from __future__ import annotations

import argparse
from typing import NoReturn


class OneLineParser(argparse.ArgumentParser):
    """Complains of a wrong command line in one line and with status 2."""

    def error(self, message: str) -> NoReturn:
        """Leave with the complaint."""
        self.exit(2, f"{self.prog}: {message}\n")
