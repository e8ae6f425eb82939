"""Tool `replay`: give a recorded run's inputs to the code again and compare what it answers."""

from __future__ import annotations

import argparse
import sys
from functools import partial
from pathlib import Path

from doormill_ros.errors import DoormillError
from doormill_ros.interrupts import interruptible
from doormill_ros.recording.accepted import accept_bag, accepted_bags
from doormill_ros.recording.errors import AcceptedBagError
from doormill_ros.tools.command_line import counted, in_a_column
from doormill_ros.tools.one_line_parser import OneLineParser

EQUAL, DIFFERENT, UNREADABLE = 0, 1, 2
WORDS = EQUAL_WORD, UNCOMPARED_WORD, DIFFERENT_WORD, UNREADABLE_WORD = (
    "equal",
    "not compared",
    "differs",
    "unreadable",
)


def _rate(text: str) -> float:
    rate = float("inf") if text == "max" else float(text)
    if not rate > 0.0:
        raise argparse.ArgumentTypeError(f"rate is {text}, allowed are numbers above 0 and 'max'")
    return rate


def parse(arguments: list[str] | None) -> argparse.Namespace:
    """Read the command line."""
    parser = OneLineParser(prog="replay", description=__doc__)
    parser.add_argument(
        "bags",
        metavar="BAG",
        type=Path,
        nargs="*",
        help="bag folder of one or more runs; without any: the accepted bags of the site",
    )
    parser.add_argument(
        "--many",
        action="store_true",
        help="every bag in these folders, by as many processes as there are cores",
    )
    parser.add_argument("--workers", type=int, metavar="N", help="of --many: processes")
    parser.add_argument(
        "--scheduler",
        default="",
        metavar="ADDRESS",
        help="of --many: workers of a Dask scheduler, tcp://HOST:8786",
    )
    parser.add_argument("--live", action="store_true", help="send the inputs to the nodes over DDS")
    parser.add_argument("--rate", type=_rate, help="of --live: times recorded speed, or max; default: 1")
    parser.add_argument("--update", action="store_true", help="let today's answers be the expectation")
    parser.add_argument(
        "--accept",
        action="store_true",
        help="copy what is equal to the accepted bags of the site, which today's software must still reproduce",
    )
    parser.add_argument("--all", action="store_true", help="tell every difference, not only the first")
    parser.add_argument(
        "--robot-model",
        default="",
        metavar="YAML",
        help="model.yaml of a diagnosis instead of the recorded one",
    )
    parser.add_argument(
        "--database", default="", metavar="URL", help="recipe database to ask for unknown doors"
    )
    options = parser.parse_args(arguments)
    if options.live and options.update:
        parser.error("--update compares offline; leave out --live")
    if not options.live and options.rate is not None:
        parser.error("--rate belongs to --live: add it")
    if not options.many and (options.workers is not None or options.scheduler):
        parser.error("--workers and --scheduler belong to --many: add it")
    if options.many and (options.live or options.update or options.all):
        parser.error("--many tells a line a bag: leave out --live, --update and --all")
    if options.accept and (options.many or options.update):
        parser.error("--accept copies bags that are equal as they are: leave out --many and --update")
    if options.accept and not options.bags:
        parser.error("--accept wants the bags that are to be accepted: name them")
    if options.workers is not None and (options.workers < 1 or options.scheduler):
        parser.error("--workers is a positive number of processes here; leave it out with --scheduler")
    options.workers = options.workers or 0  # as many as there are cores
    options.rate = options.rate or 1.0
    return options


def _replay(bag: Path, options: argparse.Namespace) -> int:
    from doormill_ros.recording.replay.expectation import write_expectation
    from doormill_ros.recording.replay.offline import OfflineOptions, replay_offline
    from doormill_ros.recording.replay.replay import replay_bag

    if options.live:
        from doormill_ros.nodes.replay.live_replay import SLACK, LiveOptions, replay_live
        from doormill_ros.recording.replay.live import LIVE_STAGES

        live = LiveOptions(options.rate, options.robot_model, options.database)
        outcome = replay_bag(bag, lambda run: replay_live(run, live), LIVE_STAGES, SLACK)
    else:
        chosen = OfflineOptions(robot_model=options.robot_model, database=options.database)
        outcome = replay_bag(bag, lambda run: replay_offline(run, chosen))
    counts = ", ".join(f"{count} of {topic}" for topic, count in outcome.counts.items())
    for difference in outcome.found if options.all or options.update else outcome.found[:1]:
        print(f"{bag}: {difference}")
    more = len(outcome.found) - 1
    if more > 0 and not (options.all or options.update):
        print(f"{bag}: {more} more fields differ (--all tells them)")
    if options.update:
        outcome.check_ended()
        path = write_expectation(bag, outcome.answers)
        print(f"{bag}: {len(outcome.found)} fields changed, {path} written")
        return EQUAL
    if outcome.answers and not outcome.found:
        runs = "1 run" if len(outcome.answers) == 1 else f"{len(outcome.answers)} runs"
        print(f"{bag}: {runs}, {f'equal: {counts}' if counts else 'nothing compared'}")
    for left_out in (*outcome.left_out, *outcome.unended):
        print(f"{bag}: not compared: {left_out}")
    if outcome.found:
        return DIFFERENT
    if outcome.unended:
        return UNREADABLE
    if options.accept:
        if not counts:
            raise AcceptedBagError(
                f"bag {bag} is not accepted: nothing of it can be compared; accept one of a run that got further"
            )
        print(f"{bag}: accepted as {accept_bag(bag, next(iter(outcome.answers)))}")
    return EQUAL


def _replay_many(options: argparse.Namespace) -> int:
    """A line a bag as it is done; 1 when anything differs, else 2 when a bag or the workers cannot be used."""
    from doormill_ros.parallel.each import each
    from doormill_ros.parallel.workplace import Workplace
    from doormill_ros.recipes.store.engine import absolute
    from doormill_ros.recording.bag_folders import bags_in
    from doormill_ros.recording.replay.bag_verdict import judge_bag
    from doormill_ros.recording.replay.offline import OfflineOptions

    # A worker may stand in another folder.
    bags = [str(bag.resolve()) for bag in bags_in(options.bags)]
    model = Path(options.robot_model)
    chosen = OfflineOptions(
        robot_model=str(model.absolute()) if options.robot_model and model.exists() else options.robot_model,
        database=absolute(options.database) if options.database else "",
    )
    place = Workplace(options.scheduler, options.workers)
    found = dict.fromkeys(WORDS, 0)
    print("verdict\tbag\truns\tcompared\tdiffering\tseconds\tfirst", flush=True)
    try:
        with counted("replaying", len(bags)) as done:
            for answer in each(partial(judge_bag, options=chosen), bags, place):
                verdict = answer.value
                if verdict is None:
                    word, numbers, first = (
                        UNREADABLE_WORD,
                        ("", "", ""),
                        f"{answer.reason} ({answer.error_code})",
                    )
                else:
                    word = EQUAL_WORD if verdict.equal else DIFFERENT_WORD
                    word = word if verdict.compared or verdict.differing else UNCOMPARED_WORD
                    numbers = (str(verdict.runs), str(verdict.compared), str(verdict.differing))
                    first = verdict.first
                found[word] += 1
                done(1)
                columns = (word, answer.thing, *numbers, f"{answer.seconds:.3f}", first)
                print("\t".join(map(in_a_column, columns)), flush=True)
    except DoormillError as error:
        print(f"replay: {error.message}", file=sys.stderr)
        return DIFFERENT if found[DIFFERENT_WORD] else UNREADABLE
    print(
        f"replay: {len(bags)} bags: " + ", ".join(f"{n} {word}" for word, n in found.items()), file=sys.stderr
    )
    return DIFFERENT if found[DIFFERENT_WORD] else UNREADABLE if found[UNREADABLE_WORD] else EQUAL


@interruptible
def main(arguments: list[str] | None = None) -> int:
    """Replay; 0 when all is equal, 1 when something differs, 2 when a bag or a run cannot be replayed."""
    options = parse(arguments)
    try:
        options.bags = options.bags or accepted_bags()
        if options.database:
            from doormill_ros.recipes.store.engine import check_file

            check_file(options.database)
        if options.robot_model:
            from doormill_ros.pipeline.plan import load_setup

            # Every bag would differ for it.
            load_setup(model=options.robot_model)
    except DoormillError as error:
        print(f"replay: {error.message}", file=sys.stderr)
        return UNREADABLE
    if options.many:
        return _replay_many(options)
    status = EQUAL
    for bag in options.bags:
        try:
            status = max(status, _replay(bag, options))
        except DoormillError as error:
            print(f"replay: {error.message}", file=sys.stderr)
            status = UNREADABLE
    return status


if __name__ == "__main__":
    sys.exit(main())
