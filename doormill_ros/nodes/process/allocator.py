"""What the allocator of a process does with memory that is freed."""

from __future__ import annotations

import contextlib
import ctypes

# Parameters of glibc's mallopt.
_TRIM_THRESHOLD, _TOP_PAD, _MMAP_THRESHOLD, _ARENA_MAX = -1, -2, -3, -8
_MEGABYTE = 1 << 20
_KEPT = {_MMAP_THRESHOLD: 32, _TRIM_THRESHOLD: 256, _TOP_PAD: 16}
_GIVEN_BACK = {_MMAP_THRESHOLD: 1, _TRIM_THRESHOLD: 4, _TOP_PAD: 1}


def set_allocator(keep_freed: bool) -> None:
    """Choose between time and memory; where there is no glibc nothing changes.

    All threads share one heap: with one for each, every new thread would keep what the largest picture or program of
    its life took.

    Args:
        keep_freed: By default a picture's buffers go back to the system each time, and touching new pages costs more
            than copying the picture. Kept, they are torn by what is small and stays: the heap grows for hundreds of
            doors. If false, pictures get pages of their own, and the process holds what it uses.
    """
    with contextlib.suppress(OSError, AttributeError):
        mallopt = ctypes.CDLL(None).mallopt
        mallopt(_ARENA_MAX, 1)
        for parameter, megabytes in (_KEPT if keep_freed else _GIVEN_BACK).items():
            mallopt(parameter, megabytes * _MEGABYTE)
