"""The measurements in a universal file: FRFs with their coherence, and single hits."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import numpy.typing as npt

from armodal.protocols.arrays import frozen_array
from armodal.protocols.errors import ForeignFileError
from armodal.protocols.foreign.frf_units import KIND_OF_FORM, frf_form, frf_scale
from armodal.protocols.foreign.hit_variables import MOST_TRIMMED
from armodal.protocols.foreign.measured import (
    Content,
    ForeignFrf,
    Hints,
    NotToldError,
    check_frf_values,
    clipped_coherence,
)
from armodal.protocols.foreign.uff_hits import hits_of, say_assumed
from armodal.protocols.foreign.uff_identification import (
    is_variance,
    reference_dof,
    response_dof,
    told_estimate,
)
from armodal.protocols.foreign.uff_records import (
    DataKind,
    FunctionKind,
    UffFile,
    UffFunction,
    UffNodes,
    UffUnits,
)
from armodal.protocols.foreign.uff_words import listed_uff, skipped_words
from armodal.protocols.foreign.units import length_scale, signal_scale
from armodal.protocols.foreign.variables import listing
from armodal.protocols.frf_records import FrfForm

__all__ = ["uff_content"]

_SAME_LINE = 1e-3  # of a line's spacing


def uff_content(file: UffFile, hints: Hints, origin: str) -> Content:
    """Return FRFs and hits of a universal file in SI.

    Raises
    ------
    ForeignFileError
        If a form or unit is contradictory or unknown, or a function is none a fit could use.
    """
    found = listed_uff(file)
    try:
        content = _content(file, hints, origin)
    except NotToldError as error:
        raise NotToldError(error.why, key=error.key, listed=found) from error
    except ForeignFileError as error:
        raise ForeignFileError(f"{error}; {listing(found)}") from error
    return replace(content, found=found)


def _content(file: UffFile, hints: Hints, origin: str) -> Content:
    said = [f"{origin}: {text}" for text in (*file.notes, *skipped_words(file.skipped))]
    frfs = [f for f in file.functions if f.kind == FunctionKind.FREQUENCY_RESPONSE]
    times = [f for f in file.functions if f.kind == FunctionKind.TIME_RESPONSE]
    coherences = [f for f in file.functions if f.kind == FunctionKind.COHERENCE]
    variances = [f for f in file.functions if is_variance(f)]
    others = {f.kind for f in file.functions if not is_variance(f)} - {1, 4, 6}
    if others:
        said.append(f"{origin}: functions of type {sorted(others)} are not used")
    if frfs and times:
        is_hit = hints.kind == "hit"
        said.append(f"{origin}: {'FRFs' if is_hit else 'time records'} are not used")
        frfs, times = ([], times) if is_hit else (frfs, [])
    measured: list[ForeignFrf] = []
    averages: set[int | None] = set()
    decays: set[float | None] = set()
    for index, function in enumerate(frfs):
        where = f"{origin}: FRF {index + 1} ({_dof_words(function)})"
        if max(abs(function.response_direction), abs(function.reference_direction)) > 3:
            said.append(f"{origin}: FRFs of rotations are not used")
            continue
        count, decay = told_estimate(function, where)
        frf = _frf(function, coherences, variances, file.units, hints, where, said)
        measured.append(replace(frf, averages=count))
        averages.add(count)
        decays.add(decay)
    if len(decays) > 1:
        raise ForeignFileError(
            f"{origin}: wanted FRFs of one window, got several; export them to separate files"
        )
    measured = _named(measured, hints, origin)
    nodes = file.nodes
    if nodes is not None:
        factor = length_scale(file.units, origin)
        position = frozen_array(nodes.position * factor, np.float64)
        nodes = UffNodes(number=nodes.number, position=position)
        if file.units is None:
            said.append(f"{origin}: no dataset 164: the unit of length is not told; taken as m")
    return Content(
        origin=origin,
        frfs=tuple(measured),
        hits=tuple(hits_of(times, file.units, hints, origin, said)),
        nodes=nodes,
        trace_lines=file.trace_lines,
        averages=_fewest(averages),
        decay_rad_s=decays.pop() if decays else None,
        said=tuple(dict.fromkeys(said)),
    )


def _named(measured: list[ForeignFrf], hints: Hints, origin: str) -> list[ForeignFrf]:
    """Return the FRFs with the degrees of freedom that the manifest tells before the file."""
    if hints.responses and len(hints.responses) != len(measured):
        raise ForeignFileError(
            f"{origin}: wanted {len(hints.responses)} FRFs, as `responses` in the manifest says, "
            f"got {len(measured)}"
        )
    if hints.responses:
        measured = [
            replace(frf, response=dof) for frf, dof in zip(measured, hints.responses, strict=True)
        ]
    reference = hints.reference
    if reference is None:
        return measured
    return [replace(frf, reference=reference) for frf in measured]


def _fewest(averages: set[int | None]) -> int | None:
    told = [number for number in averages if number is not None]
    return min(told) if told and len(told) == len(averages) else None


def _frf(
    function: UffFunction,
    coherences: list[UffFunction],
    variances: list[UffFunction],
    units: UffUnits | None,
    hints: Hints,
    where: str,
    said: list[str],
) -> ForeignFrf:
    if not np.iscomplexobj(function.values):
        raise ForeignFileError(
            f"{where}: wanted complex values, got real ones; export real and imaginary part"
        )
    form = _form(function, hints, where, said)
    scale = _frf_scale(function, form, units, hints, where, said)
    values = np.asarray(function.values, dtype=np.complex128) * scale
    freq = np.asarray(function.abscissa)
    keep = check_frf_values(freq, values, where)
    if freq[0] == 0.0:
        said.append(f"{where.split(':', maxsplit=1)[0]}: the line at 0 Hz is left out")
    coherence = _coherence_of(function, coherences, where, said)
    variance = _variance_of(function, variances, scale)
    return ForeignFrf(
        origin=where,
        form=form,
        response=response_dof(function),
        reference=reference_dof(function),
        freq_hz=frozen_array(freq[keep], np.float64),
        values=frozen_array(values[keep], np.complex128),
        coherence=None if coherence is None else frozen_array(coherence[keep], np.float64),
        variance=None if variance is None else frozen_array(variance[keep], np.float64),
    )


def _form(function: UffFunction, hints: Hints, where: str, said: list[str]) -> FrfForm:
    told = frf_form(function)
    if hints.form is not None and told is not None and hints.form is not told:
        said.append(f"{where}: the file tells {told}, the manifest {hints.form}, which holds")
    form = hints.form or told
    if form is None:
        raise NotToldError(
            f"{where}: form unknown: wanted displacement, velocity or acceleration over force "
            f"(data types 8, 11, 12 over 13), got {function.numerator} over "
            f"{function.denominator}; say `form` in the manifest",
            key="form",
        )
    return form


def _frf_scale(
    function: UffFunction,
    form: FrfForm,
    units: UffUnits | None,
    hints: Hints,
    where: str,
    said: list[str],
) -> float:
    if hints.response_unit is not None and hints.force_unit is not None:
        kind = KIND_OF_FORM[form]
        return (
            signal_scale(kind, hints.response_unit, None, where).factor
            / signal_scale(DataKind.EXCITATION_FORCE, hints.force_unit, None, where).factor
        )
    scale = frf_scale(function, form, units, where)
    say_assumed(scale, units, where, said)
    return scale.factor


def _coherence_of(
    function: UffFunction, coherences: list[UffFunction], where: str, said: list[str]
) -> npt.NDArray[np.float64] | None:
    """Return the coherence of the same two degrees of freedom on the FRF's lines, or None."""
    response = (function.response_node, abs(function.response_direction))
    reference = (function.reference_node, abs(function.reference_direction))
    same = [
        c
        for c in coherences
        if (c.response_node, abs(c.response_direction)) == response
        and (c.reference_node in {0, reference[0]})
        and (abs(c.reference_direction) in {0, reference[1]})
    ]
    if not same:
        return None
    values = np.asarray(np.real(same[0].values), dtype=np.float64)
    if len(same) > 1:
        raise ForeignFileError(f"{where}: wanted one coherence, got {len(same)}; export one")
    on_lines = _on_lines(same[0].abscissa, values, function.abscissa)
    if on_lines is None:
        said.append(f"{where}: its coherence is on other lines: it is left out")
        return None
    zero = function.abscissa <= 0.0
    return clipped_coherence(np.where(zero, 1.0, on_lines), where, said)


def _variance_of(
    function: UffFunction, variances: list[UffFunction], scale: float
) -> npt.NDArray[np.float64] | None:
    """Return the variance that armodal wrote for an FRF, on its lines; None where there is none."""
    for one in variances:
        same = (
            (one.response_node, one.response_direction, one.reference_node, one.reference_direction)
            == (
                function.response_node,
                function.response_direction,
                function.reference_node,
                function.reference_direction,
            )
            and one.identification[3:] == function.identification[3:]
            and np.array_equal(one.abscissa, function.abscissa)
        )
        values = np.asarray(np.real(one.values), dtype=np.float64)
        if same and np.isfinite(values).all() and (values >= 0.0).all():
            return values * scale**2
    return None


def _on_lines(
    freq: npt.NDArray[np.float64],
    values: npt.NDArray[np.float64],
    wanted: npt.NDArray[np.float64],
) -> npt.NDArray[np.float64] | None:
    """Return values on the wanted lines, NaN on a few that are missing; None for other lines."""
    if np.array_equal(freq, wanted):
        return values
    if len(freq) < 2 or len(wanted) < 2 or (np.diff(freq) <= 0.0).any():
        return None
    nearest = np.clip(np.searchsorted(freq, wanted), 1, len(freq) - 1)
    nearest = nearest - (wanted - freq[nearest - 1] < freq[nearest] - wanted)
    near = np.abs(freq[nearest] - wanted) <= _SAME_LINE * float(np.min(np.diff(wanted)))
    if np.count_nonzero(~near) > MOST_TRIMMED:
        return None
    return np.where(near, values[nearest], np.nan)


def _dof_words(function: UffFunction) -> str:
    return f"node {function.response_node} over {function.reference_node}"
