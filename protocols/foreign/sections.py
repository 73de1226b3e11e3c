"""What sections of one file have to do with one another: points in order, a coherence behind."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from armodal.protocols.arrays import frozen_array
from armodal.protocols.errors import ForeignFileError
from armodal.protocols.foreign.even import is_counter
from armodal.protocols.foreign.measured import (
    ForeignFrf,
    Hints,
    NotToldError,
    clipped_coherence,
)
from armodal.protocols.foreign.roles import Role, role_of
from armodal.protocols.foreign.variables import Variables

__all__ = ["is_coherence_alone", "named_in_order", "with_coherence"]

_SAME_LINE = 1e-3  # of a line's spacing


def is_coherence_alone(part: Variables) -> bool:
    """Return whether a section is a frequency and a coherence, as its header says."""
    last = part.variables[-1] if part.variables else None
    if last is None or last.is_complex or len(part.variables) > 3:
        return False
    named = role_of(f"{last.name} {part.words}", "", is_complex=False)
    return named is Role.COHERENCE and len(part.variables) >= 2


def with_coherence(frf: ForeignFrf, part: Variables, said: list[str]) -> ForeignFrf:
    """Return an FRF with the coherence that follows it, if it is on the same lines."""
    first, *rest = [np.real(variable.values) for variable in part.variables]
    freq, values = (rest[0], rest[1]) if len(rest) == 2 and is_counter(first) else (first, rest[-1])
    keep = freq > 0.0
    freq, values = freq[keep], values[keep]
    spacing = float(np.min(np.diff(frf.freq_hz)))
    if len(freq) != len(frf.freq_hz) or np.max(np.abs(freq - frf.freq_hz)) > _SAME_LINE * spacing:
        said.append(f"{part.origin}: the coherence is on other lines than the FRF: it is left out")
        return frf
    clipped = clipped_coherence(np.asarray(values, dtype=np.float64), part.origin, said)
    return frf if clipped is None else replace(frf, coherence=frozen_array(clipped, np.float64))


def named_in_order(frfs: Sequence[ForeignFrf], hints: Hints, origin: str) -> list[ForeignFrf]:
    """Return the FRFs of several sections with the points that the manifest gives them.

    Raises
    ------
    NotToldError
        If there are several and nobody names them.
    ForeignFileError
        If the names are more or fewer.
    """
    if not hints.responses and len(frfs) > 1 and any(frf.response.node is None for frf in frfs):
        raise NotToldError(
            f"{origin}: wanted names for {len(frfs)} responses, the file has none; say "
            '`responses` in the manifest, such as ["1:z", "2:z"]',
            key=f"responses {len(frfs)}",
        )
    if not hints.responses or not frfs:
        return list(frfs)
    if len(hints.responses) != len(frfs):
        raise ForeignFileError(
            f"{origin}: wanted names for {len(frfs)} responses, got {len(hints.responses)}; say "
            "`responses` in the manifest"
        )
    named = zip(frfs, hints.responses, strict=True)
    return [replace(frf, response=dof) for frf, dof in named]
