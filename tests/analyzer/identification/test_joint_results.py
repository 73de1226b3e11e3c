"""A joint's stiffness and damping from one mode alone, with what is held beside the joint."""

from types import SimpleNamespace

import numpy as np
import pytest
from support.made_fits import made_fit
from support.made_modes import made_modes

from armodal.analyzer.arm.structure import Held, Structure
from armodal.analyzer.identification.prediction import predict_modes
from armodal.analyzer.identification.result_rows import joint_results
from armodal.protocols.errors import EstimateError

K, C = 20_000.0, 4.0


def test_a_held_rotor_spring_and_damper_are_not_taken_for_the_joint_s(superset):
    # Joint 1 turns about the vertical: gravity has no say, and its one mode is its own.
    structure = Structure(
        joints=(0,),
        stiffness_n_m_per_rad=np.array([K]),
        damping_n_m_s_per_rad=np.array([C]),
        held=Held(
            names=(),
            motion=np.zeros((superset.n, 0)),
            mass=np.array([[0.4]]),
            damping=np.array([[1.5]]),
            stiffness=np.array([[3_000.0]]),
        ),
    )
    measured = made_modes(superset, np.zeros(6), structure)
    fit = made_fit(superset, structure)
    none = np.zeros(len(superset.arm.points))
    predicted = predict_modes(superset, measured.dynamics, fit, added_mass_kg=none)
    frfs = (SimpleNamespace(posture="test 1"),)
    (row,) = joint_results(superset, fit, np.zeros(99), frfs, [measured], [predicted])
    assert row.k_one_joint_n_m_per_rad == pytest.approx(K, rel=1e-9)
    assert row.c_one_joint_n_m_s_per_rad == pytest.approx(C, rel=1e-9)


def test_a_fit_that_ends_with_a_drive_that_does_not_swing_says_what_may_be_wrong(superset):
    critical = 2.0 * np.sqrt(K * 2.0)  # joint 1 moves some 2 kg m² in its posture at zero
    structure = Structure(
        joints=(0,),
        stiffness_n_m_per_rad=np.array([K]),
        damping_n_m_s_per_rad=np.array([5.0 * critical]),
    )
    dynamics = superset.posture(np.zeros(6))
    none = np.zeros(len(superset.arm.points))
    with pytest.raises(EstimateError, match=r"joint_1 \(.* of critical\).*mass and moments"):
        predict_modes(superset, dynamics, made_fit(superset, structure), added_mass_kg=none)
