"""restore: put what `backup` wrote into place; what was there is kept in the site's folder `replaced`."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from doormill_ros.backup.archive import read_archive
from doormill_ros.backup.restore import restore, take_back
from doormill_ros.backup.site import alone
from doormill_ros.errors import DoormillError
from doormill_ros.interrupts import interruptible
from doormill_ros.tools.one_line_parser import OneLineParser
from doormill_ros.tools.site_options import add_site, chosen_site


def parser() -> argparse.ArgumentParser:
    """The command line."""
    top = OneLineParser(prog="restore", description=__doc__)
    top.add_argument("file", type=Path, help="what `backup` wrote")
    top.add_argument("--check", action="store_true", help="read it to its end, change nothing")
    add_site(top)
    return top


@interruptible
def main(argv: list[str] | None = None) -> int:
    """Run the tool.

    Returns:
        0; 2 with one line on stderr when nothing was changed.
    """
    options = parser().parse_args(argv)
    try:
        backup = read_archive(options.file)
        if options.check:
            print(f"{options.file} is whole: made {backup.head.made} by release {backup.head.release}")
            return 0
        site, database = chosen_site(options)
        with alone(site):
            if take_back(site, database):
                print("restore: a restore that was cut off was taken back first", file=sys.stderr)
            kept = restore(backup, site, database)
    except DoormillError as error:
        print(f"restore: {' '.join(str(error).split())}", file=sys.stderr)
        return 2
    print(f"{site} is as it was at {backup.head.made}; what was there until now is in {kept}")
    print("restart the nodes: they read configuration and models when they are configured")
    return 0


if __name__ == "__main__":
    sys.exit(main())
