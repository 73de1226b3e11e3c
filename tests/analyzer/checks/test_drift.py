"""Modes that move are told by the check of a session."""

from support.plain_structure import plate_session

from armodal.analyzer.checks import Outcome
from armodal.analyzer.checks.drift import drift_finding
from armodal.analyzer.modal import drift_told, fit_modes


def test_what_moves_is_told_with_its_points_and_is_no_fault(moving):
    _, model = moving
    found = drift_finding("p", model)
    assert found.outcome is Outcome.TO_KNOW
    assert found.fault is None
    for told in drift_told(model):
        assert told.words in found.text
        assert {told.lowest[0], told.highest[0]} <= set(found.points)


def test_what_stays_is_good(tmp_path):
    session = plate_session(tmp_path)
    found = drift_finding("p", fit_modes(session.frfs[0]))
    assert found.outcome is Outcome.GOOD


def test_without_modes_nobody_can_tell():
    assert drift_finding("p", None).outcome is Outcome.CANNOT_TELL
