"""Score the diagnosis on seeded sets with hidden effects: `python bench/diagnosis_score.py --sets 200`.

The effects are drawn and simulated by doormill_ros.simulation.truth, which shares no model code
with the diagnosis. Prints a confusion matrix and the figures the diagnosis is held to.
"""

from __future__ import annotations

import argparse
import logging
import sys
import tempfile
import time
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from scipy.stats import chi2

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "test"))

from doormill_ros.diagnosis.core.telling.account import parameters_of
from doormill_ros.diagnosis.loading.problem import LoadingDiagnosis
from doormill_ros.measurements.sets.measurement_set import read_measurement_set
from doormill_ros.robot.description import load_robot
from support.diagnoses import diagnose_set
from support.truth.hidden_effects import (
    FOREIGN_CAUSES,
    LIBRARY_CAUSES,
    draw_effect,
    effect_rms,
    scale_effect,
)
from support.truth.loading_test import (
    STYLES,
    Spoil,
    draw_plan,
    true_displacement,
    write_loading_test,
)

#: An effect this many times the noise (root mean square over all trials) has to be found.
DETECTABLE = 2.0
#: How close to the noise an explained set has to be predicted.
LIMIT = 1.1
#: Kinds of sets, in the order in which they are dealt.
KINDS = (
    "single",
    "single",
    "small",
    "pair",
    "single",
    "none",
    "few",
    "foreign",
    "outliers",
    "unknown",
    "single",
    "small",
    "foreign",
    "pair",
    "single",
    "mixed",
)


@dataclass
class Outcome:
    """One set: what was hidden, what was said.

    `ratio_to_floor` is the held-out residual over the stated noise, `ratio_to_drawn` over the noise that
    was really drawn, and `innocent_excess` the chance that the latter alone is 1.1 times the former. `listed` counts
    hidden causes that stand under `confusable_with` of the one that was named.
    """

    seed: int
    kind: str
    truth: list[dict]
    strength: float
    verdict: str
    named: list[tuple[str, str]]
    right: bool
    wrong: list[tuple[str, str]]
    ratio_to_floor: float
    ratio_to_drawn: float
    innocent_excess: float
    listed: int = 0
    covered: list[bool] = field(default_factory=list)
    misses: list[str] = field(default_factory=list)
    seconds: float = 0.0


def draw_set(folder: Path, seed: int, kind: str) -> tuple[list[dict], list[float], np.ndarray]:
    """Write one set; returns its effects, their strength over the noise, and the tracker noise drawn (n, 3)."""
    rng = np.random.default_rng([seed, 77])
    dh = load_robot("irb6600_175_255").dh
    trials = int(rng.integers(18, 40)) if kind == "few" else 120
    postures = int(rng.integers(5, 9)) if kind == "few" else int(rng.integers(8, 24))
    plan = draw_plan(rng, dh, trials, postures, style=int(rng.integers(len(STYLES))))
    size = rng.uniform(2.1, 3.0) if kind == "small" else float(np.exp(rng.uniform(np.log(3.0), np.log(20.0))))
    causes = []
    # Dealt in turn, so that a campaign meets every cause equally often.
    first = LIBRARY_CAUSES[(seed * 5 + seed // len(KINDS)) % len(LIBRARY_CAUSES)]
    if kind in ("single", "small", "few", "outliers"):
        causes = [first]
    elif kind == "unknown":
        causes = ["joint_backlash" if seed % 2 else first]
    elif kind == "pair":
        # Sensor gain and tracker scale multiply each other: one of them says it all.
        same = ("wrench_gain", "tracker_scale") if first in ("wrench_gain", "tracker_scale") else (first,)
        causes = [first, str(rng.choice([c for c in LIBRARY_CAUSES if c not in same]))]
    elif kind == "foreign":
        causes = [FOREIGN_CAUSES[(seed // 4) % len(FOREIGN_CAUSES)]]
    elif kind == "mixed":
        causes = [first, FOREIGN_CAUSES[(seed // 4) % len(FOREIGN_CAUSES)]]
    effects = [scale_effect(draw_effect(rng, plan, cause), plan, size * plan.noise[0]) for cause in causes]
    spoil = Spoil(
        outliers=float(rng.uniform(0.03, 0.09)) if kind == "outliers" else 0.0,
        unknown_directions=float(rng.choice([0.3, 0.6, 1.0])) if kind == "unknown" else 0.0,
    )
    write_loading_test(folder, plan, effects, rng, spoil)
    drawn = read_measurement_set(folder).displacement - true_displacement(plan, effects)
    return effects, [effect_rms(plan, [e]) / plan.noise[0] for e in effects], drawn


def judge(
    seed: int,
    kind: str,
    effects: list[dict],
    strengths: list[float],
    drawn: np.ndarray,
    diagnosis: LoadingDiagnosis,
) -> Outcome:
    """Compare what was said with what was hidden."""
    library = [e for e in effects if e["cause"] in LIBRARY_CAUSES]
    foreign = len(library) < len(effects)
    truth = {(e["cause"], e["where"]): e for e in library}
    open_ = dict(truth)
    wrong, named, covered, misses, listed = [], [], [], [], 0
    for finding in diagnosis.findings:
        key = finding.cause.key
        named.append(key)
        alternatives = [key, *(c.key for c in finding.confusable)]
        match = next((a for a in alternatives if a in open_), None)
        if match is None:
            wrong.append(key)
            continue
        effect = open_.pop(match)
        listed += match != key
        if match == key:
            for name, entry in parameters_of(finding).items():
                real = np.atleast_1d(effect["parameters"].get(name, np.nan)).astype(float)
                value, std = np.atleast_1d(entry["value"]), np.atleast_1d(entry["std"])
                for r, v, s in zip(np.broadcast_to(real, value.shape), value, std, strict=True):
                    inside = bool(abs(r - v) <= 1.96 * s + 1e-12)
                    covered.append(inside)
                    if not inside:
                        misses.append(f"{key} {name}: true {r:.4g}, said {v:.4g} +- {s:.2g}")
    if foreign:
        unseen = min(strengths) < DETECTABLE
        right = not wrong and (unseen or diagnosis.verdict in ("unexplained", "partly_explained"))
    elif not effects:
        right = diagnosis.verdict == "consistent"
    else:
        weak = [s < DETECTABLE for s in strengths]
        right = (
            not wrong
            and all(weak[i] for i, e in enumerate(effects) if (e["cause"], e["where"]) in open_)
            and (diagnosis.verdict == "explained" or all(weak))
        )
    components = 3 * int(diagnosis.kept.sum())
    return Outcome(
        seed,
        kind,
        effects,
        min(strengths, default=0.0),
        diagnosis.verdict,
        named,
        right,
        wrong,
        diagnosis.holdout_rmse[1] / diagnosis.problem.noise_floor,
        diagnosis.holdout_rmse[1] / float(np.sqrt(np.mean(drawn[diagnosis.kept] ** 2))),
        float(chi2.sf(LIMIT**2 * components, components)),
        listed,
        covered,
        misses,
    )


def campaign(
    sets: int, first: int = 0, show=print, kinds: frozenset[str] = frozenset(KINDS)
) -> list[Outcome]:
    """Draw, diagnose and judge sets; of other kinds the seeds are passed over."""
    outcomes = []
    with tempfile.TemporaryDirectory() as folder:
        for seed in range(first, first + sets):
            kind = KINDS[seed % len(KINDS)]
            if kind not in kinds:
                continue
            effects, strengths, drawn = draw_set(Path(folder) / str(seed), seed, kind)
            start = time.perf_counter()
            diagnosis = diagnose_set(read_measurement_set(Path(folder) / str(seed)))
            outcome = judge(seed, kind, effects, strengths, drawn, diagnosis)
            outcome.seconds = time.perf_counter() - start
            outcomes.append(outcome)
            if not outcome.right:
                hidden = ", ".join(
                    f"{e['cause']} {e['where']} ({s:.1f})" for e, s in zip(effects, strengths, strict=True)
                )
                said = ", ".join(f"{n} {w}" for n, w in outcome.named) or "-"
                show(
                    f"set {seed} ({kind}): hidden {hidden or '-'}; {outcome.verdict}: {said}"
                    f"{'; WRONG ' + str(outcome.wrong) if outcome.wrong else ''} {diagnosis.remarks}"
                )
    return outcomes


def summary(outcomes: list[Outcome]) -> dict[str, float]:
    """The figures the diagnosis is held to."""
    known = [o for o in outcomes if o.truth and all(e["cause"] in LIBRARY_CAUSES for e in o.truth)]
    detectable = [o for o in known if o.strength >= DETECTABLE]
    other = [o for o in outcomes if o not in known]
    covered = [c for o in outcomes for c in o.covered if o.verdict == "explained"]
    explained = [o for o in outcomes if o.verdict == "explained"]
    figures = {
        "detectable sets": len(detectable),
        "right cause and place, named or listed as confusable with the name": float(
            np.mean([o.right for o in detectable])
        )
        if detectable
        else 1.0,
        "known causes named": sum(len(o.named) - len(o.wrong) - o.listed for o in known),
        "known causes listed as confusable with the name": sum(o.listed for o in known),
        "sets without effect": sum(not o.truth for o in outcomes),
        "false alarms": sum(o.verdict != "consistent" for o in outcomes if not o.truth),
        "foreign sets": sum(bool(o.truth) for o in other),
        "wrong names on the others": sum(bool(o.wrong) for o in other),
        "wrong names on known causes": sum(bool(o.wrong) for o in known),
        "parameters": len(covered),
        "coverage of 95 % intervals": float(np.mean(covered)) if covered else 0.0,
        "seconds a set": float(np.median([o.seconds for o in outcomes])),
        "explained sets": len(explained),
    }
    # The noise of a set is not of its stated size but of the size that chance gave it: the floor under any model.
    # The tracker's noise alone is counted as drawn; that of the force sensor would raise this floor a little.
    for noise, ratios in (
        ("the noise drawn in that set", [o.ratio_to_drawn for o in explained]),
        ("the noise stated", [o.ratio_to_floor for o in explained]),
    ):
        size = np.array(ratios or [0.0])
        figures |= {
            f"held-out over {noise}: all together": float(np.sqrt(np.mean(size**2))),
            f"held-out over {noise}: worst set": float(size.max()),
            f"held-out over {noise}: sets beyond {LIMIT}": int(np.sum(size > LIMIT)),
            f"held-out over {noise}: share of sets beyond {LIMIT}": float(np.mean(size > LIMIT)),
        }
    figures[f"  sets beyond {LIMIT} times the noise stated that a perfect model would leave, expected"] = (
        float(sum(o.innocent_excess for o in explained))
    )
    return figures


def matrix(outcomes: list[Outcome]) -> str:
    """Hidden causes (rows) against named ones (columns); the last column is no name at all."""
    counts: Counter[tuple[str, str]] = Counter()
    for o in outcomes:
        hidden = [e["cause"] for e in o.truth] or ["(none)"]
        said = {w: n for n, w in o.named}
        left = list(o.named)
        for e in o.truth:
            key = (e["cause"], e["where"])
            if key in left:
                left.remove(key)
                counts[e["cause"], e["cause"]] += 1
                hidden.remove(e["cause"])
        for i, cause in enumerate(hidden):
            counts[cause, left[i][0] if i < len(left) else "-"] += 1
        del said
    rows = sorted({r for r, _ in counts}, key=lambda r: (r not in LIBRARY_CAUSES, r))
    columns = [
        *LIBRARY_CAUSES,
        *sorted({c for _, c in counts} - set(LIBRARY_CAUSES) - {"-"}),
        "-",
    ]
    lines = [
        "hidden \\ named".ljust(26) + " ".join(str(i + 1).rjust(3) for i in range(len(columns) - 1)) + "   -"
    ]
    for row in rows:
        cells = " ".join((str(counts[row, c]) if counts[row, c] else ".").rjust(3) for c in columns)
        lines.append(row.ljust(26) + cells)
    lines.append("columns: " + ", ".join(f"{i + 1} {c}" for i, c in enumerate(columns[:-1])))
    return "\n".join(lines)


def main() -> int:
    """Run the campaign and print it."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--sets", type=int, default=200)
    parser.add_argument("--first", type=int, default=0, help="first seed")
    parser.add_argument("--kinds", nargs="+", choices=sorted(set(KINDS)), default=KINDS, help="of sets")
    chosen = parser.parse_args()
    logging.disable(logging.WARNING)
    outcomes = campaign(
        chosen.sets, chosen.first, lambda line: print(line, flush=True), frozenset(chosen.kinds)
    )
    for outcome in outcomes:
        for miss in outcome.misses:
            print(f"set {outcome.seed} ({outcome.kind}): {miss}")
    print(matrix(outcomes))
    for name, value in summary(outcomes).items():
        print(f"{name}: {value:.3f}" if isinstance(value, float) else f"{name}: {value}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
