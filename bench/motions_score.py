"""Score the diagnosis of moving joints on seeded recordings with hidden effects, and on measured ones by each other.

    python bench/motions_score.py --sets 200

The recordings come from a simulated gear train that shares no law with the diagnosis (test/support/motion_world.py).
Every tenth hides nothing, others an effect below the noise, several at once, or one that no cause of the library names.
"""

from __future__ import annotations

import argparse
import logging
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(ROOT), str(ROOT / "test")]

from doormill_ros.diagnosis.motion.account import check_set, named_causes  # noqa: E402
from doormill_ros.diagnosis.motion.diagnosis import diagnose_motions  # noqa: E402
from doormill_ros.measurements.sets.motion_set import MotionSet, read_motion_set  # noqa: E402
from support.motion_world import FOREIGN, LIBRARY, Recording, hide, record  # noqa: E402

DATA = ROOT / "test" / "data" / "kr300"
KINDS = ("single", "single", "pair", "small", "none", "foreign", "single", "late", "three", "mixed")
#: Causes of what follows the speed: two of them in one joint may cancel.
BY_SPEED = ("time_skew", "joint_damping")
#: Size in standard deviations of the link encoder from which an effect has to be named.
DETECTABLE = 2.0


@dataclass(frozen=True)
class Outcome:
    """One recording: what was hidden, what was said."""

    seed: int
    kind: str
    hidden: tuple[tuple[str, str], ...]
    size: float
    verdict: str
    named: tuple[tuple[str, str], ...]
    wrong: tuple[tuple[str, str], ...]
    missed: tuple[tuple[str, str], ...]
    ratio: float
    seconds: float


def draw(seed: int) -> tuple[str, Recording, list[tuple[str, str]], list[tuple[str, str]], float]:
    """Kind, recording, its library effects and all its effects by name and place, and their size."""
    rng = np.random.default_rng([seed, 31])
    kind = KINDS[seed % len(KINDS)]
    hidden = Recording(
        dropped=float(rng.choice([0.0, 0.0, 0.02])), stated=bool(rng.uniform() < 0.7), seconds=10.0
    )
    size = float(np.exp(rng.uniform(np.log(DETECTABLE), np.log(15.0))))
    if kind == "small":
        size = float(rng.uniform(0.1, 1.0))
    first = LIBRARY[(seed + seed // len(KINDS)) % len(LIBRARY)]
    effects = {
        "single": [first],
        "small": [first],
        "none": [],
        "late": ["late clock"],
        "pair": [first, str(rng.choice([one for one in LIBRARY if one != first]))],
        "three": [
            "late clock",
            *rng.choice([one for one in LIBRARY if one not in BY_SPEED], 2, replace=False),
        ],
        "foreign": [FOREIGN[(seed // len(KINDS)) % len(FOREIGN)]],
        "mixed": [first, FOREIGN[(seed // len(KINDS)) % len(FOREIGN)]],
    }[kind]
    known: list[tuple[str, str]] = []
    every: list[tuple[str, str]] = []
    for effect in effects:
        joint = int(rng.integers(2 if effect == "hardening" else 1, 4))  # nothing hardens without load
        hidden, key, _ = hide(rng, hidden, str(effect), joint, size)
        every.append(key)
        if key[0] in LIBRARY:
            known.append(key)
    return kind, hidden, known, every, size if effects else 0.0


def judge(seed: int, folder: Path) -> Outcome:
    """Record, diagnose, compare."""
    kind, hidden, known, every, size = draw(seed)
    data = read_motion_set(record(folder / str(seed), hidden, seed))
    start = time.perf_counter()
    diagnosis = diagnose_motions([data])
    open_ = list(known)
    named, wrong = [], []
    for cause in named_causes(diagnosis):
        key = (cause.cause, cause.where)
        named.append(key)
        keys = [key, *((double.cause.name, double.cause.where) for double in cause.doubles)]
        match = next((one for one in keys if one in open_), None)
        if match is None:
            wrong.append(key)
        else:
            open_.remove(match)
    left = np.sqrt(np.mean([one.problem.rmse(one.extended.held_out) ** 2 for one in diagnosis.joints]))
    return Outcome(
        seed,
        kind,
        tuple(every),
        size,
        diagnosis.verdict,
        tuple(named),
        tuple(wrong),
        tuple(key for key in open_ if _shows(key, data)) if size >= DETECTABLE and kind != "mixed" else (),
        float(left / diagnosis.noise_floor),
        time.perf_counter() - start,
    )


def _shows(key: tuple[str, str], data: MotionSet) -> bool:
    """Whether a recording holds what an effect needs: play shows where the torque changes its sign."""
    if key[0] != "joint_backlash":
        return True
    torque = next(one.torque for one in data.motions if key[1] == f"joint {one.joint}")
    return bool(0.1 < np.mean(torque > 0.0) < 0.9)


def campaign(sets: int, first: int = 0) -> list[Outcome]:
    """Draw, diagnose and judge recordings; what is not right is printed."""
    outcomes = []
    with tempfile.TemporaryDirectory() as folder:
        for seed in range(first, first + sets):
            one = judge(seed, Path(folder))
            outcomes.append(one)
            if one.wrong or one.missed:
                print(
                    f"set {seed} ({one.kind}, {one.size:.1f} sigma): hidden {list(one.hidden)}; {one.verdict}: "
                    f"{list(one.named)}; WRONG {list(one.wrong)}, missed {list(one.missed)}",
                    flush=True,
                )
    return outcomes


def summary(outcomes: list[Outcome]) -> dict[str, float]:
    """The figures the diagnosis is held to."""
    known = [one for one in outcomes if one.hidden and one.kind not in ("foreign", "mixed")]
    detectable = [one for one in known if one.size >= DETECTABLE]
    nothing = [one for one in outcomes if not one.hidden]
    return {
        "motions: recordings": len(outcomes),
        "motions: wrong names": sum(len(one.wrong) for one in outcomes),
        "motions: recordings with effects to be named": len(detectable),
        "motions: all of them named, or listed beside the name": sum(not one.missed for one in detectable),
        "motions: recordings with nothing hidden": len(nothing),
        "motions: false alarms": sum(one.verdict != "consistent" for one in nothing),
        "motions: held-out over noise where explained, worst": max(
            (one.ratio for one in outcomes if one.verdict == "explained"), default=0.0
        ),
        "motions: seconds a recording": float(np.median([one.seconds for one in outcomes])),
    }


def measured() -> dict[str, str]:
    """Measured recordings, each judged by a model from the other: before and after by joint [urad]."""
    sets = {name: read_motion_set(DATA / name) for name in ("A", "B")}
    found = {}
    for train, other in (("A", "B"), ("B", "A")):
        entry = check_set(diagnose_motions([sets[train]]), sets[other])["by_joint"]
        for where, one in entry.items():
            figures = " -> ".join(f"{1e6 * one[key]:.0f}" for key in ("baseline", "extended"))
            found[f"KR 300 recording {other} by a model from {train}, {where} [urad]"] = figures
    return found


def main() -> int:
    """Run the campaign and print it."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--sets", type=int, default=200)
    parser.add_argument("--first", type=int, default=0, help="first seed")
    chosen = parser.parse_args()
    logging.disable(logging.WARNING)
    for name, value in summary(campaign(chosen.sets, chosen.first)).items():
        print(f"{name}: {value:.3f}" if isinstance(value, float) else f"{name}: {value}")
    for name, text in measured().items():
        print(f"{name}: {text}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
