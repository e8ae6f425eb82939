"""catalogue: the runs of one or several cells: list, export as columns, make anew from bags, say how long bags stay."""

from __future__ import annotations

import argparse
import os
import sys
import time
from datetime import UTC, datetime
from pathlib import Path

from doormill_ros.catalogue.database import ENVIRONMENT, Catalogue, Selection
from doormill_ros.catalogue.errors import BadRetentionError
from doormill_ros.catalogue.needs import monitor_folders
from doormill_ros.catalogue.rebuild import rebuild
from doormill_ros.catalogue.retention import Judged, Retention, judge, retain
from doormill_ros.catalogue.run import CatalogueRow
from doormill_ros.cell.output.inspection import outcome
from doormill_ros.errors import DoormillError
from doormill_ros.interrupts import interruptible
from doormill_ros.recipes.store.engine import check_file
from doormill_ros.tools.command_line import add_database, in_a_column, plain_text
from doormill_ros.tools.one_line_parser import OneLineParser
from doormill_ros.units import bytes_to_gigabytes, m_to_mm, ns_to_s, s_to_ns

FAILED, PARTLY = 2, 1
LARGEST = 2**63 - 1
LISTED = "run\tdoor\tbegun\toutcome\trecipe\tmodel\tversion\tsoftware\tdeviation_mm\tinspection\tkept\tbag\tbag_bytes"


def _time(text: str) -> int:
    """A time or a date, UTC unless it says otherwise [ns since the epoch]."""
    try:
        moment = datetime.fromisoformat(text)
        stamp_ns = s_to_ns((moment if moment.tzinfo else moment.replace(tzinfo=UTC)).timestamp())
        # No run lies beyond what a database's whole numbers hold.
        return max(-LARGEST, min(stamp_ns, LARGEST))
    except (ValueError, OverflowError):
        raise argparse.ArgumentTypeError(
            f"found {text!r}, allowed is a date or time as 2026-11-22T08:00"
        ) from None


def parser() -> argparse.ArgumentParser:
    """The command line."""
    top = OneLineParser(prog="catalogue", description=__doc__)
    add_database(top, ENVIRONMENT)
    commands = top.add_subparsers(dest="command", required=True)
    for name, purpose in (("list", "a line a run"), ("export", "write the runs as columns")):
        command = commands.add_parser(name, help=purpose)
        if name == "export":
            command.add_argument("--parquet", type=Path, metavar="FILE", required=True, help="to write")
        command.add_argument("--door", type=plain_text, default="", metavar="ID", help="only this door")
        command.add_argument("--since", type=_time, metavar="TIME", help="only runs begun from then on, UTC")
        command.add_argument("--until", type=_time, metavar="TIME", help="only runs begun before then, UTC")
        command.add_argument("--failed", action="store_true", help="only runs that did not end well")
    command = commands.add_parser("rebuild", help="put what lies in folders into the catalogue")
    command.add_argument(
        "folders", nargs="+", type=Path, metavar="DIR", help="bags and inspections at any depth"
    )
    command = commands.add_parser("keep", help="keep the bags of runs for ever")
    command.add_argument("runs", nargs="+", type=plain_text, metavar="RUN")
    reason = command.add_mutually_exclusive_group()
    reason.add_argument("--reason", type=plain_text, default="by hand", help="why")
    reason.add_argument("--release", action="store_true", help="no longer")
    command = commands.add_parser("retain", help="delete the bags whose time is over")
    command.add_argument("--days", type=float, help="older ones go")
    command.add_argument("--gigabytes", type=float, help="the oldest go while there are more")
    command.add_argument(
        "--inspections",
        type=Path,
        action="append",
        metavar="DIR",
        help="inspections below it keep their bags; may be given again; by default where /model_monitor keeps them",
    )
    command.add_argument("--dry-run", action="store_true", help="only say which")
    return top


@interruptible
def main(argv: list[str] | None = None) -> int:
    """Run the tool.

    Returns:
        0; 1 when `rebuild` refused a bag or an inspection, or `retain` could not delete or read a bag; 2 with one line
        on stderr when nothing could be done.
    """
    arguments = parser().parse_args(argv)
    try:
        named = arguments.database or os.environ.get(ENVIRONMENT)
        if named and arguments.command != "rebuild":
            check_file(named)
        with Catalogue(arguments.database) as catalogue:
            return COMMANDS[arguments.command](catalogue, arguments)
    except DoormillError as error:
        print(f"catalogue: {error.message}", file=sys.stderr)
        return FAILED
    except BrokenPipeError:
        sys.stderr.close()  # the reader, such as head, has had enough
        return 0
    except OSError as error:
        print(f"catalogue: {error}", file=sys.stderr)
        return FAILED


def _selection(arguments: argparse.Namespace) -> Selection:
    return Selection(arguments.door, "", arguments.since, arguments.until, arguments.failed)


def _list(catalogue: Catalogue, arguments: argparse.Namespace) -> int:
    print(LISTED)
    for row in catalogue.rows(_selection(arguments)):
        print(_line(row))
    return 0


def _line(row: CatalogueRow) -> str:
    run = row.run
    begun = "" if run.begun_ns is None else _moment(run.begun_ns)
    ended = run.success is not None
    came_to = outcome(bool(run.success), run.error_code, run.measured) if ended else "not ended"
    deviation = "" if run.deviation is None else f"{m_to_mm(run.deviation):.3f}"
    recipe = f"{run.recipe_version} {run.recipe_digest[:12]}" if run.recipe_digest else ""
    inspection = "" if row.inspection is None else row.inspection.inspection
    places = (deviation, inspection, row.kept, run.bag, str(run.bag_bytes))
    columns = (
        run.run_id,
        run.door_id,
        begun,
        came_to,
        recipe,
        run.robot_model,
        run.model_version,
        run.software,
        *places,
    )
    return "\t".join(map(in_a_column, columns))


def _moment(stamp_ns: int) -> str:
    return datetime.fromtimestamp(ns_to_s(stamp_ns), UTC).strftime("%Y-%m-%dT%H:%M:%SZ")


def _export(catalogue: Catalogue, arguments: argparse.Namespace) -> int:
    # The library of columns takes as long to import as everything else here.
    from doormill_ros.catalogue.columns import write_columns

    count = write_columns(arguments.parquet, catalogue.rows(_selection(arguments)))
    print(f"wrote {count} runs to {arguments.parquet}")
    return 0


def _rebuild(catalogue: Catalogue, arguments: argparse.Namespace) -> int:
    runs = refused = 0
    for filled in rebuild(catalogue, arguments.folders):
        runs += filled.runs
        if filled.refused:
            refused += 1
            print(f"catalogue: {filled.refused}", file=sys.stderr)
    print(f"{runs} runs are in the catalogue {catalogue.url}; {refused} bags or inspections were refused")
    return PARTLY if refused else 0


def _keep(catalogue: Catalogue, arguments: argparse.Namespace) -> int:
    catalogue.keep(arguments.runs, "" if arguments.release else arguments.reason or "by hand")
    return 0


def _retain(catalogue: Catalogue, arguments: argparse.Namespace) -> int:
    retention, now_ns = Retention(arguments.days, arguments.gigabytes), s_to_ns(time.time())
    gone = size = kept = failed = 0
    dry, places = arguments.dry_run, arguments.inspections or monitor_folders()
    missing = next((place for place in places if not place.is_dir()), None)
    if missing is not None:
        raise BadRetentionError(
            f"found no folder {missing} with inspections, allowed is one that is there; no bag went",
            path=str(missing),
        )
    for judged in (judge if dry else retain)(catalogue, retention, now_ns, places):
        gone, size = gone + judged.goes, size + judged.goes * judged.size
        kept += not judged.goes
        if judged.failed:
            failed += 1
            print(in_a_column(f"catalogue: bag {judged.bag} stays: {judged.reason}"), file=sys.stderr)
        elif judged.reason:
            print(_judged(judged, dry))
    verb = "would go" if dry else "went"
    print(f"{gone} bags with {bytes_to_gigabytes(size):.3f} GB {verb}, {kept} stay")
    return PARTLY if failed else 0


def _judged(judged: Judged, dry: bool) -> str:
    word = ("would go" if dry else "went") if judged.goes else "stays"
    columns = (word, judged.bag, _moment(judged.begun_ns), judged.size, judged.reason)
    return "\t".join(map(in_a_column, columns))


COMMANDS = {"list": _list, "export": _export, "rebuild": _rebuild, "keep": _keep, "retain": _retain}

if __name__ == "__main__":
    sys.exit(main())
