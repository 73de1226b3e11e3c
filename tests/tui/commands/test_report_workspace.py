"""The workspace in a report: with what was identified, and with the effects that were held."""

from dataclasses import replace

import numpy as np
import pytest
from support.added import any_of, axis

from armodal.analyzer.corrected.batch import batched
from armodal.analyzer.corrected.held import held_arm
from armodal.analyzer.identification.as_effects import identified_arm
from armodal.analyzer.identification.predicted_posture import predict_posture
from armodal.analyzer.workspace.spectrum import spectrum
from armodal.analyzer.workspace.survey import survey_workspace
from armodal.tui.commands.workspace import workspace_section

TOLD = {"source": "a test", "session_sha256": "c" * 64, "created": "2026-01-01T00:00:00+00:00"}
Q = np.array([0.2, 0.4, 1.1, -0.5, 0.6, 0.3])


@pytest.fixture
def held(arm):
    """Effects that a fit of joints leaves as they are."""
    return any_of(arm, "payload"), any_of(arm, "rotor")


def test_the_workspace_has_the_modes_that_the_identified_model_predicts(arm, identified):
    # Gravity's small stiffness is not in a workspace; next to none leaves springs to compare.
    light = replace(arm, gravity_m_s2=np.array([0.0, 0.0, -1e-9]))
    wanted = predict_posture(light, identified, np.rad2deg(Q)).predicted.modes
    ready = batched(identified_arm(light, identified, **TOLD))
    found = spectrum(ready.batch, Q[None], ready.elastic)
    assert len(identified.axes) == 1
    # The same matrices; damping to first order leaves its square.
    assert found.f_hz[0] == pytest.approx(wanted.f_hz, rel=float(wanted.damping_ratio.max()) ** 2)
    assert found.f_hz.shape == (1, len(identified.joints) + 1)


def test_a_fitted_axis_takes_the_place_of_the_file_s_and_the_rest_stays(arm, identified, held):
    (fitted,) = identified.axes
    before = replace(arm, effects=(*held, axis(fitted.link)))
    found = identified_arm(before, identified, **TOLD)
    assert found.effects[:2] == held
    (_, _, own) = found.effects
    assert own.parameters[0].value == pytest.approx(1.0 / fitted.k_n_m_per_rad, rel=1e-12)


def test_the_report_s_workspace_names_and_has_all_that_gives_way(
    session, identified, held, monkeypatch
):
    surveys = []

    def seen(*given, **named):
        surveys.append(survey_workspace(*given, **named))
        return surveys[-1]

    monkeypatch.setattr("armodal.tui.commands.workspace.survey_workspace", seen)
    for effects in ((), held):
        own = replace(session.header, arm=replace(session.header.arm, effects=effects))
        section = workspace_section(
            replace(session, header=own), identified, 20, session_sha256="c" * 64
        )
        said = [note for note in section.notes if note.startswith("computed with")]
        assert len(said) == len(effects) + len(identified.axes)
    alone, beside = (survey.study.f_hz.mean for survey in surveys)
    assert len(alone) == len(beside) == len(identified.joints) + 1
    assert beside[0] < alone[0]  # a payload and a rotor slow the lowest mode


def test_coupling_is_of_the_arm_with_what_it_carries(arm, held):
    loaded = replace(arm, effects=held[:1])
    ready = batched(loaded)
    found = survey_workspace(loaded, ready.elastic, n_postures=2, batch=ready.batch).sweep
    own = held_arm(loaded).arm  # the same body, as a part of its link
    plain = batched(replace(own, effects=()))
    wanted = survey_workspace(own, plain.elastic, n_postures=2).sweep
    bare = survey_workspace(arm, plain.elastic, n_postures=2).sweep
    assert found.to_first == pytest.approx(wanted.to_first, rel=1e-9, abs=1e-12)
    assert np.abs(found.to_first - bare.to_first).max() > 1e-4
