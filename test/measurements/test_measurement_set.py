"""Measurement sets: what is read is what was written, and every fault is named with file, line and column."""

import os

import numpy as np
import pytest
import yaml
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from doormill_ros.errors import DataSetError
from doormill_ros.measurements.errors import DataFileError, SetDescriptionError, TrialTableError
from doormill_ros.measurements.sets.join_sets import check_same_model, join_sets
from doormill_ros.measurements.sets.measurement_set import COLUMNS, read_measurement_set

SET = """\
schema: doormill/measurement-set/1
robot: irb6600_175_255
model:
  joint_stiffness: [2.4e6, 2.1e6, 1.7e6, 3.4e5, 1.2e5, 4.6e4]
noise:
  displacement: 8e-6
  force: 0.3
  torque: 0.03
wrench_frame_rotation: 0.7688
load_point: [0.0, 0.0, 0.18]
reflectors:
  ee: {link: 6, position: [0.05, 0.0, 0.18]}
  2: {link: 0, position: [0.1, 0.0, 0.0]}
"""
ROWS = [
    "1,10.5,30,20.5,0,0.1,0.2,0.3,0.4,0.5,-1,0,1,1,1,1,1,2,3,4,5,6,ee,1e-5,2e-5,-3e-5",
    "7,50,30,,0,0.1,0.2,0.3,0.4,0.5,+1,0,1,1,1,1,-1,2,3,4,5,6,2,1e-5,2e-5,-3e-5",
]


HEADER = ",".join(COLUMNS)


def write(folder, text=SET, rows=ROWS, header=HEADER):
    (folder / "set.yaml").write_text(text)
    (folder / "trials.csv").write_text("\n".join([header, *rows]) + "\n")
    return folder


def test_a_set_is_read_as_written(tmp_path):
    data = read_measurement_set(write(tmp_path))
    assert data.trial.tolist() == [1, 7]
    assert data.noise.displacement == 8e-6
    np.testing.assert_array_equal(data.joint_stiffness, [2.4e6, 2.1e6, 1.7e6, 3.4e5, 1.2e5, 4.6e4])
    np.testing.assert_array_equal(data.q[0], [0, 0.1, 0.2, 0.3, 0.4, 0.5])
    np.testing.assert_array_equal(data.direction[:, 0], [-1, 1])
    np.testing.assert_array_equal(data.wrench[1], [-1, 2, 3, 4, 5, 6])
    np.testing.assert_array_equal(data.displacement[0], [1e-5, 2e-5, -3e-5])
    assert data.temperature[0] == 20.5
    assert np.isnan(data.temperature[1])
    assert data.reflector_link.tolist() == [6, 0]
    assert data.configuration.tolist() == [0, 0]
    assert not data.q.flags.writeable


def test_columns_may_stand_in_another_order_and_more_of_them(tmp_path):
    header = "remark," + ",".join(reversed(COLUMNS))
    rows = ["hello," + ",".join(reversed(row.split(","))) for row in ROWS]
    data = read_measurement_set(write(tmp_path, rows=rows, header=header))
    np.testing.assert_array_equal(data.wrench[1], [-1, 2, 3, 4, 5, 6])


def cell(row, column, value):
    cells = ROWS[row].split(",")
    cells[COLUMNS.index(column)] = value
    return [*ROWS[:row], ",".join(cells), *ROWS[row + 1 :]]


@pytest.mark.parametrize(
    ("rows", "line", "column"),
    [
        (cell(1, "q3", "abc"), 3, "q3"),
        (cell(0, "dx", ""), 2, "dx"),
        (cell(0, "fx", "nan"), 2, "fx"),
        (cell(1, "fx", "inf"), 3, "fx"),
        (cell(1, "a4", "2"), 3, "a4"),
        (cell(1, "a4", "0.5"), 3, "a4"),
        (cell(1, "trial", "1"), 3, "trial"),
        (cell(1, "trial", "1.5"), 3, "trial"),
        (cell(0, "dt", "-1"), 2, "dt"),
        (cell(0, "reflector", "nose"), 2, "reflector"),
        ([ROWS[0], ROWS[1] + ",9"], 3, str(len(COLUMNS) + 1)),
        ([ROWS[0], ROWS[1].rsplit(",", 1)[0]], 3, "dz"),
        ([], 1, "trial"),
    ],
)
def test_a_bad_cell_is_named(tmp_path, rows, line, column):
    with pytest.raises(TrialTableError, match=rf"trials\.csv: line {line}, column {column}: ") as caught:
        read_measurement_set(write(tmp_path, rows=rows))
    assert "\n" not in caught.value.message


def test_a_missing_column_is_named(tmp_path):
    header = ",".join(COLUMNS).replace("temperature", "temp")
    with pytest.raises(TrialTableError, match=r"line 1, column temperature"):
        read_measurement_set(write(tmp_path, header=header))


@pytest.mark.parametrize(
    ("old", "new", "line"),
    [
        ("measurement-set/1", "measurement-set/2", 1),
        ("irb6600_175_255", "c3po", 2),
        ("4.6e4]", "4.6e4, 1]", 4),
        ("4.6e4]", "-4.6e4]", 4),
        ("4.6e4]", "soft]", 4),
        ("displacement: 8e-6", "displacement: 0", 6),
        ("force: 0.3", "force: -1", 7),
        ("load_point: [0.0, 0.0, 0.18]", "load_point: 0.18", 10),
        ("link: 6", "link: 7", 12),
        ("link: 6, ", "", 12),
        ("position: [0.1, 0.0, 0.0]", "position: [0.1, 0.0]", 13),
    ],
)
def test_a_bad_description_is_named(tmp_path, old, new, line):
    assert old in SET
    with pytest.raises(SetDescriptionError, match=rf"set\.yaml: line {line}, column \d+: "):
        read_measurement_set(write(tmp_path, text=SET.replace(old, new)))


def test_yaml_that_is_none(tmp_path):
    with pytest.raises(SetDescriptionError, match=r"line 4, column 1: not YAML"):
        read_measurement_set(write(tmp_path, text="a: 1\nb: 2\nc: [1,\n"))
    with pytest.raises(SetDescriptionError, match="no mapping"):
        read_measurement_set(write(tmp_path, text="- 1\n"))


def test_files_that_are_missing_or_no_text(tmp_path):
    with pytest.raises(DataFileError, match=r"set\.yaml: line 1"):
        read_measurement_set(tmp_path)
    write(tmp_path)
    (tmp_path / "trials.csv").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(DataFileError, match=r"trials\.csv: line 1, column 1: is no UTF-8 text"):
        read_measurement_set(tmp_path)
    (tmp_path / "trials.csv").write_bytes(b"")
    with pytest.raises(
        TrialTableError, match=r"trials\.csv: line 1, column trial: the file is empty, it needs a header"
    ):
        read_measurement_set(tmp_path)


@pytest.mark.parametrize("name", ["set.yaml", "trials.csv"])
@pytest.mark.parametrize("mark", [b"", b"\xef\xbb\xbf"])
def test_the_first_byte_that_is_no_text_is_told_by_its_place(tmp_path, name, mark):
    write(tmp_path)
    text = (tmp_path / name).read_bytes().split(b"\n")
    text[1] = "3 µm, ".encode() + b"gr\xfc\xdfe" + text[1]
    (tmp_path / name).write_bytes(mark + b"\n".join(text))
    with pytest.raises(
        DataFileError, match=rf"{name}: line 2, column 9: is no UTF-8 text \(.*\), save it as UTF-8"
    ):
        read_measurement_set(tmp_path)


@pytest.mark.timeout(60)
@pytest.mark.parametrize("name", ["set.yaml", "trials.csv"])
def test_what_never_ends_is_not_read(tmp_path, name):
    """A pipe that nobody writes into, a device, and links to them."""
    for make in (os.mkfifo, lambda path: path.symlink_to("/dev/zero")):
        write(tmp_path)
        (tmp_path / name).unlink()
        make(tmp_path / name)
        with pytest.raises(
            DataFileError, match=r"cannot be opened \(a pipe, a device or a socket, not a regular file\)"
        ):
            read_measurement_set(tmp_path)
        (tmp_path / name).unlink()
    write(tmp_path)
    (tmp_path / name).rename(tmp_path / "elsewhere")
    (tmp_path / name).symlink_to("elsewhere")
    assert len(read_measurement_set(tmp_path)) == 2


@pytest.mark.parametrize("value", ["[irb6600_175_255]", "{name: irb6600_175_255}"])
def test_a_list_is_no_name(tmp_path, value):
    with pytest.raises(
        SetDescriptionError, match=r"line 2, column 8: robot is a (list|mapping), allowed is text"
    ):
        read_measurement_set(write(tmp_path, text=SET.replace("irb6600_175_255", value, 1)))


@pytest.mark.timeout(60)
def test_lists_of_aliases_that_multiply_are_refused(tmp_path):
    levels = [f"a{k}: &a{k} [{', '.join([f'*a{k - 1}'] * 9)}]" for k in range(1, 13)]
    bomb = "\n".join(["a0: &a0 [x, x, x, x, x, x, x, x, x]", *levels, "source: *a12", SET])
    with pytest.raises(SetDescriptionError, match="its aliases repeat more than the allowed 20000 values"):
        read_measurement_set(write(tmp_path, text=bomb))
    with pytest.raises(SetDescriptionError, match="an alias stands inside what it names"):
        read_measurement_set(write(tmp_path, text=f"round: &a [*a]\n{SET}"))


def test_an_alias_may_repeat_a_value(tmp_path):
    text = SET.replace("load_point: [", "load_point: &tip [").replace(
        "position: [0.05, 0.0, 0.18]", "position: *tip"
    )
    text = text.replace("reflectors:", "more: &more {}\nreflectors:")
    ordered = text.replace("reflectors:", f"many: [{', '.join(['*more'] * 5000)}]\nreflectors:")
    data = read_measurement_set(write(tmp_path, text=ordered))
    assert np.array_equal(data.reflectors["ee"].position, data.load_point)


@settings(max_examples=150, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(data=st.data())
def test_a_damaged_file_never_ends_in_another_error(tmp_path, data):
    """Whatever is cut out or overwritten, the reader either copes or raises a DataSetError."""
    write(tmp_path)
    path = tmp_path / data.draw(st.sampled_from(["set.yaml", "trials.csv"]))
    text = path.read_text()
    start = data.draw(st.integers(0, len(text)))
    stop = data.draw(st.integers(start, min(len(text), start + 40)))
    path.write_text(text[:start] + data.draw(st.text(max_size=6)) + text[stop:])
    try:
        read_measurement_set(tmp_path)
    except DataSetError as error:
        assert str(tmp_path) in error.message  # noqa: PT017 both ways out are right


def test_sets_are_joined_and_must_match(tmp_path):
    first, second, third = (tmp_path / name for name in "abc")
    for folder in (first, second, third):
        folder.mkdir()
        write(folder)
    document = yaml.safe_load(SET)
    document["load_point"] = [0.0, 0.0, 0.2]
    (third / "set.yaml").write_text(yaml.safe_dump(document))
    a, b, c = (read_measurement_set(folder) for folder in (first, second, third))
    joined = join_sets([a, b])
    assert joined.trial.tolist() == [1, 7, 8, 14]
    np.testing.assert_array_equal(joined.displacement, np.vstack([a.displacement, b.displacement]))
    with pytest.raises(DataSetError, match="load_point"):
        join_sets([a, c])
    check_same_model(a, c)  # another load point is no obstacle to a prediction
    softer = yaml.safe_load(SET)
    softer["model"]["joint_stiffness"][0] = 1e6
    (third / "set.yaml").write_text(yaml.safe_dump(softer))
    with pytest.raises(DataSetError, match="joint_stiffness"):
        check_same_model(a, read_measurement_set(third))
