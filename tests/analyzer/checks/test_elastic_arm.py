"""Checks of an arm whose links bend and whose bearings give way, by another maker."""

import pytest

from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.checks import Outcome, check_session
from armodal.analyzer.identification.estimate import estimate_frfs
from armodal.hil_sim.makers import make_case


@pytest.mark.long
def test_a_sound_session_of_an_elastic_arm_has_no_fault():
    """A chain of hinges does not bend: it made wrong points and gains of bearings and the mass."""
    session = make_case("frame", 6, "lrmate200id").session()
    superset = Superset(session.header.arm)
    findings = check_session(session, estimate_frfs(session, superset), superset)
    assert {f.check for f in findings} >= {"rigid link", "homogeneity", "sensor"}
    assert not [f"{f.check} {f.posture}: {f.text}" for f in findings if f.outcome is Outcome.FAULT]
