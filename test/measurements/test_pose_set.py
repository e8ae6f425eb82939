"""Reading: every fault in a set is named with file, line and column, and nothing is written."""

import numpy as np
import pytest
import yaml

from doormill_ros.diagnosis.pose.kind import Poses
from doormill_ros.errors import DataSetError
from doormill_ros.measurements.errors import PoseTableError, TrialTableError
from doormill_ros.measurements.sets.pose_set import placement_owners, read_pose_set
from doormill_ros.robot_model.pose.link_masses import published_masses
from doormill_ros.tools.diagnose import main


@pytest.fixture
def folder(tmp_path, write_pose_sets, faults):
    return write_pose_sets(tmp_path, faults(names=["one"]), 12, 1)[0]


def edit(path, old, new):
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new, 1))


def cell(folder, line, column, value):
    lines = (folder / "poses.csv").read_text().splitlines()
    cells = lines[line - 1].split(",")
    cells[lines[0].split(",").index(column)] = value
    lines[line - 1] = ",".join(cells)
    (folder / "poses.csv").write_text("\n".join(lines) + "\n")


def test_a_good_set_is_read(folder, invented):
    data = read_pose_set(folder)
    assert (data.robot, data.name, len(data)) == ("invented", "one", 12)
    np.testing.assert_array_equal(data.dh, invented["dh"])
    assert data.noise == invented["noise"]
    np.testing.assert_allclose(data.rotation @ np.swapaxes(data.rotation, 1, 2), [np.eye(3)] * 12, atol=1e-12)
    assert np.all(np.isnan(data.temperature))
    assert data.placement.sum() == 1


def test_noise_that_is_not_stated_is_known_as_assumed(folder):
    assert read_pose_set(folder).assumed == ()
    described = yaml.safe_load((folder / "set.yaml").read_text())
    for noise, assumed in (({"rotation": 5e-5}, ("position",)), (None, ("position", "rotation"))):
        (folder / "set.yaml").write_text(yaml.safe_dump(described | {"noise": noise}))
        assert read_pose_set(folder).assumed == assumed


def test_what_a_lab_notes_beside_is_left_alone(folder):
    described = yaml.safe_load((folder / "set.yaml").read_text())
    notes = {"note": "foggy", "operator": "K.", "links": 7}
    (folder / "set.yaml").write_text(yaml.safe_dump(described | notes))
    assert read_pose_set(folder).same_as == ""


def test_a_series_of_fewer_rows_than_blocks_is_checked_but_not_diagnosed(folder, tmp_path, capsys):
    lines = (folder / "poses.csv").read_text().splitlines(keepends=True)
    few = tmp_path / "few"
    few.mkdir()
    (few / "set.yaml").write_text((folder / "set.yaml").read_text())
    for rows in (5, 9):
        (few / "poses.csv").write_text("".join(lines[: rows + 1]))
        code = main(["--data", str(few), "--out", str(tmp_path / "out")])
        (message,) = capsys.readouterr().err.strip().splitlines()
        assert code == 2
        assert f"poses.csv: line {rows + 1}, column row: the table holds {rows} rows" in message
        assert "needs 10 at least" in message
        assert not (tmp_path / "out").exists()
    for line in (2, 3, 4):
        cell(few, line, "placement", "1")
    Poses().check_together([read_pose_set(folder)], [read_pose_set(few)])


@pytest.mark.parametrize(
    ("line", "column", "value", "problem"),
    [
        (3, "q4", "abc", "no number"),
        (5, "x", "nan", "not finite"),
        (5, "z", "", "no number"),
        (4, "qw", "3.0", "norm"),
        (6, "placement", "2", "allowed are 0 and 1"),
        (7, "row", "2", "ascend"),
        (7, "row", "2.5", "whole"),
    ],
)
def test_a_bad_cell_is_named(folder, tmp_path, capsys, line, column, value, problem):
    cell(folder, line, column, value)
    code = main(["--data", str(folder), "--out", str(tmp_path / "out")])
    message = capsys.readouterr().err.strip().splitlines()[-1]
    assert code == 2
    assert f"poses.csv: line {line}, column {column}" in message
    assert problem in message
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("file", "old", "new", "where"),
    [
        ("poses.csv", "temperature", "warmth", "column temperature"),
        ("set.yaml", "position: 1.5e-05", "position: -1", "noise.position"),
        ("set.yaml", "placement: fitted", "placement: known", "placement"),
        ("set.yaml", "mass: 13.0", "mass: heavy", "model.links"),
        (
            "set.yaml",
            "placement: fitted",
            "plaecment: same as one",
            "plaecment is read by nothing; write placement",
        ),
        ("set.yaml", "position: 1.5e-05", "positions: 1.5e-05", "noise.positions is read by nothing"),
        ("set.yaml", "- 0.13", "- high", "model.dh"),
    ],
)
def test_a_bad_description_is_named(folder, tmp_path, capsys, file, old, new, where):
    edit(folder / file, old, new)
    code = main(["--data", str(folder), "--out", str(tmp_path / "out")])
    message = capsys.readouterr().err.strip().splitlines()[-1]
    assert code == 2
    assert file in message
    assert "line " in message
    assert where in message
    assert not (tmp_path / "out").exists()


def test_sets_of_different_robots_are_refused(folder, tmp_path, write_pose_sets, faults, capsys):
    other = write_pose_sets(tmp_path / "b", faults(names=["two"]), 12, 2)[0]
    edit(other / "set.yaml", "robot: invented", "robot: another")
    arguments = ["--data", str(folder), "--data", str(other), "--out", str(tmp_path / "out")]
    assert main(arguments) == 2
    assert "robot is not the one" in capsys.readouterr().err


def test_a_set_to_check_without_marked_rows_is_refused(folder, tmp_path, write_pose_sets, faults, capsys):
    good = write_pose_sets(tmp_path / "b", faults(names=["two"]), 150, 2)[0]
    for line in range(2, 14):
        cell(folder, line, "placement", "0")
    code = main(["--data", str(good), "--check", str(folder), "--out", str(tmp_path / "out")])
    assert code == 2
    assert "placement 1" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


class TestPositionsAlone:
    @pytest.fixture
    def points(self, tmp_path, write_arm_sets, arm):
        return write_arm_sets(tmp_path / "points", arm(names=("one", "two"), same={"two": "one"}), 12, 1)

    def test_they_are_read_with_seven_joints(self, points):
        one, two = (read_pose_set(folder) for folder in points)
        assert (one.joints, one.oriented, one.same_as, two.same_as) == (7, False, "", "one")
        assert one.q.shape == (12, 7)
        assert one.dh.shape == (7, 4)
        assert len(one.links) == 7
        assert placement_owners([one, two]) == (0, 0)
        assert placement_owners([two, one]) == (0, 0)

    @pytest.mark.parametrize(
        ("file", "old", "new", "wanted"),
        [
            ("poses.csv", "q7", "q8", "column q7: the column is missing"),
            ("poses.csv", "placement", "qw", "column placement: the column is missing"),
            ("poses.csv", "temperature", "temperature,qx", "row has"),
            ("set.yaml", "placement: fitted", "placement: same", "allowed are fitted and 'same as NAME'"),
            ("set.yaml", "placement: fitted", "placement: same as three", "'three', of which 0 are given"),
            ("set.yaml", "placement: fitted", "placement: same as one", "'one', of which 0 are given"),
            ("set.yaml", "placement: fitted", "placement: [1]", "allowed are fitted"),
        ],
    )
    def test_what_is_wrong_is_said_in_a_sentence(self, points, tmp_path, capsys, file, old, new, wanted):
        edit(points[0] / file, old, new)
        code = main(["--data", str(points[0]), "--out", str(tmp_path / "out")])
        message = capsys.readouterr().err.strip().splitlines()[-1]
        assert code == 2
        assert wanted in message
        assert f"{file}: line " in message
        assert not (tmp_path / "out").exists()

    def test_a_part_of_an_orientation_is_none(self, folder):
        edit(folder / "poses.csv", "qx", "qq")
        with pytest.raises(TrialTableError, match="column qx: the column is missing"):
            read_pose_set(folder)

    def test_columns_of_orientation_with_nothing_in_them_are_those_of_a_point(self, folder):
        for line in range(2, 14):
            for column in ("qw", "qx", "qy", "qz"):
                cell(folder, line, column, "")
        data = read_pose_set(folder)
        assert (data.oriented, len(data)) == (False, 12)
        cell(folder, 5, "qy", "0.5")
        with pytest.raises(PoseTableError, match=r"line 2, column qw: is empty, allowed is .* leave out qw"):
            read_pose_set(folder)

    def test_more_joints_than_the_model_has_are_refused(self, folder):
        edit(folder / "poses.csv", "temperature", "q7")
        edit(folder / "poses.csv", ",t,", ",temperature,")
        lines = (folder / "poses.csv").read_text().splitlines()
        table = [line + (",t" if i == 0 else ",") for i, line in enumerate(lines)]
        (folder / "poses.csv").write_text("\n".join(table) + "\n")
        with pytest.raises(PoseTableError, match=r"column q7: model\.dh has 6 rows"):
            read_pose_set(folder)


def rewrite(folder, **model):
    described = yaml.safe_load((folder / "set.yaml").read_text())
    described["model"] |= model
    (folder / "set.yaml").write_text(yaml.safe_dump(described))
    return described["model"]


@pytest.mark.parametrize("links", [None, [], [None] * 6])
def test_links_of_which_nothing_is_known_count_as_left_out(folder, links):
    rewrite(folder, links=links)
    assert read_pose_set(folder).links == ()
    assert read_pose_set(folder).view.links == ()


def test_a_link_that_is_not_known_has_its_published_mass(folder):
    links = rewrite(folder)["links"]
    rewrite(folder, links=[*links[:2], None, *links[3:]])
    with pytest.raises(
        DataSetError, match=r"knows nothing of link 3, and nobody published the masses of invented"
    ):
        read_pose_set(folder)
    edit(folder / "set.yaml", "robot: invented", "robot: ur10")
    found = read_pose_set(folder).links
    published = published_masses("ur10")
    assert (found[2].mass, found[2].com.tolist()) == (published[2].mass, published[2].com.tolist())
    assert [link.mass for k, link in enumerate(found) if k != 2] == [
        link["mass"] for k, link in enumerate(links) if k != 2
    ]


def test_too_few_links_are_refused(folder):
    links = rewrite(folder)["links"]
    for few in (links[:3], [*links[:2], None], {"mass": 1.0}, 7):
        rewrite(folder, links=few)
        with pytest.raises(
            DataSetError, match=r"model\.links needs 6 entries .*, null for a link that is not known"
        ):
            read_pose_set(folder)


def test_a_list_is_no_source(folder):
    described = yaml.safe_load((folder / "set.yaml").read_text())
    (folder / "set.yaml").write_text(yaml.safe_dump(described | {"source": ["a lab", "a licence"]}))
    with pytest.raises(DataSetError, match=r"source is a list, allowed is text"):
        read_pose_set(folder)
