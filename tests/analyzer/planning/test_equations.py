"""Plans of corrected arms: the equations they are made with, and what a test then tells."""

from dataclasses import replace

import numpy as np
import pytest
from support.added import any_of, axis, with_effects
from support.quick import few_quick

from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.corrected.batch import batched
from armodal.analyzer.corrected.correction import correction_of, stepped
from armodal.analyzer.corrected.posture import corrected_posture, stand
from armodal.analyzer.corrected.prediction import predict_arm
from armodal.analyzer.gap.library import all_instances, names_of_laws
from armodal.analyzer.gap.model.ordinary import Ordinary
from armodal.analyzer.planning.equations import planned_arm
from armodal.analyzer.planning.excitation import posture_modes
from armodal.analyzer.planning.expected import Instruments, expected_std, information
from armodal.analyzer.planning.selective import plan_tests
from armodal.protocols.arm.files import load_arm
from armodal.protocols.errors import ArmError

Q = np.array([0.2, 0.4, 1.1, -0.5, 0.6, 0.3])
OF_THE_ARM = sorted(
    {
        instance.effect.name
        for instance in all_instances(Ordinary(superset=Superset(load_arm("rv4frl")), postures=()))
        if not instance.effect.of_the_test and instance.effect.name != "link_axis"
    }
    | set(names_of_laws())
)


def test_an_arm_without_effects_is_planned_as_it_is(arm):
    planned = planned_arm(arm)
    assert planned.arm is arm
    assert planned.notes == ()


@pytest.mark.parametrize("kind", few_quick(OF_THE_ARM, "base", "link_bending", "payload", "rotor"))
def test_every_effect_of_the_arm_is_in_the_modes_a_plan_counts_with(arm, kind):
    corrected = with_effects(arm, any_of(arm, kind))
    planned = planned_arm(corrected)
    modes = posture_modes(planned.at(Q))
    (wanted,) = predict_arm(corrected, [np.rad2deg(Q).tolist()], below_hz=200.0)
    # Poles of damping z stand at |s| within z² of the natural frequency; two that lie close move
    # one another by as much as they are damped. Loss factors: 2/pi ln(f / 30 Hz) of the loss.
    loose = 3.0 * float(np.max(wanted.modes.damping_ratio)) ** 2 + 1e-6
    if np.any(wanted.posture.loss):
        loose += float(np.max(wanted.modes.damping_ratio)) * 2.0 / np.pi * np.log(200.0 / 30.0)
    for f_hz in wanted.modes.f_hz:
        assert np.abs(modes.f_hz / f_hz - 1.0).min() < loose
    assert planned.notes


def test_joints_masses_hold_payloads_and_rotors(arm):
    corrected = with_effects(arm, any_of(arm, "payload"), any_of(arm, "rotor"))
    ready = batched(corrected)
    wanted = ready.batch.mass(Q[None])[..., 0] + ready.elastic.terms.mass
    # The same bodies by two ways; rounding of some hundred products.
    found = planned_arm(corrected).joint_mass(Q[None])[..., 0]
    np.testing.assert_allclose(found, wanted, rtol=1e-9, atol=1e-12)
    assert np.abs(found - planned_arm(arm).joint_mass(Q[None])[..., 0]).max() > 1e-3


def test_what_is_of_the_test_is_said_and_what_lacks_is_refused(arm):
    said = planned_arm(with_effects(arm, any_of(arm, "hammer_gain"))).notes
    assert len(said) == 1
    assert "is of the test" in said[0]
    lacking = with_effects(arm, axis("shoulder"))
    bare = replace(lacking.effects[0], parameters=())
    with pytest.raises(ArmError, match="wanted axis_compliance"):
        planned_arm(with_effects(arm, bare))


def test_the_information_on_joints_is_that_of_the_corrected_frfs(arm):
    """Slopes of the FRFs by finite differences of the corrected equations, no mounting error."""
    corrected = with_effects(arm, axis("shoulder"))
    planned, tools = planned_arm(corrected), Instruments(mounting=1e-9, line_hz=2.0, high_hz=80.0)
    direction, points = np.array([0.0, 0.6, 0.8]), ("1", "5")
    asked = {"hit_point": "1", "hit_direction": direction, "points": points, "instruments": tools}
    found = information(planned, planned.at(Q), **asked)
    correction = correction_of(corrected)
    index = planned.superset.point_index
    s = 2j * np.pi * np.arange(tools.low_hz, tools.high_hz, tools.line_hz)

    def frfs(own):
        at = corrected_posture(own, stand(own, Q))
        b = at.point_linear[index["1"]].T @ direction
        o = at.point_linear[[index[p] for p in points]].reshape(-1, len(b))
        return np.array(
            [
                z**2 * o @ np.linalg.solve(z**2 * at.mass + z * at.damping + at.stiffness, b)
                for z in s
            ]
        )

    step = 1e-5
    names = [arm.joints[i].name for i in planned.elastic.joints]
    slopes = [
        (frfs(stepped(correction, {key: step})) - frfs(stepped(correction, {key: -step})))
        / (2.0 * step)
        for key in (f"ln {what} {name}" for what in "kc" for name in names)
    ]
    weight = np.sqrt(tools.hits) * tools.impulse_n_s * 2.0 * np.sqrt(tools.line_hz)
    weight /= tools.acceleration_noise
    flat = weight * np.array([one.ravel() for one in slopes])
    n, k = len(names), len(found) // 2
    rows = [*range(n), *range(k, k + n)]
    wanted = (flat @ flat.conj().T).real
    scale = np.sqrt(np.diag(wanted))
    # A step of 1e-5 in ln k: its square times the third derivative, next to nothing.
    np.testing.assert_allclose(
        found[np.ix_(rows, rows)] / np.outer(scale, scale),
        wanted / np.outer(scale, scale),
        atol=1e-6,
    )
    # The axis is unknown too: the joints are known less well than if it were known.
    known = expected_std([found[np.ix_(rows, rows)]], n)
    assert (expected_std([found], n) > known).all()


def test_a_plan_of_a_corrected_arm_shows_its_joints(arm, small_search):
    corrected = with_effects(arm, axis("shoulder"), any_of(arm, "rotor"), any_of(arm, "bearing"))
    plan = plan_tests(planned_arm(corrected), np.random.default_rng(0), n_tests=4)
    assert np.isfinite(plan.expected_std[-1]).all()
    assert plan.expected_std.shape == (3, 3)
    n_modes = {len(test.modes.f_hz) for test in plan.tests}
    assert min(n_modes) > len(plan.elastic.joints)
    assert all(len(test.hit.share) in n_modes for test in plan.tests)
