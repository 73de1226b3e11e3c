"""Many postures of a corrected arm at once, against one posture at a time."""

from dataclasses import replace

import numpy as np
import pytest
from support.added import added, any_of, axis, with_effects
from support.quick import few_quick

from armodal.analyzer.corrected.batch import batched
from armodal.analyzer.corrected.chain import chain_of
from armodal.analyzer.corrected.correction import correction_of
from armodal.analyzer.corrected.modes import corrected_modes
from armodal.analyzer.corrected.posture import corrected_posture, stand
from armodal.analyzer.statics.deflection import deflect
from armodal.analyzer.workspace.postures import random_postures
from armodal.analyzer.workspace.spectrum import spectrum
from armodal.protocols.arm.files import load_arm
from armodal.protocols.errors import ArmError

# Gravity's small stiffness is not in a batch; next to none leaves springs to compare.
ARM = replace(load_arm("rv4frl"), gravity_m_s2=np.array([0.0, 0.0, -1e-9]))
POINT = next(p.id for p in ARM.points if p.link == "upper_arm")
TOOL = (0.02, -0.01, 0.08)
BY_NAME = {
    name: any_of(ARM, name)
    for name in (
        "base",
        "bearing",
        "coupling",
        "encoder_offset",
        "link_bending",
        "link_torsion",
        "payload",
        "released_joint",
        "rotor",
        "servo",
        "wrist_coupling",
    )
}


def axis_beyond_a_part():
    effect = axis("upper_arm", points_before=POINT)
    pieces = added("", "", axis_mass_before=0.3, axis_mass_spread=0.5).parameters
    return replace(effect, parameters=(*effect.parameters, *pieces))


EFFECTS = {name: (effect,) for name, effect in BY_NAME.items()} | {
    "axis": (axis("elbow"),),
    "axis with a part of the link before it": (axis_beyond_a_part(),),
    "three": (axis("shoulder"), BY_NAME["bearing"], BY_NAME["rotor"]),
}


@pytest.mark.parametrize("kind", few_quick(EFFECTS, "base", "encoder_offset", "servo", "three"))
def test_matrices_are_those_of_one_posture(kind):
    arm = with_effects(ARM, *EFFECTS[kind])
    ready, correction = batched(arm), correction_of(arm)
    q = random_postures(arm, 3, np.random.default_rng(2))
    mass = ready.batch.mass(q)
    motion, tool = ready.batch.unit_motions(q, TOOL)
    for number, angles in enumerate(q):
        own = corrected_posture(correction, stand(correction, angles), tool_m=TOOL)
        # Sums of some hundred products: rounding, of the largest.
        assert ready.elastic.names(arm) == own.names
        assert mass[..., number] + ready.elastic.terms.mass == pytest.approx(own.mass, abs=1e-9)
        assert motion[..., number] == pytest.approx(own.tool_jacobian, abs=1e-9)
        assert tool[:, number] == pytest.approx(own.tool_m, abs=1e-9)
        springs = ready.elastic.terms.stiffness
        assert springs == pytest.approx(own.stiffness, rel=1e-9, abs=1e-7)


def elastic_k():
    return [joint.stiffness.value for joint in ARM.joints if joint.stiffness is not None]


def test_modes_with_a_loss_factor_are_its_to_first_order():
    more = {f"loss_joint_{i}": 0.05 for i in (1, 2, 3)}
    arm = with_effects(ARM, added("hysteretic", "whole arm", **more))
    ready, correction = batched(arm), correction_of(arm)
    q = random_postures(arm, 4, np.random.default_rng(5))
    found = spectrum(ready.batch, q, ready.elastic)
    for number, angles in enumerate(q):
        posture = corrected_posture(correction, stand(correction, angles))
        exact = corrected_modes(posture)
        # Damping and loss of 0.1 in all: their squares are a hundredth.
        assert found.f_hz[number] == pytest.approx(exact.f_hz, rel=0.01)
        assert found.damping_ratio[number] == pytest.approx(exact.damping_ratio, rel=0.05)


def test_what_gives_way_moves_the_tool_as_its_compliance_says():
    arm = with_effects(ARM, axis("shoulder", compliance=2e-5))
    ready = batched(arm)
    q = np.array([[0.1, 0.5, 1.0, 0.0, 0.5, 0.0]])
    load = np.array([0.0, 50.0, -80.0, 0.0, 0.0, 0.0])
    found = deflect(ready.batch, ready.elastic, q, load, tool_m=TOOL)
    motion, _ = ready.batch.unit_motions(q, TOOL)
    J = motion[..., 0]
    k = np.append(elastic_k(), 1.0 / 2e-5)
    assert found.displacement_m[0] == pytest.approx((J @ ((J.T @ load) / k))[:3], rel=1e-9)
    assert found.names[-1] == "axis compliance shoulder"


def test_effects_that_change_with_the_posture_are_refused_by_name():
    arm = with_effects(ARM, any_of(ARM, "load_damping"), any_of(ARM, "gravity_compensator"))
    with pytest.raises(ArmError) as refused:
        chain_of(correction_of(arm))
    assert "load" in str(refused.value)
    assert "ompensator" in str(refused.value)
