"""Which poles a band of FRFs holds: candidates over orders, choice, a second look."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np
import numpy.typing as npt

from armodal.analyzer.modal.choice import candidate_poles, merge_duplicates, zoom_bands
from armodal.analyzer.modal.complete_parts import Part, complete_parts
from armodal.analyzer.modal.drift import settle_drift
from armodal.analyzer.modal.peaks import peak_poles, standing_peaks, unexplained
from armodal.analyzer.modal.plscf import Stabilisation, poles_plscf
from armodal.analyzer.modal.regression import NO_POLES, ModalData, modal_data
from armodal.analyzer.modal.residual_poles import residual_poles, split_poles
from armodal.analyzer.modal.selection import (
    Selection,
    keep_modes,
    second_poles,
    select_modes,
)
from armodal.analyzer.modal.spans import Span, spans
from armodal.analyzer.modal.windows import laplace_lines
from armodal.protocols.frf_records import FrfForm

__all__ = ["Problem", "search_poles", "stabilisation"]

_Real = npt.NDArray[np.float64]
_Complex = npt.NDArray[np.complex128]

_MOST_ROUNDS = 8  # of looking for poles in what the model leaves over
_LEAST_PROGRESS = 0.99  # of the misfit before the round
_ZOOM_ORDER_STEP = 3  # orders of a zoomed band: some fifteen suffice, each is an eigenvalue problem


@dataclass(frozen=True, slots=True, kw_only=True)
class Problem:
    """FRFs to be fitted, the longer side first: by reciprocity the shorter serves as references."""

    form: FrfForm
    freq_hz: _Real  # (n_freq,)
    decay_rad_s: float
    values: _Complex  # (n_long, n_short, n_freq)
    variance: _Real  # alike; infinite where an FRF was not measured
    line_share: float  # independent lines per line
    group: npt.NDArray[np.int64]  # (n_long,) what was measured at once
    background: _Complex = field(default_factory=lambda: NO_POLES)  # poles that are no modes

    @property
    def band_hz(self) -> tuple[float, float]:
        """Lowest and highest line."""
        return float(self.freq_hz[0]), float(self.freq_hz[-1])

    @property
    def measured(self) -> npt.NDArray[np.bool_]:
        """Which FRFs were measured: (n_long, n_short)."""
        return np.asarray(np.isfinite(self.variance).all(axis=-1))

    @property
    def rows(self) -> npt.NDArray[np.int64]:
        """Group of every FRF, references fastest: (n_long n_short,)."""
        return np.repeat(self.group, self.values.shape[1])

    def data(self) -> ModalData:
        """Regression data, one row an FRF."""
        s = laplace_lines(self.freq_hz, self.decay_rad_s)
        return modal_data(self.form, s, self.values, self.variance, self.background)

    def part(self, span: Span) -> Problem:
        """Lines of a span."""
        at = slice(span.first, span.last + 1)
        return replace(
            self,
            freq_hz=self.freq_hz[at],
            values=np.ascontiguousarray(self.values[..., at]),
            variance=np.ascontiguousarray(self.variance[..., at]),
        )


def _poles(
    problem: Problem,
    part: Part,
    max_order: int,
    *,
    lines: slice | npt.NDArray[np.bool_] = slice(None),
    order_step: int | None = None,
) -> Stabilisation:
    """Poles over orders of one polynomial over a complete part of the matrix."""
    variance = problem.variance[part].mean(axis=1)
    return poles_plscf(
        problem.values[part][..., lines],
        problem.freq_hz[lines],
        decay_rad_s=problem.decay_rad_s,
        weight=1.0 / np.sqrt(variance[:, lines]),
        max_order=max_order,
        order_step=order_step,
    )


def stabilisation(problem: Problem, max_order: int) -> Stabilisation:
    """Poles over orders of one polynomial over all lines.

    Where FRFs were not measured: of the largest complete block over several references, or of
    one reference response by response.
    """
    return _poles(problem, complete_parts(problem.measured)[0], max_order)


def _candidates(problem: Problem, whole: Stabilisation, max_order: int) -> tuple[_Complex, _Real]:
    """Candidates of the whole band and of the zoomed bands in it."""
    freq, poles, shares = problem.freq_hz, [], []
    for number, part in enumerate(complete_parts(problem.measured)):
        table = whole if number == 0 else _poles(problem, part, max_order)
        found, share = candidate_poles(table, problem.band_hz)
        poles.append(found)
        shares.append(share)
        # A polynomial matrix of n_ref columns has n_ref times as many poles as its order.
        zoom_order = max(max_order // table.participation.shape[1], 8)
        for low, high in zoom_bands(freq):
            lines = (freq >= low) & (freq <= high)
            most = min(zoom_order, int(np.count_nonzero(lines)) // 2)
            table = _poles(problem, part, most, lines=lines, order_step=_ZOOM_ORDER_STEP)
            found, share = candidate_poles(table, (low, high))
            poles.append(found)
            shares.append(share)
    pole, share = np.concatenate(poles), np.concatenate(shares)
    # What everybody sees is tried where no polynomial holds it.
    peaks = standing_peaks(freq, problem.values)
    seen = peak_poles(unexplained(peaks, pole, float(np.median(np.diff(freq)))))
    pole, share = np.concatenate([pole, seen]), np.concatenate([share, np.zeros(seen.size)])
    kept = merge_duplicates(pole, share)
    return pole[kept], share[kept]


def _settled(problem: Problem, data: ModalData, chosen: Selection) -> tuple[ModalData, Selection]:
    """FRFs and choice as if nothing had moved: copies of a mode are not looked for again."""
    still = settle_drift(data, chosen.fit, problem.rows, line_share=problem.line_share)
    if still is None:
        return data, chosen
    data = replace(problem, values=still.values.reshape(problem.values.shape)).data()
    share = chosen.share[still.kept]
    return data, keep_modes(data, still.poles, share, line_share=problem.line_share)


def _looked_again(problem: Problem, data: ModalData, chosen: Selection) -> Selection:
    """Choose again with the poles that the misfit holds, until it holds none that are needed."""
    for _ in range(_MOST_ROUNDS):
        found, seen = residual_poles(
            data,
            chosen.fit,
            problem.freq_hz,
            problem.values.shape[1],
            decay_rad_s=problem.decay_rad_s,
            line_share=problem.line_share,
        )
        poles = np.concatenate([chosen.fit.poles, found])
        # Those already chosen come before any that are found beside them.
        rank = np.concatenate([np.full(chosen.share.size, 2.0), seen])
        kept = merge_duplicates(poles, rank)
        if kept.size <= chosen.share.size:
            break
        share = np.concatenate([chosen.share, seen])[kept]
        again = select_modes(
            data,
            poles[kept],
            share,
            problem.band_hz,
            line_share=problem.line_share,
            chosen=chosen,
        )
        if again.fit.cost.sum() > _LEAST_PROGRESS * chosen.fit.cost.sum():
            break
        chosen = again
    return _split(problem, data, chosen)


def _split(problem: Problem, data: ModalData, chosen: Selection) -> Selection:
    """Choose again with a second pole beside each mode that leaves a misfit, where needed."""
    for _ in range(_MOST_ROUNDS):
        tried = split_poles(data, chosen.fit, problem.freq_hz, line_share=problem.line_share)
        found = second_poles(data, chosen.fit, tried, problem.line_share)
        if not found.size:
            break
        again = select_modes(
            data,
            np.concatenate([chosen.fit.poles, found]),
            np.concatenate([chosen.share, np.zeros(found.size)]),
            problem.band_hz,
            line_share=problem.line_share,
            chosen=chosen,
        )
        if again.share.size <= chosen.share.size:
            break
        chosen = again
    return chosen


def _in_one_piece(problem: Problem, table: Stabilisation, max_order: int) -> Selection:
    poles, share = _candidates(problem, table, max_order)
    data = problem.data()
    chosen = select_modes(data, poles, share, problem.band_hz, line_share=problem.line_share)
    data, chosen = _settled(problem, data, chosen)
    return _looked_again(problem, data, chosen)


def search_poles(
    problem: Problem, table: Stabilisation, max_order: int, *, tell: Callable[[str], None]
) -> tuple[_Complex, _Real]:
    """Poles the data need, and the share of orders each was seen at.

    A long record is searched span by span, each with residual terms of its own, which costs time
    in proportion to the lines.

    Parameters
    ----------
    problem
        The FRFs.
    table
        Poles over orders of the whole band.
    max_order
        Highest order of a stabilisation.
    tell
        Called with what is being done.
    """
    pieces = spans(problem.freq_hz, problem.values, problem.variance)
    if len(pieces) == 1:
        tell("which poles the FRFs need")
        chosen = _in_one_piece(problem, table, max_order)
        return chosen.fit.poles, chosen.share
    poles, shares = [], []
    for span in pieces:
        part = problem.part(span)
        low, high = part.band_hz
        tell(f"which poles {low:.4g} to {high:.4g} Hz needs, of {problem.band_hz[1]:.4g} Hz")
        chosen = _in_one_piece(part, stabilisation(part, max_order), max_order)
        own = span.holds(np.abs(chosen.fit.poles) / (2.0 * np.pi))
        poles.append(chosen.fit.poles[own])
        shares.append(chosen.share[own])
    return np.concatenate(poles), np.concatenate(shares)
