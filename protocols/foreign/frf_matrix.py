"""One FRF matrix of a posture from the single FRFs of foreign files."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import product

import numpy as np
import numpy.typing as npt

from armodal.protocols.arrays import frozen_array
from armodal.protocols.errors import ForeignFileError
from armodal.protocols.foreign.hit_variables import MOST_TRIMMED
from armodal.protocols.foreign.manifest import MOST_AVERAGES, PostureTable
from armodal.protocols.foreign.measured import Content, ForeignFrf
from armodal.protocols.foreign.placement import HIT, RESPONSE, SCALAR, Placement
from armodal.protocols.frf_records import Dof, FrequencyResponse

__all__ = ["frf_matrix"]

MOST_NAMED = 6  # FRFs that were not measured
_SAME_LINE = 1e-3  # of a line's spacing: programs round their frequency axes


def frf_matrix(
    contents: Sequence[Content], table: PostureTable, placement: Placement, said: list[str]
) -> FrequencyResponse:
    """Arrange FRFs as responses over references.

    Parameters
    ----------
    contents
        What the posture's files hold.
    table
        The posture in the manifest.
    placement
        Nodes and directions.
    said
        Sentences about what was left open are appended.

    Returns
    -------
    FrequencyResponse
        Variance 0 where no file tells it: `analyzer` works it out from coherence and averages. FRFs
        that no file has are not measured: value 0, variance infinite.

    Raises
    ------
    ForeignFileError
        If forms or lines differ, or an FRF comes twice.
    """
    what = f"posture {table.name!r}"
    frfs = [frf for content in contents for frf in content.frfs]
    frfs = _alike(frfs, what, said)
    first = frfs[0]
    references = _references(frfs, table, placement, said)
    rows: dict[tuple[str, str], Dof] = {}
    columns: dict[tuple[str, tuple[float, ...]], Dof] = {}
    cells: dict[tuple[tuple[str, str], tuple[str, tuple[float, ...]]], ForeignFrf] = {}
    for frf, reference in zip(frfs, references, strict=True):
        response = _response(frf, placement, said)
        row = (response.point, response.label)
        column = (reference.point, tuple(reference.direction.tolist()))
        rows.setdefault(row, response)
        columns.setdefault(column, reference)
        if (row, column) in cells:
            raise ForeignFileError(
                f"{what}: {frf.origin}: wanted each FRF once, point {row[0]} {row[1]} over "
                f"{reference.point} came twice (first in {cells[row, column].origin}); leave one "
                "out, or name the degrees of freedom with `responses` in the manifest"
            )
        cells[row, column] = frf
    shape = (len(rows), len(columns), len(first.freq_hz))
    values, variance = np.zeros(shape, dtype=np.complex128), np.full(shape, np.inf)
    coherence, n_hits = np.full(shape, np.nan), np.zeros(shape[:2], dtype=np.int64)
    averages = _averages_of_all(contents, table, what)
    for (i, row), (j, column) in product(enumerate(rows), enumerate(columns)):
        cell = cells.get((row, column))
        if cell is not None:
            values[i, j] = cell.values
            variance[i, j] = 0.0 if cell.variance is None else cell.variance
            n_hits[i, j] = _averages(cell, table, averages)
            if cell.coherence is not None:
                coherence[i, j] = cell.coherence
    measured = np.isfinite(variance[..., 0])
    _say_holes(measured, tuple(rows.values()), tuple(columns.values()), what, said)
    decay = _one(contents, "decay_rad_s", table.window_decay_rad_s, what)
    if not (variance[measured] > 0.0).any():
        _say_uncertainty(coherence[measured], averages, what, said)
    return FrequencyResponse(
        posture=table.name,
        form=first.form,
        freq_hz=first.freq_hz,
        decay_rad_s=0.0 if decay is None else float(decay),
        values=frozen_array(values, np.complex128),
        coherence=frozen_array(coherence, np.float64),
        variance=frozen_array(variance, np.float64),
        n_hits=frozen_array(n_hits, np.int64),
        responses=tuple(rows.values()),
        references=tuple(columns.values()),
        joints_rad=frozen_array(placement.joints_rad, np.float64),
    )


def _averages_of_all(contents: Sequence[Content], table: PostureTable, what: str) -> int:
    """Return the averages that manifest or files tell for all FRFs; 0 where they do not."""
    averages = _one(contents, "averages", table.averages, what)
    if averages is not None and averages > MOST_AVERAGES:
        raise ForeignFileError(
            f"{what}: wanted up to {MOST_AVERAGES} averages, the files tell {averages:g}; say "
            "`averages` in the manifest"
        )
    return 0 if averages is None else int(averages)


def _averages(frf: ForeignFrf, table: PostureTable, otherwise: int) -> int:
    """Return the averages of one FRF: the manifest's, the FRF's own, or those of all."""
    if table.averages is not None or frf.averages is None:
        return otherwise
    return min(frf.averages, MOST_AVERAGES)


def _alike(frfs: Sequence[ForeignFrf], what: str, said: list[str]) -> list[ForeignFrf]:
    """Return FRFs of one form on the same lines; a few lines at the ends may be cut off."""
    first = frfs[0]
    for frf in frfs[1:]:
        if frf.form is not first.form:
            raise ForeignFileError(
                f"{what}: wanted FRFs of one form, {frf.origin} is {frf.form}, {first.origin} is "
                f"{first.form}; import them as postures of their own"
            )
    if all(_same_lines(frf.freq_hz, first.freq_hz) for frf in frfs[1:]):
        return list(frfs)
    half = 0.5 * float(np.min(np.diff(first.freq_hz)))
    low = max(float(frf.freq_hz[0]) for frf in frfs) - half
    high = min(float(frf.freq_hz[-1]) for frf in frfs) + half
    cut = [_between(frf, low, high) for frf in frfs]
    for frf, short in zip(frfs, cut, strict=True):
        few = len(frf.freq_hz) - len(short.freq_hz) <= MOST_TRIMMED
        if not (few and _same_lines(short.freq_hz, cut[0].freq_hz)):
            raise ForeignFileError(
                f"{what}: wanted FRFs on the same lines, those of {frf.origin} are not those of "
                f"{first.origin}; import them as postures of their own"
            )
    said.append(f"{what}: the FRFs have a few lines more or less: the common ones are used")
    return cut


def _between(frf: ForeignFrf, low_hz: float, high_hz: float) -> ForeignFrf:
    keep = (frf.freq_hz > low_hz) & (frf.freq_hz < high_hz)
    coherence = frf.coherence
    return replace(
        frf,
        freq_hz=frozen_array(frf.freq_hz[keep], np.float64),
        values=frozen_array(frf.values[keep], np.complex128),
        coherence=None if coherence is None else frozen_array(coherence[keep], np.float64),
        variance=None if frf.variance is None else frozen_array(frf.variance[keep], np.float64),
    )


def _same_lines(a: npt.NDArray[np.float64], b: npt.NDArray[np.float64]) -> bool:
    if len(a) != len(b) or len(b) < 2:
        return False
    return bool(np.max(np.abs(a - b)) <= _SAME_LINE * float(np.min(np.diff(b))))


def _response(frf: ForeignFrf, placement: Placement, said: list[str]) -> Dof:
    point = placement.point(frf.response, RESPONSE, frf.origin)
    direction = placement.direction(frf.response, point, RESPONSE, frf.origin)
    if frf.response.direction is None:
        said.append(f"{frf.origin}: the direction of the response is not told")
    return Dof(point=point, label=frf.response.label or SCALAR, direction=direction)


def _references(
    frfs: Sequence[ForeignFrf], table: PostureTable, placement: Placement, said: list[str]
) -> list[Dof]:
    """Reference of each FRF: the manifest's hit where it gives one, else the file's."""
    told = {(frf.reference.node, frf.reference.label) for frf in frfs}
    what = f"posture {table.name!r}"
    if table.hit_point is not None and len(told) > 1:
        raise ForeignFileError(
            f"{what}: hit_point is for one reference, the files have {len(told)}; leave it out"
        )
    dofs = []
    for frf in frfs:
        point = placement.hit_point(table.hit_point, frf.reference, frf.origin)
        if table.hit_direction is not None:
            vector = np.array(table.hit_direction)
            direction = frozen_array(vector / np.linalg.norm(vector), np.float64)
        else:
            direction = placement.direction(frf.reference, point, HIT, frf.origin)
            if frf.reference.direction is None:
                said.append(f"{what}: the direction of the hit is not told")
        dofs.append(Dof(point=point, label=HIT, direction=direction))
    return dofs


def _one(contents: Sequence[Content], name: str, told: float | None, what: str) -> float | None:
    """Return what the manifest tells, else what all files tell alike, else None."""
    if told is not None:
        return told
    found = {getattr(content, name) for content in contents if content.frfs}
    if len(found) > 1:
        raise ForeignFileError(
            f"{what}: wanted files of one {name}, got {sorted(map(str, found))}; say it in the "
            "manifest"
        )
    value: float | None = found.pop() if found else None
    return value


def _say_holes(
    measured: npt.NDArray[np.bool_],
    responses: tuple[Dof, ...],
    references: tuple[Dof, ...],
    what: str,
    said: list[str],
) -> None:
    """Say which FRFs were not measured, and of which the mirror was."""
    holes = np.argwhere(~measured)
    if not len(holes):
        return
    named = [
        f"{responses[i].point} {responses[i].label} over {references[j].point}" for i, j in holes
    ]
    more = f" and {len(named) - MOST_NAMED} more" if len(named) > MOST_NAMED else ""
    said.append(
        f"{what}: {len(holes)} of {measured.size} FRFs were not measured and are left out: "
        f"{', '.join(named[:MOST_NAMED])}{more}"
    )


def _say_uncertainty(
    coherence: npt.NDArray[np.float64], n_hits: int, what: str, said: list[str]
) -> None:
    """Say what `coherence` (n_measured, n_freq) and the number of averages leave open."""
    untold = int(np.count_nonzero(np.isnan(coherence).any(axis=-1)))
    if untold == len(coherence):
        said.append(f"{what}: no coherence: uncertainties come from the misfit alone")
        return
    if untold:
        said.append(f"{what}: {untold} FRFs have no coherence: they weigh like the others")
    if n_hits == 0:
        said.append(
            f"{what}: the number of averages is not told: the scatter is bounded as for two; say "
            "`averages` in the manifest"
        )
    elif n_hits == 1:
        said.append(f"{what}: one average: its coherence says nothing about scatter")
