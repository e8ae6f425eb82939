"""backup: put recipes, configuration, models, accepted bags and audit log of a site into one file; cells go on."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from doormill_ros.backup.restore import take_back
from doormill_ros.backup.site import alone, make_backup
from doormill_ros.errors import DoormillError
from doormill_ros.interrupts import interruptible
from doormill_ros.tools.one_line_parser import OneLineParser
from doormill_ros.tools.site_options import add_site, chosen_site


def parser() -> argparse.ArgumentParser:
    """The command line."""
    top = OneLineParser(prog="backup", description=__doc__)
    top.add_argument("file", type=Path, help="file to write, such as doormill.tar; must not be there yet")
    add_site(top)
    return top


@interruptible
def main(argv: list[str] | None = None) -> int:
    """Run the tool.

    Returns:
        0; 2 with one line on stderr when there is no backup.
    """
    options = parser().parse_args(argv)
    try:
        site, database = chosen_site(options)
        with alone(site):
            if take_back(site, database):
                print("backup: a restore that was cut off was taken back first", file=sys.stderr)
            made = make_backup(site, database, options.file)
    except DoormillError as error:
        print(f"backup: {' '.join(str(error).split())}", file=sys.stderr)
        return 2
    kind = made.head.database or "no database"
    print(
        f"{options.file}: {options.file.stat().st_size} bytes, {len(made.digests) - 1} files, {kind}, of {site}"
    )
    return 0


if __name__ == "__main__":
    sys.exit(main())
