from dataclasses import replace

import numpy as np
import pytest
from support.offline_lab import simulate_session

from armodal.analyzer.arm.inertia import moments_about_joints
from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.gap.inference.annealing import annealing_stages
from armodal.analyzer.identification.identify import estimate_frfs, identify
from armodal.analyzer.identification.structural import STRUCTURAL_SHARE
from armodal.analyzer.modal import lines_within
from armodal.analyzer.screws import line_angle_rad, line_distance_m
from armodal.hil_sim.plant import build_plant
from armodal.protocols.arm.files import load_arm
from armodal.protocols.errors import EstimateError
from armodal.protocols.plan import load_plan
from armodal.protocols.plan_records import KnownMass


def test_joint_stiffness_is_within_two_per_cent_and_three_sigma(identified, plant):
    truth = {
        link.joint: link.stiffness_n_m_per_rad
        for link in plant.truth.links
        if link.stiffness_n_m_per_rad
    }
    for joint in identified.joints:
        error = joint.k_n_m_per_rad - truth[joint.joint]
        assert abs(error) < 0.02 * truth[joint.joint]
        assert abs(error) < 3 * joint.k_std


def test_a_joint_by_itself_has_the_stiffness_of_its_modes_frequency(identified, superset):
    """File 000, Eqs. (1) and (2): k = (2 pi f)^2 I, c = zeta k / (pi f), of the same mode."""
    names = [joint.name for joint in superset.arm.joints]
    alone = [joint for joint in identified.joints if joint.one_joint_posture is not None]
    assert alone
    for joint in alone:
        (frf,) = [f for f in identified.frfs if f.posture == joint.one_joint_posture]
        (mode,) = [
            mode
            for model in identified.modal_models
            for mode in model.modes
            if mode.f_hz == joint.one_joint_f_hz
        ]
        links = superset.posture(frf.joints_rad).T_base_link
        inertia = moments_about_joints(superset.arm, links)[names.index(joint.joint)]
        k = inertia * (2.0 * np.pi * mode.f_hz) ** 2
        assert joint.k_one_joint_n_m_per_rad == pytest.approx(k, rel=1e-9)
        c = mode.damping_ratio * k / (np.pi * mode.f_hz)
        assert joint.c_one_joint_n_m_s_per_rad == pytest.approx(c, rel=1e-9)


def test_the_hidden_axis_is_found_in_its_link(identified, plant):
    (axis,) = identified.axes
    hidden = plant.truth.hidden_axis
    assert axis.link == hidden.link
    error = axis.k_n_m_per_rad - hidden.stiffness_n_m_per_rad
    assert abs(error) < min(0.05 * hidden.stiffness_n_m_per_rad, 3 * axis.k_std)
    # The figures the whole workflow is asked for: 3 degrees and 15 mm.
    assert np.rad2deg(line_angle_rad(axis.direction_link, hidden.direction)) < 3
    assert line_distance_m(hidden.point_m, axis.point_link_m, axis.direction_link) < 0.015


def test_validation_frequencies_are_predicted_before_they_are_measured(identified):
    assert len(identified.validation) == 4
    for row in identified.validation:
        assert row.measured_hz is not None
        # 5 sigma: four comparisons, few degrees of freedom.
        spread = np.hypot(row.predicted_std_hz, row.measured_std_hz)
        assert abs(row.predicted_hz - row.measured_hz) < 5 * spread


def test_the_mozzi_axis_of_a_mode_shows_the_bias_the_model_predicts(identified):
    (axis,) = identified.axes
    first = axis.mozzi[0]
    found_bias = first.k_eq1_n_m_per_rad / axis.k_n_m_per_rad - 1
    assert found_bias == pytest.approx(first.predicted_bias_k, abs=0.02)


def test_stiffness_follows_the_tolerance_of_the_inertias(identified):
    for joint in identified.joints:
        # Masses of 5 % and inertias of 6 %, shared among several links.
        assert 0.01 < joint.k_std_model / joint.k_n_m_per_rad < 0.08


def test_poles_picked_by_hand_take_the_place_of_the_automatic_modes(session, identified, plant):
    first = identified.modal_models[0]
    poles = [mode.pole_rad_s for mode in first.modes[:-1]]
    plan = session.header.plan
    few = replace(plan, postures=plan.postures[:2])
    hits = tuple(hit for posture in few.postures for hit in session.accepted(posture.name))
    fitted = replace(session, header=replace(session.header, plan=few), hits=hits)
    by_hand = identify(fitted, picked={identified.frfs[0].posture: poles})
    assert len(by_hand.modal_models[0].modes) == len(first.modes) - 1
    assert by_hand.modal_models[1].f_hz == pytest.approx(identified.modal_models[1].f_hz)
    assert f"posture {identified.frfs[0].posture}: modes from poles picked by hand" in by_hand.notes
    # The stiffness comes from the FRFs and stays true.
    for joint in by_hand.joints:
        truth = {link.joint: link.stiffness_n_m_per_rad for link in plant.truth.links}
        assert joint.k_n_m_per_rad == pytest.approx(truth[joint.joint], rel=0.02)


def test_a_posture_with_a_known_mass_bolted_on_is_left_out_and_said(session):
    plan = session.header.plan
    *plain, last = plan.postures[:3]
    weight = KnownMass(link="wrist", mass_kg=2.0, center_m=np.zeros(3))
    few = replace(plan, postures=(*plain, replace(last, known_mass=weight)))
    hits = tuple(hit for posture in few.postures for hit in session.accepted(posture.name))
    found = identify(replace(session, header=replace(session.header, plan=few), hits=hits))
    assert [frf.posture for frf in found.frfs] == [posture.name for posture in plain]
    (said,) = [note for note in found.notes if "known mass" in note]
    assert said.startswith(f"posture {last.name}: left out")
    assert "`armodal gap` does" in said


def test_the_band_of_given_frfs_is_cut_for_what_stands_beside_the_joints(session):
    superset = Superset(session.header.arm)
    frfs = estimate_frfs(session, superset)
    given = replace(session, hits=(), frfs=frfs)
    cut = [lines_within(frf, (6.0, 60.0)) for frf in frfs]
    tops_hz = [
        max(float(lines.s_rad_s[-1].imag) for lines in stage.lines) / (2.0 * np.pi)
        for own in (None, cut)
        for stage in annealing_stages(superset, given, frfs, only=[3], band_of=own)
    ]
    assert tops_hz[0] > 100.0
    assert tops_hz[1] < 60.0


@pytest.mark.long
def test_a_band_asked_for_is_all_that_is_fitted(session, identified, plant):
    found = identify(session, band_hz=(6.0, 60.0))
    for frf, model in zip(found.frfs, found.modal_models, strict=True):
        assert frf.freq_hz[0] >= 6.0
        assert frf.freq_hz[-1] <= 60.0
        assert all(6.0 <= mode.f_hz <= 60.0 for mode in model.modes)
    truth = {link.joint: link.stiffness_n_m_per_rad for link in plant.truth.links}
    for joint, whole in zip(found.joints, identified.joints, strict=True):
        assert joint.k_n_m_per_rad == pytest.approx(truth[joint.joint], rel=0.02)
        assert joint.k_n_m_per_rad != whole.k_n_m_per_rad


@pytest.mark.long
def test_lines_of_noise_alone_are_left_out_and_said_by_posture(session, identified):
    """A soft tip: above 100 Hz noise of the FRFs' own size, here in one posture."""
    rng = np.random.default_rng(7)
    few = session.header.plan.postures[:2]
    hits = tuple(hit for posture in few for hit in session.accepted(posture.name))
    first, other = estimate_frfs(replace(session, hits=hits), Superset(session.header.arm))
    size = np.sqrt(np.mean(np.abs(first.values) ** 2)) * (first.freq_hz > 100.0)
    noise = size * rng.standard_normal((2, *first.values.shape))
    faded = replace(
        first,
        values=first.values + noise[0] + 1j * noise[1],
        variance=first.variance + 2.0 * size**2,
    )
    result = identify(replace(session, hits=(), frfs=(faded, other)))
    (said,) = [note for note in result.notes if "no band was asked for" in note]
    assert said.startswith(f"posture {first.posture!r}: ")
    assert "`--band` takes others" in said
    top_hz = {
        f.posture: m.band_hz[1] for f, m in zip(result.frfs, result.modal_models, strict=True)
    }
    # Lines are averaged with four neighbours and 16 are kept as a last flank: 17 Hz.
    assert top_hz.pop(first.posture) < 120.0
    assert min(top_hz.values()) == other.freq_hz[-1]
    assert not [note for note in identified.notes if "no band was asked for" in note]


def test_poles_of_a_posture_that_was_not_measured_are_refused(session):
    with pytest.raises(EstimateError, match="got poles of elsewhere"):
        identify(session, picked={"elsewhere": [-1.0 + 60.0j]})


def test_a_tool_the_file_does_not_know_is_no_axis(plant):
    """Joints make every shape: what is missing is said, and no line in a link is put for it."""
    last = plant.truth.links[-1]
    heavier = last.model_copy(update={"mass_kg": last.mass_kg + 2.0})
    truth = plant.truth.model_copy(
        update={"hidden_axis": None, "links": [*plant.truth.links[:-1], heavier]}
    )
    plan = load_plan("rv4frl-three-postures", load_arm("rv4frl"))
    plan = replace(plan, postures=plan.postures[:2])
    session = simulate_session(11, plan=plan, plant=build_plant(truth), hits_per_point=1)
    result = identify(session)
    assert min(mode.joint_share for mode in result.modes) > STRUCTURAL_SHARE
    assert result.axes == ()
    assert any("it lacks an effect" in note for note in result.notes)
