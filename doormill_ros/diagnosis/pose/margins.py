"""How far each decision of a diagnosis of poses was from its threshold."""

from __future__ import annotations

from doormill_ros.diagnosis.core.margin import Margin
from doormill_ros.diagnosis.core.verdict import AT_NOISE, MAIN_PART
from doormill_ros.diagnosis.pose.diagnosis import PoseDiagnosis
from doormill_ros.diagnosis.pose.model import rmse
from doormill_ros.diagnosis.pose.selection import SURE


def margins(diagnosis: PoseDiagnosis) -> list[Margin]:
    """Every decision with what it was taken by."""
    kept = [~bad for bad in diagnosis.gross]
    before, after = rmse(diagnosis.before.blocks, kept), rmse(diagnosis.after.blocks, kept)
    floor = diagnosis.noise_floor
    found = [
        Margin("the nominal model is at the noise, which leaves a share", before / floor, AT_NOISE, "share"),
        Margin("the extended model is at the noise, which leaves a share", after / floor, AT_NOISE, "share"),
    ]
    if before > floor:
        share = (before**2 - after**2) / (before**2 - floor**2)
        found.append(Margin("the causes explain most of what is beyond the noise", share, MAIN_PART, "share"))
    for score in (*diagnosis.established, *diagnosis.rejected):
        found.append(
            Margin(f"{score.cause!r} helps on blocks left out", score.total_sure, SURE, "standard errors")
        )
    return found
