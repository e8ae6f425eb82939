"""Pictures of any camera become the 8 bit grey that doors are found in."""

from __future__ import annotations

import io
import struct
import zlib
from types import SimpleNamespace as Message

import numpy as np
import pytest
from PIL import Image

from doormill_ros.localization.errors import BadPicture
from doormill_ros.localization.pictures.compressed import MOST_PIXELS
from doormill_ros.messages.picture import ENCODINGS, colours_of, packed_size, picture_of

ROWS, COLUMNS = 3, 5
MOSAICS = {"rggb": "RGGB", "bggr": "BGGR", "gbrg": "GBRG", "grbg": "GRBG"}


def picture(encoding: str, values: np.ndarray, padding: int = 0, big: bool = False) -> Message:
    """Of shape (rows, columns[, channels])."""
    rows, columns = values.shape[:2]
    if values.dtype == np.uint16:
        values = values.astype(">u2" if big else "<u2")
    flat = np.frombuffer(values.tobytes(), np.uint8).reshape(rows, -1)
    padded = np.pad(flat, ((0, 0), (0, padding)), constant_values=77)
    return Message(
        encoding=encoding,
        height=rows,
        width=columns,
        step=padded.shape[1],
        data=padded.tobytes(),
        is_bigendian=int(big),
    )


def grey_of(colours: np.ndarray) -> np.ndarray:
    """ITU-R BT.601."""
    red, green, blue = np.moveaxis(colours[..., :3].astype(float), 2, 0)
    return 0.299 * red + 0.587 * green + 0.114 * blue


def smooth(rows: int = 40, columns: int = 48) -> np.ndarray:
    """Colours that change so slowly that a mosaic loses nothing of them."""
    y, x = np.mgrid[:rows, :columns]
    return np.stack([40 + 2 * x, 200 - 2 * y, 60 + x + y], axis=2).astype(np.uint8)


@pytest.mark.parametrize("padding", [0, 3])
@pytest.mark.parametrize("encoding", ["mono8", "8UC1"])
def test_a_grey_picture_comes_as_it_is(encoding: str, padding: int) -> None:
    values = np.arange(ROWS * COLUMNS, dtype=np.uint8).reshape(ROWS, COLUMNS)
    found = picture_of(picture(encoding, values, padding))
    assert found.dtype == np.uint8
    assert np.array_equal(found, values)


@pytest.mark.parametrize("padding", [0, 3])
@pytest.mark.parametrize("order", ["rgb", "bgr", "rgba", "bgra"])
def test_colours_become_grey_by_how_bright_they_look(order: str, padding: int) -> None:
    colours = np.random.default_rng(1).integers(0, 256, (ROWS, COLUMNS, 4), dtype=np.uint8)
    sent = colours[:, :, ["rgba".index(name) for name in order]]
    found = picture_of(picture(f"{order}8", sent, padding))
    assert np.abs(found - grey_of(colours)).max() <= 0.51  # a rounding, and weights of 15 bits
    deep = picture_of(picture(f"{order}16", 257 * sent.astype(np.uint16), padding))
    assert np.abs(deep - grey_of(colours)).max() <= 0.51


@pytest.mark.parametrize("big", [False, True])
@pytest.mark.parametrize("padding", [0, 1, 4])
@pytest.mark.parametrize("encoding", ["mono16", "16UC1"])
@pytest.mark.parametrize("bits", [10, 12, 14, 16])
def test_deep_pictures_keep_their_contrast(encoding: str, padding: int, big: bool, bits: int) -> None:
    full = 2**bits - 1
    values = np.random.default_rng(bits).integers(0, full + 1, (ROWS, COLUMNS)).astype(np.uint16)
    values[1, 2] = full
    found = picture_of(picture(encoding, values, padding, big))
    assert found.dtype == np.uint8
    assert np.abs(found - 255.0 * values / full).max() <= 0.5 + 1e-6


def test_darkness_is_not_made_bright() -> None:
    values = np.random.default_rng(3).integers(0, 40, (ROWS, COLUMNS)).astype(np.uint16)
    assert picture_of(picture("mono16", values)).max() <= 10


@pytest.mark.parametrize("depth", [8, 12, 16])
@pytest.mark.parametrize("pattern", MOSAICS)
def test_a_bayer_pattern_becomes_the_grey_of_its_colours(pattern: str, depth: int) -> None:
    colours = smooth()
    mosaic = np.empty(colours.shape[:2], dtype=np.uint16)
    for place, name in enumerate(MOSAICS[pattern]):
        row, column = divmod(place, 2)
        mosaic[row::2, column::2] = colours[row::2, column::2, "RGB".index(name)]
    wanted = grey_of(colours)
    if depth == 8:
        message = picture(f"bayer_{pattern}8", mosaic.astype(np.uint8), 2)
    else:
        full = 2**depth - 1
        mosaic[0, 0] = 255  # the brightest pixel tells the depth
        message = picture(f"bayer_{pattern}16", (mosaic * (full / 255.0)).astype(np.uint16), 2, big=True)
    found = picture_of(message)
    assert found.shape == colours.shape[:2]
    assert np.abs(found - wanted)[4:-4, 4:-4].max() <= 1.5


@pytest.mark.parametrize(("encoding", "first"), [("yuv422", 1), ("yuv422_yuy2", 0)])
def test_of_luminance_and_colours_the_luminance_is_taken(encoding: str, first: int) -> None:
    values = np.random.default_rng(2).integers(0, 256, (4, 6, 2), dtype=np.uint8)
    assert np.array_equal(picture_of(picture(encoding, values)), values[:, :, first])


@pytest.mark.parametrize("encoding", ["bayer_rggb12", "yuv420", "", "32FC1", "mono12"])
def test_encodings_that_are_not_read_are_named(encoding: str) -> None:
    message = picture("mono8", np.zeros((ROWS, COLUMNS), dtype=np.uint8))
    message.encoding = encoding
    with pytest.raises(BadPicture, match=f"encoding '{encoding}', allowed are mono8"):
        picture_of(message)


@pytest.mark.parametrize("encoding", sorted(ENCODINGS))
def test_too_few_bytes_are_told_of_every_encoding(encoding: str) -> None:
    whole = picture(encoding, np.zeros((20, 20, 8), dtype=np.uint8))
    assert picture_of(whole).shape == (20, 20)
    whole.data = whole.data[:-1]
    with pytest.raises(BadPicture, match="3199 bytes"):
        picture_of(whole)
    small = picture(encoding, np.zeros((2, 2, 8), dtype=np.uint8))
    if encoding.startswith("bayer"):
        with pytest.raises(BadPicture, match="2 x 2 px"):
            picture_of(small)
    else:
        assert picture_of(small).shape == (2, 2)


@pytest.mark.parametrize(
    ("width", "height", "step"), [(0, 0, 0), (0, 9, 5), (4_294_967_295, 1, 4_294_967_295)]
)
def test_sizes_that_cannot_be_are_refused(width: int, height: int, step: int) -> None:
    sized = Message(encoding="mono8", data=bytes(100), width=width, height=height, step=step)
    with pytest.raises(BadPicture, match=f"{width} x {height}"):
        picture_of(sized)
    sized.encoding = "rgb8"
    with pytest.raises(BadPicture, match=f"{width} x {height}"):
        colours_of(sized)


def compressed(values: np.ndarray, kind: str, **options: object) -> Message:
    """By another library than the one that unpacks it."""
    out = io.BytesIO()
    Image.fromarray(values).save(out, kind, **options)
    return Message(format=f"mono8; {kind.lower()} compressed mono8", data=out.getvalue())


def noisy(rows: int = 64, columns: int = 96) -> np.ndarray:
    y, x = np.mgrid[:rows, :columns]
    noise = np.random.default_rng(5).normal(0, 2, (rows, columns))
    return np.clip(90 + 60 * (x > columns // 2) + 0.2 * y + noise, 0, 255).astype(np.uint8)


def test_png_is_the_picture_itself() -> None:
    values = noisy()
    message = compressed(values, "PNG")
    assert packed_size(message) == (96, 64)
    assert np.array_equal(picture_of(message), values)
    deep = (16 * values.astype(np.uint16) + 7).astype(np.uint16)
    deep[0, 0] = 4095
    assert np.abs(picture_of(compressed(deep, "PNG")) - deep * (255 / 4095)).max() <= 0.5 + 1e-6


@pytest.mark.parametrize("options", [{}, {"progressive": True}, {"restart_marker_rows": 1}], ids=str)
@pytest.mark.parametrize("kind", ["grey", "colour"])
def test_jpeg_is_the_picture_but_for_what_it_leaves_out(kind: str, options: dict[str, object]) -> None:
    values = noisy()
    sent = values if kind == "grey" else np.stack([values] * 3, axis=2)
    message = compressed(sent, "JPEG", quality=95, **options)
    assert packed_size(message) == (96, 64)
    assert np.abs(picture_of(message) - values.astype(float)).mean() < 1.5


def test_a_picture_is_not_turned_by_what_its_header_says_of_people() -> None:
    values = noisy(64, 64)
    turned = Image.Exif()
    turned[0x0112] = 3  # upside down
    message = compressed(values, "JPEG", quality=95, exif=turned)
    assert np.abs(picture_of(message) - values.astype(float)).mean() < 1.5


@pytest.mark.parametrize("kind", ["PNG", "JPEG"])
@pytest.mark.parametrize("cut", [0, 3, 20, 0.2, 0.5, 0.99])
def test_what_is_cut_off_is_refused(kind: str, cut: float) -> None:
    message = compressed(noisy(), kind)
    message.data = message.data[: int(cut * len(message.data)) if 0 < cut < 1 else int(cut)]
    with pytest.raises(BadPicture, match=f"{len(message.data)} bytes"):
        picture_of(message)


@pytest.mark.parametrize(("rows", "lost"), [(0, 300), (0, 1000), (0, 5000), (1, 5000), (2, 5000)])
def test_a_jpeg_with_a_hole_has_no_edge_of_its_decoder(rows: int, lost: int) -> None:
    """A lost packet leaves a grey area with a straight border, where a door's edge may be."""
    whole = compressed(noisy(400, 600), "JPEG", quality=90, restart_marker_rows=rows)
    assert picture_of(whole).shape == (400, 600)
    middle = len(whole.data) // 2
    whole.data = whole.data[:middle] + whole.data[middle + lost :]
    with pytest.raises(BadPicture, match="lost a part"):
        picture_of(whole)


def test_a_picture_that_says_it_is_too_large_is_not_unpacked() -> None:
    """200 megabytes of zeros in 200 kilobytes, and sizes without any data."""
    side = 20_000
    assert side * side > MOST_PIXELS
    header = struct.pack(">IIBBBBB", side, side, 8, 0, 0, 0, 0)

    def chunk(name: bytes, body: bytes) -> bytes:
        return struct.pack(">I", len(body)) + name + body + struct.pack(">I", zlib.crc32(name + body))

    packed = zlib.compress(bytes(side // 2 * side))
    bomb = b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", packed) + chunk(b"IEND", b"")
    with pytest.raises(BadPicture, match="20000 x 20000 px"):
        picture_of(Message(format="png", data=bomb))
    jpeg = bytearray(compressed(noisy(), "JPEG").data)
    frame = jpeg.index(b"\xff\xc0")
    jpeg[frame + 5 : frame + 9] = b"\xff\xff\xff\xff"
    with pytest.raises(BadPicture, match="65535 x 65535 px"):
        picture_of(Message(format="jpeg", data=bytes(jpeg)))


def test_a_jpeg_that_goes_through_itself_again_and_again_is_not_unpacked() -> None:
    data = compressed(noisy(), "JPEG", progressive=True).data
    last = data.rindex(b"\xff\xda")
    scan = data[last : data.rindex(b"\xff\xd9")]
    again = data[:last] + scan * 500 + b"\xff\xd9"
    with pytest.raises(BadPicture, match="scans of its picture"):
        picture_of(Message(format="jpeg", data=again))


@pytest.mark.parametrize(
    "data",
    [b"", b"\xff\xd8\xff", b"\xff\xd8\xff\xe0\x00\x00" * 50, b"RIFF1234WEBPVP8 ", b"BM" + bytes(60), b"\xff" * 999],
)  # fmt: skip
def test_other_kinds_and_nonsense_are_refused(data: bytes) -> None:
    with pytest.raises(BadPicture, match="allowed are JPEG and PNG"):
        picture_of(Message(format="16UC1; compressedDepth png", data=data))


def test_damage_anywhere_is_a_picture_or_a_refusal() -> None:
    draw = np.random.default_rng(8)
    ends = set()
    for kind in ("PNG", "JPEG"):
        good = compressed(noisy(), kind).data
        for _ in range(150):
            data = bytearray(good)
            for place in draw.integers(0, len(data), draw.integers(1, 6)):
                data[place] = draw.integers(0, 256)
            try:
                ends.add(picture_of(Message(format="", data=bytes(data))).dtype.name)
            except BadPicture as reason:
                ends.add(type(reason).__name__)
    assert ends == {"uint8", "BadPicture"}
