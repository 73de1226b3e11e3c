"""All measurement checks of a session, posture by posture, and the sensor's over all postures."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial

import numpy as np
import numpy.typing as npt

from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.checks.drift import drift_finding
from armodal.analyzer.checks.driving_point import driving_point
from armodal.analyzer.checks.homogeneity import homogeneity
from armodal.analyzer.checks.links import TOPS_HZ, check_links, no_links
from armodal.analyzer.checks.reciprocity import reciprocity
from armodal.analyzer.checks.records import Finding
from armodal.analyzer.checks.rigid_link import RigidLinkResult
from armodal.analyzer.checks.sensor import sensor_verdict
from armodal.analyzer.modal import ModalModel, convert_form, fit_modes, hit_frfs, hit_spectra
from armodal.analyzer.modal.windows import laplace_lines
from armodal.protocols.errors import EstimateError
from armodal.protocols.frf_records import FrequencyResponse, FrfForm
from armodal.protocols.plan_records import Mode
from armodal.protocols.session.records import Session

__all__ = ["check_session"]

Array = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]

_NOT_ROVING = "the sensor stays at one point in roving-hammer; one point shows no rigid motion"


def check_session(
    session: Session,
    frfs: Sequence[FrequencyResponse],
    superset: Superset,
    models: Sequence[ModalModel] | None = None,
) -> tuple[Finding, ...]:
    """Run every check on every posture.

    FRFs that were given to the session have no single hits: homogeneity then cannot tell.

    Parameters
    ----------
    frfs
        Of the session's postures (`estimate_frfs`).
    models
        Modes already fitted to each of them; None fits them here.
    """
    found: list[Finding] = []
    links: list[RigidLinkResult] = []
    check_again: list[Callable[..., RigidLinkResult]] = []
    roving_hammer = session.header.plan.mode is Mode.ROVING_HAMMER
    for number, frf in enumerate(frfs):
        model = _model(frf) if models is None else models[number]
        poles = () if model is None else tuple(mode.pole_rad_s for mode in model.modes)
        single = _single_hits(session, frf, roving_hammer=roving_hammer)
        if roving_hammer:
            found.append(no_links(frf.posture, _NOT_ROVING))
        else:
            by_point = {point: values for point, (values, _) in single.items()}
            try:
                accelerance = convert_form(frf, FrfForm.ACCELERANCE)
                check = partial(check_links, accelerance, by_point, poles, superset)
                links.append(check())
                check_again.append(check)
                found.append(links[-1].finding)
            except EstimateError as error:
                found.append(no_links(frf.posture, str(error)))
        found += [driving_point(frf, i) for i, dof in _driven(frf)]
        found.append(
            homogeneity(
                frf.posture,
                laplace_lines(frf.freq_hz, frf.decay_rad_s),
                poles,
                [values for values, _ in single.values()],
                [level for _, level in single.values()],
            )
        )
        found += reciprocity([frf])
        found.append(drift_finding(frf.posture, model))
    narrower = ([check(below_hz=top) for check in check_again] for top in TOPS_HZ[1:])
    return (*found, sensor_verdict(links, narrower))


def _single_hits(
    session: Session, frf: FrequencyResponse, *, roving_hammer: bool
) -> dict[str, tuple[ComplexArray, Array]]:
    """Accelerance (n_hits, n_axes, n_freq) and level (n_hits,) of the hits of each point."""
    hits = session.accepted(frf.posture)
    if not roving_hammer:
        # Hits at other points are other FRFs.
        hits = tuple(hit for hit in hits if hit.hit_point == frf.references[0].point)
    if not hits or frf.posture in {given.posture for given in session.frfs}:
        return {}
    step = float(frf.freq_hz[1] - frf.freq_hz[0]) / 2.0
    band = (float(frf.freq_hz[0]) - step, float(frf.freq_hz[-1]) + step)
    spectra = hit_spectra(session, hits, band_hz=band)
    single = hit_frfs(spectra)
    level = np.sqrt(np.mean(np.abs(spectra.force) ** 2, axis=-1))
    at = np.array([hit.hit_point if roving_hammer else hit.sensor_point for hit in hits])
    found = {}
    for point in dict.fromkeys(at.tolist()):
        here = single[at == point]
        # An axis that a sensor has not is zero.
        found[point] = (here[:, here.any(axis=(0, 2))], level[at == point])
    return found


def _model(frf: FrequencyResponse) -> ModalModel | None:
    try:
        return fit_modes(frf)
    except EstimateError:
        return None


def _driven(frf: FrequencyResponse) -> list[tuple[int, str]]:
    """References whose point is also a response; the first one where none is."""
    measured = {dof.point for dof in frf.responses}
    driven = [(i, dof.point) for i, dof in enumerate(frf.references) if dof.point in measured]
    return driven or [(0, frf.references[0].point)]
