"""What swings on a link: beside equations by hand, and named where it is hidden."""

import json

import numpy as np
import pytest
from support.without_errors import without_errors

from armodal.analyzer.gap.effects import absorber
from armodal.analyzer.gap.model.hypothesis import Hypothesis
from armodal.analyzer.gap.model.lines import PostureLines
from armodal.analyzer.gap.model.ordinary import Ordinary
from armodal.analyzer.gap.model.posed import PosedModel
from armodal.analyzer.gap.workflow import find_gap
from armodal.hil_sim import makers, study
from armodal.study.score import mark

Q = np.deg2rad([10.0, -35.0, 20.0, 15.0, 40.0, 20.0])
S = 2.0 * np.pi * (2.0 + 1j * np.array([8.0, 13.0, 31.0, 64.0, 110.0]))
PULL, ONES = np.array([[-0.45, -0.62, -0.6427]]), np.ones((18, 3, len(S)), dtype=complex)


def test_it_is_a_mass_on_a_spring_along_its_line_and_carried_across(superset):
    """Without the mass's own weight: 5 N m/rad of some 10^4, 1e-3 of what is seen."""
    u, p = np.array([0.0, 0.6, 0.8]), np.array([0.05, 0.08, -0.06])
    ordinary = Ordinary(superset=superset, postures=("p",))
    hung = Hypothesis(ordinary=ordinary, instances=(absorber.at_line(ordinary, 2, u, p),))
    mass, ln_hz, loss, across, along, *_ = (own.name for own in hung.instances[0].parameters)
    values = without_errors(hung.space().values(hung.space().start()))
    values |= {mass: 0.9, ln_hz: np.log(25.0), loss: 2e-3, across: 0.7, along: 0.05}
    at, m = np.arange(len(ONES)), {"values": ONES, "variance": ONES.real, "sensor_mass_kg": 0.0}
    m |= {"sensor_point": at, "hit": 0 * at, "hit_point": at[:1], "hit_direction": PULL}
    found = PosedModel(superset, Q).values(
        hung, PostureLines(name="p", joints_rad=Q, s_rad_s=S, **m), values
    )
    dynamics, J = superset.posture(Q), superset.posture(Q).link_jacobian[2]
    own = [superset.joint_column(i) for i in ordinary.elastic]
    k, c = (np.exp([values[f"ln {x} axis_{i + 1}"] for i in ordinary.elastic]) for x in "kc")
    v = (J[:3] - np.cross(p + 0.05 * u, J[3:], axisb=0, axisc=0))[:, own]
    carried = 0.9 * 0.7 * v.T @ (np.eye(3) - np.outer(u, u)) @ v
    w2 = (2.0 * np.pi * 25.0) ** 2
    for i, s in enumerate(S):
        spring = w2 * (1.0 + 2e-3 * s)
        Z = s**2 * (dynamics.mass[np.ix_(own, own)] + carried) + np.diag(k + c * s)
        Z = Z + dynamics.gravity_stiffness[np.ix_(own, own)]
        Z = Z + 0.9 * s**2 * spring / (s**2 + spring) * np.outer(u @ v, u @ v)
        x = np.linalg.solve(Z, dynamics.point_jacobian[0][:3, own].T @ PULL[0])
        want = s**2 * dynamics.point_jacobian[9][:3, own] @ x
        want += np.cross(dynamics.point_jacobian[9][3:, own] @ x, dynamics.gravity_m_s2)
        want = dynamics.point_rotation[9].T @ want
        np.testing.assert_allclose(found[9, :, i], want, atol=1e-3 * np.abs(want).max())


@pytest.mark.long
@pytest.mark.parametrize("maker", ["home", "mujoco"])
def test_it_is_named_where_it_swings(maker):
    case = study.make_case(5, "bench57", "absorber") if maker == "home" else None
    case = case or makers.make_case("mujoco", 1001, "ur10e", "absorber", wrist="rigid")
    result = find_gap(case.session(), gates=False, modes=False, advice=False).result
    assert mark(json.loads(case.open_truth()), result).outcome == "right"
