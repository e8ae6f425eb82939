"""Measurement sets of a robot that gives way by a hidden law without a name in the contract.

`draw(seed)` makes a world: a lab's session with a robot whose joint springs are as stated, but for one law and, in
every other round of seeds, one named cause. In half of the worlds where a joint obeys the law, the stated spring
was identified on that very robot and holds the law's mean slope: then nothing is wrong with that spring.
`World.write` writes the set, `World.write_unseen` the configurations held out of it: same world, same session, same
clock, so a law of time or use is asked between what it was shown, not beyond. `World.truth` says what was hidden.

What the format (doormill/measurement-set/1) can carry of a driver, and what not:

* own angle, angle or torque of joint k, own torque, torque sign, wrench, direction: every row has q, a and the wrench.
* time: t. Clocks of two sets are the same only if the lab says so; here they are.
* time under load: dt, if the load comes at once after the unloaded measurement. It does here, and the robot rests so
  long between loadings that nothing of a creep is left; the format says neither.
* temperature: the air's, at the loaded measurement. No column holds a gear's or link's; what warms with a constant of
  its own shows only through t.
* path: rows in the order of t. A loading that was not written down is missing from the memory (those held out are
  missing here: what counts loadings is, to the set, a law of time). No column says whether the robot moved
  between two rows; here a stance comes from the opposite side of the one before, so q or a change when it does.
* constant: an error of displacement alike in all rows; one of position alone cancels, since a row is a difference.
* speed: nothing, all loadings are static. No world has it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from support.law_worlds import memory, springs, surroundings
from support.law_worlds.files import write_set
from support.law_worlds.geometry import joint
from support.law_worlds.law import Effect, Law, around_its_mean
from support.law_worlds.named import CAUSES, Named, draw_named, rms, strength
from support.law_worlds.session import SENSOR_ROTATION, Session, draw_session

#: One after the other by seed.
LAWS: tuple[Callable[[np.random.Generator, Session], Law], ...] = (
    springs.one_sided_spring,
    springs.creep,
    surroundings.sensor_bias,
    springs.gear_waves,
    springs.neighbour_angle,
    memory.softening,
    surroundings.reflector_slip,
    springs.coupling,
    memory.hysteresis,
    springs.warming,
    surroundings.sensor_crosstalk,
    springs.worn_sector,
    springs.direction_spring,
    springs.opening_seat,
    surroundings.rocking_base,
    surroundings.turning_tracker,
)
WEAKEST, STRONGEST = 2.0, 15.0  # times the tracker's noise
FORCE_NOISE, TORQUE_NOISE = 0.3, 0.03


@dataclass(frozen=True, eq=False)
class World:
    """One robot, one lab, one session.

    Attributes:
        seed: What it was drawn from.
        session: What was done.
        law, size: The hidden law and how many units of it there are.
        named: The named cause beside it.
        noise: Standard deviation of one displacement component [m].
        tracker_noise, sensor_noise: As drawn, shapes (n, 3) [m] and (n, 6) [N, N m].
    """

    seed: int
    session: Session
    law: Law
    size: float
    named: Named | None
    noise: float
    tracker_noise: np.ndarray
    sensor_noise: np.ndarray

    def displacement(self, session: Session | None = None) -> np.ndarray:
        """Of the reflectors without noise, shape (n, 3) [m], base frame; of another session on request."""
        session = self.session if session is None else session
        return displaced(session, self.law.effect(session).scaled(self.size), self.named)

    def recorded(self) -> tuple[np.ndarray, np.ndarray]:
        """What the files hold: wrench (n, 6) [N, N m] in sensor axes, displacement (n, 3) [m]."""
        error = self.law.effect(self.session).scaled(self.size).reading
        wrench = self.session.in_sensor_axes() + error + self.sensor_noise
        return wrench, self.displacement() + self.tracker_noise

    def floor(self) -> np.ndarray:
        """What who knows this world exactly still misses, reading the sensor: shape (n, 3) [m]."""
        noisy = with_reading_error(self.session, self.sensor_noise)
        return self.displacement() + self.tracker_noise - self.displacement(noisy)

    def write(self, folder: Path) -> None:
        """The set: set.yaml and trials.csv."""
        write_set(folder, self.session, *self.recorded(), self.session.seen, self._noises)

    def write_unseen(self, folder: Path) -> None:
        """The configurations held out, in the same form."""
        write_set(folder, self.session, *self.recorded(), ~self.session.seen, self._noises)

    @property
    def _noises(self) -> tuple[float, float, float]:
        return self.noise, FORCE_NOISE, TORQUE_NOISE

    @property
    def truth(self) -> dict[str, Any]:
        """What was hidden; amplitudes are root mean squares over the set's components, over the noise.

        `noise` has the stated size, what was drawn, and the `floor` of the best possible model [m].
        """
        seen, floor = self.session.seen, self.floor()
        beside = None
        if self.named is not None:
            beside = {**self.named.truth, "amplitude": strength(self.named, self.session) / self.noise}
        return {
            "seed": self.seed,
            "law": self.law.name,
            "form": self.law.form,
            "where": self.law.where,
            "driver": self.law.driver,
            "also": list(self.law.also),
            "amplitude": law_strength(self.session, self.law, self.size) / self.noise,
            "size": self.size,
            "parameters": self.law.parameters,
            "mean_slope_identified": self.law.around_mean,
            "named": beside,
            "noise": {
                "stated": self.noise,
                "drawn": rms(self.tracker_noise[seen]),
                "drawn_unseen": rms(self.tracker_noise[~seen]),
                "floor": rms(floor[seen]),
                "floor_unseen": rms(floor[~seen]),
            },
        }


def displaced(session: Session, effect: Effect, named: Named | None) -> np.ndarray:
    """Of the reflectors, shape (n, 3) [m]: stated springs, a law's effect, a named cause."""
    turns = [(joint(k), session.torque(joint(k)) * joint(k).compliance) for k in range(1, 7)]
    turns += list(effect.turns)
    if named is not None:
        turns.append(named.turn(session))
    by_hinge: dict[str, tuple[Any, np.ndarray]] = {}
    for hinge, angle in turns:
        before = by_hinge[hinge.where][1] if hinge.where in by_hinge else 0.0
        by_hinge[hinge.where] = (hinge, before + angle)
    return session.moved(list(by_hinge.values())) + effect.apparent


def with_reading_error(session: Session, error: np.ndarray) -> Session:
    """The session as if the load were what a sensor with this error reads, (n, 6) [N, N m], sensor axes."""
    c, s = np.cos(SENSOR_ROTATION), np.sin(SENSOR_ROTATION)
    R = session.frames[:, 6, :3, :3] @ np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    force, couple = (np.einsum("nij,nj->ni", R, error[:, i : i + 3]) for i in (0, 3))
    return replace(session, force=session.force + force, couple=session.couple + couple)


def law_strength(session: Session, law: Law, size: float) -> float:
    """What the stated springs miss of the set, by the law alone: root mean square of components [m]."""
    effect = law.effect(session).scaled(size)
    believed = session
    if not np.isscalar(effect.reading):
        believed = with_reading_error(session, np.asarray(effect.reading))
    missed = displaced(session, effect, None) - displaced(believed, Effect(), None)
    return rms(missed[session.seen])


def sized(
    rng: np.random.Generator, session: Session, make: Callable[..., Law], noise: float
) -> tuple[Law, float]:
    """A law that can be seen in this session, and its size.

    Raises:
        RuntimeError: In a hundred places it was too weak.
    """
    for _ in range(100):
        law = make(rng, session)
        if law.hinge is not None and rng.random() < 0.5:
            law = around_its_mean(law, law.hinge, session)
        most = law_strength(session, law, law.largest) / noise
        if most < 1.25 * WEAKEST:
            continue
        wanted = float(np.exp(rng.uniform(np.log(WEAKEST), np.log(min(STRONGEST, most)))))
        size = law.largest * wanted / most
        for _ in range(3):  # nearly linear
            size *= wanted * noise / law_strength(session, law, size)
        return law, min(size, law.largest)
    raise RuntimeError(f"{make.__name__} is too weak everywhere in this session")


def draw(seed: int) -> World:
    """The world of a seed: law by seed % 16, a named cause beside it in every other sixteen."""
    lab, hidden, chance = (np.random.default_rng([seed, stream]) for stream in (1, 2, 3))
    session = draw_session(lab)
    noise = float(lab.uniform(5e-6, 1e-5))
    law, size = sized(hidden, session, LAWS[seed % len(LAWS)], noise)
    round_ = seed // len(LAWS)
    named = None
    if round_ % 2:
        cause = CAUSES[(seed + round_ // 2) % len(CAUSES)]
        named = draw_named(hidden, session, noise, law.where, cause)
    n = len(session.q)
    scale = np.repeat([FORCE_NOISE, TORQUE_NOISE], 3)
    return World(
        seed,
        session,
        law,
        size,
        named,
        noise,
        chance.normal(0.0, noise, (n, 3)),
        chance.normal(size=(n, 6)) * scale,
    )
