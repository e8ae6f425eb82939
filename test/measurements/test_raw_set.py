"""From raw tracker and force files to stiffness and back to the springs that made them."""

from __future__ import annotations

import dataclasses
import json
import math

import numpy as np
import pytest
import yaml
from scipy.spatial.transform import Rotation

from doormill_ros.errors import DataSetError
from doormill_ros.identification.weighted import fit_stiffness
from doormill_ros.measurements.errors import LoadingTestError
from doormill_ros.measurements.raw.raw_set import read_raw_set
from doormill_ros.resources import share_directory
from doormill_ros.simulation.truth.robot import TruthRobot
from doormill_ros.thesis.procedure import thesis_stiffness

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
    # A on the axis of joint 4, 0.269 m from joint 3; B 0.095 m from that axis (A.11).
    "joint4": [(3, [0.0, 0.0, 0.18]), (4, [0.095, 0.0, 0.0]), (6, [0.088, 0.0, 0.207])],
    # A on the forearm, B on the axis of joint 5, C at the flange.
    "joint5": [(3, [0.1, 0.0, 0.3]), (4, [0.0, 0.0, 0.0]), (6, [0.088, 0.0, 0.207])],
    "joint6": [(6, [0.088, 0.25, 0.207]), (5, [0.0, 0.0, 0.1])],
}

THESIS = {
    "joint1": {"joint": 1, "force": "fy", "load_arm": 1.842, "lever": math.hypot(0.12, 0.48)},
    "joint2": {"joint": 2, "load_arm": 1.075, "lever": 1.1},
    "joint3": {"joint": 3, "lever": math.hypot(1.054, 0.207)},
    "joint4": {"joint": 4, "force": "fx", "load_arm": 0.38, "lever": math.hypot(0.18, 0.2), "radius": 0.095},
    "joint5": {"joint": 5, "force": "fx", "load_arm": 0.38},
    "joint6": {"joint": 6, "lever": math.hypot(0.088, 0.25)},
}


def write_tracker(path, position, rng, settles, noise):
    """Ten seconds at 100 Hz in tracker axes; a loaded reflector comes to rest first."""
    t = np.arange(1000) / 100
    swing = 2e-4 * np.exp(-t / 0.8) * np.cos(3 * t) if settles else 0 * t
    samples = TRACKER.inv().apply(position + np.array([0.3, 1.0, 0.2])) + swing[:, None]
    samples = samples + rng.normal(scale=noise, size=samples.shape)
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


def write_raw(folder, robot, seed, stiffness=TRUE, noise=2e-5):
    rng = np.random.default_rng(seed)
    truth = TruthRobot(robot.dh, stiffness=stiffness)
    tare = np.array([12.0, -7.0, 40.0, 0.5, -0.3, 0.1])
    tests = []
    for name, (degrees, load) in TESTS.items():
        q = np.radians(degrees)[None]
        rest = truth.link_frames(q)
        test = {"name": name, "q": q[0].tolist(), "reflectors": [], "thesis": THESIS[name]}
        if load is None:
            # A rope at the origin of frame 2 (joint 3): nothing behind it is loaded. Seen from the flange the
            # same load is a force and a couple, which bends joints 3 to 6 too, so these are made rigid.
            force, point = np.array([197.0, 0, 0]), rest[0, 2, :3, 3]
            stiff = TruthRobot(robot.dh, stiffness=np.array([*stiffness[:2], *[1e15] * 4]))
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
                write_tracker(folder / file, point, rng, file.endswith("1.txt"), noise)
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
    assert len(raw.loadings) == 12
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


def formulas(tmp_path, robot, kinematics, stiffness, seed=3):
    write_raw(tmp_path, robot, seed, stiffness, noise=1e-7)
    found = thesis_stiffness(kinematics, read_raw_set(tmp_path).tests, robot.stiffness)
    assert [f.joint for f in found] == [1, 2, 3, 4, 5, 6]
    return np.array([f.stiffness for f in found])


@pytest.mark.parametrize("joint", range(1, 7))
def test_formula_of_a_joint_that_gives_way_alone(tmp_path, robot, kinematics, joint):
    """With one joint soft its formula gives it back; the noise of the logs is left, that of the tracker is not."""
    stiffness = np.full(6, 1e13)
    stiffness[joint - 1] = TRUE[joint - 1]
    # Joints 3 and 6 take the robot's own joints 2 and 1 off where no test makes them soft: make these rigid too.
    rigid = robot if joint in (1, 2) else dataclasses.replace(robot, stiffness=np.full(6, 1e13))
    write_raw(tmp_path, robot, seed=joint, stiffness=stiffness, noise=1e-7)
    tests = [t for t in read_raw_set(tmp_path).tests if t.thesis["joint"] == joint]
    found = thesis_stiffness(kinematics, tests, rigid.stiffness)
    assert len(found) == 1
    assert found[0].stiffness == pytest.approx(TRUE[joint - 1], rel=0.01)


def test_formulas_when_every_joint_gives_way(tmp_path, robot, kinematics):
    """Tests 1 and 2 isolate their joint; the other formulas are wrong by what they do not take off."""
    ratio = formulas(tmp_path, robot, kinematics, TRUE) / TRUE
    assert ratio[:2] == pytest.approx(1.0, abs=0.01)
    # Joint 2's displacement taken at the load point is not the reflector's: a tenth.
    assert 0.85 < ratio[2] < 1.15
    # (3.14) takes off more than joint 4 turned: the rotation and with it the stiffness come out negative.
    assert ratio[3] < 0
    # Pucks beside the joint see joint 5 alone.
    assert ratio[4] == pytest.approx(1.0, abs=0.01)
    # Joint 5 bends under the rope of test 6 and is read as joint 6.
    assert ratio[5] < 0.8


def test_formula_of_joint_4_drowns_in_noise(tmp_path, robot, kinematics):
    """Its angle is a tenth of joint 4's turn, (3.14) takes the noise of A off: 20 um samples spoil it."""
    stiffness = np.full(6, 1e13)
    stiffness[3] = TRUE[3]
    found = [formulas(tmp_path, robot, kinematics, stiffness, seed)[3] / TRUE[3] for seed in range(3)]
    write_raw(tmp_path, robot, 0, stiffness)
    noisy = thesis_stiffness(kinematics, read_raw_set(tmp_path).tests, robot.stiffness)[3].stiffness / TRUE[3]
    assert np.abs(np.array(found) - 1).max() < 0.01
    assert abs(noisy - 1) > 0.1


@pytest.mark.parametrize(
    ("thesis", "problem"),
    [
        ({"joint": 7}, "thesis joint 7"),
        ({"joint": 1, "force": "up", "load_arm": 1.0, "lever": 1.0}, "thesis force 'up'"),
        ({"joint": 1, "force": "fy", "load_arm": 1842, "lever": 1.0}, "thesis load_arm 1842"),
        ({"joint": 3}, "thesis lever None"),
        ({"joint": 5, "force": "fx", "load_arm": 0.38}, "needs 3"),
    ],
)
def test_formula_complaints(tmp_path, robot, kinematics, thesis, problem):
    document = write_raw(tmp_path, robot, seed=1)
    document["tests"][0]["thesis"] = thesis
    (tmp_path / "loading_tests.yaml").write_text(yaml.safe_dump(document), encoding="utf-8")
    with pytest.raises(LoadingTestError, match=problem):
        thesis_stiffness(kinematics, read_raw_set(tmp_path).tests, robot.stiffness)


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
    assert "12 loadings" in capsys.readouterr().out
    document = json.loads((tmp_path / "out" / "identification.json").read_text())
    assert document["stiffness"] == pytest.approx(TRUE, rel=0.05)
    assert [f["joint"] for f in document["thesis_formulas"]] == [1, 2, 3, 4, 5, 6]
    assert len(document["windows"]) == 34  # 24 tracker files, 10 force logs
    # A broken file: one line that names it, nothing written.
    (tmp_path / "FARO_joint5_0_1.txt").write_text("0 1 2 3\n0.1 1 2 x\n")
    assert main(["--raw", str(tmp_path), "--out", str(tmp_path / "other")]) == 2
    assert "FARO_joint5_0_1.txt: line 2, column 4: 'x' is no number" in capsys.readouterr().err
    assert not (tmp_path / "other").exists()


def test_page_says_what_the_formulas_make_of_the_shipped_stiffness(tmp_path, robot, kinematics):
    ratio = formulas(tmp_path, robot, kinematics, np.array(robot.stiffness)) / robot.stiffness
    page = (share_directory() / "docs" / "thesis.md").read_text(encoding="utf-8")
    line = next(line for line in page.splitlines() if line.startswith("| found / true |"))
    printed = [float(cell) for cell in line.strip("| ").split("|")[1:]]
    assert printed == pytest.approx(ratio, abs=0.006)
