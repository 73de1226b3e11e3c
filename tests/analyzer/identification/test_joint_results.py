"""A joint's stiffness and damping from one mode alone, with what is held beside the joint."""

from types import SimpleNamespace

import numpy as np
import pytest
from support.made_fits import made_fit
from support.made_modes import made_modes

from armodal.analyzer.arm.structure import Held, Structure
from armodal.analyzer.identification.prediction import predict_modes
from armodal.analyzer.identification.result_rows import joint_results

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
