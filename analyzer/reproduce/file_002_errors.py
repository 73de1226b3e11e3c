"""File 002, section 5: how far calculated and measured frequencies and dampings are apart."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from armodal.analyzer.reproduce.records import Figure, Status, compared, statement
from armodal.analyzer.workspace.meridian import meridian_plane
from armodal.protocols.arm.records import Arm

__all__ = ["errors_of_table_4", "workspace_radius"]

PAPER = "002"
# Table 4, measured frequencies in Hz and damping in per cent.
MEASURED = (
    ((16.3, 17.8, 36.2, 58.4, 170.5), (3.9, 2.1, 3.1, 3.4, 3.2)),
    ((13.3, 14.5, 40.2, 59.1, 171.8), (2.7, 2.4, 2.5, 3.7, 2.7)),
)
LOW = 0.7  # calculated over measured damping, "significantly lower"
RADIUS_M = 0.6


def errors_of_table_4(
    calculated: Sequence[tuple[object, Sequence[float], Sequence[float]]],
) -> list[Figure]:
    """The statements of section 5 on Table 4, both rows as printed."""
    f_error, damping = [], []
    for (_, f_hz, percent), (f_measured, percent_measured) in zip(
        calculated, MEASURED, strict=True
    ):
        f_error.append(100.0 * (np.array(f_hz) / np.array(f_measured) - 1.0))
        damping.append(np.array(percent) / np.array(percent_measured))
    one, two = f_error
    told = [", ".join(f"{value:+.1f}" for value in row) + " %" for row in f_error]
    ratios = "; ".join(", ".join(f"{value:.2f}" for value in row) for row in damping)

    def said(item: str, holds: bool, number: str) -> Figure:
        return statement(
            PAPER, "section 5", item, holds=holds, status=Status.RECOMPUTED, number=number
        )

    low = [set(np.flatnonzero(row < LOW).tolist()) for row in damping]
    return [
        said(
            "validation 1: the first four calculated frequencies are lower, the fifth a bit higher",
            bool(np.all(one[:4] < 0.0) and 0.0 < one[4] < 2.0),
            told[0],
        ),
        said(
            "validation 1: the largest error is less than -10 %, in mode 2",
            int(np.argmin(one)) == 1 and float(one[1]) > -10.0,
            told[0],
        ),
        said(
            "validation 2: modes 1 and 4 are a bit lower, about -3 %, the others higher",
            bool(np.all(np.abs(two[[0, 3]] + 3.0) < 0.5) and np.all(two[[1, 2, 4]] > 0.0)),
            told[1],
        ),
        compared(
            PAPER,
            "section 5",
            "validation 2: largest error, of mode 3",
            "%",
            published=15.0,
            ours=float(two.max()),
            margin=0.5,
            status=Status.RECOMPUTED,
            why="rounding of the print",
        ),
        said(
            "only in the first mode is the calculated damping significantly lower",
            low == [{0}, {0}],
            f"calculated over measured {ratios}",
        ),
    ]


def workspace_radius(arm: Arm) -> Figure:
    """The hemisphere that the workspace roughly is: the wrist's reach from joint 2."""
    return compared(
        PAPER,
        "section 2",
        "radius of the workspace, about",
        "m",
        published=RADIUS_M,
        ours=float(meridian_plane(arm).reach_m),
        margin=0.05 * RADIUS_M,
        status=Status.RECOMPUTED,
        why="'roughly' and 'about' in the print; ours is the wrist's reach from joint 2, by "
        "geometry alone",
    )
