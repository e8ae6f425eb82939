import numpy as np
import pytest

from doormill_ros.robot.kinematics import Kinematics
from doormill_ros.workspace.doors import DoorRange, FlangeBox, thesis_box
from doormill_ros.workspace.posture import R_AT_HINGE, posture_figures
from doormill_ros.workspace.region import RegionRules, _sliding_minimum, assess, survey
from support.inverse_kinematics import inverse_all


def test_travel_of_table_4_4():
    np.testing.assert_allclose(DoorRange().travel(), [0.100, 0.580, 2.700])


def test_travel_without_the_thesis_simplifications():
    # Doors are 30 to 100 mm thick, and sections 3.7 and A.1 print 290 mm for the narrowest.
    doors = DoorRange(thickness=(0.030, 0.100), width=(0.290, 1.350))
    np.testing.assert_allclose(doors.travel(), [0.070, 0.530, 2.700])


def test_box_of_the_thesis_has_its_travel():
    np.testing.assert_allclose(thesis_box().size, DoorRange().travel())
    samples = thesis_box().samples(0.05)
    np.testing.assert_allclose(samples[0, 0, 0], [1.3, -0.29, 0])
    np.testing.assert_allclose(samples[-1, -1, -1], [1.4, 0.29, 2.7])
    assert samples.shape == (3, 13, 55, 3)


@pytest.mark.parametrize(
    "wrong",
    [{"width": (1.0, 0.5)}, {"thickness": (-0.1, 0.1)}, {"hinge_end": 1.5}, {"thickness": (0.0, 0.0)}],
)
def test_impossible_doors_are_refused(wrong):
    with pytest.raises(ValueError, match="allowed is"):
        DoorRange(**wrong)


@pytest.mark.parametrize("lowest_axis_5", [-120, -60])
def test_figures_by_plain_search(irb6600, lowest_axis_5):
    limits = np.radians([-180, -65, -180, -300, lowest_axis_5, -300])
    irb6600 = type(irb6600)(**{**irb6600.__dict__, "lower": limits})
    rng = np.random.default_rng(3)
    positions = rng.uniform([0.8, -0.8, -0.5], [2.4, 0.8, 2.8], (120, 3))
    T = np.tile(np.eye(4), (len(positions), 1, 1))
    T[:, :3, :3], T[:, :3, 3] = R_AT_HINGE, positions
    kinematics = Kinematics(irb6600)
    unlimited = type(irb6600)(**{**irb6600.__dict__, "lower": np.full(6, -np.pi), "upper": np.full(6, np.pi)})
    found = inverse_all(unlimited, T)
    seen = 0
    for posture in range(4):
        figures = posture_figures(irb6600, positions, posture)
        for index in range(len(positions)):
            q = found.q[(found.pose == index) & (found.branch // 2 == posture)]
            if not len(q):
                assert figures.margin[index] == -np.inf
                assert figures.conditioning[index] == 0.0
                continue
            seen += 1
            J = kinematics.jacobian(q[0])
            C = J[:3] @ np.diag(1 / irb6600.stiffness) @ J[:3].T
            assert figures.stiffness[index] == pytest.approx(1 / np.linalg.eigvalsh(C)[-1])
            assert figures.wrist[index] == pytest.approx(min(abs(q[0, 4]), np.pi - abs(q[0, 4])), abs=1e-9)
            room = np.minimum(q - irb6600.lower, irb6600.upper - q)[:, [0, 1, 2, 4]].min(axis=1).max()
            assert figures.margin[index] == pytest.approx(room)
            elbow = kinematics.link_frames(q[0])[2, 0, 3]
            assert figures.clearance[index] == pytest.approx(positions[index, 0] - elbow)
    assert seen > 200


@pytest.mark.parametrize("cells", [(0, 1, 2), (3, 2, 5), (2, 12, 4)])
def test_sliding_minimum_by_loops(cells):
    values = np.random.default_rng(4).normal(size=(6, 15, 9))
    found = _sliding_minimum(values, np.array(cells))
    nx, ny, nz = np.array(values.shape) - cells
    assert found.shape == (nx, ny, nz)
    for i in range(nx):
        for j in range(ny):
            for k in range(nz):
                box = values[i : i + cells[0] + 1, j : j + cells[1] + 1, k : k + cells[2] + 1]
                assert found[i, j, k] == box.min()


def test_the_region_of_the_thesis_holds_a_wrist_singularity(irb6600):
    # Table 4.6 lists the corners, and they are fine; in between, straight ahead of the foot and two
    # metres up, axes 4 and 6 fall in line.
    placement = assess(irb6600, thesis_box())
    assert placement.wrist < np.radians(1)
    assert "axis 5" in placement.refusal
    corner = posture_figures(irb6600, np.array([[1.4, 0.29, 0.0], [1.4, 0.29, 2.7]]), 0)
    np.testing.assert_allclose(np.degrees(corner.wrist), [180 - 104.10, 39.46], atol=0.01)


@pytest.fixture(scope="module", params=["irb6600", "irb6700"])
def found(request):
    robot = request.getfixturevalue(request.param)
    return robot, survey(robot, DoorRange()).best()


def test_best_region_keeps_to_the_rules_everywhere(found):
    robot, result = found
    rules = RegionRules()
    best = result.best
    assert not best.refusal
    assert best.margin >= rules.margin
    assert best.wrist >= rules.wrist
    assert best.clearance >= rules.clearance
    assert best.corner[0] >= rules.distance
    # Assessed anew, sampled finer than the search did.
    again = assess(robot, FlangeBox(best.corner, best.size), best.posture, pitch=0.03)
    assert again.refusal == ""
    assert again.margin > rules.margin * 0.9
    assert again.wrist > rules.wrist * 0.9
    assert again.conditioning > 0.9 * best.conditioning


def test_best_region_beats_the_thesis_by_far(found):
    robot, result = found
    reference = assess(robot, thesis_box())
    assert result.best.conditioning > 10 * reference.conditioning


def test_no_allowed_place_on_the_lattice_is_better(found):
    _, result = found
    values = result.worst["conditioning"][result.allowed]
    # The best may have been passed over only because no configuration leads through its box.
    assert result.best.conditioning <= values.max()
    assert (values > result.best.conditioning).sum() < 5


def test_a_mirrored_box_is_as_good(irb6600):
    box = FlangeBox(np.array([1.25, 0.4, -0.2]), np.array([0.1, 0.3, 1.0]))
    mirrored = FlangeBox(np.array([1.25, -0.7, -0.2]), box.size)
    a, b = assess(irb6600, box), assess(irb6600, mirrored)
    for name in ("conditioning", "stiffness", "margin", "wrist", "clearance"):
        assert getattr(a, name) == pytest.approx(getattr(b, name), rel=1e-9)


def test_pedestal_raises_the_base_to_the_box(irb6600):
    placement = assess(irb6600, FlangeBox(np.array([1.3, 0.4, -0.2]), np.array([0.1, 0.1, 0.2])))
    # Lowest hinge 0.9 m above the floor and 0.2 m below the base.
    assert placement.pedestal_height(0.9) == pytest.approx(1.1)


def test_rules_that_nothing_keeps_find_nothing(irb6600):
    doors = DoorRange(width=(0.9, 1.0))
    found = survey(irb6600, doors, RegionRules(margin=np.radians(60)))
    assert found.best().best is None
    assert not any(allowed.any() for allowed in found.allowed.values())
    with pytest.raises(ValueError, match="conditioning and stiffness"):
        found.best("beauty")
