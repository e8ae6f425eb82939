"""The checksum of a target file: two rolling remainders that a RAPID program can compute.

RAPID numbers are float32, in which integers are exact up to 2^23 only. Each remainder is
h <- (h * factor + byte) mod modulus with factor * (modulus - 1) + 255 < 2^23, so every
intermediate value is exact. The two together tell 10^9 contents apart.
"""

from __future__ import annotations

from typing import NamedTuple

LARGEST_EXACT = 2**23  #: integers up to here are exact in a RAPID num

FACTOR_A, MODULUS_A = 251, 32749
FACTOR_B, MODULUS_B = 241, 32719
#: What both remainders start with, so that a leading zero byte counts.
SEED = 1


class Checksum(NamedTuple):
    """The two remainders."""

    a: int
    b: int


def checksum(data: bytes) -> Checksum:
    """Checksum of all bytes, line feeds included."""
    a = b = SEED
    for byte in data:
        a = (a * FACTOR_A + byte) % MODULUS_A
        b = (b * FACTOR_B + byte) % MODULUS_B
    return Checksum(a, b)
