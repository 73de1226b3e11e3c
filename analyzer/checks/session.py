"""All measurement checks of a session, posture by posture, and the sensor's over all postures."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from analyzer.arm.superset import Superset
from analyzer.checks.driving_point import driving_point
from analyzer.checks.homogeneity import homogeneity
from analyzer.checks.links import check_links
from analyzer.checks.reciprocity import reciprocity
from analyzer.checks.records import Finding, Outcome
from analyzer.modal import fit_modes, hit_frfs, hit_spectra
from analyzer.modal.windows import laplace_lines
from protocols.errors import EstimateError
from protocols.frf_records import FrequencyResponse
from protocols.plan_records import Mode
from protocols.session.records import Session

__all__ = ["check_session", "sensor_verdict"]


def check_session(
    session: Session, frfs: Sequence[FrequencyResponse], superset: Superset
) -> tuple[Finding, ...]:
    """Run every check on every posture.

    Parameters
    ----------
    frfs
        Accelerance of the session's postures (`estimate_frfs`).
    """
    found: list[Finding] = []
    links: list[Finding] = []
    for frf in frfs:
        poles = _poles(frf)
        hits = session.accepted(frf.posture)
        step = float(frf.freq_hz[1] - frf.freq_hz[0]) / 2.0
        band = (float(frf.freq_hz[0]) - step, float(frf.freq_hz[-1]) + step)
        spectra = hit_spectra(session, hits, band_hz=band)
        single = hit_frfs(spectra)
        roving_hammer = session.header.plan.mode is Mode.ROVING_HAMMER
        at = np.array([hit.hit_point if roving_hammer else hit.sensor_point for hit in hits])
        points = list(dict.fromkeys(at.tolist()))
        level = np.sqrt(np.mean(np.abs(spectra.force) ** 2, axis=-1))
        s = laplace_lines(frf.freq_hz, frf.decay_rad_s)
        if roving_hammer:
            links.append(_not_roving_sensor(frf.posture))
        else:
            by_point = {point: single[at == point] for point in points}
            links.append(check_links(frf, by_point, poles, superset).finding)
        found.append(links[-1])
        found += [driving_point(frf, i) for i, dof in _driven(frf)]
        found.append(
            homogeneity(
                frf.posture,
                s,
                poles,
                [single[at == point] for point in points],
                [level[at == point] for point in points],
            )
        )
        found += reciprocity([frf])
    return (*found, sensor_verdict(links))


def sensor_verdict(links: Sequence[Finding]) -> Finding:
    """What the rigid-link checks of all postures say together.

    A fault of the roving sensor is in every posture; one found in a single posture while another
    was found good is a matter of mounting, or not to be told.
    """

    def say(
        outcome: Outcome, text: str, like: Finding | None = None, confidence: float = 0.0
    ) -> Finding:
        return Finding(
            check="sensor",
            posture="all",
            outcome=outcome,
            fault=like.fault if like else None,
            points=like.points if like else (),
            everywhere=like.everywhere if like else False,
            confidence=confidence,
            text=text,
        )

    faults = [f for f in links if f.outcome is Outcome.FAULT]
    good = [f for f in links if f.outcome is Outcome.GOOD]
    if not faults and not good:
        return say(Outcome.CANNOT_TELL, "no posture could be judged")
    if not faults:
        names = ", ".join(f.posture for f in good)
        confidence = min(f.confidence for f in good)
        return say(Outcome.GOOD, f"nothing wrong in {names}", None, confidence)
    kinds = {(f.fault, f.points, f.everywhere) for f in faults}
    names = ", ".join(f.posture for f in faults)
    if len(kinds) > 1:
        return say(Outcome.CANNOT_TELL, f"different faults in {names}; see each posture")
    first = faults[0]
    confidence = 1.0 - float(np.prod([1.0 - f.confidence for f in faults]))
    if first.everywhere and good:
        other = ", ".join(f.posture for f in good)
        text = f"{first.text} in {names}, but nothing wrong in {other}: the sensor was changed"
        return say(Outcome.FAULT, text, first, confidence)
    return say(Outcome.FAULT, f"{first.text} (in {names})", first, confidence)


def _poles(frf: FrequencyResponse) -> tuple[complex, ...]:
    try:
        return tuple(mode.pole_rad_s for mode in fit_modes(frf).modes)
    except EstimateError:
        return ()


def _driven(frf: FrequencyResponse) -> list[tuple[int, str]]:
    """References whose point is also a response; the first one where none is."""
    measured = {dof.point for dof in frf.responses}
    driven = [(i, dof.point) for i, dof in enumerate(frf.references) if dof.point in measured]
    return driven or [(0, frf.references[0].point)]


def _not_roving_sensor(posture: str) -> Finding:
    return Finding(
        check="rigid link",
        posture=posture,
        outcome=Outcome.CANNOT_TELL,
        fault=None,
        points=(),
        everywhere=False,
        confidence=0.0,
        text="the sensor stays at one point in roving-hammer; one point shows no rigid motion",
    )
