"""The dictionary of physical terms: what may act where, driven by what, in which shape; one line an entry."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from doormill_ros.frames import cross
from doormill_ros.robot_model.elastic.law.carriers import CARRIERS
from doormill_ros.robot_model.elastic.law.cracks import ROUGH_CRACKS
from doormill_ros.robot_model.elastic.law.edges import ROUGH
from doormill_ros.robot_model.elastic.law.memory import tried
from doormill_ros.robot_model.elastic.law.term import LawTerm
from doormill_ros.robot_model.elastic.load_case import LoadCase
from doormill_ros.robot_model.elastic.places import JOINTS, LINKS
from doormill_ros.robot_model.law.entries import SECTORS, Entry, terms

WAVES = 30  #: a turn, at most
_NO_LENGTH, _NO_ANGLE = 1e-9, 1e-6  #: of a link [m], and between it and an axis [rad]
OTHER_WAVES = 4  #: the same of another joint's angle: that is no gear

#: Shapes of a kind of driver, each with its own numbers in parts of how the driver was spread in the test:
#: of its largest size, or of quantiles for "past".
_TORQUE = (
    ("size", 1.0),
    ("square", 1.0),
    ("root", 1.0),
    *((name, part) for name in ("fading", "saturating") for part in (0.1, 0.3, 1.0)),
    *((name, part) for name in ("past", "beyond") for part in (0.2, 0.4, 0.6)),
)
_STEPS = tuple(("past", float(part)) for part in np.round(np.arange(0.1, 0.95, 0.05), 2))
_PERIODS = tuple(("periods", float(np.round(1.0 / n, 3))) for n in (0.5, 1.0, 1.5, 2.0, 3.0, 4.0))
_OVER_TIME = (("slope", 0.0), ("line", 0.5), *_STEPS, ("settling", 0.1), ("settling", 0.3), *_PERIODS)
_UNDER_LOAD = (
    ("logarithm", 0.0),
    ("logarithmic line", 0.0),
    *(("creeping", part) for part in (0.01, 0.03, 0.1, 0.3)),
    *(("settling", part) for part in (0.05, 0.1, 0.2, 0.5)),
    ("root", 1.0),
    ("slope", 0.0),
)
_WARM = (("rise", 0.0), ("rise", 0.5), ("line", 0.5), ("past", 0.5))
_OTHER_ANGLE = (
    ("slope", 0.0),
    ("line", 0.5),
    ("square", 1.0),
    *(("waves", float(n)) for n in range(1, OTHER_WAVES + 1)),
    ("positive", 0.0),
)
_OWN_ANGLE = (*_OTHER_ANGLE, *(("waves", float(n)) for n in range(OTHER_WAVES + 1, WAVES + 1)), *SECTORS)
_OTHER_TORQUE = (("slope", 0.0), ("size", 1.0), ("square", 1.0), ("positive", 0.0))
_AGAINST = (("sign", 0.0), ("positive", 0.0), ("negative", 0.0))
_LIMITED = (
    *(("limited", part) for part in (0.05, 0.1, 0.2, 0.4, 0.8)),
    ("saturating", 0.1),
    ("saturating", 0.3),
    ("past", 0.2),
    ("past", 0.4),
)
_CROSSED = tuple(("limited", part) for part in (0.02, 0.05, 0.1, 0.2, 0.4, 0.8))
#: A foot or a seat that opens, at once or beyond what holds it.
_OPENS = tuple(("opening", part) for part in (0.0, 0.1, 0.25, 0.5))

#: What a modulated thing may hang on: driver ("k" stands for every other joint), shapes, whether also a curve.
_SPRING = (
    ("own torque", _TORQUE, True),
    ("torque sign", (("positive", 0.0),), False),
    ("direction", _AGAINST, False),
    ("direction (sense)", _AGAINST, False),
    ("own angle", _OWN_ANGLE, True),
    ("angle of joint k", _OTHER_ANGLE, True),
    ("torque of joint k", _OTHER_TORQUE, True),
    ("time", _OVER_TIME, True),
    ("time under load", _UNDER_LOAD, True),
    ("temperature", _WARM, True),
    ("wrench", (("size", 1.0),), False),
)
_LEVEL = (("constant", (("level", 0.0),), False),)
_PLAIN = (
    ("time", (("slope", 0.0), ("line", 0.5)), False),
    ("time under load", (("logarithm", 0.0), ("slope", 0.0)), False),
    ("temperature", _WARM, False),
)
_SENSOR = (*_LEVEL, ("time", _OVER_TIME, False), *_PLAIN[1:])
#: A cable or a hose that pulls beside the sensor follows the joint about which it is led.
_PULLED = (("angle of joint k", (("slope", 0.0), ("line", 0.5), ("waves", 1.0), ("waves", 2.0)), False),)
_BY_WRENCH = (("wrench", (("level", 0.0), ("size", 1.0)), False), *_PLAIN)
_MOUNT = (*_BY_WRENCH, ("angle of joint k", _OTHER_ANGLE, False))
_TURN = (
    ("torque of joint k", _OTHER_TORQUE, True),
    *_LEVEL,
    ("own torque", (("size", 1.0), ("square", 1.0)), False),
    ("time", _OVER_TIME, False),
    *_PLAIN[1:],
)
_WITH_LOAD = (
    ("torque sign", (("level", 0.0),), False),
    ("direction", _AGAINST, False),
    ("own torque", _LIMITED, False),
    # A gap is crossed, and friction holds, in proportion to the load before they are so in full.
    ("direction (torque along it)", _CROSSED, False),
    ("direction (torque against it)", _CROSSED, False),
    ("time under load", _UNDER_LOAD, False),
    ("time", _OVER_TIME, False),
    ("temperature", _WARM, False),
    ("own angle", tuple(("waves", float(n)) for n in range(1, 5)), False),
)
_TILT = (*_BY_WRENCH, ("direction", (("sign", 0.0),), False), ("own angle", _OTHER_ANGLE, False))
_SLIP = (("wrench", (("size", 1.0), ("past", 0.3), ("past", 0.5), ("past", 0.7)), False),)
_DRIFT = (("time", _OVER_TIME, False), ("time under load", _UNDER_LOAD, False), ("temperature", _WARM, False))
_SPEED = (
    ("time", (("level", 0.0), ("line", 0.5), ("settling", 0.1), ("settling", 0.3), *_PERIODS), False),
    ("temperature", (("line", 0.5),), False),
)
_DRAWN = (*(("past", part) for part in (0.3, 0.5, 0.7)), ("beyond", 0.3), ("beyond", 0.5))

#: What it acts on, its places (None: the reflectors), what may drive it. Equals go by this order: what sits at an end
#: of the arm and would look alike inside it comes first.
DICTIONARY = (
    ("spring", JOINTS, _SPRING),
    *(
        (f"coupling with joint {k}", JOINTS[: k - 1], ((f"torque of joint {k}", (("level", 0.0),), False),))
        for k in range(2, 7)
    ),
    ("joint angle", JOINTS, _TURN),
    ("joint angle with the load", JOINTS, _WITH_LOAD),
    *((mount, ("base",), _MOUNT) for mount in ("base tilt", "base turn", "base shift")),
    *((mount, ("tool",), _MOUNT) for mount in ("tool tilt", "tool turn", "tool shift")),
    *((edge.acts_on, (edge.where,), ((edge.driver, _OPENS, False),)) for edge in ROUGH),
    ("seat", ("tool",), (*_LEVEL, *_DRIFT)),
    ("straightness", LINKS, _DRIFT),
    ("length", LINKS, _DRIFT),
    ("tilt across the axis", JOINTS, _TILT),
    ("bearing", JOINTS, _BY_WRENCH),
    ("torsion", LINKS, _BY_WRENCH),
    ("bending", LINKS, _BY_WRENCH),
    ("hinge", LINKS, _BY_WRENCH),
    # A crack that does not close is a hinge; one that holds shut for a while is none.
    *((crack.acts_on, LINKS, ((crack.driver, (("opening", 0.0),), False),)) for crack in ROUGH_CRACKS),
    ("force bias", ("sensor",), (*_SENSOR, *_PULLED)),
    ("torque bias", ("sensor",), (*_SENSOR, *_PULLED)),
    (
        "sensor gain",
        ("sensor",),
        (("wrench", _TORQUE, True), ("time", _OVER_TIME, True), *_PLAIN[1:], *_PULLED),
    ),
    *(
        (name, ("sensor",), (("wrench", (("level", 0.0),), False),))
        for name in CARRIERS
        if name.startswith("crosstalk")
    ),
    (
        "reading",
        ("tracker",),
        (
            *_LEVEL,
            ("time", _OVER_TIME, True),
            ("time under load", _UNDER_LOAD, False),
            ("temperature", _WARM, False),
            ("angle of joint k", (("waves", 1.0), ("slope", 0.0)), False),
        ),
    ),
    *((name, ("tracker",), _DRIFT) for name in ("axes", "place")),
    *((name, ("tracker",), _SPEED) for name in ("drift", "turning")),
    *((name, ("tracker",), _LEVEL) for name in CARRIERS if name.startswith("axes ")),
    ("slip", None, (*_SENSOR, *_SLIP)),
    (
        "slip along the load",
        None,
        (("wrench", (("level", 0.0), *_DRAWN), False), ("time", _OVER_TIME, False)),
    ),
    ("holder", None, (("wrench", (("level", 0.0), ("size", 1.0)), False), *_PLAIN)),
)


def dictionary(case: LoadCase, reflectors: Sequence[str]) -> list[LawTerm]:
    """Every term that loadings can speak of: its driver was recorded and changed.

    Args:
        case: The loadings.
        reflectors: Names of the reflectors.
    """
    own = tuple(f"reflector {name}" for name in reflectors)
    # What twists along the axis of its own joint is the spring of that joint in other words.
    twisting = tuple(link for k, link in enumerate(LINKS) if not _along_its_axis(case, k))
    entries: list[Entry] = [
        (acts_on, own if places is None else twisting if acts_on == "torsion" else places, drives)
        for acts_on, places, drives in DICTIONARY
    ]
    entries += [
        (
            "spring",
            (joint,),
            tuple((friction.driver, (("slope", 0.0),), False) for friction in tried(case, k)),
        )
        for k, joint in enumerate(JOINTS)
    ]
    return terms(LawTerm, case, entries, range(1, 7))


def _along_its_axis(case: LoadCase, k: int) -> bool:
    """Whether the line of link k + 1 is the axis about which its joint turns."""
    line = case.origin[:, k + 1] - case.origin[:, k]
    beside = np.linalg.norm(cross(case.axis(k), line), axis=1)
    return bool(np.all(beside <= _NO_LENGTH + _NO_ANGLE * np.linalg.norm(line, axis=1)))
