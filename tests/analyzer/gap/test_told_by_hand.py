"""Joint angles that a person has told: the verdict says so, and they are not merged."""

import math
from dataclasses import replace

import pytest

from armodal.analyzer.gap.decision.data_requirements import notes_on
from armodal.analyzer.merge_sessions import merge_sessions
from armodal.protocols.errors import EstimateError


@pytest.fixture
def told(session):
    header = replace(session.header, session_id="0f", told_tolerance_rad=math.radians(0.2))
    return replace(session, header=header)


def test_the_verdict_says_that_angles_were_told(session, told):
    words = "joint angles were told by the operator, to 0.2 deg"
    assert notes_on(told, ())[0].startswith(words)
    assert notes_on(session, [told])[0].startswith(f"test 2: {words}")
    assert not any("told" in note for note in notes_on(session, ()))


def test_told_and_measured_angles_are_not_merged(session, told):
    with pytest.raises(EstimateError, match="measured and some told by hand"):
        merge_sessions([session, told], ["a", "b"], created="", software="")
