"""Effects that stay as they are while joints are fitted, against the corrected posture."""

from dataclasses import replace

import numpy as np
import pytest
from support.added import added, any_of, axis, with_effects
from support.quick import few_quick

from armodal.analyzer.arm.reduced import model_modes, reduce_model
from armodal.analyzer.arm.structure import believed_structure
from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.corrected.correction import correction_of
from armodal.analyzer.corrected.held import held_arm
from armodal.analyzer.corrected.modes import corrected_modes
from armodal.analyzer.corrected.posture import corrected_posture, stand
from armodal.protocols.arm.files import load_arm
from armodal.protocols.errors import ArmError

ARM = load_arm("rv4frl")
Q = np.array([0.2, 0.4, 1.1, -0.5, 0.6, 0.3])
KINDS = ("bearing", "base", "coupling", "rotor", "payload", "released_joint")


def without_loss_factor(effect):
    kept = tuple(p for p in effect.parameters if not p.name.endswith("loss_factor"))
    return replace(effect, parameters=kept)


def held_modes(arm):
    ready = held_arm(arm)
    superset = Superset(ready.arm)
    structure = believed_structure(ready.arm)
    structure = type(structure)(
        joints=structure.joints,
        stiffness_n_m_per_rad=structure.stiffness_n_m_per_rad,
        damping_n_m_s_per_rad=structure.damping_n_m_s_per_rad,
        axes=ready.axes,
        held=ready.held,
    )
    return model_modes(reduce_model(superset, superset.posture(Q), structure))


@pytest.mark.parametrize("kind", few_quick([*KINDS, "axis and all"], "base", "axis and all"))
def test_a_structure_with_held_effects_has_the_corrected_arm_s_modes(kind):
    """Without loss factors: those count as dashpots."""
    several = (axis("elbow"), any_of(ARM, "rotor"), any_of(ARM, "coupling"), any_of(ARM, "payload"))
    effects = several if kind == "axis and all" else (any_of(ARM, kind),)
    arm = with_effects(ARM, *map(without_loss_factor, effects))
    correction = correction_of(arm)
    wanted = corrected_modes(corrected_posture(correction, stand(correction, Q)))
    found = held_modes(arm)
    # The same matrices through two solvers.
    assert found.f_hz == pytest.approx(wanted.f_hz, rel=1e-7)
    assert found.damping_ratio == pytest.approx(wanted.damping_ratio, rel=1e-6)


def test_an_axis_is_fitted_anew_and_the_rest_is_held_and_both_are_said():
    ready = held_arm(with_effects(ARM, axis("elbow"), any_of(ARM, "rotor")))
    assert len(ready.axes) == 1
    held, anew = ready.notes
    assert held.startswith("as the arm file has them, not fitted: Motor")
    assert anew.startswith("fitted anew from where the arm file has them: ")
    assert anew.endswith("(elbow)")


def test_a_loss_factor_is_held_as_a_dashpot_that_loses_as_much_and_that_is_said():
    factor, compliance = 0.06, 1e-5
    plain, lossy = axis("elbow", compliance, 0.0), axis("elbow", compliance, 0.0)
    told = added("", "", axis_loss_factor=factor).parameters
    ready = held_arm(with_effects(ARM, replace(lossy, parameters=(*lossy.parameters, *told))))
    assert any("as much at 30 Hz" in note for note in ready.notes)
    assert not any("as much at 30 Hz" in n for n in held_arm(with_effects(ARM, plain)).notes)
    (found,) = ready.axes
    lost = found.damping_n_m_s_per_rad * 2.0 * np.pi * 30.0 / found.stiffness_n_m_per_rad
    assert lost == pytest.approx(factor)


def test_what_cannot_be_held_is_named_with_its_reason_all_at_once():
    arm = with_effects(
        ARM,
        any_of(ARM, "servo"),
        any_of(ARM, "wrist_coupling"),
        any_of(ARM, "link_torsion"),
        any_of(ARM, "encoder_offset"),
        added("hysteretic", "whole arm", loss_joint_1=0.1),
    )
    with pytest.raises(ArmError) as refused:
        held_arm(arm)
    for why in (
        "hangs on a joint's stiffness",
        "another one's spring",
        "divides a link",
        "moves an angle",
        "gives a joint a loss factor",
    ):
        assert why in str(refused.value)


def test_a_plain_arm_is_as_it_was():
    ready = held_arm(ARM)
    assert ready.arm is ARM
    assert (ready.axes, ready.held, ready.notes) == ((), None, ())
