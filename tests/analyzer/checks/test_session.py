"""All checks of a session whose FRFs were measured here, given, or both."""

from __future__ import annotations

from dataclasses import replace

import pytest

from armodal.analyzer.checks import Outcome, check_session
from armodal.analyzer.identification.identify import estimate_frfs
from armodal.analyzer.modal import convert_form
from armodal.protocols.frf_records import FrfForm


@pytest.fixture(scope="module")
def two_postures(session):
    """Three hits at each point."""
    two = session.header.plan.postures[:2]
    names = {posture.name for posture in two}
    header = replace(session.header, plan=replace(session.header.plan, postures=two))
    return replace(
        session, header=header, hits=tuple(hit for hit in session.hits if hit.posture in names)
    )


@pytest.fixture(scope="module")
def frfs(two_postures, superset):
    return estimate_frfs(two_postures, superset)


@pytest.fixture(scope="module")
def from_hits(two_postures, superset, frfs):
    return check_session(two_postures, frfs, superset)


def of(findings, check, posture):
    return [f for f in findings if f.check == check and f.posture == posture]


@pytest.mark.parametrize(
    "form", [pytest.param(FrfForm.ACCELERANCE, marks=pytest.mark.long), FrfForm.RECEPTANCE]
)
def test_given_frfs_are_checked_without_single_hits(two_postures, superset, frfs, from_hits, form):
    given = tuple(convert_form(frf, form) for frf in frfs)
    only = replace(two_postures, hits=(), frfs=given)
    findings = check_session(only, estimate_frfs(only, superset), superset)
    assert not [f.text for f in findings if f.outcome is Outcome.FAULT]
    for frf in frfs:
        (link,) = of(findings, "rigid link", frf.posture)
        assert link.outcome is Outcome.GOOD
        assert [f.outcome for f in of(findings, "driving point", frf.posture)] == [
            f.outcome for f in of(from_hits, "driving point", frf.posture)
        ]
        (level,) = of(findings, "homogeneity", frf.posture)
        assert level.outcome is Outcome.CANNOT_TELL


def test_a_given_posture_leaves_the_checks_of_a_measured_one_as_they_are(
    two_postures, superset, frfs, from_hits
):
    measured, given = (frf.posture for frf in frfs)
    mixed = replace(two_postures, hits=two_postures.accepted(measured), frfs=frfs[1:])
    findings = check_session(mixed, estimate_frfs(mixed, superset), superset)
    assert [f for f in findings if f.posture == measured] == [
        f for f in from_hits if f.posture == measured
    ]
    assert of(findings, "rigid link", given)


def test_frfs_of_two_references_end_no_other_check(two_postures, superset, frfs):
    first, second = frfs
    doubled = replace(
        second,
        values=second.values.repeat(2, axis=1),
        variance=second.variance.repeat(2, axis=1),
        coherence=second.coherence.repeat(2, axis=1),
        n_hits=second.n_hits.repeat(2, axis=1),
        references=second.references * 2,
    )
    given = replace(two_postures, hits=(), frfs=(first, doubled))
    findings = check_session(given, estimate_frfs(given, superset), superset)
    (link,) = of(findings, "rigid link", second.posture)
    assert link.outcome is Outcome.CANNOT_TELL
    assert "one reference" in link.text
    assert of(findings, "rigid link", first.posture)[0].outcome is Outcome.GOOD
    assert of(findings, "driving point", second.posture)
