"""A picture in a file is read as the same bytes in a message are: as deep, as turned and as whole."""

from __future__ import annotations

import errno
import io
import os
from pathlib import Path
from types import SimpleNamespace as Message

import numpy as np
import pytest
from PIL import Image

from doormill_ros.localization.errors import BadPicture
from doormill_ros.localization.pictures.picture_file import read_picture, write_picture
from doormill_ros.messages.picture import picture_of


def scene(rows: int = 96, columns: int = 128) -> np.ndarray:
    y, x = np.mgrid[:rows, :columns]
    noise = np.random.default_rng(5).normal(0, 2, (rows, columns))
    return np.clip(90 + 60 * (x > columns // 2) + 0.5 * y + noise, 0, 255).astype(np.uint8)


def file_of(values: np.ndarray, kind: str, **options: object) -> bytes:
    """By another library than the one that reads it."""
    out = io.BytesIO()
    Image.fromarray(values).save(out, kind, **options)
    return out.getvalue()


def turned(orientation: int) -> Image.Exif:
    exif = Image.Exif()
    exif[0x0112] = orientation
    return exif


GREY = scene()
WHOLE = {
    "8 bit": file_of(GREY, "PNG"),
    **{f"{n} of 16 bit": file_of(GREY.astype(np.uint16) << (n - 8), "PNG") for n in (10, 12, 14, 16)},
    "colours": file_of(np.stack([GREY, GREY // 2, GREY // 3], axis=2), "PNG"),
    "see through": file_of(np.stack([GREY, GREY // 2, GREY // 3, GREY], axis=2), "PNG"),
    "jpeg": file_of(GREY, "JPEG", quality=95),
    **{f"turned {n}": file_of(GREY, "JPEG", quality=95, exif=turned(n)) for n in (3, 6, 8)},
}


@pytest.mark.parametrize("name", WHOLE)
def test_a_file_is_read_as_the_node_reads_it(name: str, tmp_path: Path) -> None:
    path = tmp_path / "picture"
    path.write_bytes(WHOLE[name])
    picture = read_picture(path)
    assert (picture.dtype, picture.shape) == (np.uint8, GREY.shape)
    assert np.array_equal(picture, picture_of(Message(format="", data=WHOLE[name])))
    assert picture.max() > 100


@pytest.mark.parametrize("part", [0.0, 0.5, 0.8])
@pytest.mark.parametrize("name", ["8 bit", "jpeg"])
def test_what_the_node_refuses_is_refused_with_its_file(name: str, part: float, tmp_path: Path) -> None:
    path = tmp_path / "picture"
    path.write_bytes(WHOLE[name][: int(part * len(WHOLE[name]))])
    with pytest.raises(BadPicture) as refused:
        read_picture(path)
    assert refused.value.message.startswith(f"{path}: a ")


def test_where_no_file_is_no_picture_is_read(tmp_path: Path) -> None:
    with pytest.raises(BadPicture, match="no picture that can be read"):
        read_picture(tmp_path / "none.png")
    with pytest.raises(BadPicture, match="no picture that can be read"):
        read_picture(tmp_path)


def test_a_picture_that_cannot_be_put_in_place_leaves_the_one_before(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "a.png"
    write_picture(np.full((20, 30, 3), 90, np.uint8), path)
    before = path.read_bytes()

    def full(_source: Path, _target: Path) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(os, "replace", full)
    with pytest.raises(OSError, match="No space left"):
        write_picture(np.zeros((40, 60, 3), np.uint8), path)
    assert path.read_bytes() == before
    assert list(tmp_path.iterdir()) == [path]
