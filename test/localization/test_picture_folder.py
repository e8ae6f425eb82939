"""Files of a folder come one by one, each once, in the order that people number them in."""

from __future__ import annotations

from pathlib import Path

import pytest

from doormill_ros.localization.errors import BadPicture
from doormill_ros.localization.pictures.picture_folder import LARGEST, PictureFolder


def test_files_come_in_order_and_once_and_later_ones_too(tmp_path: Path) -> None:
    folder = PictureFolder(tmp_path / "pictures")
    assert folder.take() is None
    folder.path.mkdir()
    (folder.path / "door3.png").mkdir()
    for name in ("door10.png", "door9.JPG", "door2.jpeg", "notes.txt", ".door1.png"):
        (folder.path / name).write_bytes(name.encode())
    assert [folder.take().name for _ in range(3)] == ["door2.jpeg", "door9.JPG", "door10.png"]
    assert folder.take() is None
    (folder.path / "door1.png").write_bytes(b"late")
    assert folder.left == 1
    assert folder.read(folder.take()) == b"late"
    assert folder.left == 0


def test_what_is_gone_or_too_large_is_refused(tmp_path: Path) -> None:
    folder = PictureFolder(tmp_path)
    with pytest.raises(BadPicture, match="cannot be read"):
        folder.read(tmp_path / "gone.png")
    with open(tmp_path / "large.png", "wb") as file:
        file.truncate(LARGEST + 1)
    with pytest.raises(BadPicture, match=f"{LARGEST + 1} bytes"):
        folder.read(folder.take())
