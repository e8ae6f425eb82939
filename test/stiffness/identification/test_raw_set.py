"""From raw tracker and force files to stiffness and back to the springs that made them."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest
import yaml
from scipy.spatial.transform import Rotation

from doormill_ros.diagnosis.errors import DataSetError
from doormill_ros.simulation.truth_robot import TruthRobot
from doormill_ros.stiffness.identification.raw_set import read_raw_set
from doormill_ros.stiffness.identification.weighted import fit_stiffness

TRUE = np.array([3.1e6, 1.7e6, 2.2e6, 2.6e5, 1.6e5, 6.1e4])
ROTATION = math.atan2(219.25, 226.66)
TRACKER = Rotation.from_rotvec([0.05, -0.03, 1.1])  # tracker axes to base axes
LOAD_POINT = np.array([0.0, 0.0, 0.18])
# Postures of the thesis, the force on the robot there (flange axes) and an arm, as it used them.
TESTS = {
    "joint1": ([0, 0, 0, 0, 0, 0], [0, -176, 0, 0, 0, 0]),
    "joint2": ([0, 0, -30, 0, 0, 0], None),
    "joint3": ([0, 0, 0, 0, 90, 0], [0, 0, 198, 0, 0, 0]),
    "joint4": ([0, 0, 0, 90, -90, 90], [197, 0, 0, 0, 0, 0]),
    "joint5": ([0, 0, 0, 0, 0, 0], [194, 0, 0, 0, 0, 0]),
    "joint6": ([0, 0, 0, 0, 90, 0], [178, 0, 0, 0, 0, -89.5]),
}
REFLECTORS = {
    "joint1": [(1, [-0.2, 0.3, 0.48])],
    "joint2": [(2, [0.025, 0.0, 0.0])],
    "joint3": [(6, [0.088, 0.0, 0.207]), (2, [0.0, 0.0, 0.05])],
    "joint4": [(6, [0.088, 0.0, 0.207]), (4, [0.1, 0.0, 0.0])],
    "joint5": [(6, [0.088, 0.0, 0.207]), (3, [0.0, 0.05, 0.0])],
    "joint6": [(6, [0.088, 0.25, 0.207]), (5, [0.0, 0.0, 0.1])],
}


def write_tracker(path, position, rng, settles):
    """Ten seconds at 100 Hz in tracker axes; a loaded reflector comes to rest first."""
    t = np.arange(1000) / 100
    swing = 2e-4 * np.exp(-t / 0.8) * np.cos(3 * t) if settles else 0 * t
    samples = TRACKER.inv().apply(position + np.array([0.3, 1.0, 0.2])) + swing[:, None]
    samples = samples + rng.normal(scale=2e-5, size=samples.shape)
    np.savetxt(path, np.column_stack([t + 512.5, samples]), fmt="%.9f")


def write_force(path, wrench_flange, rng, tare):
    c, s = math.cos(ROTATION), math.sin(ROTATION)
    R_sensor_flange = np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]])
    reading = (
        np.concatenate([R_sensor_flange @ wrench_flange[:3], R_sensor_flange @ wrench_flange[3:]]) + tare
    )
    samples = reading + rng.normal(scale=[1.0] * 3 + [0.1] * 3, size=(800, 6))
    table = np.column_stack([np.arange(800) / 100, samples])
    np.savetxt(path, table, delimiter=",", header="Time (s),Fx,Fy,Fz,Tx,Ty,Tz", comments="")


def write_raw(folder, robot, seed):
    rng = np.random.default_rng(seed)
    truth = TruthRobot(robot.dh, stiffness=TRUE)
    tare = np.array([12.0, -7.0, 40.0, 0.5, -0.3, 0.1])
    tests = []
    for name, (degrees, load) in TESTS.items():
        q = np.radians(degrees)[None]
        rest = truth.link_frames(q)
        test = {"name": name, "q": q[0].tolist(), "reflectors": []}
        if load is None:
            # A rope at the origin of frame 2 (joint 3): nothing behind it is loaded. Seen from the flange the
            # same load is a force and a couple, which bends joints 3 to 6 too, so these are made rigid.
            force, point = np.array([197.0, 0, 0]), rest[0, 2, :3, 3]
            stiff = TruthRobot(robot.dh, stiffness=np.array([*TRUE[:2], *[1e15] * 4]))
            lever = point - (rest[0, 6] @ np.append(LOAD_POINT, 1))[:3]
            bent = stiff.deflected_frames(
                q, np.concatenate([force, np.cross(lever, force)])[None], LOAD_POINT
            )
            test["load"] = {"link": 2, "point": [0.0, 0.0, 0.0], "force": force.tolist()}
        else:
            R = rest[0, 6, :3, :3]
            wrench = np.concatenate([R @ load[:3], R @ load[3:]])
            bent = truth.deflected_frames(q, wrench[None], LOAD_POINT)
            write_force(folder / f"{name}_force_1.csv", np.array(load, float), rng, tare)
            write_force(folder / f"{name}_force_0.csv", np.zeros(6), rng, tare)
            test["force"] = {"loaded": f"{name}_force_1.csv", "unloaded": f"{name}_force_0.csv"}
        for i, (link, position) in enumerate(REFLECTORS[name]):
            files = [f"FARO_{name}_{i}_{state}.txt" for state in "01"]
            for file, frames in zip(files, (rest, bent), strict=True):
                point = (frames[0, link] @ np.append(position, 1.0))[:3]
                write_tracker(folder / file, point, rng, settles=file.endswith("1.txt"))
            test["reflectors"].append(
                {"link": link, "position": position, "unloaded": files[0], "loaded": files[1]}
            )
        tests.append(test)
    document = {
        "schema": "doormill/raw-loading-tests/1",
        "robot": "irb6600_175_255",
        "wrench_frame_rotation": ROTATION,
        "load_point": LOAD_POINT.tolist(),
        "tracker_rotation": TRACKER.as_rotvec().tolist(),
        "noise": {"displacement": 1e-7, "force": 0.01, "torque": 0.001},
        "tests": tests,
    }
    (folder / "loading_tests.yaml").write_text(yaml.safe_dump(document), encoding="utf-8")
    return document


def test_raw_files_give_back_the_springs(tmp_path, robot, kinematics):
    write_raw(tmp_path, robot, seed=5)
    raw = read_raw_set(tmp_path)
    assert len(raw.loadings) == 10
    # 20 um samples, about 900 of them: the means are known to about a micrometre.
    assert raw.loadings.displacement_std.max() < 3e-6
    # The swing of the loaded reflector is not in the mean.
    assert all(w.start >= 100 for name, w in raw.windows.items() if name.endswith("_1.txt"))
    fit = fit_stiffness(kinematics, raw.loadings)
    pulls = (fit.compliance - 1.0 / TRUE) / np.sqrt(np.diag(fit.compliance_covariance))
    assert np.abs(pulls).max() < 4.5
    assert fit.stiffness == pytest.approx(TRUE, rel=0.05)


def test_a_wrong_mounting_angle_is_noticed(tmp_path, robot, kinematics):
    document = write_raw(tmp_path, robot, seed=6)
    good = fit_stiffness(kinematics, read_raw_set(tmp_path).loadings)
    document["wrench_frame_rotation"] = ROTATION + math.radians(20)
    (tmp_path / "loading_tests.yaml").write_text(yaml.safe_dump(document), encoding="utf-8")
    bad = fit_stiffness(kinematics, read_raw_set(tmp_path).loadings)
    assert good.chi_square < 3 * good.degrees_of_freedom
    assert bad.chi_square > 10 * bad.degrees_of_freedom


@pytest.mark.parametrize(
    ("change", "problem"),
    [
        (lambda d: d.update(schema="x"), "schema"),
        (lambda d: d.update(robot="nobody"), "no robot 'nobody'"),
        (lambda d: d.update(tests=[]), "at least one test"),
        (lambda d: d["noise"].update(displacement=0.0), "positive"),
        (lambda d: d["tests"][0].update(q=[0, 0]), "test 1 (joint1) has q [0, 0]"),
        (lambda d: d["tests"][0].pop("force"), "either 'force'"),
        (lambda d: d["tests"][0]["force"].pop("loaded"), "names no file under 'loaded'"),
        (lambda d: d["tests"][0]["reflectors"][0].update(link=7), "link 7"),
        (lambda d: d["tests"][1]["load"].update(force="much"), "has force 'much'"),
        (lambda d: d["tests"][2].update(reflectors=[]), "no reflectors"),
        (lambda d: d["tests"][2]["reflectors"][0].update(loaded="gone.txt"), "gone.txt: line 1, column 1"),
    ],
)
def test_complaints_are_one_line(tmp_path, robot, change, problem):
    document = write_raw(tmp_path, robot, seed=1)
    change(document)
    (tmp_path / "loading_tests.yaml").write_text(yaml.safe_dump(document), encoding="utf-8")
    with pytest.raises(DataSetError) as caught:
        read_raw_set(tmp_path)
    assert problem in caught.value.message
    assert "\n" not in caught.value.message
    assert "line " in caught.value.message


def test_tool_reads_raw_files(tmp_path, robot, capsys):
    from doormill_ros.tools.identify import main

    write_raw(tmp_path, robot, seed=9)
    assert main(["--raw", str(tmp_path), "--out", str(tmp_path / "out")]) == 0
    assert "10 loadings" in capsys.readouterr().out
    document = json.loads((tmp_path / "out" / "identification.json").read_text())
    assert document["stiffness"] == pytest.approx(TRUE, rel=0.05)
    assert len(document["windows"]) == 30  # 20 tracker files, 10 force logs
    # A broken file: one line that names it, nothing written.
    (tmp_path / "FARO_joint5_0_1.txt").write_text("0 1 2 3\n0.1 1 2 x\n")
    assert main(["--raw", str(tmp_path), "--out", str(tmp_path / "other")]) == 2
    assert "FARO_joint5_0_1.txt: line 2, column 4: 'x' is no number" in capsys.readouterr().err
    assert not (tmp_path / "other").exists()
