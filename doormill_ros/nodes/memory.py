"""How a node's process keeps its memory, so that a picture does not wait for the system to hand out pages."""

from __future__ import annotations

import contextlib
import ctypes
import gc

# Parameters of glibc's mallopt.
_TRIM_THRESHOLD, _TOP_PAD, _MMAP_THRESHOLD = -1, -2, -3
_MEGABYTE = 1 << 20


def keep_freed_memory() -> None:
    """Let the allocator keep what is freed.

    By default a picture's buffers go back to the system each time, and touching new pages costs more
    than copying the picture. Where there is no glibc nothing changes.
    """
    with contextlib.suppress(OSError, AttributeError):
        mallopt = ctypes.CDLL(None).mallopt
        mallopt(_MMAP_THRESHOLD, 32 * _MEGABYTE)
        mallopt(_TRIM_THRESHOLD, 256 * _MEGABYTE)
        mallopt(_TOP_PAD, 16 * _MEGABYTE)


def spare_collector() -> None:
    """Take everything made until now, modules above all, out of the garbage collector's rounds."""
    gc.collect()
    gc.freeze()
