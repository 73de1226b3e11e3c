"""The planner against file 002's own postures, and its parts against closed forms."""

from __future__ import annotations

import numpy as np
import pytest

from armodal.analyzer.planning import selective
from armodal.analyzer.planning.clearance import Clearance, clear_postures
from armodal.analyzer.planning.equations import planned_arm
from armodal.analyzer.planning.excitation import (
    HitChoice,
    PostureModes,
    best_hits,
    observable_joints,
    observing_points,
    posture_modes,
)
from armodal.analyzer.planning.expected import Instruments, expected_std, information
from armodal.analyzer.planning.selective import describe_tests, plan_tests
from armodal.analyzer.planning.selectivity import coupling_ratios, separable_set, worst_coupling
from armodal.analyzer.workspace.batch import ArmBatch
from armodal.analyzer.workspace.postures import random_postures
from armodal.analyzer.workspace.spectrum import ElasticJoints, elastic_joints
from armodal.protocols.arm.files import load_arm
from armodal.protocols.errors import EstimateError

# File 002, Table 1: the posture chosen for each of joints 1 to 5.
PAPER_DEG = [
    [0, 0, 90, 0, 0, 0],
    [0, 0, 17, 0, -17, 0],
    [0, -189, 243, 0, -54, 0],
    [0, 0, 90, 0, 90, 0],
    [0, -90, 180, 0, 90, 0],
]


@pytest.fixture(scope="module")
def arm():
    return load_arm("viper_s650")


@pytest.fixture(scope="module")
def elastic(arm):
    return elastic_joints(arm)


@pytest.fixture(scope="module")
def planned(arm):
    return planned_arm(arm)


@pytest.fixture(scope="module")
def plan(planned):
    return plan_tests(planned, np.random.default_rng(1))


def test_ratios_are_the_couplings_over_the_joints_own_inertia():
    mass = np.array([[4.0, -1.0], [-1.0, 2.0]])[..., None]
    np.testing.assert_array_equal(coupling_ratios(mass)[..., 0], [[0.0, 0.25], [0.5, 0.0]])
    np.testing.assert_array_equal(worst_coupling(mass)[:, 0], [0.25, 0.5])


def test_a_separable_set_follows_ties_from_joint_to_joint():
    mass = np.eye(4)
    mass[0, 1] = mass[1, 0] = mass[1, 2] = mass[2, 1] = 0.5  # squared 0.25, above a tenth
    mass[2, 3] = mass[3, 2] = 0.2  # squared 0.04, below
    assert separable_set(mass, 0) == (0, 1, 2)
    assert separable_set(mass, 3) == (3,)


def test_every_joint_gets_a_posture_at_least_as_selective_as_the_papers(arm, elastic, plan):
    """By the papers' own measure, the largest |M_ij| / M_ii over the elastic joints."""
    mass = ArmBatch(arm).mass(np.deg2rad(PAPER_DEG))[:5, :5]
    paper = np.diag(worst_coupling(mass))
    np.testing.assert_array_less(plan.least_coupling, paper)
    found = ArmBatch(arm).mass(plan.most_selective)[:5, :5]
    np.testing.assert_allclose(np.diag(worst_coupling(found)), plan.least_coupling, rtol=1e-9)


def test_the_plan_is_within_ranges_and_clear(arm, plan):
    low, high = np.array([joint.range_rad for joint in arm.joints]).T
    q = np.array([test.joints_rad for test in plan.tests])
    assert ((q >= low) & (q <= high)).all()
    assert clear_postures(ArmBatch(arm), q, Clearance()).all()


def test_the_needed_tests_serve_every_joint_and_are_fewer_than_the_joints(elastic, plan):
    needed = plan.tests[: plan.n_needed]
    assert {joint for test in needed for joint in test.serves} == set(elastic.joints)
    assert plan.not_isolated == ()
    assert plan.n_needed < len(elastic.joints)


def test_each_further_test_tells_more(plan):
    # Information adds: no standard deviation can grow. 1e-6 is the rounding of the inverse.
    assert (np.diff(plan.expected_std, axis=0) <= 1e-6 * plan.expected_std[:-1]).all()


def test_the_first_further_test_leaves_the_smallest_deviations_of_all(
    arm, elastic, planned, monkeypatch
):
    tools = Instruments(high_hz=60.0, line_hz=2.0)
    others = random_postures(arm, 12, np.random.default_rng(4), still=(0,))
    others = others[clear_postures(ArmBatch(arm), others, Clearance())]
    papers = [q[None] for q in np.deg2rad(PAPER_DEG)]
    monkeypatch.setattr(selective, "isolating_postures", lambda *_, **__: papers)
    monkeypatch.setattr(selective, "random_postures", lambda *_, **__: others)
    plan = plan_tests(planned, np.random.default_rng(1), instruments=tools, n_tests=6)
    needed = plan.tests[: plan.n_needed]

    def told(test):
        return information(
            planned,
            planned.at(test.joints_rad),
            hit_point=test.hit.point,
            hit_direction=test.hit.direction_base,
            points=test.points,
            instruments=tools,
        )

    known = [told(test) for test in needed]
    left = [
        np.log(expected_std([*known, told(test)], 5)).sum()
        for q in others
        for joint in elastic.joints
        for test in describe_tests(planned, q, joint, least_mass_kg=tools.least_mass_kg)
        if test.hit.point == plan.hit_point
        and all(np.abs(q - other.joints_rad).max() > selective.ANOTHER_RAD for other in needed)
    ]
    chosen = np.log(plan.expected_std[plan.n_needed]).sum()
    # The same sums in the same order: rounding alone.
    assert chosen == pytest.approx(min(left), abs=1e-9)
    assert chosen < np.median(left)


@pytest.mark.parametrize(
    ("neighbour_hz", "share", "served"),
    [
        (10.5, (0.8, 0.2), ()),  # each hides the other
        (20.0, (0.8, 0.2), (1, 3)),
        (10.5, (0.94, 0.06), (1,)),  # too faint to hide the first
        (20.0, (0.96, 0.04), (1,)),  # too faint to show itself
    ],
)
def test_a_hit_serves_the_joints_whose_own_modes_show_apart(neighbour_hz, share, served):
    # At 2 % of damping a mode of 10 Hz is 0.2 Hz wide at each side.
    modes = PostureModes(
        f_hz=np.array([10.0, neighbour_hz]),
        damping_ratio=np.array([0.02, 0.02]),
        shape=np.eye(2),
        joint_share=np.eye(2),
        mass=np.eye(2),
    )
    hit = HitChoice(
        point="1",
        direction_base=np.array([0.0, 0.0, 1.0]),
        peak=1.0,
        purity=share[0],
        share=np.array(share),
        effective_mass_kg=1.0,
        along_normal=True,
    )
    two = ElasticJoints(
        joints=(1, 3), stiffness_n_m_per_rad=np.ones(2), damping_n_m_s_per_rad=np.ones(2)
    )
    assert observable_joints(two, modes, [1, 3], hit) == served


def test_shares_of_a_mode_sum_to_one_and_name_the_joint(planned, elastic):
    modes = posture_modes(planned.at(np.deg2rad(PAPER_DEG[0])))
    np.testing.assert_allclose(modes.joint_share.sum(axis=0), 1.0, rtol=1e-12)
    assert modes.joint_share[0, modes.mode_of(0)] > 0.95  # one joint all but alone


def test_the_paper_s_lateral_hit_is_found_for_joint_1(planned, elastic):
    """File 002, section 3: a lateral force (y) on the stretched arm excites joint 1."""
    at = planned.at(np.deg2rad(PAPER_DEG[0]))
    modes = posture_modes(at)
    hit = best_hits(planned, at, modes, modes.mode_of(0))[0]
    assert abs(hit.direction_base[1]) > 0.99
    assert hit.purity > 0.9


def test_points_that_see_a_mode_move_and_the_base_does_not(planned, elastic):
    at = planned.at(np.deg2rad(PAPER_DEG[0]))
    modes = posture_modes(at)
    points = observing_points(planned, at, modes, modes.mode_of(0))
    assert "1" in points
    assert "10" not in points


def test_gravity_beside_the_springs_is_small_as_the_paper_says(planned, elastic):
    """File 002, end of section 3: gravity torques much smaller than the elastic ones."""
    for joint, q in zip(elastic.joints, np.deg2rad(PAPER_DEG), strict=True):
        test = describe_tests(planned, q, joint)[0]
        assert np.abs(test.gravity.part_of_spring).max() < 0.02


def test_clearance_sees_the_floor_and_the_base(arm):
    batch = ArmBatch(arm)
    stretched_down = np.deg2rad([[0, 45, 90, 0, 0, 0]])
    assert not clear_postures(batch, stretched_down, Clearance())[0]
    assert clear_postures(batch, np.deg2rad([PAPER_DEG[0]]), Clearance())[0]
    assert not clear_postures(batch, np.deg2rad([PAPER_DEG[0]]), Clearance(floor_m=0.5))[0]


def test_an_arm_that_can_stand_nowhere_is_said(planned):
    with pytest.raises(EstimateError, match="clear of floor and base"):
        plan_tests(planned, np.random.default_rng(1), clearance=Clearance(floor_m=5.0))


def test_the_expected_std_is_the_scatter_of_estimates_from_noisy_records(planned, elastic):
    """One point, no mounting error: white noise in time, spectra, and ln k by least squares."""
    superset = planned.superset
    dynamics = superset.posture(np.deg2rad(PAPER_DEG[1]))
    tools = Instruments(mounting=1e-9, high_hz=60.0, line_hz=2.0)
    direction = np.array([0.0, 0.6, 0.8])
    total = information(
        planned,
        planned.at(np.deg2rad(PAPER_DEG[1])),
        hit_point="1",
        hit_direction=direction,
        points=("5",),
        instruments=tools,
    )
    columns = [superset.joint_column(joint) for joint in elastic.joints]
    J = dynamics.point_jacobian[:, :3][:, :, columns]
    M = dynamics.mass[np.ix_(columns, columns)]
    G = dynamics.gravity_stiffness[np.ix_(columns, columns)]
    lines = np.arange(2, 30)  # of 2 Hz, from 4 Hz to below 60 Hz
    s = 2j * np.pi * tools.line_hz * lines

    def frf(logs):
        k = elastic.stiffness_n_m_per_rad * np.exp(logs[:5])
        c = elastic.damping_n_m_s_per_rad * np.exp(logs[5:])
        out = [
            z**2
            * J[superset.point_index["5"]]
            @ np.linalg.solve(
                z**2 * M + z * np.diag(c) + G + np.diag(k),
                J[superset.point_index["1"]].T @ direction,
            )
            for z in s
        ]
        return np.array(out).T.ravel()  # axis by axis

    step = 1e-5
    slope = np.stack(
        [(frf(step * unit) - frf(-step * unit)) / (2 * step) for unit in np.eye(10)], axis=1
    )
    slope = np.concatenate([slope.real, slope.imag])
    # Records of 1 / line_hz seconds at 200 Hz; the noise's power, density² times half the rate.
    rng, n_runs, rate_hz = np.random.default_rng(3), 400, 200.0
    records = rng.standard_normal((n_runs, tools.hits, 3, round(rate_hz / tools.line_hz)))
    records *= tools.acceleration_noise * np.sqrt(rate_hz / 2.0)
    spectra = np.fft.rfft(records, axis=-1)[..., lines] / rate_hz
    error = (spectra / tools.impulse_n_s).mean(axis=1).reshape(n_runs, -1)
    size = np.linalg.norm(slope, axis=0)
    parts = np.concatenate([error.real, error.imag], axis=1)
    found = np.linalg.lstsq(slope / size, parts.T, rcond=None)[0] / size[:, None]
    scatter = found[:5].std(axis=1)
    # 400 runs tell a scatter to 3.5 %: four times that.
    np.testing.assert_allclose(expected_std([total], 5), scatter, rtol=0.14)


def test_a_joint_nothing_tells_about_has_no_finite_uncertainty():
    total = np.diag([4.0, 0.0, 1.0, 0.0])  # ln k1, ln k2, ln c1, ln c2
    np.testing.assert_array_equal(expected_std([total], 2), [0.5, np.inf])


def test_random_postures_are_less_selective_than_the_plan_s(arm, elastic, plan):
    batch = ArmBatch(arm)
    q = random_postures(arm, 2000, np.random.default_rng(2), still=(0,))
    q = q[clear_postures(batch, q, Clearance())]
    ratios = worst_coupling(batch.mass(q)[:5, :5])
    assert (plan.least_coupling < ratios.min(axis=1)).all()
    for test in plan.tests[: plan.n_needed]:
        number = elastic.joints.index(test.target)
        # A posture that shows several joints is not the best for each: a few in a thousand are.
        assert (ratios[number] < test.coupling.max()).mean() < 0.005
