"""One posture's FRFs, geometry and mode shapes as a universal file that others read.

Most programs know the directions +-X, +-Y, +-Z of one frame and nothing else, so what a sensor
measured along axes of its own is turned into the base frame where its three axes allow it. A
direction along no axis is told in an identification line, and its code is 0, "not told".
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TypedDict

import numpy as np
import numpy.typing as npt

from armodal.protocols.arm.kinematics import link_pose
from armodal.protocols.arm.records import Arm
from armodal.protocols.arrays import frozen_array
from armodal.protocols.foreign.session_texts import UNKNOWN_PLACES
from armodal.protocols.foreign.uff_identification import (
    VARIANCE_WORDS,
    direction_words,
    estimate_words,
)
from armodal.protocols.foreign.uff_records import (
    DataKind,
    FunctionKind,
    UffFile,
    UffFunction,
    UffHeader,
    UffNodes,
    UffShape,
    UffTraceLine,
)
from armodal.protocols.foreign.uff_write import SI_UNITS
from armodal.protocols.frf_records import Dof, FrequencyResponse, FrfForm

__all__ = ["ExportedMode", "posture_uff"]

_ALIGNED = 1e-9
_ORTHOGONAL = 1e-6
_EVEN = 1e-6  # of a line's spacing
_LONGEST_TRACE = 250
_LEAST_COHERENCE = 1e-12
_NUMERATORS = {
    FrfForm.RECEPTANCE: (DataKind.DISPLACEMENT, "m"),
    FrfForm.MOBILITY: (DataKind.VELOCITY, "m/s"),
    FrfForm.ACCELERANCE: (DataKind.ACCELERATION, "m/s^2"),
}


@dataclass(frozen=True, slots=True, kw_only=True)
class ExportedMode:
    """A mode as dataset 55 wants it: receptance is shape participation^T / (s - pole)."""

    pole_rad_s: complex
    shape: npt.NDArray[np.complex128]  # (n_resp,)
    participation: npt.NDArray[np.complex128]  # (n_ref,)
    words: str  # what an identification line says of it


@dataclass(frozen=True, slots=True, kw_only=True)
class _Row:
    """A response as it is written: a sum of measured ones."""

    point: str
    code: int  # 0 along no axis
    direction: npt.NDArray[np.float64]  # (3,)
    index: tuple[int, ...]
    factor: tuple[float, ...]


def node_numbers(arm: Arm, frf: FrequencyResponse) -> dict[str, int]:
    """Return the node number of each point: its own where it is one, others behind the largest."""
    names = dict.fromkeys(dof.point for dof in (*frf.responses, *frf.references))
    ids = [point.id for point in arm.points if point.id in names]
    own = {name: int(name) for name in ids if name.isdecimal() and str(int(name)) == name}
    own = {name: number for name, number in own.items() if 0 < number < 10**9}
    behind = max(own.values(), default=0)
    for name in ids:
        if name not in own:
            behind += 1
            own[name] = behind
    return {name: own[name] for name in ids}


def posture_uff(
    frf: FrequencyResponse, arm: Arm, *, modes: Sequence[ExportedMode], software: str
) -> tuple[UffFile, tuple[str, ...]]:
    """Return a posture as a universal file in SI, and sentences about what it cannot tell.

    Parameters
    ----------
    frf
        The posture's FRFs.
    arm
        Where their points are.
    modes
        Mode shapes to add, or none.
    software
        Who writes.
    """
    numbers = node_numbers(arm, frf)
    rows = _rows(frf.responses)
    said: list[str] = []
    if any(len(row.index) > 1 for row in rows):
        said.append(
            "responses were turned from the sensors' axes into the base frame; the coherence of "
            "a turned axis takes the noise of the three as independent"
        )
    if frf.decay_rad_s > 0.0:
        said.append(
            f"the FRFs lie on the line Re s = {frf.decay_rad_s:.6g} rad/s of an exponential window "
            "on force and response: take it off the decay rate of every pole fitted to them"
        )
    oblique = [dof for dof in frf.references if _code(dof.direction) == 0]
    if oblique or any(row.code == 0 for row in rows):
        said.append(
            "directions along no axis have the code 0 and stand in the identification lines"
        )
    renamed = {name: number for name, number in numbers.items() if name != str(number)}
    if renamed:
        said.append("node numbers: " + ", ".join(f"{k} is {n}" for k, n in renamed.items()))
    functions = [
        *_functions(frf, rows, numbers),
        *_coherences(frf, rows, numbers),
        *_variances(frf, rows, numbers),
    ]
    nodes, lines = _geometry(frf, arm, numbers)
    unplaced = len(numbers) - (0 if nodes is None else len(nodes.number))
    if unplaced:
        said.append(f"the position of {unplaced} point(s) is not known and not written")
    file = UffFile(
        header=UffHeader(model=arm.name, description=f"posture {frf.posture}", program=software),
        units=SI_UNITS,
        nodes=nodes,
        trace_lines=lines,
        functions=tuple(functions),
        shapes=tuple(_shape(i + 1, mode, frf, rows, numbers) for i, mode in enumerate(modes)),
    )
    return file, tuple(said)


def _code(direction: npt.NDArray[np.float64]) -> int:
    """Return +-1, +-2, +-3 for a direction along an axis, else 0."""
    at = int(np.argmax(np.abs(direction)))
    if abs(abs(float(direction[at])) - 1.0) > _ALIGNED:
        return 0
    return int(np.sign(direction[at])) * (at + 1)


def _rows(responses: Sequence[Dof]) -> list[_Row]:
    """Return what is written for the responses, points in their order."""
    at_point: dict[str, list[int]] = {}
    for i, dof in enumerate(responses):
        at_point.setdefault(dof.point, []).append(i)
    rows: list[_Row] = []
    for point, index in at_point.items():
        D = np.stack([responses[i].direction for i in index], axis=1)  # (3, n) columns
        codes = [_code(d) for d in D.T]
        square = D.shape[1] == 3 and np.allclose(D.T @ D, np.eye(3), atol=_ORTHOGONAL)
        if all(codes) or not square:
            rows += [
                _Row(point=point, code=code, direction=d, index=(i,), factor=(1.0,))
                for i, code, d in zip(index, codes, D.T, strict=True)
            ]
            continue
        rows += [
            _Row(
                point=point,
                code=axis + 1,
                direction=np.eye(3)[axis],
                index=tuple(index),
                factor=tuple(float(x) for x in D[axis]),
            )
            for axis in range(3)
        ]
    return rows


class _Place(TypedDict):
    response_node: int
    response_direction: int
    reference_node: int
    reference_direction: int
    abscissa: npt.NDArray[np.float64]
    even: bool
    abscissa_kind: int


def _functions(
    frf: FrequencyResponse, rows: Sequence[_Row], numbers: Mapping[str, int]
) -> list[UffFunction]:
    numerator, unit = _NUMERATORS[frf.form]
    functions = []
    for j, reference in enumerate(frf.references):
        for row in rows:
            if not frf.measured[list(row.index), j].all():
                continue
            values = np.zeros(len(frf.freq_hz), dtype=np.complex128)
            for i, factor in zip(row.index, row.factor, strict=True):
                values += factor * frf.values[i, j]
            n_hits = _n_hits(frf, row, j)
            functions.append(
                UffFunction(
                    kind=FunctionKind.FREQUENCY_RESPONSE,
                    values=frozen_array(values, np.complex128),
                    numerator=numerator,
                    denominator=DataKind.EXCITATION_FORCE,
                    numerator_unit=unit,
                    denominator_unit="N",
                    identification=_identification(frf, row, reference, n_hits),
                    **_place(frf, row, reference, numbers),
                )
            )
    return functions


def _coherences(
    frf: FrequencyResponse, rows: Sequence[_Row], numbers: Mapping[str, int]
) -> list[UffFunction]:
    functions = []
    for j, reference in enumerate(frf.references):
        for row in rows:
            index = list(row.index)
            if not np.isfinite(frf.coherence[index, j]).all():
                continue
            n_hits = int(frf.n_hits[index, j].min())
            functions.append(
                UffFunction(
                    kind=FunctionKind.COHERENCE,
                    values=frozen_array(_coherence(frf, row, j), np.float64),
                    numerator=DataKind.UNKNOWN,
                    denominator=DataKind.UNKNOWN,
                    identification=_identification(frf, row, reference, n_hits),
                    **_place(frf, row, reference, numbers),
                )
            )
    return functions


def _variances(
    frf: FrequencyResponse, rows: Sequence[_Row], numbers: Mapping[str, int]
) -> list[UffFunction]:
    """E|error|^2 of every FRF where it is known, as functions of the general type.

    A coherence tells it only to a program that averages as armodal does; this is the number itself.
    """
    functions = []
    for j, reference in enumerate(frf.references):
        for row in rows:
            parts = frf.variance[list(row.index), j]
            if not (np.isfinite(parts).all() and (parts > 0.0).any()):
                continue
            identification = list(_identification(frf, row, reference, _n_hits(frf, row, j)))
            identification[2] = VARIANCE_WORDS
            functions.append(
                UffFunction(
                    kind=FunctionKind.GENERAL,
                    values=frozen_array(np.array(row.factor) ** 2 @ parts, np.float64),
                    numerator=DataKind.UNKNOWN,
                    denominator=DataKind.UNKNOWN,
                    identification=tuple(identification),
                    **_place(frf, row, reference, numbers),
                )
            )
    return functions


def _n_hits(frf: FrequencyResponse, row: _Row, j: int) -> int:
    return min(int(frf.n_hits[i, j]) for i in row.index)


def _coherence(frf: FrequencyResponse, row: _Row, j: int) -> npt.NDArray[np.float64]:
    """Coherence of a row, (n_freq,); of a turned one from the noise of its parts.

    Noise over force is |H|^2 (1 - g)/g for coherence g; independent parts add with their factors
    squared.
    """
    index = list(row.index)
    coherence = frf.coherence[index, j]
    if len(index) == 1:
        alone: npt.NDArray[np.float64] = frf.coherence[index[0], j]
        return alone
    factor = np.array(row.factor)
    values = factor @ frf.values[index, j]
    parts = np.abs(frf.values[index, j]) ** 2 / np.maximum(coherence, _LEAST_COHERENCE)
    noise = factor**2 @ (parts * (1.0 - coherence))
    size = np.abs(values) ** 2
    turned: npt.NDArray[np.float64] = size / np.maximum(size + noise, np.finfo(float).tiny)
    return turned


def _place(frf: FrequencyResponse, row: _Row, reference: Dof, numbers: Mapping[str, int]) -> _Place:
    steps = np.diff(frf.freq_hz)
    even = bool(np.max(np.abs(steps - steps.mean())) <= _EVEN * steps.mean())
    return {
        "response_node": numbers[row.point],
        "response_direction": row.code,
        "reference_node": numbers[reference.point],
        "reference_direction": _code(reference.direction),
        "abscissa": frf.freq_hz,
        "even": even,
        "abscissa_kind": DataKind.FREQUENCY,
    }


def _identification(
    frf: FrequencyResponse, row: _Row, reference: Dof, n_hits: int
) -> tuple[str, ...]:
    response_words = "" if row.code else direction_words("response", row.direction)
    oblique = _code(reference.direction) == 0
    reference_words = direction_words("reference", reference.direction) if oblique else ""
    words = estimate_words(n_hits, frf.decay_rad_s)
    return (f"posture {frf.posture}", words, "", response_words, reference_words)


def _geometry(
    frf: FrequencyResponse, arm: Arm, numbers: Mapping[str, int]
) -> tuple[UffNodes | None, tuple[UffTraceLine, ...]]:
    """Points in the base frame at the posture, and a line through those of each link."""
    unknown = set(arm.groups.get(UNKNOWN_PLACES, ()))
    places: dict[str, npt.NDArray[np.float64]] = {}
    of_link: dict[str, list[int]] = {}
    for name in numbers:
        point = arm.point(name)
        if name in unknown or (frf.joints_rad is None and point.link != "base"):
            continue
        joints = np.zeros(len(arm.joints)) if frf.joints_rad is None else frf.joints_rad
        T = link_pose(arm, point.link, joints)
        places[name] = T[:3, :3] @ point.position_m + T[:3, 3]
        of_link.setdefault(point.link, []).append(numbers[name])
    if not places:
        return None, ()
    nodes = UffNodes(
        number=frozen_array([numbers[name] for name in places], np.int64),
        position=frozen_array(list(places.values()), np.float64),
    )
    lines = [(link, chain[:_LONGEST_TRACE]) for link, chain in of_link.items() if len(chain) > 1]
    return nodes, tuple(
        UffTraceLine(number=i + 1, name=link, nodes=frozen_array(chain, np.int64))
        for i, (link, chain) in enumerate(lines)
    )


def _shape(
    number: int,
    mode: ExportedMode,
    frf: FrequencyResponse,
    rows: Sequence[_Row],
    numbers: Mapping[str, int],
) -> UffShape:
    """Translations X, Y, Z at every response point; zero along what was not measured."""
    at_node: dict[int, npt.NDArray[np.complex128]] = {}
    missing = False
    for row in rows:
        translation = at_node.setdefault(numbers[row.point], np.zeros(3, dtype=np.complex128))
        value = sum(f * mode.shape[i] for i, f in zip(row.index, row.factor, strict=True))
        translation += row.direction * value
    missing = len(rows) < 3 * len(at_node)
    size = abs(mode.pole_rad_s)
    modal_a = _modal_a(mode, frf)
    scale = "residue = shape shape^T / modal A" if modal_a else "scale not known: no driving point"
    unmeasured = "; directions not measured are 0" if missing else ""
    return UffShape(
        mode=number,
        node=frozen_array(list(at_node), np.int64),
        shape=frozen_array(list(at_node.values()), np.complex128),
        f_hz=size / (2.0 * np.pi),
        damping_ratio=-mode.pole_rad_s.real / size,
        pole_rad_s=mode.pole_rad_s,
        modal_a=modal_a,
        identification=(f"posture {frf.posture}", mode.words, scale + unmeasured, "", ""),
    )


def _modal_a(mode: ExportedMode, frf: FrequencyResponse) -> complex:
    """Return modal A, for which shape shape^T / A are the receptance residues; 0 if not known.

    At a driving point the shape along the hit is known, psi_r, and the participation there is
    psi_r / A.
    """
    for j, reference in enumerate(frf.references):
        index = [i for i, dof in enumerate(frf.responses) if dof.point == reference.point]
        D = np.array([frf.responses[i].direction for i in index])
        if len(index) != 3 and not (
            len(index) == 1 and abs(abs(float(D[0] @ reference.direction)) - 1.0) < _ORTHOGONAL
        ):
            continue
        along = complex(np.sum((D @ reference.direction) * mode.shape[index]))
        participation = complex(mode.participation[j])
        if abs(participation) > 0.0 and abs(along) > 0.0:
            return along / participation
    return 0.0
