from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from support.offline_lab import ALL_POINTS, first_postures, simulate_session
from support.sensor_faults import FLIP_Z, SWAP_XY, exchanged, gains, misplaced, mixed

from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.checks import Fault, Outcome, check_links, check_session, sensor_verdict
from armodal.analyzer.identification.identify import estimate_frfs
from armodal.analyzer.modal import fit_modes, hit_frfs, hit_spectra
from armodal.protocols.errors import EstimateError
from armodal.protocols.frf_records import FrfForm

# Exchanged points are tried in pairs: a third fewer halve the work.
POINTS = tuple(point for point in ALL_POINTS if point not in {"2", "4", "10", "11", "14", "17"})


@cache
def good():
    session = simulate_session(3, plan=first_postures(3, POINTS))
    return session, Superset(session.header.arm)


@cache
def good_poles(at):
    """Poles of a posture: what is wrong with a sensor moves none."""
    session, superset = good()
    hits = session.accepted(session.header.plan.postures[at].name)
    (frf,) = estimate_frfs(replace(session, hits=hits), superset)
    return [mode.pole_rad_s for mode in fit_modes(frf).modes]


@pytest.fixture(scope="module")
def measured():
    return good()


def posture_inputs(session, superset, at):
    name = session.header.plan.postures[at].name
    hits = session.accepted(name)
    (frf,) = estimate_frfs(replace(session, hits=hits), superset)
    half = float(frf.freq_hz[1] - frf.freq_hz[0]) / 2
    band = (frf.freq_hz[0] - half, frf.freq_hz[-1] + half)
    single = hit_frfs(hit_spectra(session, hits, band_hz=band))
    points = np.array([hit.sensor_point for hit in hits])
    by_point = {p: single[points == p] for p in dict.fromkeys(points.tolist())}
    return frf, by_point, good_poles(at), superset


def links(session, superset, at=1):
    return check_links(*posture_inputs(session, superset, at))


MATRICES = {
    Fault.AXIS_SWAPPED: SWAP_XY,
    Fault.SIGN_FLIPPED: FLIP_Z,
    Fault.GAIN: gains(z=1.25),
}


@cache
def faulty(fault, points):
    """Links of a posture whose sensor has a fault, at some points or at all; None is no fault."""
    session, superset = good()
    return links(session if fault is None else mixed(session, MATRICES[fault], points), superset)


@pytest.mark.parametrize(
    ("fault", "points"),
    [
        pytest.param(Fault.AXIS_SWAPPED, ("6",), marks=pytest.mark.long),
        pytest.param(Fault.GAIN, ("6",), marks=pytest.mark.long),
        pytest.param(Fault.SIGN_FLIPPED, None, marks=pytest.mark.long),
        pytest.param(Fault.SIGN_FLIPPED, ("6",), marks=pytest.mark.long),
        pytest.param(Fault.AXIS_SWAPPED, None, marks=pytest.mark.long),
        pytest.param(Fault.GAIN, None, marks=pytest.mark.long),
    ],
)
def test_a_fault_of_axes_is_named_with_its_place(fault, points):
    finding = faulty(fault, points).finding
    assert (finding.outcome, finding.fault) == (Outcome.FAULT, fault), finding.text
    assert finding.points == (points or ())
    assert finding.everywhere is (points is None)
    assert finding.confidence > 0.99


def test_a_sensor_at_another_point_is_named_with_that_point(measured, session):
    own, superset = measured
    finding = links(misplaced(own, session, "7", "12"), superset).finding
    assert (finding.fault, finding.points) == (Fault.WRONG_POINT, ("7",))
    assert "point 12" in finding.text


@pytest.mark.long
def test_two_exchanged_points_are_named(measured):
    session, superset = measured
    finding = links(exchanged(session, "6", "13"), superset).finding
    assert finding.fault is Fault.WRONG_POINT
    assert set(finding.points) == {"6", "13"}


def test_a_common_gain_of_all_axes_is_rigid_motion_too(measured):
    session, superset = measured
    finding = links(mixed(session, gains(1.3, 1.3, 1.3)), superset).finding
    assert finding.outcome is Outcome.GOOD


def test_two_faults_at_once_are_both_named(measured):
    session, superset = measured
    broken = mixed(mixed(session, SWAP_XY, ("6",)), FLIP_Z, ("13",))
    finding = links(broken, superset).finding
    assert finding.outcome is Outcome.FAULT
    assert set(finding.points) == {"6", "13"}
    assert "axis swapped at point 6" in finding.text
    assert "sign flipped at point 13" in finding.text


def test_one_point_cannot_tell(measured):
    frf, by_point, poles, superset = posture_inputs(*measured, 1)
    rows = [i for i, dof in enumerate(frf.responses) if dof.point == "6"]
    alone = replace(
        frf,
        values=frf.values[rows],
        variance=frf.variance[rows],
        coherence=frf.coherence[rows],
        n_hits=frf.n_hits[rows],
        responses=tuple(frf.responses[i] for i in rows),
    )
    assert check_links(alone, by_point, poles, superset).finding.outcome is Outcome.CANNOT_TELL


def test_it_wants_accelerance_and_joint_angles(measured):
    frf, by_point, poles, superset = posture_inputs(*measured, 0)
    with pytest.raises(EstimateError, match="accelerance"):
        check_links(replace(frf, form=FrfForm.MOBILITY), by_point, poles, superset)
    with pytest.raises(EstimateError, match="joint angles"):
        check_links(replace(frf, joints_rad=None), by_point, poles, superset)


def test_a_session_is_checked_in_every_posture(measured):
    session, superset = measured
    findings = check_session(session, estimate_frfs(session, superset), superset)
    rigid = [f for f in findings if f.check == "rigid link"]
    assert [f.posture for f in rigid] == [p.name for p in session.header.plan.postures]
    for finding in rigid:
        assert finding.outcome is Outcome.GOOD, finding.text
        assert 0.4 < finding.confidence <= 1.0  # 0.4: what is nearer to the bar is not good
    assert not [f.text for f in findings if f.outcome is Outcome.FAULT]
    assert findings[-1].check == "sensor"
    assert findings[-1].outcome is Outcome.GOOD


def test_a_gain_too_faint_for_one_posture_is_named_by_all_together(measured):
    session, superset = measured
    broken = mixed(session, gains(z=1.18), ("6",))
    results = [links(broken, superset, at=at) for at in range(3)]
    assert not [r for r in results if r.finding.outcome is Outcome.FAULT]
    unusable = [replace(r, candidates=()) for r in results]  # too few lines in a narrow band
    for bands in ([], [results], [unusable]):
        finding = sensor_verdict(results, bands)
        assert (finding.fault, finding.points) == (Fault.GAIN, ("6",)), finding.text
    elsewhere = sensor_verdict(results, [results, [faulty(None, None)] * 3])
    assert elsewhere.outcome is Outcome.CANNOT_TELL
    assert "every band" in elsewhere.text


def test_the_sensor_is_judged_over_all_postures():
    good = faulty(None, None)
    swapped = faulty(Fault.AXIS_SWAPPED, None)
    loud = faulty(Fault.GAIN, ("6",))
    assert sensor_verdict([good, good]).outcome is Outcome.GOOD
    assert sensor_verdict([swapped, swapped]).everywhere
    assert sensor_verdict([swapped, loud]).outcome is Outcome.CANNOT_TELL
    # What one posture alone names, others do not have in any band either.
    assert "only" in sensor_verdict([loud, good], [[loud, good]]).text
    assert sensor_verdict([]).outcome is Outcome.CANNOT_TELL
    unnamed = replace(good.finding, outcome=Outcome.CANNOT_TELL, text="something is wrong")
    assert sensor_verdict([good, replace(good, finding=unnamed)]).outcome is Outcome.CANNOT_TELL
    faint = replace(good, finding=unnamed, faint=True)
    assert sensor_verdict([good, faint]).outcome is Outcome.GOOD
