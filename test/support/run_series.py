"""Series of runs without an inspection, as a real cell would have recorded them, and what changed in them.

Each bag is a shipped one without what the simulation tells and without pictures. Door, camera, probe, controller and
link are drawn; the truth stays in `Series`. Offsets are along base y and z and about base x [m, m, rad].
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta
from itertools import islice

import numpy as np
import numpy.typing as npt
from scipy import stats

Floats = npt.NDArray[np.float64]

RECIPES = ("thesis_190_0deg", "thesis_1350_0deg", "standard_door")  #: shipped bags that hold a milled door
PROBE = "touch_probe"
BEGAN = datetime(2026, 11, 23, 6, 0, 0, 60038, tzinfo=UTC)
TAKT = 180.0  #: from one run to the next [s]
PLACES = {
    "camera_shift": "camera",
    "clamp_shift": "clamp",
    "sensor_shift": PROBE,
    "camera_lens": "camera",
    "camera_scatter": "camera",
    "controller_speed": "controller",
    "controller_answer": "controller",
    "link_delay": "link",
    "cutting_power": "spindle",
}  #: every kind of change and where it is
#: What is drawn where nobody asks for anything; before cells recorded the load of their spindles.
DRAWN = tuple(kind for kind in PLACES if kind != "cutting_power")
DRIFTING = ("camera_shift", "controller_speed", "camera_lens", "cutting_power")
FACTORS = {
    "camera_lens": (1.5, 3.0),
    "camera_scatter": (4.0, 8.0),
    "controller_speed": (1.03, 1.3),
    "controller_answer": (2.0, 5.0),
    "link_delay": (2.0, 6.0),
    "cutting_power": (1.3, 2.2),
}
#: Scatter of the logarithm of what a kind multiplies; of camera_scatter for three localizations of three offsets.
SPREAD = {
    "camera_scatter": 0.3,
    "controller_speed": 0.003,
    "controller_answer": 0.1,
    "link_delay": 0.15,
    "cutting_power": 0.06,
}
UPSETS = {
    "residual": 5.0,
    "milling": 1.5,
    "answer": 4.0,
    "link": 5.0,
}  #: what is off in one run, and how often as large


@dataclass(frozen=True)
class Change:
    """Something that changed, from run `first` on at full size, or over the whole series where it drifts.

    `axis` is 0, 1 or 2 for y, z [m] or rotation [rad], of which `size` is the jump; -1 where `size` is a factor.
    """

    kind: str
    drift: bool
    first: int
    axis: int
    size: float

    def share(self, count: int) -> Floats:
        """Of the full size in each run, 0 to 1."""
        run = np.arange(count, dtype=float)
        return run / (count - 1) if self.drift else (run >= self.first).astype(float)


@dataclass(frozen=True, eq=False)
class Series:
    """What happened in n runs; r localizations of each.

    Offsets [m, m, rad]: `truth` (n, 3), `seen` by the camera (n, r, 3), by the `probe` (n, 3), the camera's `way` by
    the marks (n, r, 3). `residual` (n, r) [m]; `milling` (n,), a factor of the predicted time; `answer`, `link` (n,)
    [s]. `work` (n,) of the cut, in a recipe's usual one; None where nobody records the spindle's load. `stated` are the
    deviations in the covariance of camera and probe, (2, 3). `refused` and `upset` are -1 where there is no such run.
    """

    changes: tuple[Change, ...]
    recipes: tuple[str, ...]
    truth: Floats
    seen: Floats
    probe: Floats | None
    way: Floats | None
    stated: Floats
    residual: Floats
    milling: Floats
    answer: Floats
    link: Floats
    work: Floats | None
    refused: int
    upset: int

    def run_id(self, run: int) -> str:
        """In the form of the shipped bags, in order."""
        return f"{BEGAN + timedelta(seconds=TAKT * run):%Y%m%dT%H%M%S%fZ}"

    def rivals(self, change: Change) -> tuple[str, ...]:
        """Other kinds that nothing in the bags tells from this one."""
        pair = {"camera_shift", "clamp_shift" if self.probe is None else "sensor_shift"}
        return tuple(pair - {change.kind}) if self.way is None and change.kind in pair else ()


def draw_series(
    seed: int,
    kinds: Sequence[str] | None = None,
    count: int | None = None,
    probe: bool | None = None,
    marks: bool | None = None,
    repeats: int | None = None,
    drift: bool | None = None,
    order: str | None = None,
    calm: bool = False,
    spindle: bool = False,
) -> Series:
    """Draw a series whose changes are large enough to be told from chance; what is None is drawn too.

    Args:
        seed: Of everything drawn.
        kinds: What changes.
        count: Number of runs.
        probe: A touch probe measures beside the camera.
        marks: The cell has marks.
        repeats: Localizations of each run.
        drift: What can drift does.
        order: Of the recipes: one, cycle, random, or split for one recipe before and another after some run.
        calm: No run is refused or has an outlier.
        spindle: The load of the spindle is recorded, as it is where the work of the cut changes. Where kinds are
            drawn, that may change too; everything else is as without.
    """
    rng = np.random.default_rng([seed, 61])
    chosen: list[str] = []
    for attempt in range(20000):
        if (
            attempt % 500 == 0
        ):  # what is drawn keeps to its kinds, or there were few of those that are hard to tell
            chosen = list(kinds) if kinds is not None else _kinds(rng)
        n = count or int(np.exp(rng.uniform(np.log(8), np.log(61))))
        probed = bool(rng.random() < 0.5) if probe is None else probe
        marked = bool(rng.random() < 0.5) if marks is None else marks
        times = repeats or (3 if rng.random() < 0.4 else 1)
        if ("sensor_shift" in chosen and not probed) or ("camera_scatter" in chosen and times == 1):
            continue
        scatter = np.array([*rng.uniform(3e-4, 2e-3, 2), rng.uniform(2e-4, 2e-3)])
        noise = np.array([*rng.uniform(10e-6, 60e-6, 2), rng.uniform(20e-6, 80e-6)])
        fine = rng.uniform([[5e-6] * 3, [10e-6] * 3], [[20e-6] * 3, [30e-6] * 3])  # of probe and marks
        spread = {"camera_lens": rng.uniform(0.1, 0.2), **SPREAD}
        recipes = _recipes(rng, n, order or ("" if chosen else str(rng.choice(["", "split"])) * (n >= 8)))
        changes = tuple(_change(rng, kind, n, scatter, drift) for kind in chosen)
        beside = noise if marked else np.hypot(noise, fine[0]) if probed else np.hypot(scatter, noise)
        off = {
            "camera_shift": np.hypot(beside, fine[1]) if marked else beside,
            "clamp_shift": np.hypot(scatter, noise),
            "sensor_shift": np.hypot(noise, fine[0]),
        }
        told = all(
            _told(c, float(off[c.kind][c.axis]) if c.axis >= 0 else spread[c.kind], n, len(set(recipes)))
            for c in changes
        )
        # Two changes whose traces are the same cannot be told apart.
        same = {"camera_shift", "sensor_shift" if probed else "clamp_shift"} <= set(chosen) and not marked
        if told and not same:
            break
    else:
        raise ValueError(f"no such series can be drawn: {kinds}")

    own_rng = np.random.default_rng([seed, 67])  # what came later draws from its own, so that the rest stays
    if spindle and kinds is None and own_rng.random() < 0.5:
        tried = (_change(own_rng, "cutting_power", n, scatter, drift) for _ in range(20))
        told_ones = (c for c in tried if _told(c, SPREAD["cutting_power"], n, len(set(recipes))))
        changes = (*changes, *islice(told_ones, 1))
    shift, factor = {kind: np.zeros((n, 3)) for kind in PLACES}, {kind: np.ones(n) for kind in PLACES}
    way = rng.normal(0.0, 40e-6, 3) + rng.normal(0.0, fine[1], (n, times, 3))
    for c in changes:
        if c.axis < 0:
            factor[c.kind] = 1.0 + (c.size - 1.0) * c.share(n)
            continue
        shift[c.kind][:, c.axis] = c.size * c.share(n)
        if c.kind == "camera_shift":
            way -= shift[c.kind][:, None]
    calibration = rng.choice([-1.0, 1.0], 3) * rng.uniform(50e-6, 100e-6, 3)
    truth = rng.normal(0.0, scatter, (n, 3)) + rng.uniform(-1e-3, 1e-3, 3) + shift["clamp_shift"]
    grown = factor["camera_scatter"][:, None, None] * noise
    seen = (truth + calibration + shift["camera_shift"])[:, None] + rng.normal(
        0.0, 1.0, (n, times, 3)
    ) * grown
    touched = truth + rng.normal(0.0, 1e-4, 3) + shift["sensor_shift"] + rng.normal(0.0, fine[0], (n, 3))
    own = {name: (rng.uniform(20e-6, 60e-6), rng.uniform(0.98, 1.05)) for name in RECIPES}
    level = np.array([own[name] for name in recipes])
    off_run = {name: np.ones(n) for name in UPSETS}
    refused, upset = (
        int(run) if not calm and rng.random() < 0.35 else -1 for run in rng.permutation(max(n, 2))[:2]
    )
    if upset >= 0 and all(abs(upset - c.first) > 1 for c in changes):
        name = str(rng.choice(list(UPSETS)))
        off_run[name][upset] = UPSETS[name]
    else:
        upset = -1

    def scattered(kind: str, name: str, size: tuple[int, ...]) -> Floats:
        whole = np.reshape(factor[kind] * off_run[name], (n, *[1] * (len(size) - 1)))
        return np.asarray(whole * np.exp(rng.normal(0.0, spread[kind], size)), dtype=float)

    work = factor["cutting_power"] * np.exp(own_rng.normal(0.0, SPREAD["cutting_power"], n))
    recorded = spindle or any(c.kind == "cutting_power" for c in changes)
    return Series(
        changes=changes,
        recipes=recipes,
        truth=truth,
        seen=seen,
        probe=touched if probed else None,
        way=way if marked else None,
        stated=np.array([np.hypot(noise, np.abs(calibration)), np.hypot(fine[0], 4e-4)]),
        residual=level[:, :1] * scattered("camera_lens", "residual", (n, times)),
        milling=level[:, 1] * scattered("controller_speed", "milling", (n,)),
        answer=rng.uniform(0.3, 0.6) * scattered("controller_answer", "answer", (n,)),
        link=rng.uniform(0.1, 0.2) * scattered("link_delay", "link", (n,)),
        work=work if recorded else None,
        refused=refused,
        upset=upset,
    )


def _kinds(rng: np.random.Generator) -> list[str]:
    number = rng.choice(3, p=(0.25, 0.45, 0.3))
    return list(map(str, rng.choice(list(DRAWN), number, replace=False)))


def _recipes(rng: np.random.Generator, n: int, order: str) -> tuple[str, ...]:
    order = order or str(rng.choice(["one", "cycle", "random"]))
    chosen = rng.permutation(RECIPES)[
        : 1 if order == "one" else 2 if order == "split" else rng.integers(2, 4)
    ]
    if order == "random":
        return tuple(map(str, rng.choice(chosen, n)))
    if order == "split":
        first = rng.integers(4, n - 3)
        return tuple(str(chosen[int(run >= first)]) for run in range(n))
    return tuple(str(chosen[run % len(chosen)]) for run in range(n))


def _change(rng: np.random.Generator, kind: str, n: int, scatter: Floats, drift: bool | None) -> Change:
    drifts = kind in DRIFTING and (bool(rng.random() < 0.2) if drift is None else drift)
    first, axis = 0 if drifts else int(rng.integers(4, n - 3)), int(rng.integers(3))
    if kind in FACTORS:
        return Change(kind, drifts, first, -1, float(rng.uniform(*FACTORS[kind])))
    size = rng.uniform(0.2e-3, 1e-3) if axis == 2 else rng.uniform(0.15e-3, 1e-3)
    if kind == "clamp_shift":
        size = max(2.0 * scatter[axis], 1e-3) * rng.uniform(1.0, 2.5)
    return Change(kind, drifts, first, axis, float(size * rng.choice([-1.0, 1.0])))


def _told(change: Change, deviation: float, n: int, recipes: int) -> bool:
    """Whether a change stands out of one quantity of this deviation, though many quantities and runs are looked at."""
    size = abs(change.size) if change.axis >= 0 else float(np.log(change.size))
    runs = n / 12.0 if change.drift else change.first * (n - change.first) / n
    free = n - 3 - recipes
    return size * np.sqrt(runs) > deviation * (2.0 + stats.t.isf(1e-5, free)) and size > 2.0 * deviation
