"""Files of a diagnosis belong to one question."""

import pytest

from doormill_ros.diagnosis.core.telling.document import write_diagnosis
from doormill_ros.robot_model.model_file import MODEL_FILE
from support.full_disk import room_for


def test_no_model_of_an_earlier_question_stays_beside_a_new_diagnosis(tmp_path):
    write_diagnosis(tmp_path, {"verdict": "explained"}, {"robot": "r"}, "<p>first</p>")
    assert (tmp_path / MODEL_FILE).is_file()
    write_diagnosis(tmp_path, {"verdict": "consistent"}, None, "<p>second</p>")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["diagnosis.json", "report.html"]


@pytest.mark.parametrize("model", [None, {"robot": "second"}])
def test_a_disk_that_becomes_full_leaves_the_earlier_diagnosis(tmp_path, model):
    write_diagnosis(tmp_path, {"verdict": "explained"}, {"robot": "first"}, "<p>first</p>")
    before = {path.name: path.read_bytes() for path in tmp_path.iterdir()}
    with room_for(100), pytest.raises(OSError, match="too large"):
        # The report fits.
        write_diagnosis(tmp_path, {"verdict": "consistent", "remarks": ["long"] * 50}, model, "<p>second</p>")
    assert {path.name: path.read_bytes() for path in tmp_path.iterdir()} == before
