"""The cell as services of a booted system: `python bench/booted.py`, as root, with mmdebstrap and systemd-container.

Puts a Debian into a folder, builds the repository's last commit in its /opt/doormill, boots it with an init, a journal
and a network of its own, and installs the units by the very commands of docs/living.md. Then doors are milled, nodes
killed, the log read, a backup made, the system booted again. Exit code 1 when a check came out otherwise, 2 where no
system can be booted.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "test"))

from rich.console import Console
from rich.table import Table

from support.booted.campaign import play
from support.booted.machine import booted, missing
from support.source_tree import ROOT


def main() -> int:
    """Boot, live, print the table."""
    argparse.ArgumentParser(description=__doc__).parse_args()
    if hindrances := missing():
        print("\n".join(hindrances), file=sys.stderr)
        return 2
    console, begun = Console(width=150), time.monotonic()
    with (
        tempfile.TemporaryDirectory(prefix="booted-", ignore_cleanup_errors=True) as name,
        booted(Path(name), ROOT) as machine,
    ):
        system = machine.run(". /etc/os-release && echo $PRETTY_NAME && systemctl --version | head -1")
        checked = list(play(machine))
    title = f"Services on {', '.join(system.splitlines())}, {(time.monotonic() - begun) / 60.0:.1f} min"
    table = Table(title=title)
    table.add_column("what was wanted")
    table.add_column("came")
    for check in checked:
        table.add_row(check.what, "as wanted" if not check.instead else check.instead)
    table.add_row("came otherwise", str(sum(bool(check.instead) for check in checked)))
    console.print(table)
    return 1 if any(check.instead for check in checked) else 0


if __name__ == "__main__":
    sys.exit(main())
