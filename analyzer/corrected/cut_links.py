"""Links cut where their hinges stand, so that every piece of their mass moves whole.

A fit lets a piece move in part where a soft stretch lies in it: its equations are smooth where a
stretch moves. Other programs have bodies that move whole, and a chain of them is the arm in all.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import numpy.typing as npt

from armodal.analyzer.gap.model.assembly import Assembly
from armodal.analyzer.gap.model.spread import apart
from armodal.protocols.arm.records import Arm

__all__ = ["with_cut_links"]

Array = npt.NDArray[np.float64]


def with_cut_links(assembly: Assembly, arm: Arm) -> Assembly:
    """Return equations whose soft links have their pieces between the hinges."""
    if not assembly.pieces:
        return assembly
    found = assembly.copied()
    for link, (shares, offsets) in assembly.pieces.items():
        cuts = _cuts(assembly, link)
        if not cuts:
            continue
        places = np.array(sorted(set(cuts.values())))
        for at, place in cuts.items():
            stays = 1 + int(np.searchsorted(places, place))
            found.inside[at] = replace(assembly.inside[at], stretch=None, by=(), before=stays)
        found.pieces[link] = _between(assembly, arm, link, places, (shares, offsets))
    return found


def _cuts(assembly: Assembly, link: int) -> dict[int, float]:
    """Where along a link's line each coordinate's hinge stands, a part of its length."""
    found = {}
    for at, inside in assembly.inside.items():
        stretch = inside.stretch
        if inside.link == link and stretch is not None and assembly.compliance[at] > 0.0:
            found[at] = 0.5 * (stretch.start_m + stretch.end_m) / stretch.length_m
    return found


def _between(
    assembly: Assembly, arm: Arm, link: int, places: Array, pieces: tuple[Array, Array]
) -> tuple[Array, Array]:
    """Shares (P,) and offsets (P, 3) of pieces between hinges, spread as wide as those given."""
    stretch = next(
        own.stretch
        for own in assembly.inside.values()
        if own.link == link and own.stretch is not None
    )
    shares, offsets = pieces
    edges = np.concatenate([[0.0], np.cumsum(shares)])
    middles = 0.5 * (edges[1:] + edges[:-1])
    spread_m = (offsets[-1] - offsets[0]) @ stretch.along / (middles[-1] - middles[0])
    edges = np.array([0.0, *places, 1.0])
    shares, middles = np.diff(edges), 0.5 * (edges[1:] + edges[:-1]) - 0.5
    return shares, apart(arm.joints[link].link, stretch.along, shares, spread_m * middles)
