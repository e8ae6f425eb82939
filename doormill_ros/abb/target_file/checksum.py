"""The checksum of a target file: two rolling remainders that a RAPID program can compute.

RAPID numbers are float32, in which integers are exact up to 2^23 only. The characters of a line
are taken in pairs, first * 128 + second, an odd last one with 0, and the line feed by itself. Each
remainder is h <- (h * factor + pair) mod modulus with factor * (modulus - 1) + 128^2 < 2^23, so
every intermediate value is exact. The two together tell 10^9 contents apart.
"""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np

from doormill_ros.arrays import IntArray

FACTOR_A, MODULUS_A = 251, 32749
FACTOR_B, MODULUS_B = 241, 32719
#: More than any character code of the file, which is ASCII.
CODES = 128
LINE_FEED = 10
#: What both remainders start with, so that leading zeros would count.
SEED = 1


class Checksum(NamedTuple):
    """The two remainders."""

    a: int
    b: int


def checksum(lines: list[str]) -> Checksum:
    """Checksum of lines of ASCII text, without their line feeds."""
    end = "\0" + chr(LINE_FEED)  # by itself, hence behind a 0
    even = [line + "\0" if len(line) % 2 else line for line in lines]
    codes = np.frombuffer("".join(line + end for line in even).encode("ascii"), dtype=np.uint8)
    pairs = codes.reshape(-1, 2).astype(np.int64) @ np.array([CODES, 1])
    return Checksum(_remainder(pairs, FACTOR_A, MODULUS_A), _remainder(pairs, FACTOR_B, MODULUS_B))


def _remainder(pairs: IntArray, factor: int, modulus: int) -> int:
    """SEED * factor^n + sum of pair[i] * factor^(n - 1 - i), modulo modulus."""
    powers = _powers(factor, modulus, 1 << max(10, len(pairs).bit_length()))
    total = SEED * int(powers[len(pairs)]) + int(pairs @ powers[: len(pairs)][::-1])
    return total % modulus


@lru_cache(maxsize=32)
def _powers(factor: int, modulus: int, count: int) -> IntArray:
    """factor^0 ... factor^(count - 1), modulo modulus, each below 2^15."""
    powers = np.ones(count, dtype=np.int64)
    known = 1
    while known < count:
        step = int(powers[known - 1]) * factor % modulus
        powers[known : 2 * known] = powers[: min(known, count - known)] * step % modulus
        known *= 2
    return powers
