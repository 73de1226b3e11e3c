"""Which accepted hits of a posture make its FRFs, and why the others do not."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from armodal.analyzer.modal.hit_selection import DroppedHit, select_hits
from armodal.analyzer.modal.spectra import HitSpectra, hit_frfs, hit_spectra
from armodal.protocols.arrays import frozen_array
from armodal.protocols.errors import EstimateError
from armodal.protocols.frf_records import Dof
from armodal.protocols.session.records import Hit, Session

__all__ = ["HitChoice", "HitPairs", "accepted_hits", "choose_hits", "hit_choices", "hit_pairs"]

_SAME_DIRECTION = np.cos(np.radians(1.0))  # hits at one point planned along one direction
_FEWEST_TESTED = 4  # with three, two that agree against one are no proof


@dataclass(frozen=True, slots=True, kw_only=True)
class HitPairs:
    """Hits sorted by sensor point and reference; pair i is point i // n_ref, reference i % n_ref.

    A reference is a hit point with a direction.
    """

    points: tuple[str, ...]
    references: tuple[Dof, ...]
    pair_of: npt.NDArray[np.intp]  # (n_hits,)

    def members(self) -> list[npt.NDArray[np.intp]]:
        """Indices of the hits of every pair, possibly none."""
        n_pairs = len(self.points) * len(self.references)
        return [np.flatnonzero(self.pair_of == pair) for pair in range(n_pairs)]


@dataclass(frozen=True, slots=True, kw_only=True)
class HitChoice:
    """The hits of one sensor point and reference: kept and left out, by their number.

    `variance_factor` multiplies the variance of the averaged FRF estimated from the kept hits,
    `scatter_factor` their scatter; both are 1 unless good hits were left out. `note` says what
    could not be told, or is empty.
    """

    posture: str
    sensor_point: str
    reference: Dof
    kept: tuple[int, ...]
    dropped: tuple[DroppedHit, ...]  # `hit` is the hit's number in the session
    variance_factor: float
    scatter_factor: float
    note: str


def accepted_hits(session: Session, posture: str) -> tuple[Hit, ...]:
    """Return the accepted hits of a posture, at least one.

    Raises
    ------
    EstimateError
        If there are none.
    """
    hits = session.accepted(posture)
    if not hits:
        raise EstimateError(
            f"posture {posture!r} has no accepted hits in this session; measure it first"
        )
    return hits


def hit_pairs(hits: tuple[Hit, ...]) -> HitPairs:
    """Sort hits by sensor point and reference, both in the order in which they first come."""
    references: list[Dof] = []
    reference_of = []
    for hit in hits:
        direction = np.asarray(hit.hit_direction, dtype=np.float64)
        for index, dof in enumerate(references):
            if dof.point == hit.hit_point and dof.direction @ direction > _SAME_DIRECTION:
                reference_of.append(index)
                break
        else:
            reference_of.append(len(references))
            references.append(
                Dof(
                    point=hit.hit_point,
                    label="hit",
                    direction=frozen_array(direction, np.float64),
                )
            )
    points = tuple(dict.fromkeys(hit.sensor_point for hit in hits))
    pair_of = [
        points.index(hit.sensor_point) * len(references) + j
        for hit, j in zip(hits, reference_of, strict=True)
    ]
    return HitPairs(
        points=points, references=tuple(references), pair_of=np.asarray(pair_of, dtype=np.intp)
    )


def choose_hits(
    posture: str,
    hits: tuple[Hit, ...],
    pairs: HitPairs,
    spectra: HitSpectra,
    *,
    keep: int | None,
) -> tuple[HitChoice, ...]:
    """Choose among the hits of every sensor point and reference that has any.

    Parameters
    ----------
    posture
        Its name.
    hits, pairs, spectra
        The accepted hits, how they belong together, and their spectra.
    keep
        Hits kept at most at each; None keeps every hit that is not unlike the others.

    References
    ----------
    `analyzer/modal/hit_selection.py`, `docs/hit-judge.md`.
    """
    choices = []
    for pair, members in enumerate(pairs.members()):
        if not members.size:
            continue
        i, j = divmod(pair, len(pairs.references))
        numbers = [hits[k].number for k in members]
        choice = HitChoice(
            posture=posture,
            sensor_point=pairs.points[i],
            reference=pairs.references[j],
            kept=tuple(numbers),
            dropped=(),
            variance_factor=1.0,
            scatter_factor=1.0,
            note="",
        )
        if members.size >= _FEWEST_TESTED or (keep is not None and members.size > keep):
            found = select_hits(hit_frfs(spectra)[members], spectra.freq_hz, keep=keep)
            choice = replace(
                choice,
                kept=tuple(numbers[k] for k in found.kept),
                dropped=tuple(replace(hit, hit=numbers[hit.hit]) for hit in found.dropped),
                variance_factor=found.variance_factor,
                scatter_factor=found.scatter_factor,
                note=found.note,
            )
        choices.append(choice)
    return tuple(choices)


def hit_choices(session: Session, posture: str) -> tuple[HitChoice, ...]:
    """Which accepted hits of a posture make its FRFs, by the averaging its plan asks for.

    Raises
    ------
    EstimateError
        If the posture has no accepted hits, or their records cannot be compared.
    """
    hits = accepted_hits(session, posture)
    return choose_hits(
        posture,
        hits,
        hit_pairs(hits),
        hit_spectra(session, hits),
        keep=session.header.plan.averaging.keep_hits,
    )
