"""Motion instructions and what is asked about the robot."""

from __future__ import annotations

from doormill_ros.simulation.controller.rapid.context import Context
from doormill_ros.simulation.controller.rapid.faults import ERROR_NUMBERS, RapidFault
from doormill_ros.simulation.controller.rapid.library.predefined import predefined
from doormill_ros.simulation.controller.rapid.machine import Move
from doormill_ros.simulation.controller.rapid.scope import Reference
from doormill_ros.simulation.controller.rapid.types import Value, copy

#: What MoveL and its kin take after the target; `tail` in the routines below.
_TAIL = (
    "speeddata Speed \\num V | num T, zonedata Zone \\num Z, "
    "PERS tooldata Tool \\PERS wobjdata WObj \\switch Corr"
)
#: wobj0: the work object of the base frame.
_WOBJ0 = [False, True, "", [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0, 0.0]], [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0, 0.0]]]


def _move(
    context: Context,
    kind: str,
    target: Value,
    via: Value | None,
    speed: Value,
    v: float | None,
    t: float | None,
    zone: Value,
    z: float | None,
    tool: Reference,
    wobj: Reference | None,
    corr: bool,
) -> None:
    if corr:
        raise RapidFault("ERR_ARGVALERR", f"{kind} \\Corr: path corrections are not simulated")
    if v is not None:
        speed = [v, *speed[1:]]
    if z is not None:
        zone = [False, z, *zone[2:]]
    move = Move(
        kind,
        copy(target),
        copy(via),
        copy(speed),
        copy(zone),
        copy(tool[0][tool[1]]),
        copy(wobj[0][wobj[1]] if wobj is not None else _WOBJ0),
        t,
        context.file,
        context.line,
    )
    with context.interrupts.moving():
        context.machine.move(move)


@predefined(f"PROC MoveJ(robtarget ToPoint, {_TAIL})")
def move_j(context: Context, target: Value, *tail: Value) -> None:
    """Move the joints together to a target."""
    _move(context, "MoveJ", target, None, *tail)


@predefined(f"PROC MoveL(robtarget ToPoint, {_TAIL})")
def move_l(context: Context, target: Value, *tail: Value) -> None:
    """Move the tool on a straight line."""
    _move(context, "MoveL", target, None, *tail)


@predefined(f"PROC MoveC(robtarget CirPoint, robtarget ToPoint, {_TAIL})")
def move_c(context: Context, via: Value, target: Value, *tail: Value) -> None:
    """Move the tool on an arc through the circle point."""
    _move(context, "MoveC", target, via, *tail)


@predefined(f"PROC MoveAbsJ(jointtarget ToJointPos \\switch NoEOffs, {_TAIL})")
def move_abs_j(context: Context, target: Value, _no_offsets: bool, *tail: Value) -> None:
    """Move the joints to given angles."""
    _move(context, "MoveAbsJ", target, None, *tail)


@predefined("PROC WaitRob(\\switch InPos | switch ZeroSpeed)")
def wait_rob(context: Context, _in_position: bool, zero_speed: bool) -> None:
    """Wait until the robot stands at its last target, or with `ZeroSpeed` wherever it was stopped."""
    with context.interrupts.moving():
        if zero_speed:
            context.machine.wait_at_rest()
        else:
            context.machine.wait_in_position()


@predefined("PROC StopMove()")
def stop_move(context: Context) -> None:
    """Stop the robot on its path; without Quick, which RobotWare 7.21 did not take (docs/rapid.md, [V])."""
    context.machine.stop_motion(clear=False)


@predefined("PROC ClearPath()")
def clear_path(context: Context) -> None:
    """Forget the motions that are left."""
    context.machine.stop_motion(clear=True)


@predefined("PROC StartMove()")
def start_move(context: Context) -> None:
    """Go on after StopMove."""
    context.machine.restart_motion()


@predefined("PROC StorePath(\\switch KeepSync)")
def store_path(context: Context, _keep_sync: bool) -> None:
    """Put the path aside that the robot was stopped on, to move on another one."""
    context.machine.store_path()


@predefined("PROC RestoPath()")
def resto_path(context: Context) -> None:
    """Take the path up again that StorePath put aside; StartMove goes on with it."""
    context.machine.restore_path()


@predefined("PROC ConfL(\\switch On | switch Off)")
def conf_l(context: Context, _on: bool, off: bool) -> None:
    """Supervise the configuration of linear motions."""
    context.machine.supervise_configuration(linear=True, on=not off)


@predefined("PROC ConfJ(\\switch On | switch Off)")
def conf_j(context: Context, _on: bool, off: bool) -> None:
    """Use the configuration of joint motions."""
    context.machine.supervise_configuration(linear=False, on=not off)


@predefined("PROC SingArea(\\switch Wrist | switch Off)")
def sing_area(_context: Context, wrist: bool, _off: bool) -> None:
    """Interpolation near singularities; only the exact one is simulated."""
    if wrist:
        raise RapidFault("ERR_ARGVALERR", "SingArea \\Wrist is not simulated")


@predefined("PROC AccSet(num Acc, num Ramp)")
def acc_set(_context: Context, acceleration: float, ramp: float) -> None:
    """Accelerations in per cent; checked, and not driven."""
    for value in (acceleration, ramp):
        if not 0.0 < value <= 100.0:
            raise RapidFault("ERR_ARGVALERR", f"AccSet {value:g}: allowed is above 0 and up to 100 %")


@predefined("PROC VelSet(num Override, num Max)")
def vel_set(context: Context, override: float, largest: float) -> None:
    """Speed override is not simulated unless it is the default."""
    if override != 100.0:
        context.machine.log(
            "warning", "VelSet", f"override {override:g} % and limit {largest:g} are not simulated"
        )


@predefined("PROC GripLoad(PERS loaddata Load)")
def grip_load(_context: Context, _load: Reference) -> None:
    """The load is known to the simulated robot by other means."""


@predefined("FUNC robtarget CRobT(\\PERS tooldata Tool \\PERS wobjdata WObj)")
def c_rob_t(context: Context, tool: Reference | None, wobj: Reference | None) -> Value:
    """Where the robot stands, once it does."""
    if tool is None:
        raise RapidFault("ERR_ARGVALERR", "CRobT without \\Tool is not simulated: name the tool")
    context.machine.wait_in_position()
    return context.machine.current_target(tool[0][tool[1]], wobj[0][wobj[1]] if wobj is not None else _WOBJ0)


@predefined("FUNC pos CPos(\\PERS tooldata Tool \\PERS wobjdata WObj)")
def c_pos(context: Context, tool: Reference | None, wobj: Reference | None) -> Value:
    """Where the tool is at this moment, also while it moves."""
    if tool is None:
        raise RapidFault("ERR_ARGVALERR", "CPos without \\Tool is not simulated: name the tool")
    frame = wobj[0][wobj[1]] if wobj is not None else _WOBJ0
    return context.machine.current_target(tool[0][tool[1]], frame)[0]


@predefined(
    "FUNC jointtarget CalcJointT(\\switch UseCurWObjPos, robtarget Rob_target, PERS tooldata Tool "
    "\\PERS wobjdata WObj \\VAR errnum ErrorNumber)"
)
def calc_joint_t(
    context: Context,
    _current: bool,
    target: Value,
    tool: Reference,
    wobj: Reference | None,
    error: Reference | None,
) -> Value:
    """Joint angles of a target; one out of reach is ERR_OUTSIDE_REACH, or sets ErrorNumber."""
    frame = wobj[0][wobj[1]] if wobj is not None else _WOBJ0
    joints = context.machine.joints_of(target, tool[0][tool[1]], frame)
    if error is not None:
        error[0][error[1]] = 0.0 if joints is not None else float(ERROR_NUMBERS["ERR_OUTSIDE_REACH"])
    elif joints is None:
        raise RapidFault("ERR_OUTSIDE_REACH", "CalcJointT: the target is out of reach in its configuration")
    return [joints or [0.0] * 6, [9e9] * 6]


@predefined("FUNC robtarget CalcRobT(jointtarget Joint_target, PERS tooldata Tool \\PERS wobjdata WObj)")
def calc_rob_t(context: Context, joints: Value, tool: Reference, wobj: Reference | None) -> Value:
    """Target of joint angles."""
    frame = wobj[0][wobj[1]] if wobj is not None else _WOBJ0
    return context.machine.target_of(joints[0], tool[0][tool[1]], frame)


@predefined("PROC PathAccLim(bool AccLim \\num AccMax, bool DecelLim \\num DecelMax)")
def path_acc_lim(
    _context: Context, limited: bool, largest: float | None, slowing: bool, largest_slowing: float | None
) -> None:
    """Limits of the acceleration along the path [m/s^2]; checked, and not driven."""
    for on, value, name in ((limited, largest, "AccMax"), (slowing, largest_slowing, "DecelMax")):
        if on and (value is None or value < 0.1):
            raise RapidFault("ERR_ARGVALERR", f"PathAccLim TRUE: \\{name} is missing or below 0.1 m/s^2")


@predefined("PROC MotionSup(\\switch On | switch Off \\num TuneValue)")
def motion_sup(_context: Context, on: bool, off: bool, tune: float | None) -> None:
    """Collision detection; checked, and nothing collides."""
    if on == off:
        raise RapidFault("ERR_ARGVALERR", "MotionSup: allowed is one of \\On and \\Off")
    if tune is not None and not 1.0 <= tune <= 300.0:
        raise RapidFault("ERR_ARGVALERR", f"MotionSup \\TuneValue {tune:g}: allowed is 1 to 300 %")


@predefined("FUNC jointtarget CJointT()")
def c_joint_t(context: Context) -> Value:
    """Joint angles where the robot stands."""
    return [list(context.machine.current_joints()), [9e9] * 6]
