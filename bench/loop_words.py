"""What the loops of drawn shifts left, in words."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from doormill_ros.units import m_to_um
from support.shift_loop import LEFT, LoopWorth


def walls_of(loop: LoopWorth) -> str:
    """Of one shift, in um."""
    before, after, least, told = (
        m_to_um(value) for value in (loop.before, loop.after, loop.least, loop.told)
    )
    remarks = (
        [f"beyond {LEFT:g}"] * (not loop.kept)
        + ["of told, too"] * (not loop.as_told)
        + ["worse"] * loop.worse
    )
    return f"walls {before:.0f} to {after:.0f} um, as assumed {least:.0f}, told {told:.0f} {' '.join(remarks)}".rstrip()


def print_loops(label: str, loops: Sequence[LoopWorth]) -> None:
    """Print what those of one kind of shift left."""
    milled = [loop for loop in loops if not np.isnan(loop.before + loop.after)]
    if not milled:
        print(f"{label}: no doors after the loop")
        return
    before, after, least, told = np.array(
        [[loop.before, loop.after, loop.least, loop.told] for loop in milled]
    ).T
    print(
        f"{label}: walls of the next doors after the loop {m_to_um(np.median(after)):.0f} um in the median, "
        f"{m_to_um(np.quantile(after, 0.9)):.0f} in 9 of 10, {m_to_um(np.median(before)):.0f} and "
        f"{m_to_um(np.quantile(before, 0.9)):.0f} before; {np.median(after / least):.2f} and "
        f"{np.quantile(after / least, 0.9):.2f} times what is left as assumed, "
        f"{np.nanmedian(after / told):.2f} and {np.nanquantile(after / told, 0.9):.2f} times what the world's own "
        f"figures leave; {sum(loop.kept for loop in milled)} of "
        f"{len(milled)} within {LEFT:g} times, {sum(loop.worse for loop in milled)} worse than before, "
        f"{len(loops) - len(milled)} refused"
    )


def print_sum(loops: Sequence[LoopWorth]) -> tuple[int, int]:
    """Print and return how many loops leave no more than they may, and how many more than there was before."""
    kept, worse = sum(loop.as_told for loop in loops), sum(loop.worse for loop in loops)
    print(
        f"all loops: {kept} of {len(loops)} leave at most {LEFT:g} times what gauge, localization, program and gears "
        f"leave of a world that is known, {worse} more than before"
    )
    return kept, worse
