"""Several series at once: each is told by its name, and counts by its own noise."""

import pytest

from doormill_ros.diagnosis.pose.diagnosis import PoseQuestion
from doormill_ros.measurements.errors import SetMixError
from doormill_ros.measurements.pose_set import read_pose_set
from doormill_ros.tools.diagnose import main


def test_two_series_of_one_name_are_refused(tmp_path, write_arm_sets, arm, capsys):
    """A step in one of them would be laid on both."""
    folders = write_arm_sets(tmp_path, arm(names=("mon/poses", "tue/poses")), 40, 1)
    arguments = [part for folder in folders for part in ("--data", str(folder))]
    assert main([*arguments, "--out", str(tmp_path / "out")]) == 2
    told = capsys.readouterr().err
    assert "tue/poses/set.yaml: line 1, column 1: the folder is called poses" in told
    assert "mon/poses" in told
    assert not (tmp_path / "out").exists()
    with pytest.raises(SetMixError, match="rename"):
        PoseQuestion([read_pose_set(folder) for folder in folders])
