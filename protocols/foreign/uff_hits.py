"""The single hits among the time records of a universal file."""

from __future__ import annotations

import numpy as np

from armodal.protocols.errors import ForeignFileError
from armodal.protocols.foreign.hit_variables import MOST_TRIMMED
from armodal.protocols.foreign.measured import ForeignHit, Hints, check_signals, exact_rate
from armodal.protocols.foreign.recording import Recording, cut_recording
from armodal.protocols.foreign.uff_identification import response_dof
from armodal.protocols.foreign.uff_records import DataKind, UffFunction, UffUnits
from armodal.protocols.foreign.units import Scale, signal_scale, unit

__all__ = ["SIX_DIGITS", "hits_of", "say_assumed"]

SIX_DIGITS = 5e-6  # relative: E13.5
_FORCES = {DataKind.EXCITATION_FORCE, DataKind.REACTION_FORCE}


def hits_of(
    times: list[UffFunction], units: UffUnits | None, hints: Hints, origin: str, said: list[str]
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
        hit
        for i, group in enumerate(groups)
        for hit in cut_recording(
            _recording(group, units, hints, f"{origin}: hit {i + 1}", said), hints.cut, said
        )
    ]


def _recording(
    group: list[UffFunction], units: UffUnits | None, hints: Hints, where: str, said: list[str]
) -> Recording:
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
        said.append(f"{where}: channels differ in length: the first {length} samples are used")
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
            say_assumed(scale, units, where, said)
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
    return Recording(
        origin=where,
        rate_hz=exact_rate(np.asarray(first.abscissa)[:length], where, rounding=SIX_DIGITS),
        forces_n=signals[0][None],
        acceleration_m_s2=np.stack(signals[1:]),
        hammers=(hints.reference or response_dof(first),),
        responses=hints.responses or tuple(response_dof(function) for function in others),
    )


def _is_force(function: UffFunction) -> bool:
    if function.numerator in _FORCES:
        return True
    told = unit(function.numerator_unit) if function.numerator_unit else None
    return function.numerator in {0, 1} and told is not None and told[0] == "force"


def say_assumed(scale: Scale, units: UffUnits | None, where: str, said: list[str]) -> None:
    """Say that a unit nobody told is taken as SI."""
    if scale.assumed:
        missing = "no dataset 164 and no unit labels" if units is None else "no units"
        file = where.split(":", maxsplit=1)[0]
        said.append(
            f"{file}: {missing}: the units are not told; the numbers are taken as SI (m, s, N). "
            "Say `units` in the manifest"
        )
