"""Pictures as cameras of all kinds send them, to the localizer's node: the same door, or an answer under the run."""

from __future__ import annotations

import array
import io
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from PIL import Image as Pillow
from rclpy.context import Context
from rclpy.parameter import Parameter
from sensor_msgs.msg import CompressedImage

from doormill_interfaces.msg import DoorLocalization
from doormill_ros.cell.errors import BadParameterError
from doormill_ros.localization.errors import BadPicture, CameraInfoSize
from doormill_ros.messages.picture import ENCODINGS
from doormill_ros.nodes.base import topics
from doormill_ros.nodes.door_localizer import DoorLocalizer
from support.localizer_node import Localizer

BROWN = np.array([1.25, 1.0, 0.62])  # red, green and blue of wood, as shares of its grey
PLACE, TURN = 3e-6, 3e-5  # m, rad that rounding may move a door
MOSAIC_PLACE, MOSAIC_TURN = 1e-5, 1e-4  # half of the pixels of each colour are made up of their neighbours


@pytest.fixture
def localizer(
    recorded: dict[str, bytes], context: Context, request: pytest.FixtureRequest
) -> Iterator[Localizer]:
    localizer = Localizer(recorded, context, **getattr(request, "param", {}))
    localizer.send(topics.CAMERA_INFO)
    yield localizer
    localizer.node.close()
    localizer.node.destroy_node()


def grey_of(localizer: Localizer) -> np.ndarray:
    message = localizer.good[topics.IMAGE.name]
    return np.frombuffer(message.data, np.uint8).reshape(message.height, message.width)


def as_sent(grey: np.ndarray, encoding: str, bits: int, big: bool) -> dict[str, Any]:
    """Fields of the message of a camera that sees the same in brown."""
    name, deep = (
        encoding.removesuffix("16").removesuffix("8"),
        encoding.startswith("16") or encoding.endswith("16"),
    )
    colours = 0.75 * grey[..., None].astype(float) * (BROWN / (BROWN @ [0.299, 0.587, 0.114]))
    if name.startswith("bayer"):
        values = np.empty(grey.shape)
        for place, letter in enumerate(name[-4:]):
            row, column = divmod(place, 2)
            values[row::2, column::2] = colours[row::2, column::2, "rgb".index(letter)]
    elif name[:3] in ("rgb", "bgr"):
        values = np.stack(
            [colours[..., "rgb".index(n)] if n != "a" else 0 * grey + 0.0 for n in name], axis=2
        )
    elif name.startswith(("yuv", "uyvy", "yuyv")):
        both = [grey, np.full_like(grey, 128)]
        values = np.stack(both[::-1] if encoding in ("yuv422", "uyvy") else both, axis=2)
    else:
        values = grey.astype(float)
    kind = np.dtype((">u2" if big else "<u2") if deep else "u1")
    scaled = np.rint(values * ((2**bits - 1) / 255 if deep else 1.0)).astype(kind)
    rows = np.frombuffer(scaled.tobytes(), np.uint8).reshape(len(grey), -1)
    padded = np.pad(rows, ((0, 0), (0, 6)), constant_values=201)
    return {
        "encoding": encoding,
        "is_bigendian": int(big),
        "step": padded.shape[1],
        "data": array.array("B", padded.tobytes()),
    }


def apart(found: DoorLocalization, wanted: DoorLocalization) -> tuple[float, float]:
    """Distance [m] and turn [rad]."""
    place = np.hypot(found.offset_y - wanted.offset_y, found.offset_z - wanted.offset_z)
    return float(place), abs(found.offset_rotation - wanted.offset_rotation)


@pytest.mark.parametrize(("bits", "big"), [(12, False), (16, True)])
def test_the_same_door_is_found_by_every_kind_of_camera(localizer: Localizer, bits: int, big: bool) -> None:
    wanted = localizer.answer()
    assert wanted.accepted
    grey = grey_of(localizer)
    for encoding in ENCODINGS:
        localizer.send(topics.IMAGE, **as_sent(grey, encoding, bits, big))
        found = localizer.answers[-1]
        assert (found.run_id, found.accepted) == (wanted.run_id, True), (encoding, found.reason)
        place, turn = apart(found, wanted)
        mosaic = encoding.startswith("bayer")
        assert place < (MOSAIC_PLACE if mosaic else PLACE), (encoding, place)
        assert turn < (MOSAIC_TURN if mosaic else TURN), (encoding, turn)


def packed(grey: np.ndarray, kind: str, **options: Any) -> bytes:
    out = io.BytesIO()
    Pillow.fromarray(grey).save(out, kind, **options)
    return out.getvalue()


def send_packed(localizer: Localizer, data: bytes) -> DoorLocalization:
    header = localizer.good[topics.IMAGE.name].header
    message = CompressedImage(
        header=header, format="mono8; jpeg compressed mono8", data=array.array("B", data)
    )
    (tap,) = (t for t in localizer.node.subscriptions if t.topic_name == "/camera/image_raw/compressed")
    before = len(localizer.answers)
    tap.callback(message)
    assert len(localizer.answers) == before + 1
    return localizer.answers[-1]


@pytest.mark.parametrize("localizer", [{"image_transport": "compressed"}], indirect=True)
def test_compressed_pictures_by_the_name_that_image_transport_gives_them(localizer: Localizer) -> None:
    grey = grey_of(localizer)
    assert not [t for t in localizer.node.subscriptions if t.topic_name == "/camera/image_raw"]
    exact = send_packed(localizer, packed(grey, "PNG", compress_level=1))
    assert exact.accepted
    jpeg = send_packed(localizer, packed(grey, "JPEG", quality=95))
    assert jpeg.accepted
    place, turn = apart(jpeg, exact)
    assert place < 1e-5
    assert turn < 1e-4
    whole = packed(grey, "JPEG", quality=95)
    middle = len(whole) // 2
    for data, code, says in (
        (b"", BadPicture.code, "0 bytes"),
        (whole[:middle], BadPicture.code, "before its picture does"),
        (whole[:middle] + whole[middle + 4000 :], BadPicture.code, "lost a part"),
        (packed(grey[:540], "PNG"), CameraInfoSize.code, "1920 x 540 px"),
        (packed(np.zeros((9000, 9000), np.uint8), "PNG"), CameraInfoSize.code, "9000 x 9000 px"),
    ):
        refused = send_packed(localizer, data)
        assert (refused.run_id, refused.accepted, refused.error_code) == (exact.run_id, False, code)
        assert says in refused.reason
    assert send_packed(localizer, whole).accepted


def test_a_way_that_pictures_do_not_take_is_named(context: Context) -> None:
    with pytest.raises(BadParameterError, match="'theora', allowed is one of 'raw', 'compressed'"):
        DoorLocalizer(context=context, parameter_overrides=[Parameter("image_transport", value="theora")])
