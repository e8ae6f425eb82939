"""A cause that the contract has a name for, to stand beside a law."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from support.law_worlds.geometry import SPRINGS, Hinge, joint
from support.law_worlds.session import Session

CAUSES = ("joint_backlash", "joint_stiffness", "joint_friction")


@dataclass(frozen=True)
class Named:
    """One cause at one joint.

    Attributes:
        cause: One of CAUSES.
        joint: 1 to 6.
        value: gap [rad], stiffness [N m / rad], or torque [N m] that a pre-loaded joint's spring does not see.
        crossing: Torque at which a gap is fully crossed [N m].
    """

    cause: str
    joint: int
    value: float
    crossing: float = 0.0

    def turn(self, session: Session) -> tuple[Hinge, np.ndarray]:
        """The joint, and its turn beyond torque over stated stiffness, shape (n,) [rad].

        A joint that last moved against its load is pre-loaded: it lies against the flank already, and its
        friction holds.
        """
        hinge = joint(self.joint)
        torque = session.torque(hinge)
        size, sign = np.abs(torque), np.sign(torque)
        preloaded = session.approach[:, self.joint - 1] * torque < 0.0
        if self.cause == "joint_backlash":
            crossed = np.minimum(size / max(self.crossing, 1e-12), 1.0)
            return hinge, sign * np.where(preloaded, 0.0, self.value * crossed)
        if self.cause == "joint_stiffness":
            return hinge, torque * (1.0 / self.value - hinge.compliance)
        held = np.where(preloaded, np.minimum(size, self.value), 0.0)
        return hinge, -sign * held * hinge.compliance

    @property
    def truth(self) -> dict[str, object]:
        """As diagnosis.json would say it."""
        name = {"joint_backlash": "gap", "joint_stiffness": "stiffness", "joint_friction": "torque"}[
            self.cause
        ]
        values = {name: self.value}
        if self.cause == "joint_backlash":
            values["crossing"] = self.crossing
        return {"cause": self.cause, "where": f"joint {self.joint}", "parameters": values}


def rms(values: np.ndarray) -> float:
    """Root mean square of all components."""
    return float(np.sqrt(np.mean(np.square(values))))


def strength(named: Named, session: Session) -> float:
    """By how much the cause moves the reflectors of the set, root mean square of components [m]."""
    return rms(session.moved([named.turn(session)])[session.seen])


def draw_named(rng: np.random.Generator, session: Session, noise: float, elsewhere: str, cause: str) -> Named:
    """A cause of 4 to 12 times the noise [m], at another joint than `elsewhere`.

    Raises:
        RuntimeError: No joint lets it be as strong as that.
    """
    for k in rng.permutation(6) + 1:
        lever = float(np.median(np.abs(session.torque(joint(int(k))))))
        crossing, softer = float(rng.uniform(0.0, 0.1)) * lever, bool(rng.random() < 0.5)

        def of_size(size: float, k: int = int(k), crossing: float = crossing, softer: bool = softer) -> Named:
            if cause == "joint_stiffness":
                share = 1.0 + size if softer else 1.0 / (1.0 + size)
                return Named(cause, k, float(SPRINGS[k - 1] / share))
            return Named(cause, k, size, crossing if cause == "joint_backlash" else 0.0)

        largest = {"joint_backlash": 1e-3, "joint_stiffness": 1.0, "joint_friction": lever}[cause]
        most = strength(of_size(largest), session) / noise
        if f"joint {k}" == elsewhere or most < 5.0:
            continue
        wanted = float(np.exp(rng.uniform(np.log(4.0), np.log(min(12.0, most))))) * noise
        low, high = 0.0, largest
        for _ in range(40):  # stronger with size, whatever the cause
            middle = 0.5 * (low + high)
            low, high = (middle, high) if strength(of_size(middle), session) < wanted else (low, middle)
        return of_size(high)
    raise RuntimeError(f"no joint makes {cause} as strong as 5 times the noise of {noise:.3g} m")
