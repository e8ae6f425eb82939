"""Whom no door waits for gives the memory of its pictures back; the others keep it."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest

from doormill_ros.nodes import bag_recorder, door_localizer

PAGES = """
import ctypes
from doormill_ros.nodes.process.allocator import set_allocator

class Kept(ctypes.Structure):
    _fields_ = [(name, ctypes.c_size_t) for name in (
        "arena", "ordblks", "smblks", "hblks", "hblkhd", "usmblks", "fsmblks", "uordblks", "fordblks", "keepcost"
    )]

libc = ctypes.CDLL(None)
libc.mallinfo2.restype = Kept
set_allocator({keep_freed})
before = libc.mallinfo2()
picture = bytes(5 << 20)
during = libc.mallinfo2()
del picture
after = libc.mallinfo2()
print(during.hblks - before.hblks, (after.arena + after.hblkhd - before.arena - before.hblkhd) >> 20)
"""


def held(keep_freed: bool) -> list[int]:
    """Of a picture of 5 MB: blocks of pages of its own, and what is left once it is gone [MB]."""
    code = PAGES.replace("{keep_freed}", str(keep_freed))
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    return [int(word) for word in done.stdout.split()]


def test_pictures_have_pages_of_their_own_or_stay() -> None:
    assert held(keep_freed=False) == [1, 0]
    blocks, left = held(keep_freed=True)
    assert blocks == 0
    assert left >= 5


def test_the_recorder_gives_back_and_who_a_door_waits_for_does_not(monkeypatch: pytest.MonkeyPatch) -> None:
    told: list[object] = []
    for module in (bag_recorder, door_localizer):
        monkeypatch.setattr(module, "run_nodes", lambda *_, keep_freed=True: told.append(keep_freed) or 0)
    monkeypatch.setattr(os, "nice", lambda _: 0)
    bag_recorder.main()
    door_localizer.main()
    assert told == [False, True]
