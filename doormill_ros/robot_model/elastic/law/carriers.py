"""What an effect acts on, as the motion of the measured point that one unit of it makes: one line a carrier.

A carrier times a shape of a driver is a term of a law: "spring of joint 2" times "logarithm of the time under load".
"""

from __future__ import annotations

from doormill_ros.frames import WRENCH_COMPONENTS
from doormill_ros.robot_model.elastic.law import chain, parts
from doormill_ros.robot_model.elastic.law.cracks import OPENING
from doormill_ros.robot_model.elastic.law.parts import Motion
from doormill_ros.robot_model.law.parts import Carrier, number_of

_XYZ = "xyz"

#: Carriers by what they act on, as in diagnosis.json.
CARRIERS: dict[str, Carrier[Motion]] = {
    "spring": Carrier(parts.spring, "1", 0.1, "gives way more"),
    "joint angle": Carrier(lambda case, where: [case.joint_twist(number_of(where))], "rad", 1e-5, "turns"),
    "joint angle with the load": Carrier(parts.with_load, "rad", 1e-5, "turns with the load"),
    **{
        f"coupling with joint {k + 1}": Carrier(
            parts.coupling(k), "rad / (N m)", 1e-8, f"and joint {k + 1} turn each by the other's torque"
        )
        for k in range(6)
    },
    "tilt across the axis": Carrier(parts.tilt, "rad / (N m)", 1e-7, "tilts across its axis"),
    "bearing": Carrier(parts.yielding(-1), "m / N", 1e-7, "yields to the force"),
    "torsion": Carrier(parts.torsion, "rad / (N m^2)", 1e-7, "twists about its length"),
    "bending": Carrier(parts.bending, "1 / (N m^2)", 1e-7, "bends"),
    "hinge": Carrier(parts.hinge, "rad / (N m)", 1e-7, "gives way at its middle", True, 3),
    "straightness": Carrier(parts.crooked, "rad", 1e-5, "bends at its middle, whatever the load,", True, 2),
    "length": Carrier(parts.longer, "m", 1e-5, "grows"),
    "seat": Carrier(
        parts.seat, "rad", 1e-5, "turns about x, y, z of the flange, whatever the load,", True, 3
    ),
    "base tilt": Carrier(parts.mount(0, (0, 1)), "rad / (N m)", 1e-8, "tilts"),
    "base turn": Carrier(parts.mount(0, (2,)), "rad / (N m)", 1e-8, "turns about its upright axis"),
    "base shift": Carrier(parts.yielding(0), "m / N", 1e-7, "yields to the force"),
    "tool tilt": Carrier(parts.mount(6, (0, 1)), "rad / (N m)", 1e-6, "tilts"),
    "tool turn": Carrier(parts.mount(6, (2,)), "rad / (N m)", 1e-6, "turns about the axis of the flange"),
    "tool shift": Carrier(parts.yielding(6), "m / N", 1e-7, "yields to the force"),
    **{name: Carrier(one.motion, "rad", 1e-5, one.does) for name, one in OPENING.items()},
    "force bias": Carrier(chain.bias((0, 1, 2)), "N", 5.0, "reads a force too small", False, 3),
    "torque bias": Carrier(chain.bias((3, 4, 5)), "N m", 5.0, "reads a torque too small", False, 3),
    "sensor gain": Carrier(chain.gain, "1", 0.05, "reads too small a share", False),
    **{
        f"crosstalk {WRENCH_COMPONENTS[of]} into {WRENCH_COMPONENTS[into]}": Carrier(
            chain.crosstalk(of, into),
            "1" if of // 3 == into // 3 else ("m" if into >= 3 else "1 / m"),
            {(0, 0): 0.05, (1, 1): 0.05, (0, 1): 0.02, (1, 0): 0.1}[of // 3, into // 3],
            f"reads too little {WRENCH_COMPONENTS[into]} by a share of {WRENCH_COMPONENTS[of]}",
            False,
        )
        for of in range(6)
        for into in range(6)
    },
    "reading": Carrier(chain.shift, "m", 1e-5, "reads along x, y, z", False, 3),
    "axes": Carrier(chain.turned, "rad", 0.01, "stands turned about x, y, z", False, 3),
    "place": Carrier(chain.turning, "rad, m", 1e-5, "turns about and moves along x, y, z", False, 6),
    "drift": Carrier(chain.drifting(chain.shift), "m / s", 1e-7, "drifts along x, y, z", False, 3),
    "turning": Carrier(chain.drifting(chain.turning), "rad / s, m / s", 1e-7, "turns and drifts", False, 6),
    **{
        f"axes {_XYZ[of]} into {_XYZ[into]}": Carrier(
            chain.skew(of, into), "1", 0.05, f"adds to {_XYZ[into]} a share of {_XYZ[of]}", False
        )
        for of in range(3)
        for into in range(3)
    },
    "slip": Carrier(chain.slip, "m", 1e-5, "slips along x, y, z of its link", False, 3),
    "slip along the load": Carrier(chain.drawn, "m", 1e-5, "slips along the force", False),
    "holder": Carrier(chain.swing, "1", 0.1, "moves more than its link", False),
}
