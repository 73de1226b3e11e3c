"""A corrected arm in a posture against closed forms and the plain model."""

from dataclasses import replace

import numpy as np
import pytest
from support.added import AXIS_DIRECTION, AXIS_POINT, added, any_of, axis, with_effects

from armodal.analyzer.arm.hysteresis import hysteresis
from armodal.analyzer.arm.reduced import model_modes, reduce_model
from armodal.analyzer.arm.structure import Axis, Structure, believed_structure
from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.corrected.correction import correction_of
from armodal.analyzer.corrected.modes import corrected_modes
from armodal.analyzer.corrected.posture import assembly_at, corrected_posture, stand
from armodal.analyzer.gap.model.dynamic_stiffness import dynamic_stiffness, resists
from armodal.analyzer.gap.model.hypothesis import Hypothesis
from armodal.analyzer.gap.model.ordinary import LOSS_POWER, Ordinary
from armodal.analyzer.gap.model.systems import systems
from armodal.protocols.arm.files import load_arm
from armodal.protocols.errors import ArmError, EstimateError

ARM = load_arm("rv4frl")
Q = np.array([0.2, 0.4, 1.1, -0.5, 0.6, 0.3])
SHAPES = ("aside_a", "aside_b", "turn_a", "turn_b", "flat", "lean")
# The same matrices through eigenvalue solvers: machine epsilon times their condition.
SAME = 1e-9


def posture_of(arm, q=Q, **more):
    correction = correction_of(arm)
    return corrected_posture(correction, stand(correction, q), **more)


def reduced(structure):
    superset = Superset(ARM)
    return reduce_model(superset, superset.posture(Q), structure)


def test_without_effects_it_is_the_plain_model():
    plain = model_modes(reduced(believed_structure(ARM)))
    found = corrected_modes(posture_of(ARM))
    assert found.f_hz == pytest.approx(plain.f_hz, rel=SAME)
    assert found.damping_ratio == pytest.approx(plain.damping_ratio, rel=SAME)


def test_an_axis_of_the_file_is_the_axis_that_identify_fits():
    believed = believed_structure(ARM)
    direction, point = np.array(AXIS_DIRECTION), np.array(AXIS_POINT)
    own = Axis(
        link=2,
        direction=direction,
        point_m=point - direction * (direction @ point),
        stiffness_n_m_per_rad=1e5,
        damping_n_m_s_per_rad=10.0,
    )
    structure = Structure(
        joints=believed.joints,
        stiffness_n_m_per_rad=believed.stiffness_n_m_per_rad,
        damping_n_m_s_per_rad=believed.damping_n_m_s_per_rad,
        axes=(own,),
    )
    wanted = model_modes(reduced(structure))
    found = corrected_modes(posture_of(with_effects(ARM, axis("elbow"))))
    assert found.f_hz == pytest.approx(wanted.f_hz, rel=SAME)
    assert found.damping_ratio == pytest.approx(wanted.damping_ratio, rel=SAME)


def test_a_rotor_is_on_its_joint_s_diagonal_alone():
    plain = posture_of(ARM)
    found = posture_of(with_effects(ARM, added("rotor", "joint_2", rotor=0.7)))
    more = np.zeros_like(plain.mass)
    more[1, 1] = 0.7
    assert found.mass == pytest.approx(plain.mass + more, rel=SAME)
    assert found.stiffness == pytest.approx(plain.stiffness, rel=SAME)


def test_an_encoder_s_offset_is_another_posture():
    offset = added("encoder_offset", "joint_3", encoder=0.05)
    moved = Q + np.array([0.0, 0.0, 0.05, 0.0, 0.0, 0.0])
    found = corrected_modes(posture_of(with_effects(ARM, offset)))
    assert found.f_hz == pytest.approx(corrected_modes(posture_of(ARM, moved)).f_hz, rel=SAME)


@pytest.mark.parametrize("loss", [0.02, 0.2])
def test_with_a_loss_factor_each_pole_solves_the_equations_at_itself(loss):
    more = {f"loss_joint_{i}": loss for i in (1, 2, 3)} | {
        f"ln_c_joint_{i}": 1.0 for i in (1, 2, 3)
    }
    posture = posture_of(with_effects(ARM, added("hysteretic", "whole arm", **more)))
    modes = corrected_modes(posture)
    for s, shape in zip(modes.pole_rad_s, modes.shape.T, strict=True):
        elastic = posture.stiffness + hysteresis(s) * posture.loss
        left = (s**2 * posture.mass + s * posture.damping + elastic) @ shape
        # A pole stands still to 1e-10 of itself.
        assert np.linalg.norm(left) < 1e-7 * np.linalg.norm(elastic @ shape)
    # Of pure hysteresis the damping ratio is half the loss factor (Ewins, 2nd ed., section 2.4.3).
    assert (modes.damping_ratio > 0.4 * loss).all()


@pytest.mark.parametrize(
    "lost",
    [{"loss joint_2": 0.06, LOSS_POWER: 0.9}, {"loss relaxing joint_2": 0.06}],
    ids=["growing", "relaxing"],
)
def test_a_fit_s_own_losses_of_drives_are_in_its_modes(lost):
    correction = correction_of(ARM)
    ordinary = Ordinary(superset=Superset(ARM), postures=())
    values = {p.name: p.mean for p in ordinary.parameters()}
    values |= {name: 0.0 for name in values if name.startswith("loss ")} | lost
    fit = replace(correction, hypothesis=Hypothesis(ordinary=ordinary), values=values)
    at = stand(fit, Q)
    modes = corrected_modes(corrected_posture(fit, at))
    system = systems([assembly_at(fit, at)])
    for pole in modes.pole_rad_s[:3]:
        s = np.array([[pole]])
        Z = dynamic_stiffness(system, s)[0, 0]
        resisted = resists(system, s)[0, 0]
        with np.errstate(invalid="ignore", divide="ignore"):
            own = np.where(np.isnan(system.compliance[0]), 0.0, resisted / system.compliance[0])
        gives = np.flatnonzero(np.isfinite(own))
        Z = Z[np.ix_(gives, gives)] + np.diag(own[gives])
        scale = np.sqrt(np.abs(np.diag(Z)))
        singular = np.linalg.svd(Z / np.outer(scale, scale), compute_uv=False)
        # What moves no mass follows at once, without its dampers' lag: 2e-4 of a pole at 50 Hz.
        # Without these losses it is 0.08.
        assert singular[-1] < 1e-3 * singular[0]


def test_a_law_of_amplitude_is_a_spring_that_follows_the_level():
    arm = with_effects(ARM, any_of(ARM, "softening"))
    plain = corrected_modes(posture_of(ARM)).f_hz
    gently, middle, harder = (
        corrected_modes(posture_of(arm, level=level)).f_hz for level in (-6.0, 0.0, 1.0)
    )
    # What softens goes with the square of the swing: e^-12 of what it is in the middle.
    assert gently == pytest.approx(plain, rel=1e-5)
    assert (middle < 0.99 * gently).any()
    assert (harder < 0.99 * middle).any()


def test_the_tool_moves_as_the_points_beside_it_do():
    correction = correction_of(with_effects(ARM, axis("upper_arm")))
    last = next(p for p in ARM.points if p.link == ARM.joints[-1].link.name)
    posture = corrected_posture(correction, stand(correction, Q), tool_m=last.position_m)
    at = [p.id for p in ARM.points].index(last.id)
    assert posture.tool_jacobian[:3] == pytest.approx(posture.point_linear[at], abs=1e-12)


def test_what_is_of_the_test_changes_no_mode_and_is_said():
    arm = with_effects(ARM, added("delay", "whole arm", delay=1e-3))
    correction = correction_of(arm)
    assert correction.titles == ()
    assert "is of the test that found it" in correction.notes[0]
    assert corrected_modes(posture_of(arm)).f_hz == pytest.approx(
        corrected_modes(posture_of(ARM)).f_hz, rel=SAME
    )


def test_all_that_an_effect_lacks_is_named_at_once():
    arm = with_effects(ARM, added("servo", "joint_1"), added("rotor", "joint_2"))
    with pytest.raises(ArmError) as refused:
        correction_of(arm)
    for key in ("servo_compliance", "servo_loss", "servo_rotor", "rotor of rotor"):
        assert key in str(refused.value)


def test_a_base_without_a_mass_is_refused_as_no_arm_tells_it():
    base = any_of(ARM, "base")
    assert correction_of(with_effects(ARM, base)).values["base mass"] > 0.0
    light = tuple(p for p in base.parameters if p.name not in {"mass", "height"})
    with pytest.raises(ArmError, match=r"mass of base \(base\), height of base \(base\)"):
        correction_of(with_effects(ARM, replace(base, parameters=light)))


def test_an_arm_that_falls_is_refused():
    soft = axis("upper_arm", compliance=1.0)
    with pytest.raises(EstimateError, match="do not hold it against gravity"):
        corrected_modes(posture_of(with_effects(ARM, soft)))


def test_modes_near_each_other_stay_two_with_a_loss_factor():
    """Springs are softer at 5 Hz than at 30: both move further than they are apart."""
    soft = any_of(ARM, "bearing")
    lossy = tuple(
        replace(p, value=0.2) if p.name.endswith("factor") else p for p in soft.parameters
    )
    posture = posture_of(with_effects(ARM, replace(soft, parameters=lossy)))
    first, second, *_ = corrected_modes(posture).f_hz
    assert second > 1.05 * first


@pytest.mark.parametrize(
    ("name", "newer"),
    [
        ("link_bending", ("loss_factor", "taper", "middle", *SHAPES)),
        ("gravity_compensator", ("aside", "stretch", "growth")),
    ],
)
def test_a_file_from_before_a_parameter_was_there_means_none_of_it(name, newer):
    """Such as where along its line a link is soft, or how a spring pulls."""
    effect = any_of(ARM, name)
    older = tuple(p for p in effect.parameters if not p.name.endswith(newer))
    assert len(older) == len(effect.parameters) - len(newer)
    told = tuple(replace(p, value=0.0) if p.name.endswith(newer) else p for p in effect.parameters)
    before, now = (
        corrected_modes(posture_of(with_effects(ARM, replace(effect, parameters=of))))
        for of in (older, told)
    )
    assert before.f_hz == pytest.approx(now.f_hz, rel=SAME)
