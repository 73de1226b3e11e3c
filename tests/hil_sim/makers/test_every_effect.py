"""Every effect goes into every arm, at each place it names, and leaves a machine that stands."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest

from armodal.hil_sim.makers.arms import ARMS, arm_table
from armodal.hil_sim.makers.draw import draw_cases
from armodal.hil_sim.makers.frame.everyday import everyday
from armodal.hil_sim.makers.frame.kit import Kit, stiffer_at_told
from armodal.hil_sim.makers.frame.maker import EFFECTS as FRAME_EFFECTS
from armodal.hil_sim.makers.frame.modal import modal
from armodal.hil_sim.makers.frame.standing import stand
from armodal.hil_sim.makers.making import arms_of
from armodal.hil_sim.makers.mujoco.compiled import compiled
from armodal.hil_sim.makers.mujoco.laboratory import true_angles
from armodal.hil_sim.makers.mujoco.maker import EFFECTS as MUJOCO_EFFECTS
from armodal.hil_sim.makers.mujoco.ordinary import ordinary
from armodal.hil_sim.makers.mujoco.rig import Rig
from armodal.hil_sim.streams import stream

SOME = 1  # arms that `make test` looks at; `make test-all` looks at every one
EVERY_ARM = [
    pytest.param(arm, marks=() if number < SOME else pytest.mark.long)
    for number, arm in enumerate(ARMS)
]


def middle(span):
    return 1.0 if span is None else float(np.sqrt(span[0] * span[1]))


@pytest.mark.parametrize("arm", ARMS)
def test_links_that_bend_or_twist_are_longer_than_wide(arm):
    """A piece along a joint's own axis that twists is that joint in series: no name tells it."""
    table = arm_table(arm)
    shells = {row.link: row.shell for row in table.links}
    for kind in ("link_bending", "link_torsion"):
        places = [
            *FRAME_EFFECTS[kind].where(everyday(table, "rigid", 3)),
            *MUJOCO_EFFECTS[kind].places(ordinary(table, "rigid", 3)),
        ]
        assert all(shells[place].slenderness > 1.0 for place in places)


def test_links_twist_where_no_joint_turns_about_their_line():
    """The 7-axis arms roll and pitch in turn: each long link's line is a joint's axis."""
    for maker in ("frame", "mujoco"):
        assert set(arms_of(maker, "link_torsion")) == {"kr210", "lrmate200id", "ur10e"}
        assert arms_of(maker, "link_bending") == ARMS
        cases = draw_cases(maker, 5, nulls=0, effects=200)
        drawn = {case.arm for case in cases if case.kinds == ("link_torsion",)}
        assert drawn == {"kr210", "lrmate200id", "ur10e"}
    assert arm_table("kr210").twisting_links == ("link_arm",)  # its arm_front turns about A4


@pytest.mark.parametrize("arm", EVERY_ARM)
def test_mujocos_effects_fit_every_arm(arm):
    table = arm_table(arm)
    for wrist in ("elastic", "rigid"):
        drawn = ordinary(table, wrist, 3)
        told = np.deg2rad(table.postures_deg[0])
        for name, effect in MUJOCO_EFFECTS.items():
            for place in effect.places(drawn)[:2]:
                rig = Rig(
                    drawn=drawn,
                    machine=drawn.machine.copy(),
                    bench=drawn.bench,
                    rng=stream(3, name, place),
                )
                json.dumps(effect.put(rig, place, middle(effect.SPAN)), allow_nan=False)
                machine = rig.machine
                plant = compiled(machine, true_angles(drawn, told), 4e-4, slowed=machine.nonlinear)
                # At rest: springs carry what gravity asks of them, to round-off of the solver's.
                assert np.max(np.abs(plant.data.qacc)) < 1e-6, (name, place)


@pytest.mark.parametrize("arm", EVERY_ARM)
def test_the_frames_effects_fit_every_arm(arm):
    table = arm_table(arm)
    for wrist in ("elastic", "rigid"):
        drawn = everyday(table, wrist, 3)
        told = np.deg2rad(table.postures_deg[0])
        plain = modal(stand(drawn.parts, told), 300.0).frequencies_hz
        assert plain[0] > 2.0
        tried = {"released_joint"} if wrist == "rigid" else set(FRAME_EFFECTS)
        for name in sorted(tried):
            effect = FRAME_EFFECTS[name]
            for place in effect.where(drawn)[:1]:
                kit = Kit(
                    drawn=drawn,
                    parts=drawn.parts.copy(),
                    gear=drawn.gear,
                    rng=stream(3, name, place),
                )
                json.dumps(effect.hide(kit, place, middle(effect.RANGE)), allow_nan=False)
                found = modal(stand(kit.parts, told), 300.0).frequencies_hz
                assert found[0] > 0.5, (name, place)


@pytest.mark.parametrize(("stiffer", "is_plate_alone"), [(1.0, False), (1e6, True)])
def test_a_base_is_told_with_its_casting_below_the_first_joint(stiffer, is_plate_alone):
    drawn = everyday(arm_table("ur10e"), "rigid", 3)
    parts = drawn.parts.copy()
    casting = parts.sections["base"]
    parts.sections["base"] = replace(casting, youngs_pa=stiffer * casting.youngs_pa)
    kit = Kit(drawn=drawn, parts=parts, gear=drawn.gear, rng=stream(3, "told"))
    told = FRAME_EFFECTS["base"].hide(kit, "base", 0.05)
    felt = stiffer_at_told(parts.plate_loss) * parts.plate[5, 5]
    # A millionth of the casting's yield is left, which itself is below the plate's.
    assert bool(told["turn_n_m_per_rad"] == pytest.approx(felt, rel=1e-6)) == is_plate_alone
    assert told["turn_n_m_per_rad"] <= felt * (1.0 + 1e-9)
