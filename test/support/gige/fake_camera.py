"""Aravis' fake GigE camera on this machine, a process that can be killed, with a line that loses packets.

It shows a file (numpy, uint8, the size of its pictures) as a linear sensor does: twice the exposure, twice the
grey. Its gain is in dB.
"""

from __future__ import annotations

import ctypes
import os
import signal
import subprocess
import sys
from pathlib import Path

import numpy as np

ADDRESS, PORT = "127.0.0.1", 3956
LIBRARY = "libaravis-0.8.so.0"
EXPOSURE = 0.01  # s with which a picture comes out as its file says
_FILL = ctypes.CFUNCTYPE(
    None, ctypes.c_void_p, ctypes.c_void_p, ctypes.c_uint32, ctypes.c_uint32, ctypes.c_uint32
)


def installed() -> bool:
    """Whether the fake camera, the library and its introspection are here."""
    from doormill_ros.localization.gige.errors import AravisMissing
    from doormill_ros.localization.gige.library import load_aravis

    try:
        load_aravis()
        ctypes.CDLL(LIBRARY)
    except (AravisMissing, OSError):
        return False
    return True


class FakeCamera:
    """The process; loses that share of the packets of its pictures."""

    def __init__(self, picture: Path, lost: float = 0.0) -> None:
        self.picture = picture
        self._lost = lost
        self._process: subprocess.Popen[str] | None = None

    def plug(self) -> None:
        """Start, or start again, and wait until it listens."""
        self._process = subprocess.Popen(
            [sys.executable, __file__, str(self.picture), str(self._lost)], stdout=subprocess.PIPE, text=True
        )
        assert self._process.stdout is not None
        assert self._process.stdout.readline() == "listening\n"

    def unplug(self) -> None:
        """End at once, as a camera without power does."""
        if self._process is not None:
            self._process.kill()
            self._process.communicate()
            self._process = None

    def show(self, picture: np.ndarray) -> None:
        """Put something else before the camera."""
        whole = self.picture.with_suffix(".new.npy")
        np.save(whole, picture)
        os.replace(whole, self.picture)

    def __enter__(self) -> FakeCamera:
        self.plug()
        return self

    def __exit__(self, *_: object) -> None:
        self.unplug()


def serve(picture: Path, lost: float) -> None:
    """Be the camera until killed."""
    aravis, glib = ctypes.CDLL(LIBRARY), ctypes.CDLL("libgobject-2.0.so.0")
    for function in ("gv_fake_camera_new_full", "gv_fake_camera_get_fake_camera", "buffer_get_data"):
        getattr(aravis, f"arv_{function}").restype = ctypes.c_void_p

    @_FILL
    def fill(buffer: int, _data: int, exposure: int, gain: int, _format: int) -> None:
        it = ctypes.c_void_p(buffer)
        place = aravis.arv_buffer_get_data(it, ctypes.byref(ctypes.c_size_t()))
        room = aravis.arv_buffer_get_image_width(it) * aravis.arv_buffer_get_image_height(it)
        seen = np.load(picture)
        pixels = np.minimum(
            seen.ravel().astype(np.float32) * (exposure * 1e-6 / EXPOSURE * 10 ** (gain / 20)), 255.0
        )
        content = np.rint(pixels).astype(np.uint8).tobytes()[:room]
        ctypes.memmove(place, content, len(content))

    camera = ctypes.c_void_p(aravis.arv_gv_fake_camera_new_full(ADDRESS.encode(), b"FAKE", None))
    glib.g_object_set(camera, b"gvsp-lost-ratio", ctypes.c_double(lost), None)
    inner = ctypes.c_void_p(aravis.arv_gv_fake_camera_get_fake_camera(camera))
    aravis.arv_fake_camera_set_fill_pattern(inner, fill, None)
    assert aravis.arv_gv_fake_camera_is_running(camera), f"{ADDRESS}:{PORT} is taken"
    sys.stdout.write("listening\n")
    sys.stdout.flush()
    signal.pause()


if __name__ == "__main__":
    serve(Path(sys.argv[1]), float(sys.argv[2]))
