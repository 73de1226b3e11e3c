"""The FRFs in named arrays: complex ones, or parts to be put together, over their lines."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from armodal.protocols.arrays import frozen_array
from armodal.protocols.errors import ForeignFileError
from armodal.protocols.foreign.complex_arrays import complex_arrays
from armodal.protocols.foreign.frf_dofs import reference_dofs, response_dofs
from armodal.protocols.foreign.frf_units import KIND_OF_FORM, frf_unit
from armodal.protocols.foreign.measured import (
    ForeignFrf,
    Hints,
    NotToldError,
    check_frf_values,
    clipped_coherence,
    not_measured,
)
from armodal.protocols.foreign.roles import Role, role_of, tokens
from armodal.protocols.foreign.uff_records import DataKind
from armodal.protocols.foreign.units import SI, hertz, signal_scale
from armodal.protocols.foreign.variables import Variable, Variables
from armodal.protocols.frf_records import FrfForm

__all__ = ["frfs_of"]

Found = Mapping[Role, Sequence[Variable]]
Reals = npt.NDArray[np.float64]

_FORM_WORDS = (
    (FrfForm.ACCELERANCE, {"accelerance", "inertance"}),
    (FrfForm.MOBILITY, {"mobility"}),
    (FrfForm.RECEPTANCE, {"receptance", "compliance", "admittance"}),
)


@dataclass(slots=True)
class Words:
    """What is said about a file while it is read."""

    said: list[str]
    read_as: list[str]


def frfs_of(part: Variables, found: Found, hints: Hints, words: Words) -> tuple[ForeignFrf, ...]:
    """Return the FRFs of named arrays in SI.

    Raises
    ------
    NotToldError
        If form, lines or degrees of freedom are told neither by the file nor by the manifest.
    ForeignFileError
        If shapes do not fit, or values are none that a fit could use.
    """
    arrays = complex_arrays(found, part.origin, words.said, words.read_as)
    freq = _lines(part, found, arrays, hints)
    form, factors = _form_and_factors(part, arrays, hints, words)
    blocks = [
        _lines_last(array, len(freq), part.origin) * factor
        for array, factor in zip(arrays, factors, strict=True)
    ]
    if len({block.shape[1] for block in blocks}) != 1:
        raise ForeignFileError(
            f"{part.origin}: wanted FRFs over the same references, got arrays of "
            f"{sorted({block.shape[1] for block in blocks})}; say `variables` in the manifest"
        )
    values = np.concatenate(blocks)
    names = [a.name for a, b in zip(arrays, blocks, strict=True) for _ in range(len(b))]
    responses = response_dofs(part, names, hints, words.read_as)
    references = reference_dofs(part, names, values.shape[1], hints)
    coherence = _coherence(found, values.shape, freq, part.origin, words.said)
    if coherence is None and not found.get(Role.COHERENCE):
        words.said += _empty_coherence(part)
    variance, averages = _own_matrices(part, values.shape)
    if freq[0] == 0.0:
        words.said.append(f"{part.origin}: the line at 0 Hz is left out")
    frfs = []
    for i, response in enumerate(responses):
        for j, reference in enumerate(references):
            where = part.origin if values.shape[:2] == (1, 1) else f"{part.origin}: FRF {i + 1}"
            where += f", {j + 1}" if len(references) > 1 else ""
            if values.shape[:2] != (1, 1) and not_measured(values[i, j]):
                words.said.append(f"{where}: 0 or NaN on every line: taken as not measured")
                continue
            keep = check_frf_values(freq, values[i, j], where)
            own = None if coherence is None else coherence[i, min(j, coherence.shape[1] - 1)][keep]
            if own is not None:
                own = clipped_coherence(own, where, words.said)
            frfs.append(
                ForeignFrf(
                    origin=where,
                    form=form,
                    response=response,
                    reference=reference,
                    freq_hz=frozen_array(freq[keep], np.float64),
                    values=frozen_array(values[i, j][keep], np.complex128),
                    coherence=None if own is None else frozen_array(own, np.float64),
                    variance=(
                        None if variance is None else frozen_array(variance[i, j][keep], np.float64)
                    ),
                    averages=None if averages is None else int(averages[i, j]),
                )
            )
    return tuple(frfs)


def _own_matrices(part: Variables, shape: tuple[int, ...]) -> tuple[Reals | None, Reals | None]:
    """Return variances, and averages of each FRF, where armodal wrote them; else None."""
    own = part.texts.get("unit") == (SI,) and part.texts.get("form", ("",))[0] in set(FrfForm)
    by_name = {v.name: v.values for v in part.variables if own and not v.is_complex}
    variance, averages = by_name.get("variance"), by_name.get("averages")
    # MATLAB drops sides of one.
    if variance is not None and variance.size == np.prod(shape):
        variance = variance.reshape(shape)
        known = bool((variance >= 0.0).all())  # infinite where nothing was measured
    else:
        known = False
    several = averages is not None and 1 < averages.size == np.prod(shape[:2])
    if averages is not None and several and np.isfinite(averages).all():
        return (variance if known else None), np.clip(averages, 0, 10**6).reshape(shape[:2])
    return (variance if known else None), None


def _lines(part: Variables, found: Found, arrays: Sequence[Variable], hints: Hints) -> Reals:
    """Return the frequencies of the lines, Hz."""
    sizes = {size for array in arrays for size in array.values.shape}
    for variable in found.get(Role.FREQUENCY, ()):
        freq = np.asarray(np.real(variable.values), dtype=np.float64).reshape(-1)
        if len(freq) in sizes and len(freq) > 1:
            label = variable.unit or ("rad/s" if "omega" in tokens(variable.name) else "Hz")
            factor = hertz(label)
            if factor is None:
                raise ForeignFileError(
                    f"{part.origin}: wanted frequencies in Hz, kHz or rad/s, got "
                    f"{variable.name[:40]!r} in {label!r}; convert them"
                )
            return freq * factor
    count = max(sizes)
    step, first = hints.line_spacing_hz, hints.first_line_hz or 0.0
    if step is None and part.axis is not None and part.axis.unit == "Hz":
        step, first = part.axis.step, part.axis.first
    if step is None:
        raise NotToldError(
            f"{part.origin}: wanted the frequencies of {count} lines, the file does not tell them; "
            "say `line_spacing_hz` in the manifest, or name their array in `variables`",
            key="line_spacing_hz",
        )
    return first + step * np.arange(count, dtype=np.float64)


def _lines_last(array: Variable, n_lines: int, origin: str) -> npt.NDArray[np.complex128]:
    """Return (responses, references, lines); a table has one reference, and lines either way."""
    values = np.asarray(array.values, dtype=np.complex128)
    values = values.reshape(-1) if values.size == n_lines else values
    axes = [i for i, size in enumerate(values.shape) if size == n_lines]
    if not axes or values.ndim > 3:
        shape = " x ".join(map(str, values.shape))
        raise ForeignFileError(
            f"{origin}: wanted {array.name[:40]} of shape (responses, references, {n_lines}), got "
            f"{shape}: none of its sizes is the number of lines; name others in `variables`"
        )
    values = np.moveaxis(values, axes[-1], -1)
    if values.ndim == 1:
        return values[None, None, :]
    return values[:, None, :] if values.ndim == 2 else values


def _form_and_factors(
    part: Variables, arrays: Sequence[Variable], hints: Hints, words: Words
) -> tuple[FrfForm, list[float]]:
    told = [frf_unit(array.unit) for array in arrays]
    forms = {one[0] for one in told if one is not None}
    if len(forms) > 1:
        raise ForeignFileError(
            f"{part.origin}: wanted FRFs of one form, the units tell {', '.join(sorted(forms))}; "
            "say `variables` in the manifest"
        )
    by_unit = forms.pop() if forms else None
    if hints.form is not None and by_unit not in {None, hints.form}:
        words.said.append(
            f"{part.origin}: the file tells {by_unit}, the manifest {hints.form}, which holds"
        )
    form = hints.form or by_unit or _form_in_words(part)
    if form is None:
        raise NotToldError(
            f"{part.origin}: form unknown: wanted {', '.join(FrfForm)}, told by a variable `form` "
            "or by a unit such as (m/s^2)/N; say `form` in the manifest",
            key="form",
        )
    if hints.response_unit is not None and hints.force_unit is not None:
        response = signal_scale(KIND_OF_FORM[form], hints.response_unit, None, part.origin)
        force = signal_scale(DataKind.EXCITATION_FORCE, hints.force_unit, None, part.origin)
        return form, [response.factor / force.factor] * len(arrays)
    if (hints.response_scale, hints.force_scale) != (None, None):
        factor = (hints.response_scale or 1.0) / (hints.force_scale or 1.0)
        return form, [factor] * len(arrays)
    if by_unit is form:
        return form, [1.0 if one is None else one[1] for one in told]
    if part.texts.get("unit") != (SI,):
        words.said.append(
            f"{part.origin}: the units are not told; the numbers are taken as SI (m, s, N). Say "
            "`units` in the manifest"
        )
    return form, [1.0] * len(arrays)


def _form_in_words(part: Variables) -> FrfForm | None:
    told = part.texts.get("form", ())
    if len(told) == 1 and told[0] in set(FrfForm):
        return FrfForm(told[0])
    names = " ".join(v.name for v in part.variables)
    found = tokens(f"{names} {part.words}")
    forms = [form for form, known in _FORM_WORDS if found & known]
    return forms[0] if len(forms) == 1 else None


def _coherence(
    found: Found, shape: tuple[int, ...], freq: Reals, origin: str, said: list[str]
) -> Reals | None:
    """Return the coherence over (responses, references or 1, lines), None where there is none."""
    told = found.get(Role.COHERENCE, ())
    if not told:
        return None
    n_resp, n_ref, n_lines = shape
    rows = []
    for variable in told:
        values = variable.values
        if variable.is_complex or values.size == 0:
            raise _other_coherence(variable, shape, origin)
        if values.size == n_lines - 1 and freq[0] == 0.0:
            values = np.concatenate([[0.0], values.reshape(-1)])
        rows.append(_real_lines_last(variable, values, n_lines, shape, origin))
    if len({row.shape[1] for row in rows}) == 1:
        matrix = np.concatenate(rows)
        if matrix.shape[0] == n_resp and matrix.shape[1] == n_ref:
            return matrix
        if matrix.shape[:2] == (n_resp, 1):
            said.append(f"{origin}: one coherence for several references: it is left out")
            return None
    raise _other_coherence(told[0], shape, origin)


def _empty_coherence(part: Variables) -> list[str]:
    """Return a word about a coherence that is text, or empty."""
    names = {variable.name for variable in part.variables}
    rest = [one for one in part.listed if one.name not in names]
    return [
        f"{part.origin}: wanted numbers as coherence, got {one.words}: it is left out"
        for one in rest
        if role_of(one.name, "", is_complex=False) is Role.COHERENCE
    ]


def _real_lines_last(
    variable: Variable, values: Reals, n_lines: int, shape: tuple[int, ...], origin: str
) -> Reals:
    if values.size == n_lines:
        return values.reshape(1, 1, n_lines)
    axes = [i for i, size in enumerate(values.shape) if size == n_lines]
    if not axes or values.ndim > 3:
        raise _other_coherence(variable, shape, origin)
    values = np.moveaxis(values, axes[-1], -1)
    return values[:, None, :] if values.ndim == 2 else values


def _other_coherence(variable: Variable, shape: tuple[int, ...], origin: str) -> ForeignFileError:
    return ForeignFileError(
        f"{origin}: wanted a real coherence of frf's shape {shape}, got {variable.name[:40]} "
        f"({'complex' if variable.is_complex else 'real'}, {variable.values.shape}); save it like "
        "the FRFs, or say `variables` in the manifest without it"
    )
