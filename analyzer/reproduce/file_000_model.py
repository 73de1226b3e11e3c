"""File 000: what the whole model says of Table 3, and where the compliance axis passes."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from armodal.analyzer.reproduce.records import Figure, Status, compared, statement
from armodal.analyzer.workspace.batch import ArmBatch
from armodal.analyzer.workspace.spectrum import ElasticJoints, spectrum
from armodal.protocols.arm.records import Arm

__all__ = ["axis_statements", "full_model"]

PAPER = "000"
COUPLED = 0.05  # of the frequency: what the other joints' giving way may move the mode by
BELOW, NEAR = ("1", "2"), ("3", "4")
# The axis is looked at with the arm of test 1 turned to x: Fig. 6 of the paper.
ALONG_X_DEG = (0.0, 90.0, 0.0, 0.0, 90.0, 0.0)
NEAR_M = 0.03


def full_model(
    arm: Arm,
    tests_deg: Sequence[Sequence[float]],
    f_hz: Sequence[float],
    k: Sequence[float],
) -> list[Figure]:
    """The frequencies of Table 3 by all three joints together, k as printed.

    The mode of a joint is that with the largest part of its strain energy.
    """
    elastic = ElasticJoints(
        joints=(0, 1, 2), stiffness_n_m_per_rad=np.array(k), damping_n_m_s_per_rad=np.zeros(3)
    )
    modes = spectrum(ArmBatch(arm), np.deg2rad(tests_deg), elastic)
    figures = []
    for i, published in enumerate(f_hz):
        strain = elastic.stiffness_n_m_per_rad[:, None] * modes.shape[i] ** 2
        own = int(np.argmax(strain[i] / strain.sum(axis=0)))
        figures.append(
            compared(
                PAPER,
                "Table 3",
                f"frequency of joint {i + 1} in test {i + 1}, three joints together",
                "Hz",
                published=published,
                ours=float(modes.f_hz[i, own]),
                margin=COUPLED * published,
                status=Status.CALIBRATED_TO,
                why="k was made of this frequency one joint at a time, and the density of that k; "
                "what is new is what the other joints add",
            )
        )
    return figures


def axis_statements(arm: Arm, average: tuple[float, float, float]) -> list[Figure]:
    """Where the average axis of Table 5 passes among the points.

    A turn about the axis z = m y + q moves a point along x by its turn times z - m y - q, y being
    away from the arm (docs/simulated-plant.md).
    """
    slope, intercept_mm, _ = average
    batch = ArmBatch(arm)
    links = [joint.link.name for joint in arm.joints]
    above_m = {}
    for point in arm.points:
        if point.link in links:
            x, _, z = batch.position(
                np.deg2rad([ALONG_X_DEG]), links.index(point.link), tuple(point.position_m)
            )[:, 0]
            above_m[point.id] = float(z - slope * -x - 1e-3 * intercept_mm)
    told = ", ".join(f"{name}: {1e3 * above_m[name]:+.0f} mm" for name in (*BELOW, *NEAR))
    others = [value for name, value in above_m.items() if name not in (*BELOW, *NEAR)]
    ours = "the points' places are ours, on the links the paper names"
    return [
        statement(
            PAPER,
            "section 5",
            "points 1 and 2 lie below the axis and move against the others",
            holds=all(above_m[name] < 0.0 for name in BELOW) and float(np.mean(others)) > 0.0,
            status=Status.GEOMETRY,
            number=f"height over the axis {told}; mean of the others "
            f"{1e3 * float(np.mean(others)):+.0f} mm; {ours}",
        ),
        statement(
            PAPER,
            "section 5",
            "the axis passes near points 3 and 4",
            holds=all(abs(above_m[name]) < NEAR_M for name in NEAR),
            status=Status.GEOMETRY,
            number=f"height over the axis {told}; {ours}",
        ),
    ]
