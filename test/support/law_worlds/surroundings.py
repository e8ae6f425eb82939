"""Laws outside joints and links: foot, reflector, force sensor, tracker."""

from __future__ import annotations

import numpy as np

from support.law_worlds.geometry import base_edge
from support.law_worlds.law import Effect, Law, of_hinge
from support.law_worlds.session import REFLECTORS, Session


def rocking_base(rng: np.random.Generator, session: Session) -> Law:
    """The foot lifts over one edge once the load overcomes what holds it down."""
    hinge = base_edge(float(rng.uniform(-np.pi, np.pi)), float(rng.uniform(0.2, 0.5)))
    holds = float(rng.uniform(0.0, 1.0) * np.median(np.abs(session.torque(hinge))))
    return of_hinge(
        "rocking_base",
        hinge,
        "wrench",
        lambda _, moment: np.maximum(moment - holds, 0.0),
        10.0,
        also=("own torque",),
        parameters={"holds": holds, "edge_axis": hinge.axis.tolist(), "edge_point": hinge.point.tolist()},
    )


def reflector_slip(rng: np.random.Generator, session: Session) -> Law:
    """A reflector slips in its nest at every loading: always alike, or along a force beyond what holds it."""
    form = str(rng.choice(["settling", "pushed"]))
    name = str(rng.choice(list(REFLECTORS)))
    way = rng.normal(size=3)
    way /= np.linalg.norm(way)
    holds = float(rng.uniform(100.0, 250.0))

    def effect(s: Session) -> Effect:
        on_it = (s.reflector == name)[:, None]
        if form == "settling":
            R = s.frames[np.arange(len(s.q)), s.links, :3, :3]
            return Effect(apparent=on_it * (R @ way) * 1e-5)
        size = np.linalg.norm(s.force, axis=1, keepdims=True)
        return Effect(apparent=on_it * s.force / size * np.maximum(size - holds, 0.0) * 1e-7)

    return Law(
        "reflector_slip",
        f"reflector {name}",
        "constant" if form == "settling" else "wrench",
        effect,
        100.0,
        {"step": (way * 1e-5).tolist()} if form == "settling" else {"holds": holds, "per_newton": 1e-7},
        form=form,
    )


def sensor_bias(rng: np.random.Generator, session: Session) -> Law:
    """The force sensor was not set to zero."""
    way = rng.normal(size=3)
    bias = np.concatenate([way / np.linalg.norm(way), np.zeros(3)])

    def effect(s: Session) -> Effect:
        return Effect(reading=np.tile(bias, (len(s.q), 1)))

    return Law("sensor_bias", "sensor", "constant", effect, 200.0, {"bias": bias.tolist()})


def sensor_crosstalk(rng: np.random.Generator, session: Session) -> Law:
    """One force axis of the sensor shows part of another."""
    into, of = (int(axis) for axis in rng.permutation(3)[:2])

    def effect(s: Session) -> Effect:
        reading = np.zeros((len(s.q), 6))
        reading[:, into] = s.in_sensor_axes()[:, of]
        return Effect(reading=reading)

    return Law("sensor_crosstalk", "sensor", "wrench", effect, 0.5, {"into": "xyz"[into], "of": "xyz"[of]})


def turning_tracker(rng: np.random.Generator, session: Session) -> Law:
    """The tracker's stand turns to and fro with the day; what it turns within dt looks like displacement."""
    bearing, height = float(rng.uniform(-1.0, 1.0)), float(rng.uniform(1.0, 1.8))
    station = np.array([4.0 * np.cos(bearing), 4.0 * np.sin(bearing), height])
    period, phase = float(rng.uniform(1.5e4, 4e4)), float(rng.uniform(0.0, 2 * np.pi))
    axis = rng.normal(size=3)
    axis /= np.linalg.norm(axis)

    def effect(s: Session) -> Effect:
        angle = 1e-8 * s.dt * np.sin(2 * np.pi * s.t / period + phase)
        return Effect(apparent=np.cross(angle[:, None] * axis, s.points - station))

    parameters = {"station": station.tolist(), "axis": axis.tolist(), "rate": 1e-8}
    parameters |= {"period": period, "phase": phase}
    return Law("turning_tracker", "tracker", "time", effect, 1000.0, parameters, also=("time under load",))
