"""Reciprocity: the response at i to a force at j is that at j to the same force at i.

Two directions are compared: u_i^T H(i <- j) f_j, the motion at i along the hit that i gets, under
the hit at j, and the same with i and j exchanged. It takes a triaxial sensor (or one along the hit)
and a hit at both points, so usually two sets of FRFs of one posture.

References
----------
Ewins, Modal Testing, 2nd ed. (2000), section 3.10.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from armodal.analyzer.checks.records import Fault, Finding, Outcome
from armodal.protocols.frf_records import Dof, FrequencyResponse

__all__ = ["reciprocity"]

Array = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]

_BAND_HZ = (8.0, 200.0)
_CROSS = 0.05  # of the transverse response: aim and tilt
_MATERIAL_GAIN = 0.05
_ALIKE = 0.15  # misfit over response below which two FRFs are the same but for a factor
_SAME_LINES_HZ = 1e-6
_SAME_DIRECTION = np.cos(np.radians(1.0))


@dataclass(frozen=True, slots=True, kw_only=True)
class _Hit:
    """A point with a direction it is hit along, as the findings name it."""

    point: str
    direction: Array  # (3,)
    name: str


@dataclass(frozen=True, slots=True, kw_only=True)
class _Path:
    """Motion along one hit per newton of another."""

    response: _Hit
    reference: _Hit
    value: ComplexArray  # (n_freq,)
    variance: Array  # (n_freq,)


def reciprocity(frfs: Sequence[FrequencyResponse]) -> tuple[Finding, ...]:
    """Compare every pair of exchanged paths among FRFs of one posture.

    Returns
    -------
    One finding a pair of hits, a point hit along two directions being two; one that cannot tell
    where there is no pair, and one for each FRF that was not measured while its mirror was.
    """
    if not frfs:
        return (_say("", None, Outcome.CANNOT_TELL, None, 0.0, "no FRFs were given"),)
    first = frfs[0]
    same = [
        frf
        for frf in frfs
        if frf.posture == first.posture
        and frf.form is first.form
        and frf.decay_rad_s == first.decay_rad_s
        and frf.freq_hz.shape == first.freq_hz.shape
        and np.allclose(frf.freq_hz, first.freq_hz, rtol=0.0, atol=_SAME_LINES_HZ)
    ]
    hits = _hits(same)
    paths = [path for frf in same for path in _paths(frf, hits)]
    keep = (first.freq_hz >= _BAND_HZ[0]) & (first.freq_hz <= _BAND_HZ[1])
    found = [
        _compare(first.posture, a, b, keep)
        for i, a in enumerate(paths)
        for b in paths[i + 1 :]
        if a.response is b.reference
        and a.reference is b.response
        and a.response.point != a.reference.point
    ]
    nothing = _say(
        first.posture,
        None,
        Outcome.CANNOT_TELL,
        None,
        0.0,
        "no path between two points was measured in both directions; hit one more point",
    )
    told = [_mirror(first.posture, path) for path in paths if _only_mirror(path, paths, same)]
    return (*(found or [nothing]), *told)


def _hits(frfs: Sequence[FrequencyResponse]) -> list[_Hit]:
    """Every point and direction that is hit, once; the name tells directions where several are."""
    found: list[Dof] = []
    for dof in (dof for frf in frfs for dof in frf.references):
        if not any(_same_hit(dof, other.point, other.direction) for other in found):
            found.append(dof)
    points = [dof.point for dof in found]
    return [
        _Hit(
            point=dof.point,
            direction=dof.direction,
            name=dof.point
            if points.count(dof.point) == 1
            else f"{dof.point} along ({', '.join(f'{part:.2f}' for part in dof.direction)})",
        )
        for dof in found
    ]


def _only_mirror(path: _Path, paths: Sequence[_Path], frfs: Sequence[FrequencyResponse]) -> bool:
    """Whether a path was measured and its mirror is a hole of the matrix."""
    there = any(p.response is path.reference and p.reference is path.response for p in paths)
    if there or path.response is path.reference:
        return False
    return any(
        not frf.measured[i, j]
        for frf in frfs
        for i, response in enumerate(frf.responses)
        for j, reference in enumerate(frf.references)
        if response.point == path.reference.point
        and _same_hit(reference, path.response.point, path.response.direction)
    )


def _mirror(posture: str, path: _Path) -> Finding:
    a, b = path.response, path.reference
    text = (
        f"{b.name} under a hit at {a.name} was not measured; {a.name} under a hit at {b.name} "
        "was, and is the same by reciprocity"
    )
    return _say(posture, (a.point, b.point), Outcome.CANNOT_TELL, None, 0.0, text)


def _same_hit(dof: Dof, point: str, direction: Array) -> bool:
    return dof.point == point and bool(dof.direction @ direction > _SAME_DIRECTION)


def _paths(frf: FrequencyResponse, hits: Sequence[_Hit]) -> list[_Path]:
    """Motion along every hit whose point is measured, under every hit of these FRFs."""
    result = []
    for hit in hits:
        rows = [i for i, dof in enumerate(frf.responses) if dof.point == hit.point]
        if not rows:
            continue
        axes = np.array([frf.responses[i].direction for i in rows])
        along = np.linalg.pinv(axes.T) @ hit.direction
        if np.linalg.norm(axes.T @ along - hit.direction) > _CROSS:
            continue
        for j, dof in enumerate(frf.references):
            if not frf.measured[rows, j].all():
                continue
            H = frf.values[rows, j]
            cross = _CROSS**2 * np.sum(np.abs(H) ** 2, axis=0)
            result.append(
                _Path(
                    response=hit,
                    reference=next(h for h in hits if _same_hit(dof, h.point, h.direction)),
                    value=along @ H,
                    variance=along**2 @ frf.variance[rows, j] + cross,
                )
            )
    return result


def _compare(posture: str, a: _Path, b: _Path, keep: npt.NDArray[np.bool_]) -> Finding:
    A, B = a.value[keep], b.value[keep]
    weight = 1.0 / (a.variance + b.variance)[keep]
    size = float(np.sqrt(np.sum(weight * np.abs(A) ** 2) * np.sum(weight * np.abs(B) ** 2)))
    cross = float(np.sum(weight * (B.conj() * A).real)) / max(size, 1e-300)
    ratio = float(np.sqrt(np.sum(weight * np.abs(A) ** 2) / np.sum(weight * np.abs(B) ** 2)))
    # Two FRFs that agree within the noise everywhere have a squared misfit of one a line.
    noise = np.count_nonzero(keep) / max(size, 1e-300)
    alike = np.sqrt(max(2.0 - 2.0 * abs(cross), 0.0))
    text = f"{a.response.name} and {b.response.name}: ratio {ratio:.3f}, misfit {100 * alike:.1f} %"
    pair = (a.response.point, b.response.point)
    confidence = float(np.clip(1.0 - noise, 0.0, 1.0))
    if noise > _ALIKE:
        return _say(posture, pair, Outcome.CANNOT_TELL, None, 0.0, f"{text}; too noisy")
    if alike > max(_ALIKE, 3.0 * np.sqrt(noise)):
        return _say(posture, pair, Outcome.FAULT, Fault.NOT_RECIPROCAL, confidence, text)
    if cross < 0.0:
        return _say(posture, pair, Outcome.FAULT, Fault.SIGN_FLIPPED, confidence, text)
    if abs(np.log(ratio)) > _MATERIAL_GAIN + 3.0 * np.sqrt(noise / np.count_nonzero(keep)):
        return _say(posture, pair, Outcome.FAULT, Fault.GAIN, confidence, text)
    return _say(posture, pair, Outcome.GOOD, None, confidence, text)


def _say(
    posture: str,
    points: tuple[str, str] | None,
    outcome: Outcome,
    fault: Fault | None,
    confidence: float,
    text: str,
) -> Finding:
    return Finding(
        check="reciprocity",
        posture=posture,
        outcome=outcome,
        fault=fault,
        points=points or (),
        everywhere=False,
        confidence=confidence,
        text=text,
    )
