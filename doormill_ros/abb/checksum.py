"""The checksum of a target file: two rolling remainders that a RAPID program can compute.

RAPID numbers are float32, in which integers are exact up to 2^23 only. The characters of a line
are taken in pairs, first * 128 + second, an odd last one with 0, and the line feed by itself. Each
remainder is h <- (h * factor + pair) mod modulus with factor * (modulus - 1) + 128^2 < 2^23, so
every intermediate value is exact. The two together tell 10^9 contents apart.
"""

from __future__ import annotations

from typing import NamedTuple

LARGEST_EXACT = 2**23  #: integers up to here are exact in a RAPID num

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
    a = b = SEED
    for line in lines:
        codes = line.encode("ascii")
        if len(codes) % 2:
            codes += b"\0"
        pairs = [first * CODES + second for first, second in zip(codes[::2], codes[1::2], strict=True)]
        for pair in (*pairs, LINE_FEED):
            a = (a * FACTOR_A + pair) % MODULUS_A
            b = (b * FACTOR_B + pair) % MODULUS_B
    return Checksum(a, b)
