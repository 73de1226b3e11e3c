"""Inertias calibrated to figures: the Viper of file 002, and an arm whose truth is known."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from armodal.analyzer.calibration.bodies import N_NUMBERS, BelievedBody, moved_body
from armodal.analyzer.calibration.calibrate import calibrate_inertia
from armodal.analyzer.calibration.from_file import calibrate_from_file, modes_target
from armodal.analyzer.calibration.targets import MomentTarget, TotalMassTarget
from armodal.analyzer.workspace.batch import ArmBatch
from armodal.analyzer.workspace.coupling import sweep_coupling
from armodal.protocols.arm.files import ARMS_DIRECTORY, load_arm
from armodal.protocols.arm.inertial import physical_link
from armodal.protocols.errors import ArmError, EstimateError
from armodal.protocols.inertia_targets import load_inertia_targets

TARGETS = ARMS_DIRECTORY.parent / "targets"
UNCALIBRATED = TARGETS / "viper_s650-uncalibrated.toml"
WITH_TABLE_4 = TARGETS / "viper_s650-with-table4.toml"
WITHOUT_TABLE_4 = TARGETS / "viper_s650-without-table4.toml"


@pytest.fixture(scope="module")
def uncalibrated():
    return load_arm(UNCALIBRATED)


@pytest.fixture(scope="module")
def predicting(uncalibrated):
    return calibrate_from_file(uncalibrated, load_inertia_targets(WITHOUT_TABLE_4, uncalibrated))


@pytest.fixture(scope="module")
def calibrated(uncalibrated):
    return calibrate_from_file(uncalibrated, load_inertia_targets(WITH_TABLE_4, uncalibrated))


@pytest.fixture(scope="module")
def table_4(uncalibrated):
    return [
        modes_target(uncalibrated, t)
        for t in load_inertia_targets(WITH_TABLE_4, uncalibrated).modes
    ]


def body(name="link", mass_kg=3.0):
    return BelievedBody(
        name=name,
        mass_kg=mass_kg,
        center_m=np.array([0.1, 0.0, -0.05]),
        box_m=np.array([0.3, 0.1, 0.2]),
        mass_std=0.2,
        center_std=0.15,
        spread_std=0.5,
    )


@given(st.lists(st.floats(-6, 6), min_size=N_NUMBERS, max_size=N_NUMBERS))
def test_every_number_gives_a_body_that_can_exist(u):
    link = moved_body(body(), np.array(u))
    physical_link(link.name, link.mass_kg, link.center_m, link.inertia_kg_m2)


def test_the_belief_itself_is_the_full_box():
    link = moved_body(body(), np.zeros(N_NUMBERS))
    a, b, c = 0.3, 0.1, 0.2
    of_box = 3.0 / 12 * np.diag([b * b + c * c, a * a + c * c, a * a + b * b])
    np.testing.assert_allclose(link.inertia_kg_m2, of_box, rtol=1e-12, atol=1e-15)


def test_table_4_is_predicted_within_half_a_hertz(predicting, table_4):
    """Nothing of Table 4 was a target here."""
    for target in table_4:
        f_hz = target.values(ArmBatch(predicting.arm).mass(target.postures))[:5]
        assert np.abs(f_hz - target.f_hz).max() < 0.5


def test_the_slope_by_inertial_parameters_gives_the_mass_matrix(calibrated):
    batch = ArmBatch(calibrated.arm)
    q = np.random.default_rng(2).uniform(-2, 2, size=(4, 6))
    links = [joint.link for joint in calibrated.arm.joints]
    mass = np.einsum("ijklp,lp->ijk", batch.mass_slope(q), batch.parameters(links))
    np.testing.assert_allclose(mass, batch.mass(q), atol=1e-13 * mass.max())


def test_the_interval_of_the_prediction_covers_table_4(predicting, table_4):
    inside = []
    for target in table_4:
        value, std = predicting.spread_of(target.postures, target.values)
        inside += list(np.abs(value[:5] - target.f_hz) <= 2 * np.hypot(std[:5], 0.03))
    # Ten figures of one arm, correlated: one outside two standard deviations is no surprise.
    assert sum(inside) >= 9


def test_table_4_is_met_within_a_tenth_of_a_hertz_and_of_a_point(calibrated, table_4):
    for target in table_4:
        value = target.values(ArmBatch(calibrated.arm).mass(target.postures))
        assert np.abs(value[:5] - target.f_hz).max() < 0.1
        assert np.abs(value[5:] - target.damping_ratio).max() < 0.001


def test_couplings_vanish_within_a_degree_of_the_printed_angles(predicting, calibrated):
    for found in (predicting, calibrated):
        sweep = sweep_coupling(found.arm, (1, 2), joint=2, limits_rad=tuple(np.deg2rad([-60, 320])))
        np.testing.assert_allclose(np.rad2deg(sweep.zeros_rad), [-38, 293], atol=1.0)


def test_masses_stay_within_40_percent_of_the_volume_shares(predicting, calibrated):
    for found in (predicting, calibrated):
        for joint, believed in zip(found.arm.joints, found.bodies, strict=True):
            assert abs(joint.link.mass_kg / believed.mass_kg - 1) < 0.4


@pytest.mark.parametrize("name", ["viper_s650", "viper_s650-without-table4"])
def test_the_shipped_arm_is_what_calibration_gives(name, predicting, calibrated):
    shipped = load_arm(name)
    found = calibrated if name == "viper_s650" else predicting
    q = np.random.default_rng(1).uniform(-2, 2, size=(50, 6))
    # Files hold six digits, and the minimum is flat: a thousandth of the largest inertia.
    made, kept = ArmBatch(found.arm).mass(q), ArmBatch(shipped).mass(q)
    np.testing.assert_allclose(kept, made, atol=1e-3 * made.max())


def test_another_arm_that_is_as_probable_is_told(predicting, calibrated, uncalibrated):
    assert predicting.twin is None
    assert calibrated.twin is not None
    arm = ArmBatch(uncalibrated).with_links(list(calibrated.twin)).arm
    # Its modes meet the figures as well: each in margins, and the two differ by far more than
    # rounding.
    for target, pulls in calibrated.pulls:
        theirs = target.pulls(
            ArmBatch(arm).mass(target.postures),
            calibrated.base_mass_kg + sum(link.mass_kg for link in calibrated.twin),
        )
        assert np.linalg.norm(theirs) == pytest.approx(np.linalg.norm(pulls), abs=0.5)
    inertias = np.array([joint.link.inertia_kg_m2 for joint in calibrated.arm.joints])
    twins = np.array([link.inertia_kg_m2 for link in calibrated.twin])
    assert np.abs(twins - inertias).max() > 0.01 * inertias.max()  # no rounding


def test_more_figures_leave_less_undetermined(predicting, calibrated):
    few, many = predicting.undetermined(), calibrated.undetermined()
    assert all(set(many[link]) <= set(few[link]) for link in few)
    assert sum(map(len, many.values())) < sum(map(len, few.values()))


@pytest.mark.long
def test_intervals_cover_the_truth_as_often_as_they_say():
    """Arms drawn from the belief itself: 95 % intervals of a moment nobody gave as a target."""
    arm = load_arm("rv4frl")
    bodies = [
        replace(
            body(joint.link.name, 2.0 + i),
            center_m=np.asarray(joint.link.center_m),
        )
        for i, joint in enumerate(arm.joints[::-1])
    ][::-1]
    q = np.deg2rad([[0, 0, 90, 0, 0, 0], [0, 40, 30, 0, 60, 0], [0, -30, 140, 0, -50, 0]])
    rng = np.random.default_rng(4)
    inside, n = 0, 20
    for _ in range(n):
        truth = ArmBatch(arm).with_links(
            [moved_body(b, rng.normal(size=N_NUMBERS)) for b in bodies]
        )
        total = sum(joint.link.mass_kg for joint in truth.arm.joints)
        targets = [
            MomentTarget(
                joint=joint,
                joints_rad=q[posture],
                value_kg_m2=(1 + 0.01 * rng.normal()) * truth.mass(q)[joint, joint, posture],
                margin_kg_m2=0.01 * truth.mass(q)[joint, joint, posture],
                source="drawn",
            )
            for joint, posture in ((0, 0), (1, 1), (2, 1))
        ]
        mass = TotalMassTarget(n_joints=6, value_kg=total, margin_kg=0.1, source="drawn")
        found = calibrate_inertia(
            arm, bodies, [mass, *targets], base_mass_kg=1e-6, base_mass_std=0.1
        )
        value, std = found.spread_of(q[[2]], lambda mass: mass[1, 1])
        inside += abs(value[0] - truth.mass(q)[1, 1, 2]) <= 1.96 * std[0]
    # The slope stands for a curved map, so a little off 95 %; a binomial of 20 at 0.95 is below
    # 16 once in four hundred.
    assert inside >= 16


def test_figures_that_exclude_each_other_are_refused():
    arm = load_arm("rv4frl")
    bodies = [body(joint.link.name) for joint in arm.joints]
    q = np.zeros(6)
    moment = MomentTarget(joint=1, joints_rad=q, value_kg_m2=200.0, margin_kg_m2=1.0, source="slip")
    mass = TotalMassTarget(n_joints=6, value_kg=18.0, margin_kg=0.1, source="scales")
    with pytest.raises(EstimateError, match="no plausible inertias meet"):
        calibrate_inertia(arm, bodies, [mass, moment], base_mass_kg=1e-6, base_mass_std=0.1)


@pytest.mark.parametrize("swept", ["joint_1", "joint_2"])
def test_a_zero_that_its_swept_joint_cannot_move_is_refused_by_its_source(uncalibrated, swept):
    file = load_inertia_targets(WITHOUT_TABLE_4, uncalibrated)
    first, *others = file.zeros
    still = first.model_copy(update={"swept": swept, "source": "a slip in the table"})
    with pytest.raises(EstimateError, match=rf"'a slip in the table'.* got joint {swept[-1]}"):
        calibrate_from_file(uncalibrated, file.model_copy(update={"zeros": [still, *others]}))


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('arm = "viper_s650-uncalibrated"', 'arm = "rv4frl"', "the arm at hand"),
        ('joint = "joint_1"', 'joint = "joint_9"', r"moments\[0\].joint"),
        ("volume_share = 0.27", "volume_share = 0.9", "sum to 1"),
        ("spread_std = 0.5", "spread = 0.5", "spread"),
        ("posture_deg = [0.0, 0.0, 17.0, 0.0, -17.0, 0.0]", "posture_deg = [0.0]", "6 angles"),
    ],
)
def test_a_targets_file_that_does_not_fit_is_refused_with_the_key(
    tmp_path, uncalibrated, old, new, message
):
    text = WITHOUT_TABLE_4.read_text()
    assert old in text
    path = tmp_path / "targets.toml"
    path.write_text(text.replace(old, new, 1))
    with pytest.raises(ArmError, match=message):
        load_inertia_targets(path, uncalibrated)
