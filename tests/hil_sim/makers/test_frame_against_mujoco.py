"""Two machines that share no line: where the frame is rigid they must be one."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from armodal.hil_sim.makers.arms import ARMS
from armodal.hil_sim.makers.frame import modal as modal_module
from armodal.hil_sim.makers.frame.effects.gravity_compensator import pulled
from armodal.hil_sim.makers.frame.frfs import felt_per_wrench
from armodal.hil_sim.makers.frame.modal import modal
from armodal.hil_sim.makers.frame.standing import stand
from armodal.hil_sim.makers.mujoco.compiled import compiled, jacobian
from armodal.hil_sim.makers.mujoco.laboratory import site_jacobian
from armodal.hil_sim.makers.mujoco.machine import Spring
from armodal.hil_sim.makers.mujoco.small_signal import frequencies_hz, small_signal

STEP_S = 4e-4  # no step is taken


@pytest.mark.parametrize("name", ARMS)
@pytest.mark.parametrize("posture", [pytest.param(0, marks=pytest.mark.long), 2])
def test_rigid_frame_has_mujocos_frequencies_under_gravity(ideal, name, posture):
    """Soft drives, so that gravity is some percent of their stiffness.

    A shell ten thousand times as stiff as the table's still gives way by some 1e-5 of the drives.
    """
    arm = ideal(name, soft=0.05)
    plant = compiled(arm.machine(), arm.by_joint(posture), STEP_S)
    expected = frequencies_hz(small_signal(plant))
    found = modal(stand(arm.parts(), arm.angles(posture))).frequencies_hz[: len(expected)]
    np.testing.assert_allclose(found, expected, atol=0.01)


def test_gravity_matters_in_that_comparison(ideal, monkeypatch):
    arm = ideal("xarm7", soft=0.05)
    weighed = modal(stand(arm.parts(), arm.angles(2))).frequencies_hz[:7]
    monkeypatch.setattr(modal_module, "GRAVITY_M_S2", np.zeros(3))
    weightless = modal(stand(arm.parts(), arm.angles(2))).frequencies_hz[:7]
    assert np.max(np.abs(weighed - weightless)) > 0.05  # five times what is allowed above


def test_a_pulling_spring_is_the_same_on_both(ideal):
    """Beside a soft drive; what its pull does to the structure is of the joint's own size."""
    arm, posture = ideal("ur10e", soft=0.05), 2
    anchor, eye, k, strain = np.array([0.1, -0.05, 0.16]), np.array([-0.2, 0.0, 0.15]), 4e4, 0.2
    links = [row.link for row in arm.table.links[:2]]
    frequencies = []
    for part in (0.0, strain):
        machine, parts = arm.machine(), arm.parts()
        parts.last.append(pulled((links[0], anchor), (links[1], eye), k, part))
        standing = stand(parts, arm.angles(posture))
        ends = standing.place(links[0], anchor), standing.place(links[1], eye)
        rest_m = (1.0 - part) * float(np.linalg.norm(ends[1] - ends[0]))
        ends = (links[0], anchor), (links[1], eye)
        machine.springs.append(Spring(name="spring", ends=ends, stiffness=k, rest_m=rest_m))
        plant = compiled(machine, arm.by_joint(posture), STEP_S)
        expected = frequencies_hz(small_signal(plant))
        found = modal(standing).frequencies_hz[: len(expected)]
        np.testing.assert_allclose(found, expected, atol=0.01)
        frequencies.append(found)
    loose, tight = frequencies
    assert np.max(np.abs(tight - loose)) > 0.05  # five times what is allowed above


def test_sensors_of_a_rigid_frame_feel_what_mujocos_do(ideal):
    """FRFs with the sensor's mass, its place, its axes and gravity in them."""
    arm, kg = ideal("ur10e"), 0.4
    machine, angles = arm.machine(), arm.angles(0)
    standing = stand(arm.parts(), angles)
    s = (0.03 + 1j) * 2.0 * np.pi * np.array([5.0, 9.0, 20.0, 60.0])
    direction = np.array([0.48, -0.6, 0.64])
    names = ("1", "5", "9", "12")
    spots = [standing.point(name)[0] for name in names]
    felt = felt_per_wrench(standing, modal(standing), s, spots, [standing.point("1")[0]], kg)
    for name, one in zip(names, felt, strict=True):
        alone = replace(machine, places={name: machine.places[name]})
        plant = compiled(alone, arm.by_joint(0), STEP_S)
        J, W, R = site_jacobian(plant)
        hit = machine.places["1"]
        load = jacobian(plant, hit.body, hit.at_m)[0].T @ direction
        moved = small_signal(plant).with_mass(kg, J).receptance(s, load[:, None])[..., 0]
        gravity = plant.model.opt.gravity
        expected = (moved @ J.T) * (s**2)[:, None] + np.cross(moved @ W.T, gravity)
        found = one[:, :, 0, :3] @ direction
        # What is left of the frame's compliance, over the width of the lines.
        np.testing.assert_allclose(found, expected, atol=3e-3 * np.max(np.abs(expected)))
        np.testing.assert_allclose(standing.point(name)[1], R, atol=1e-9)
