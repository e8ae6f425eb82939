"""Files of a diagnosis belong to one question."""

from doormill_ros.diagnosis.core.telling.document import write_diagnosis
from doormill_ros.robot_model.model_file import MODEL_FILE


def test_no_model_of_an_earlier_question_stays_beside_a_new_diagnosis(tmp_path):
    write_diagnosis(tmp_path, {"verdict": "explained"}, {"robot": "r"}, "<p>first</p>")
    assert (tmp_path / MODEL_FILE).is_file()
    write_diagnosis(tmp_path, {"verdict": "consistent"}, None, "<p>second</p>")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["diagnosis.json", "report.html"]
