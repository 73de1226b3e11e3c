"""Rigid-link check of one posture's FRFs: what to compare, in which band, under which assembly."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.checks.decision import ADEQUATE, CLEARLY_BETTER, RIVAL_WITHIN
from armodal.analyzer.checks.hit_aim import aim_patterns
from armodal.analyzer.checks.records import Finding, Outcome
from armodal.analyzer.checks.rigid_design import Assembly, rigid_design
from armodal.analyzer.checks.rigid_link import RigidLinkResult, named_fault, rigid_link
from armodal.analyzer.checks.rigid_statistics import OrdinaryErrors, statistics
from armodal.analyzer.modal.noise import independent_line_share
from armodal.analyzer.modal.windows import laplace_lines
from armodal.protocols.errors import EstimateError
from armodal.protocols.frf_records import FrequencyResponse, FrfForm

__all__ = ["TOPS_HZ", "check_links", "no_links"]

ComplexArray = npt.NDArray[np.complex128]

POSITION_STD_M = 0.003  # of a sensor put on a marked point by hand
LOWEST_HZ = 8.0  # below, an accelerometer feels gravity turn more than the arm move
# The widest band in which links are rigid is taken; a name must hold in the narrower ones too.
TOPS_HZ = (200.0, 120.0, 70.0, 40.0)
MIN_LINES = 20
SURE = 3.0  # deviations, within which one size is that of another band


def ordinary_errors(superset: Superset) -> OrdinaryErrors:
    """Errors a good measurement has, from the arm file's tolerances."""
    tolerances = superset.arm.tolerances
    return OrdinaryErrors(
        tilt_rad=tolerances.sensor_tilt_rad,
        gain=tolerances.sensor_gain,
        position_m=POSITION_STD_M,
    )


def check_links(
    frf: FrequencyResponse,
    single_hits: Mapping[str, ComplexArray],
    poles: Sequence[complex],
    superset: Superset,
    errors: OrdinaryErrors | None = None,
    *,
    below_hz: float = np.inf,
) -> RigidLinkResult:
    """Name what is wrong with a roving triaxial sensor, if anything is.

    Parameters
    ----------
    frf
        Accelerance of one posture, one reference, three responses a point in the order x, y, z.
    single_hits
        Per point (n_hits, 3, n_freq) accelerance of its single hits, on the lines of `frf`;
        points that are missing count as measured with one hit.
    poles
        Poles of the posture's modes in rad/s (see `fit_modes`): they tell what an error of aim
        can do. May be empty, at the price of power.
    errors
        By default those of the arm file.
    below_hz
        No wider band is taken.

    Raises
    ------
    EstimateError
        If the FRFs are not accelerance, have several references, or no joint angles.
    """
    _require(frf)
    dynamics = superset.posture(np.asarray(frf.joints_rad))
    errors = errors or ordinary_errors(superset)
    measured, where = _triaxial_points(frf, superset)
    if len(measured) < 2:
        return _too_few(frf.posture)
    values = np.stack([frf.values[rows, 0] for rows in where])
    variance = np.stack([frf.variance[rows, 0] for rows in where])
    hits = [single_hits.get(point, values[i : i + 1]) for i, point in enumerate(measured)]
    s = laplace_lines(frf.freq_hz, frf.decay_rad_s)
    patterns = aim_patterns(s, poles, values, hits)
    spacing = float(frf.freq_hz[1] - frf.freq_hz[0])
    share = independent_line_share(frf.decay_rad_s, spacing)

    def judged(assembly: Assembly, top_hz: float) -> RigidLinkResult | None:
        keep = (frf.freq_hz >= LOWEST_HZ) & (frf.freq_hz <= top_hz)
        if np.count_nonzero(keep) < MIN_LINES:
            return None
        stats = statistics(values[..., keep], variance[..., keep], patterns[..., keep], share)
        design = rigid_design(superset, dynamics, assembly)
        return rigid_link(frf.posture, measured, stats, design, errors)

    last: RigidLinkResult | None = None
    tops_hz = [top_hz for top_hz in TOPS_HZ if top_hz <= below_hz]
    for assembly in Assembly:
        for at, top_hz in enumerate(tops_hz):
            result = judged(assembly, top_hz)
            if result is None:
                continue
            last = result
            if result.residual_per_dof > ADEQUATE:
                continue
            if result.finding.outcome is Outcome.FAULT:
                for narrower in tops_hz[at + 1 :]:
                    result = _unless_elsewhere(result, judged(assembly, narrower), narrower)
            if assembly is Assembly.CHAIN and result.finding.outcome is Outcome.FAULT:
                result = _unless_contradicted(result, judged(Assembly.LINKS, top_hz))
            return result
    return last or _too_few(frf.posture)


def _require(frf: FrequencyResponse) -> None:
    if frf.form is not FrfForm.ACCELERANCE or len(frf.references) != 1:
        raise EstimateError(
            "the rigid-link check wants accelerance with one reference, got "
            f"{frf.form.value} with {len(frf.references)}; convert it, or check one reference "
            "at a time"
        )
    if frf.joints_rad is None:
        raise EstimateError(
            f"posture {frf.posture!r} has no joint angles, so nobody knows where its points are; "
            "give them to check links"
        )


def _triaxial_points(
    frf: FrequencyResponse, superset: Superset
) -> tuple[tuple[str, ...], list[list[int]]]:
    """Points on moving links with all of x, y, z, and their three rows."""
    rows: dict[str, dict[str, int]] = {}
    for i, dof in enumerate(frf.responses):
        rows.setdefault(dof.point, {})[dof.label] = i
    measured = tuple(
        point
        for point, axes in rows.items()
        if set(axes) == {"x", "y", "z"} and superset.point_link[superset.point_index[point]] >= 0
    )
    return measured, [[rows[point][axis] for axis in "xyz"] for point in measured]


def _unless_elsewhere(
    wide: RigidLinkResult, narrow: RigidLinkResult | None, top_hz: float
) -> RigidLinkResult:
    """The name stands where a narrower band has it too: a wrong sensor is wrong at every frequency.

    What bends, gives way in a bearing or moves with the sensor's own mass is not.
    """
    if narrow is None or wide.finding.outcome is not Outcome.FAULT:
        return wide
    if _is_best(narrow, wide):
        is_told = len(wide.named) == 1 or wide.named <= narrow.named
        return wide if is_told else replace(wide, finding=wide.first)
    said = f"perhaps {wide.finding.text}, but not by lines up to {top_hz:.0f} Hz: an arm that"
    return _in_doubt(wide, f"{said} bends, or the sensor's mass, may look so; measure it again")


def _unless_contradicted(chain: RigidLinkResult, links: RigidLinkResult | None) -> RigidLinkResult:
    """The chain's name stands unless the links alone, with no hinge assumed, speak against it."""
    if links is None:
        return chain
    best = chain.candidates[0]
    null = next(c for c in links.candidates if c.fault is None)
    same = [c.cost for c in links.candidates if c.name == best.name]
    another = links.finding.outcome is Outcome.FAULT and not _is_best(links, chain)
    # A fault that fell out of the links' screen explains them worse than nothing at all does.
    if same and min(same) < null.cost + CLEARLY_BETTER and not another:
        return chain
    return _in_doubt(chain, f"the chain says {chain.finding.text}, the links alone do not")


def _is_best(result: RigidLinkResult, named: RigidLinkResult) -> bool:
    """Whether a named fault, or one of two at once, is what explains a result's lines best.

    A gain or a displacement must be as large there.
    """
    null = next(c for c in result.candidates if c.fault is None)
    best, wanted = result.candidates[0], named.candidates[0]
    if best.name != wanted.name and named_fault(named.measured, wanted) not in result.named:
        return False
    is_size = best.name == wanted.name and best.continuous and wanted.continuous
    if is_size and abs(best.size - wanted.size) > SURE * best.std:
        return False
    return (null.cost - best.cost) / result.scale > RIVAL_WITHIN


def _in_doubt(result: RigidLinkResult, text: str) -> RigidLinkResult:
    return replace(result, finding=no_links(result.finding.posture, text))


def no_links(posture: str, why: str) -> Finding:
    """Return that a posture's links cannot be checked, and why."""
    return Finding(
        check="rigid link",
        posture=posture,
        outcome=Outcome.CANNOT_TELL,
        fault=None,
        points=(),
        everywhere=False,
        confidence=0.0,
        text=why,
    )


def _too_few(posture: str) -> RigidLinkResult:
    why = "wanted two or more triaxial points on moving links and 20 lines above 8 Hz"
    finding = no_links(posture, why)
    return RigidLinkResult(
        finding=finding,
        first=finding,
        named=frozenset(),
        measured=(),
        candidates=(),
        residual_per_dof=float("nan"),
        faint=False,
        scale=1.0,
    )
