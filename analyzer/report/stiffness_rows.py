"""Joint stiffness with one standard deviation and one range."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from armodal.analyzer.gap.records import GapResult
from armodal.analyzer.identification.records import Identification
from armodal.analyzer.identification.scatter import stated_half_width_95

__all__ = ["Stiffness", "stiffness_rows"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Stiffness:
    """A joint's stiffness in N m/rad."""

    joint: str
    k: float
    std: float  # of scatter and of what the model leaves open together
    low: float  # of the 95 % range, over every explanation that still stands
    high: float
    believed: float | None  # by the arm file


def stiffness_rows(result: Identification, gap: GapResult | None) -> tuple[Stiffness, ...]:
    """Return the gap workflow's, over all that still may be so, or else the identification's."""
    believed = {joint.joint: joint.believed_k_n_m_per_rad for joint in result.joints}
    if gap is not None and gap.joint_stiffness_ranges:
        return tuple(
            Stiffness(
                joint=row.joint,
                k=row.k_n_m_per_rad,
                std=row.k_std,
                low=row.low,
                high=row.high,
                believed=believed.get(row.joint),
            )
            for row in gap.joint_stiffness_ranges
        )
    rows = []
    for joint in result.joints:
        k = joint.k_n_m_per_rad
        half = stated_half_width_95(joint)
        rows.append(
            Stiffness(
                joint=joint.joint,
                k=k,
                std=float(np.hypot(joint.k_std, joint.k_std_model)),
                low=k - half,
                high=k + half,
                believed=joint.believed_k_n_m_per_rad,
            )
        )
    return tuple(rows)
