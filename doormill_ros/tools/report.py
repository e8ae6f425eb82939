"""Tool `report`: an HTML page from a bag."""

from __future__ import annotations

import sys
from pathlib import Path

from doormill_ros.errors import DoormillError
from doormill_ros.interrupts import interruptible
from doormill_ros.tools.one_line_parser import OneLineParser


@interruptible
def main(arguments: list[str] | None = None) -> int:
    """Write the page; 2 when the bag cannot be read or the page not written."""
    parser = OneLineParser(prog="report", description=__doc__)
    parser.add_argument("bag", type=Path, help="bag folder of a run")
    parser.add_argument("--out", type=Path, help="page to write; default: report.html beside the bag")
    options = parser.parse_args(arguments)
    from doormill_ros.report.run_report import write_report

    page = options.out or options.bag.resolve().parent / "report.html"
    try:
        write_report(options.bag, page)
    except DoormillError as error:
        print(f"report: {error.message}", file=sys.stderr)
        return 2
    except OSError as error:
        print(
            f"report: {page} cannot be written, {error.strerror or error}; name another with --out",
            file=sys.stderr,
        )
        return 2
    print(page)
    return 0


if __name__ == "__main__":
    sys.exit(main())
