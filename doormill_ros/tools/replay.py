"""Tool `replay`: give a recorded run's inputs to the code again and compare what it answers."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from doormill_ros.errors import DoormillError

EQUAL, DIFFERENT, UNREADABLE = 0, 1, 2


def _rate(text: str) -> float:
    rate = float("inf") if text == "max" else float(text)
    if not rate > 0.0:
        raise argparse.ArgumentTypeError(f"rate is {text}, allowed are numbers above 0 and 'max'")
    return rate


def parse(arguments: list[str] | None) -> argparse.Namespace:
    """Read the command line."""
    parser = argparse.ArgumentParser(prog="replay", description=__doc__)
    parser.add_argument("bags", metavar="BAG", type=Path, nargs="+", help="bag folder of one or more runs")
    parser.add_argument("--live", action="store_true", help="send the inputs to the nodes over DDS")
    parser.add_argument("--rate", type=_rate, default=1.0, help="of --live: times recorded speed, or max")
    parser.add_argument("--update", action="store_true", help="let today's answers be the expectation")
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
    return options


def _replay(bag: Path, options: argparse.Namespace) -> int:
    from doormill_ros.recording.replay.expectation import write_expectation
    from doormill_ros.recording.replay.offline import OfflineOptions, replay_offline
    from doormill_ros.recording.replay.replay import replay_bag

    if options.live:
        from doormill_ros.nodes.live_replay import SLACK, LiveOptions, replay_live
        from doormill_ros.recording.replay.answer import STAGES

        live = LiveOptions(options.rate, options.robot_model, options.database)
        outcome = replay_bag(bag, lambda run: replay_live(run, live), STAGES, SLACK)
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
        path = write_expectation(bag, outcome.answers)
        print(f"{bag}: {len(outcome.found)} fields changed, {path} written")
        return EQUAL
    if not outcome.found:
        runs = "1 run" if len(outcome.answers) == 1 else f"{len(outcome.answers)} runs"
        print(f"{bag}: {runs}, {f'equal: {counts}' if counts else 'nothing compared'}")
    for left_out in outcome.left_out:
        print(f"{bag}: not compared: {left_out}")
    return DIFFERENT if outcome.found else EQUAL


def main(arguments: list[str] | None = None) -> int:
    """Replay; 0 when everything is equal, 1 when something differs, 2 when a bag cannot be replayed."""
    options = parse(arguments)
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
