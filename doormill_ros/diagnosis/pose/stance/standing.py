"""Finds along which direction gravity acts in a robot's base, and what hangs at its flange that no set tells.

A sag in proportion to the torque of gravity is the only cause that takes the stance of the robot for granted. Where
that is wrong, other causes stand in for what gravity does; so it is asked before anything is named.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from doormill_ros.diagnosis.core.fitting.held_out import gain_in_errors
from doormill_ros.diagnosis.pose.fitting.fit import Fitted, fit_causes
from doormill_ros.diagnosis.pose.fitting.validation import Validation, held_out_fall
from doormill_ros.diagnosis.pose.searching.selection import SHARE, SURE, WORTH
from doormill_ros.diagnosis.pose.stance.free_weight import FreeWeight
from doormill_ros.diagnosis.pose.stance.likely_stance import Standing, Weights, likeliest
from doormill_ros.measurements.sets.pose_set import PoseSet
from doormill_ros.robot_model.law.entries import terms
from doormill_ros.robot_model.pose.causes.cause import PoseCause
from doormill_ros.robot_model.pose.causes.hints import Hints, places_of_joints
from doormill_ros.robot_model.pose.causes.joint_periodic_error import dense_orders
from doormill_ros.robot_model.pose.causes.joint_sag import JointSag
from doormill_ros.robot_model.pose.causes.registry import candidates
from doormill_ros.robot_model.pose.law.term import PoseTerm, Sight
from doormill_ros.robot_model.pose.stance import UPRIGHT, Stance
from doormill_ros.units import rad_to_deg

#: Rows that are asked, of which every series keeps so many at least.
ROWS, LEAST = 1500, 60
#: Times that a stance is sought, since what follows the size of a torque hangs on the last one.
ROUNDS = 3


def find_standing(
    sets: Sequence[PoseSet], nominal: Fitted, progress: Callable[[str], None] = lambda line: None
) -> Standing:
    """Upright without a load, unless rows left out speak for another stance; straight on a wall before aslant.

    Args:
        sets: The series; where none states masses nothing is asked.
        nominal: How the nominal model places them.
        progress: Told what is tried.
    """
    upright = Standing(UPRIGHT)
    if not any(data.view.links for data in sets):
        return upright
    some = _thinned(sets)
    likely = _likely(some, nominal)
    if likely is None:
        return upright
    found, best = upright, _tried(some, UPRIGHT, nominal)
    for one in (*likely.simpler(), likely):
        progress(f"gravity may act along {one.stance.document()}; asking rows left out")
        tried = _tried(some, one.stance, nominal)
        fall, left = held_out_fall(best, tried)
        if fall.sum() > max(WORTH, SHARE * left) and gain_in_errors(fall) > SURE:
            found, best = one, tried
    return found


def _likely(sets: Sequence[PoseSet], nominal: Fitted) -> Standing | None:
    """The likeliest stance by what each joint turns under weight in any direction; None for being upright."""
    where = places_of_joints(sets[0].joints)  # one that carries nothing may do so on a wall
    likely = None
    for _ in range(ROUNDS):
        others = [cause for cause in _library(sets) if not isinstance(cause, JointSag)]
        causes = [*(FreeWeight(one) for one in where), *others]
        free = fit_causes(sets, causes, nominal.problem.placements, 2)
        likely = likeliest(Weights(free, len(where)))
        if likely is None:
            break
        sets = stood(sets, likely.stance)
    return likely


def stood(sets: Sequence[PoseSet], stance: Stance) -> tuple[PoseSet, ...]:
    """The series of a robot that stands so."""
    return tuple(replace(data, stance=stance) for data in sets)


def _thinned(sets: Sequence[PoseSet]) -> list[PoseSet]:
    """Every so many-th row of series that are long enough to do without the others."""
    every = -(-sum(map(len, sets)) // ROWS)
    columns = ("row", "time", "temperature", "q", "position", "placement")
    found = []
    for data in sets:
        some = slice(None, None, max(1, min(every, len(data) // LEAST)))
        rotation = None if data.rotation is None else data.rotation[some]
        parts = {name: getattr(data, name)[some] for name in columns}
        found.append(replace(data, **parts, rotation=rotation))
    return found


def _library(sets: Sequence[PoseSet]) -> list[PoseCause]:
    """Everything that may act, and beside it turns by the size of a torque.

    A joint that gives way one way only is no robot that leans: without such turns gravity would be sought where it
    follows what a proportion leaves. Being the same for both signs of a torque, they never stand for its direction.
    """
    views = tuple(data.view for data in sets)
    orders = dict.fromkeys(places_of_joints(sets[0].joints), dense_orders(views)[0])
    library = candidates(Hints(views, orders, drift=False))
    sagging = [cause.where for cause in library if isinstance(cause, JointSag)]
    sizes = [("joint angle", sagging, (("own torque", (("size", 1.0),), False),))]
    return [*library, *terms(PoseTerm, Sight(views), sizes, ())]


def _tried(sets: Sequence[PoseSet], stance: Stance, nominal: Fitted) -> Validation:
    """What a stance predicts. A joint gives way to a torque, never against it: what sags upwards does not count."""
    some = stood(sets, stance)
    fitted = fit_causes(some, _library(some), nominal.problem.placements, 2)
    layout = fitted.problem.layout
    upwards = [
        layout.part(i).start
        for i, cause in enumerate(layout.causes)
        if isinstance(cause, JointSag) and fitted.solution.x[layout.part(i).start] < 0.0
    ]
    return Validation(fitted).less(np.array(upwards, dtype=int))


def standing_document(standing: Standing) -> dict[str, Any]:
    """For diagnosis.json: `standing`, with deviations; empty where the robot stands as the sets tell."""
    if standing.stance is UPRIGHT:
        return {}
    found = standing.stance.document()
    for name, pair in (("tilt", standing.tilt), ("mass", standing.mass)):
        if pair is not None:
            found[name] = {"value": pair[0], "std": pair[1], "unit": "rad" if name == "tilt" else "kg"}
    return {"standing": found}


def standing_remarks(standing: Standing) -> list[str]:
    """What the sets do not tell of gravity and load, as sentences."""
    lines = []
    if standing.tilt is not None:
        along = ", ".join(f"{v:.2f}" for v in standing.stance.down)
        angle, std = rad_to_deg(standing.tilt[0]), rad_to_deg(standing.tilt[1])
        lines.append(
            f"Gravity seems to act along ({along}) of the base, {angle:.1f} deg off straight down (standard deviation "
            f"{std:.1f} deg), and every torque of gravity is reckoned so: how does the robot stand?"
        )
    if standing.mass is not None and standing.stance.load is not None:
        at = ", ".join(f"{v:.2f}" for v in standing.stance.load.com)
        lines.append(
            f"The robot seems to carry {standing.mass[0]:.1f} kg (standard deviation {standing.mass[1]:.1f} kg) at "
            f"({at}) m of the flange that the stated masses do not hold, and every torque of gravity is reckoned so: "
            "what hangs there, or which stated mass is wrong? A load belongs to the last of the links in set.yaml."
        )
    return lines
