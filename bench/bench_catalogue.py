"""What a bag of a hinge door costs to replay among many, which share of the cores is used, what a row costs."""

from __future__ import annotations

import os
import shutil
import statistics
import tempfile
import time
from pathlib import Path

from doormill_ros.catalogue.database import Catalogue
from doormill_ros.catalogue.rebuild import rebuild
from doormill_ros.parallel.each import each
from doormill_ros.parallel.workplace import Workplace
from doormill_ros.recording.replay.bag_verdict import judge_bag
from harness import Entry, entry, limit

ROOT = Path(__file__).resolve().parents[1]
BAG = ROOT / "bags" / "thesis_190_0deg"
BAGS = int(os.environ.get("DOORMILL_BENCH_BAGS", "120"))
IDLE = 0.2  #: share of the cores that may be left unused
WORKERS = 4  #: that the cost is carried to, on paper


def processor_times() -> tuple[float, float]:
    """What this process group and what the whole machine have computed so far [s]."""
    tick = os.sysconf("SC_CLK_TCK")
    ours = 0
    for path in Path("/proc").glob("[0-9]*/stat"):
        try:
            fields = path.read_text().rpartition(")")[2].split()
        except OSError:
            continue  # it has ended meanwhile
        if int(fields[2]) == os.getpgrp():
            ours += int(fields[11]) + int(fields[12])
    user, nice, system, _, _, *interrupts = map(
        int, Path("/proc/stat").read_text().split("\n")[0].split()[1:9]
    )
    return ours / tick, (user + nice + system + sum(interrupts)) / tick


def share_of_cores(bags: list[str]) -> list[Entry]:
    """Processor time of the replays over what other programs left of the cores, between first and last answer."""
    cores = len(os.sched_getaffinity(0))
    seconds: list[float] = []
    begun, before = 0.0, (0.0, 0.0)
    for answer in each(judge_bag, bags, Workplace()):
        assert answer.value is not None, answer.reason
        assert answer.value.equal, answer.value.first
        now, after = time.perf_counter(), processor_times()
        # The first answer of each worker has its start in it.
        if len(seconds) < cores:
            begun, before = now, after
        seconds.append(answer.seconds)
    wall, counted = now - begun, seconds[cores:]
    ours, machine = (b - a for a, b in zip(before, after, strict=True))
    left = wall * cores - max(0.0, machine - ours)
    name = f"{len(bags)} bags of a hinge door replayed on {cores} cores"
    cost, others = statistics.median(counted), len(bags)
    print(f"{name}: others took {machine - ours:.1f} s of {wall * cores:.1f} s, replays {sum(counted):.1f} s")
    return [
        limit(f"{name}, share left unused of what others left", 1.0 - sum(counted) / left, "", IDLE, others),
        entry(f"{name}, processor time a bag", cost, "s", "wall time a bag", wall / len(counted), others),
        entry(
            f"on paper, 1000 such bags by {WORKERS} workers",
            1000 / WORKERS * cost,
            "s",
            "by one",
            1000 * cost,
            others,
        ),
    ]


def rows(folder: Path) -> list[Entry]:
    """Rebuilding the catalogue from the bags, in one process."""
    with Catalogue(str(folder / "catalogue.sqlite")) as catalogue:
        begun = time.process_time()
        count = sum(1 for found in rebuild(catalogue, [folder]) if not found.refused)
        cost = (time.process_time() - begun) / count
    return [limit("catalogue rebuilt from bags of a hinge door, a bag", cost, "s", 1.0, count)]


def run() -> list[Entry]:
    with tempfile.TemporaryDirectory(prefix="doormill_bench_") as name:
        folder = Path(name)
        bags = [str(shutil.copytree(BAG, folder / f"{number:04d}" / "bag")) for number in range(BAGS)]
        return share_of_cores(bags) + rows(folder)
