"""What asks aravis' fake camera is collected only where aravis is installed."""

from __future__ import annotations

from support.gige.fake_camera import installed

collect_ignore = [] if installed() else ["test_ten_doors.py"]
