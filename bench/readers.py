"""Bad files for every reader: `python bench/readers.py --runs 5000`.

Exit code 1 when one of them is neither read nor refused in one sentence that names the file and the place in it, takes
longer or more memory than allowed, changes a file, or is read otherwise in another spelling or when written again.
"""

from __future__ import annotations

import argparse
import logging
import sys
import tempfile
from collections import Counter
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "test"))

from rich.console import Console
from rich.table import Table

from support.hostile.campaign import judge
from support.hostile.readers import subjects

KINDS = ("read", "refused", "fault")


def main() -> int:
    """Run the campaign and print its table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--runs", type=int, default=5000, help="files in all")
    parser.add_argument("--only", default="", help="kinds of input whose name contains this")
    parser.add_argument("--seed", type=int, default=0, help="another number makes other files")
    arguments = parser.parse_args()
    logging.disable(logging.WARNING)
    table = Table("input", "read", "refused", "fault", title="Bad files")
    faults: list[str] = []
    totals = Counter[str]()
    with tempfile.TemporaryDirectory() as folder:
        chosen = [item for item in subjects(Path(folder) / "good") if arguments.only in item.name]
        runs = -(-arguments.runs // len(chosen))
        for item in chosen:
            outcome = judge(item, range(runs), f"{arguments.seed} ")
            table.add_row(item.name, *(str(outcome.answers[kind]) for kind in KINDS))
            totals.update(outcome.answers)
            faults += outcome.faults
    table.add_section()
    table.add_row(f"all {len(chosen)} inputs", *(str(totals[kind]) for kind in KINDS))
    console = Console(width=160)
    console.print(table)
    for fault in faults:
        console.print(fault, markup=False)
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
