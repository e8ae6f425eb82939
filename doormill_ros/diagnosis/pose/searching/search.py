"""Finds which causes of pose errors are real: all act at once, and those leave that rows left out do not miss."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from functools import cache

import numpy as np

from doormill_ros.diagnosis.core.searching.search import Search
from doormill_ros.diagnosis.pose.fitting.fit import Fitted, fit_causes
from doormill_ros.diagnosis.pose.fitting.model import SeriesFit, rmse
from doormill_ros.diagnosis.pose.fitting.noise import evened
from doormill_ros.diagnosis.pose.fitting.validation import Validation, held_out_fall
from doormill_ros.diagnosis.pose.searching.courses import find_moved
from doormill_ros.diagnosis.pose.searching.orders import find_orders
from doormill_ros.diagnosis.pose.searching.scale import scaled_members, spared
from doormill_ros.diagnosis.pose.searching.selection import MATCHED, REAL, SHARE, WORTH, Score, scores
from doormill_ros.measurements.sets.pose_set import PoseSet
from doormill_ros.robot_model.candidate import number
from doormill_ros.robot_model.pose.causes.cause import PoseCause
from doormill_ros.robot_model.pose.causes.hints import Hints, TimeCourse, places_of_joints
from doormill_ros.robot_model.pose.causes.joint_periodic_error import dense_orders
from doormill_ros.robot_model.pose.causes.link_geometry import LinkGeometry
from doormill_ros.robot_model.pose.causes.registry import candidates
from doormill_ros.robot_model.pose.causes.session_step import SessionStep, find_step
from doormill_ros.robot_model.pose.causes.settling import PoseSettling

#: A whole spectrum has to leave this much less of rows left out than a few orders do.
SPECTRUM = 0.95
#: Fall of the sum of squares that makes a step worth a trial.
STEP = 60.0


class PoseSearch(Search[PoseCause, SeriesFit]):
    """Hundreds of coefficients whose sizes are learnt: whatever may act is in from the start.

    Attributes:
        scores: What each cause was worth when it was asked last.
        gone: Causes that left, in the order in which they did.
        instead: Geometry of links that a scale of the tracker does without.
        scale_instead: By identity of links' geometry, a scale of the tracker that may stand for some of their lengths.
        moved_otherwise: By place of a series, what may have moved its base as well as what is in the model.
    """

    at_once = 0.5

    def __init__(
        self,
        sets: Sequence[PoseSet],
        baseline: Fitted,
        progress: Callable[[str], None],
        beside: Sequence[PoseCause] = (),
    ) -> None:
        """Keep the series, how the nominal model places them, and laws without a name that act as well and stay."""
        self.sets, self.baseline, self.progress, self.beside = sets, baseline, progress, tuple(beside)
        self.scores: dict[int, Score] = {}
        self.gone: list[PoseCause] = []
        self.instead: list[PoseCause] = []
        self.scale_instead: dict[int, PoseCause] = {}
        self.moved_otherwise: dict[str, tuple[PoseCause, ...]] = {}

    def simpler(self, best: SeriesFit) -> SeriesFit:
        """The model, with a scale of the tracker in the place of lengths of links where it predicts as well."""
        scaled = scaled_members(best)
        if scaled is None:
            return best
        members = scaled.members
        instead: list[PoseCause] = [
            cause for cause in best.members if isinstance(cause, LinkGeometry) and spared(cause, members)
        ]
        if not scaled.earned:
            self.scale_instead = {id(cause): members[0] for cause in instead}
            return best
        self.progress("one share may stand for the lengths of several links")
        gone = list(self.gone)
        simpler = self.finished(self._fit(members, best.fitted))
        fall, left = held_out_fall(best.validation, simpler.validation)
        if fall.sum() < -max(WORTH, SHARE * left) or members[0] not in simpler.members:
            self.gone = gone
            return best
        self.instead = instead
        return simpler

    def starts(self) -> list[SeriesFit]:
        """Everything that may act, with a whole spectrum of waves where that predicts better than a few."""
        few, *spectrum = [self._start(dense) for dense in dense_orders([data.view for data in self.sets])]
        for other in spectrum:
            kept = [
                (a > 0.0) & (b > 0.0) for a, b in zip(few.problem.weights, other.problem.weights, strict=True)
            ]
            left = [rmse(evened(self.sets, one.errors.blocks), kept) for one in (few, other)]
            if left[1] < SPECTRUM * left[0]:
                return [other]
        return [few]

    def _start(self, dense: tuple[int, ...]) -> SeriesFit:
        """Everything that may act with waves of some orders: first without, then with hints from the residual."""
        sets, views = self.sets, [data.view for data in self.sets]
        joints = places_of_joints(sets[0].joints)
        library = [*candidates(Hints(views, dict.fromkeys(joints, dense), drift=False)), *self.beside]
        self.progress(f"{len(library)} causes to try")
        first = fit_causes(sets, library, self.baseline.problem.placements, 2, self.progress)
        orders = {where: dense + find_orders(first, number(where), dense[-1]) for where in joints}
        extra = sum(len(o) - len(dense) for o in orders.values())
        self.progress(f"the residual asks for {extra} orders beyond {dense[-1]}")
        steps, courses, known = self._moved(first)
        hints = Hints(views, orders, steps, courses, known=known)
        return self._fit([*candidates(hints), *self.beside], first)

    def _moved(self, first: Fitted) -> tuple[dict[int, tuple[int, int]], dict[int, TimeCourse], list[int]]:
        """Steps and courses of the base by index of the series, and where they say all there is."""
        steps: dict[int, tuple[int, int]] = {}
        courses: dict[int, TimeCourse] = {}
        known = []
        validated, problem = cache(lambda: Validation(first)), first.problem
        for index, data in enumerate(self.sets):
            moved = find_moved(first, index, validated)
            self.moved_otherwise |= {f"set {data.name}": moved.others}
            if moved.causes:
                known.append(index)
                for one in moved.causes:
                    if isinstance(one, SessionStep):
                        steps[index] = one.row, one.spread
                    elif isinstance(one, PoseSettling):
                        courses[index] = one.course
                continue
            at, fall = find_step(problem.residual(index), problem.scale(index), problem.weights[index])
            if fall > STEP:
                steps[index] = int(data.row[at]), 1
        return steps, courses, known

    def _fit(self, causes: Sequence[PoseCause], start: Fitted) -> SeriesFit:
        fitted = fit_causes(self.sets, causes, start.problem.placements, 2, self.progress, start)
        self.progress("leaving out blocks and whole series")
        return SeriesFit(tuple(causes), fitted, Validation(fitted))

    def settled(self, model: SeriesFit) -> SeriesFit:
        """Noise and weights change with the weak causes gone: what is laid on the robot has to pass once more."""
        self.progress(f"{len(model.members)} causes are established; fitting them")
        return self._fit(model.members, model.fitted)

    def ranked(self, models: Iterable[SeriesFit]) -> list[SeriesFit]:
        """As they came: there is one way down."""
        return list(models)

    def without(self, model: SeriesFit, *causes: PoseCause) -> SeriesFit:
        """The same with some causes held at zero, which is exact by conditioning."""
        rest = tuple(cause for cause in model.members if cause not in causes)
        self.gone += causes
        self.progress(f"{len(self.gone)} causes do not earn their place")
        return SeriesFit(rest, model.fitted, model.validation.less(model.ids(causes)))

    def rivals(self, model: SeriesFit, cause: PoseCause) -> list[tuple[PoseCause, SeriesFit]]:
        """None: everything that may act was in from the start."""
        return []

    def useless(
        self, model: SeriesFit, asked: Sequence[PoseCause], strictly: bool
    ) -> list[tuple[PoseCause, float]]:
        """Causes that rows left out do not miss; in the end only those that are laid on the robot."""
        causes = model.fitted.problem.layout.causes
        own = [causes.index(cause) for cause in asked if cause not in self.beside]
        found = scores(model.validation, own, model.validation.left)
        self.scores |= {id(score.cause): score for score in found}
        weak = [score for score in found if score.status != REAL]
        # What others imitate leaves before them: they are asked again with what it took of theirs.
        imitated = {score.cause.where for score in weak if score.status == MATCHED}

        def worth(score: Score) -> float:
            if score.status == MATCHED:
                return -np.inf
            return np.inf if score.cause.where in imitated else score.total

        return [(score.cause, worth(score)) for score in weak if score.cause.of_robot or not strictly]
