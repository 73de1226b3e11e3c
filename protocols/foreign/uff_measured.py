"""The measurements in a universal file: FRFs with their coherence, and single hits.

armodal's own files tell in their identification lines what the format has no field for; these are
read back here and stay readable words to everybody else.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from armodal.protocols.arrays import frozen_array
from armodal.protocols.errors import ForeignFileError
from armodal.protocols.foreign.frf_units import KIND_OF_FORM, frf_form, frf_scale
from armodal.protocols.foreign.hit_variables import MOST_TRIMMED
from armodal.protocols.foreign.measured import (
    Content,
    ForeignFrf,
    ForeignHit,
    Hints,
    NotToldError,
    ToldDof,
    axis_direction,
    check_frf_values,
    check_signals,
    clipped_coherence,
    exact_rate,
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
from armodal.protocols.foreign.units import Scale, length_scale, signal_scale, unit
from armodal.protocols.foreign.variables import listing
from armodal.protocols.frf_records import FrfForm

__all__ = ["direction_words", "estimate_words", "uff_content"]

_SIX_DIGITS = 5e-6  # relative: E13.5
_SAME_LINE = 1e-3  # of a line's spacing
_FORCES = {DataKind.EXCITATION_FORCE, DataKind.REACTION_FORCE}
_DIRECTION = re.compile(r"armodal (response|reference) direction (\S+) (\S+) (\S+)")
_ESTIMATE = re.compile(r"armodal averages (\d{1,6}), window decay (\S{1,30}) rad/s")


def direction_words(what: str, direction: npt.NDArray[np.float64]) -> str:
    """Return the identification line that tells a direction along no axis.

    >>> direction_words("reference", np.array([0.6, 0.0, 0.8]))
    'armodal reference direction 0.600000000 0.000000000 0.800000000'
    """
    return f"armodal {what} direction " + " ".join(f"{x:.9f}" for x in direction)


def estimate_words(averages: int, decay_rad_s: float) -> str:
    """Return the identification line that tells averages and window.

    >>> estimate_words(3, 2.5)
    'armodal averages 3, window decay 2.5 rad/s'
    """
    return f"armodal averages {averages}, window decay {decay_rad_s:.12g} rad/s"


@dataclass(slots=True)
class _Said:
    """Sentences about the file, each once."""

    sentences: list[str]

    def add(self, text: str) -> None:
        if text not in self.sentences:
            self.sentences.append(text)


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
    said = _Said([])
    for text in (*file.notes, *skipped_words(file.skipped)):
        said.add(f"{origin}: {text}")
    frfs = [f for f in file.functions if f.kind == FunctionKind.FREQUENCY_RESPONSE]
    times = [f for f in file.functions if f.kind == FunctionKind.TIME_RESPONSE]
    coherences = [f for f in file.functions if f.kind == FunctionKind.COHERENCE]
    others = {f.kind for f in file.functions} - {1, 4, 6}
    if others:
        said.add(f"{origin}: functions of type {sorted(others)} are not used")
    if frfs and times:
        is_hit = hints.kind == "hit"
        said.add(f"{origin}: {'FRFs' if is_hit else 'time records'} are not used")
        frfs, times = ([], times) if is_hit else (frfs, [])
    measured: list[ForeignFrf] = []
    averages: set[int | None] = set()
    decays: set[float | None] = set()
    for index, function in enumerate(frfs):
        where = f"{origin}: FRF {index + 1} ({_dof_words(function)})"
        if max(abs(function.response_direction), abs(function.reference_direction)) > 3:
            said.add(f"{origin}: FRFs of rotations are not used")
            continue
        measured.append(_frf(function, coherences, file.units, hints, where, said))
        words = _ESTIMATE.fullmatch(function.identification[1])
        averages.add(int(words[1]) if words and words[1].strip("0") else None)
        decays.add(_number(words[2], where) if words else None)
    if len(decays) > 1:
        raise ForeignFileError(
            f"{origin}: wanted FRFs of one window, got several; export them to separate files"
        )
    if len(averages) > 1:
        said.add(f"{origin}: FRFs differ in their number of averages; the smallest holds for all")
    measured = _named(measured, hints, origin)
    nodes = file.nodes
    if nodes is not None:
        factor = length_scale(file.units, origin)
        position = frozen_array(nodes.position * factor, np.float64)
        nodes = UffNodes(number=nodes.number, position=position)
        if file.units is None:
            said.add(f"{origin}: no dataset 164: the unit of length is not told; taken as m")
    return Content(
        origin=origin,
        frfs=tuple(measured),
        hits=tuple(_hits(times, file.units, hints, origin, said)),
        nodes=nodes,
        trace_lines=file.trace_lines,
        averages=_fewest(averages),
        decay_rad_s=decays.pop() if decays else None,
        said=tuple(said.sentences),
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
    units: UffUnits | None,
    hints: Hints,
    where: str,
    said: _Said,
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
        said.add(f"{where.split(':', maxsplit=1)[0]}: the line at 0 Hz is left out")
    coherence = _coherence_of(function, coherences, where, said)
    return ForeignFrf(
        origin=where,
        form=form,
        response=_response(function),
        reference=_reference(function),
        freq_hz=frozen_array(freq[keep], np.float64),
        values=frozen_array(values[keep], np.complex128),
        coherence=None if coherence is None else frozen_array(coherence[keep], np.float64),
    )


def _form(function: UffFunction, hints: Hints, where: str, said: _Said) -> FrfForm:
    told = frf_form(function)
    if hints.form is not None and told is not None and hints.form is not told:
        said.add(f"{where}: the file tells {told}, the manifest {hints.form}, which holds")
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
    said: _Said,
) -> float:
    if hints.response_unit is not None and hints.force_unit is not None:
        kind = KIND_OF_FORM[form]
        return (
            signal_scale(kind, hints.response_unit, None, where).factor
            / signal_scale(DataKind.EXCITATION_FORCE, hints.force_unit, None, where).factor
        )
    scale = frf_scale(function, form, units, where)
    _say_assumed(scale, units, where, said)
    return scale.factor


def _say_assumed(scale: Scale, units: UffUnits | None, where: str, said: _Said) -> None:
    if scale.assumed:
        missing = "no dataset 164 and no unit labels" if units is None else "no units"
        file = where.split(":", maxsplit=1)[0]
        said.add(
            f"{file}: {missing}: the units are not told; the numbers are taken as SI (m, s, N). "
            "Say `units` in the manifest"
        )


def _coherence_of(
    function: UffFunction, coherences: list[UffFunction], where: str, said: _Said
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
        said.add(f"{where}: its coherence is on other lines: it is left out")
        return None
    sentences: list[str] = []
    zero = function.abscissa <= 0.0
    clipped = clipped_coherence(np.where(zero, 1.0, on_lines), where, sentences)
    for sentence in sentences:
        said.add(sentence)
    return clipped


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


def _hits(
    times: list[UffFunction], units: UffUnits | None, hints: Hints, origin: str, said: _Said
) -> list[ForeignHit]:
    """Group time records into hits: a force opens a hit, or a channel that comes again does."""
    groups: list[list[UffFunction]] = []
    seen: set[tuple[bool, int, int]] = set()
    for function in times:
        is_force = _is_force(function)
        key = (is_force, function.response_node, function.response_direction)
        if not groups or key in seen or (is_force and any(k[0] for k in seen)):
            groups.append([])
            seen = set()
        groups[-1].append(function)
        seen.add(key)
    return [
        _hit(group, units, hints, f"{origin}: hit {i + 1}", said) for i, group in enumerate(groups)
    ]


def _hit(
    group: list[UffFunction], units: UffUnits | None, hints: Hints, where: str, said: _Said
) -> ForeignHit:
    force = [f for f in group if _is_force(f)]
    others = [f for f in group if not _is_force(f)]
    if len(force) != 1 or not others:
        raise ForeignFileError(
            f"{where}: wanted one force and at least one acceleration record, got {len(force)} "
            f"and {len(others)}; export both channels"
        )
    first = force[0]
    length = min(len(function.values) for function in group)
    for function in others:
        few = abs(len(function.values) - len(first.values)) <= MOST_TRIMMED
        if not few or not np.array_equal(function.abscissa[:length], first.abscissa[:length]):
            raise ForeignFileError(
                f"{where}: wanted the same times in every channel, got others; export it again"
            )
    if any(len(function.values) > length for function in group):
        said.add(f"{where}: channels differ in length: the first {length} samples are used")
    signals = []
    for function in (first, *others):
        kind = DataKind.EXCITATION_FORCE if function is first else DataKind.ACCELERATION
        if function is not first and function.numerator not in {0, 1, kind}:
            raise ForeignFileError(
                f"{where}: wanted accelerations, got data type {function.numerator}; "
                "export acceleration"
            )
        label = hints.force_unit if function is first else hints.response_unit
        if label is not None:
            scale = signal_scale(kind, label, None, where)
        else:
            scale = signal_scale(kind, function.numerator_unit, units, where)
            _say_assumed(scale, units, where, said)
        values = np.asarray(function.values)[:length]
        if np.iscomplexobj(values):
            raise ForeignFileError(f"{where}: wanted real samples, got complex ones")
        signals.append(np.asarray(values * scale.factor, dtype=np.float64))
        check_signals(signals[-1], where)
    if hints.responses and len(hints.responses) != len(others):
        raise ForeignFileError(
            f"{where}: wanted {len(hints.responses)} responses, as the manifest says, got "
            f"{len(others)}"
        )
    return ForeignHit(
        origin=where,
        rate_hz=exact_rate(np.asarray(first.abscissa)[:length], where, rounding=_SIX_DIGITS),
        force_n=frozen_array(signals[0], np.float64),
        acceleration_m_s2=frozen_array(np.stack(signals[1:]), np.float64),
        hit=hints.reference or _response(first),
        responses=hints.responses or tuple(_response(function) for function in others),
    )


def _is_force(function: UffFunction) -> bool:
    if function.numerator in _FORCES:
        return True
    told = unit(function.numerator_unit) if function.numerator_unit else None
    return function.numerator in {0, 1} and told is not None and told[0] == "force"


def _response(function: UffFunction) -> ToldDof:
    return _dof(function.response_node, function.response_direction, function, "response")


def _reference(function: UffFunction) -> ToldDof:
    return _dof(function.reference_node, function.reference_direction, function, "reference")


def _dof(node: int, code: int, function: UffFunction, what: str) -> ToldDof:
    direction = axis_direction(code)
    if direction is None:
        for line in function.identification:
            words = _DIRECTION.fullmatch(line)
            if words and words[1] == what:
                vector = np.array([_number(words[i], line) for i in (2, 3, 4)])
                length = float(np.linalg.norm(vector))
                direction = vector / length if length > 0.5 else None
    return ToldDof(str(node) if node else None, direction)


def _number(text: str, where: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = np.nan
    if not np.isfinite(value):
        raise ForeignFileError(f"{where}: wanted a number, got {text[:30]!r}")
    return value


def _dof_words(function: UffFunction) -> str:
    return f"node {function.response_node} over {function.reference_node}"
