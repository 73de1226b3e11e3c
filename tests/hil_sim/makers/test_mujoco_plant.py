"""The MuJoCo plant against pinocchio, against itself in time, and against closed forms."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pinocchio as pin
import pytest

from armodal.hil_sim.makers.arm_table import Inertial
from armodal.hil_sim.makers.arms import ARMS
from armodal.hil_sim.makers.belief import urdf_text
from armodal.hil_sim.makers.mujoco.compiled import compiled, jacobian
from armodal.hil_sim.makers.mujoco.in_time import ring_in_time
from armodal.hil_sim.makers.mujoco.laboratory import site_jacobian
from armodal.hil_sim.makers.mujoco.machine import Axis, Body, Machine, Place, Spring, read_machine
from armodal.hil_sim.makers.mujoco.small_signal import (
    frequencies_hz,
    ring_linear,
    small_signal,
)
from armodal.hil_sim.makers.mujoco.split import outer_half

RATE_HZ = 2500.0
STEPS_HZ = 10000.0  # of the laboratory, where hits are simulated in time


@pytest.mark.parametrize("name", ARMS)
def test_frequencies_are_those_of_pinocchios_masses_and_gravity(ideal, name):
    arm = ideal(name)
    plant = compiled(arm.machine(), arm.by_joint(1), 1.0 / RATE_HZ)
    model = pin.buildModelFromXML(urdf_text(arm.table))
    model.gravity.linear = np.array([0.0, 0.0, -9.80665])
    data, q = model.createData(), arm.angles(1)
    M = pin.crba(model, data, q)
    M = np.triu(M) + np.triu(M, 1).T
    slope = pin.computeGeneralizedGravityDerivatives(model, data, q)
    K = np.diag(list(arm.stiffness.values())) + slope
    squared = np.sort(np.linalg.eigvals(np.linalg.solve(M, K)).real)
    np.testing.assert_allclose(
        frequencies_hz(small_signal(plant)), np.sqrt(squared) / (2.0 * np.pi), rtol=1e-6
    )


def test_a_linear_machine_rings_in_time_as_on_its_modes(ideal):
    """A leapfrog step's error at the fastest mode, 130 Hz: (0.08)^2 / 24 of a turn a radian."""
    arm = ideal("ur10e")
    machine = arm.machine()
    machine = replace(machine, places={"5": machine.places["5"]})
    plant = compiled(machine, arm.by_joint(0), 1.0 / STEPS_HZ)
    load = jacobian(plant, "flange", np.array([0.03, 0.0, 0.02]))[0].T @ [0.6, 0.0, 0.8]
    t = np.arange(6000) / STEPS_HZ
    force = 40.0 * np.sin(np.pi * np.clip((t - 0.01) / 0.005, 0.0, 1.0)) ** 2
    (timed,) = ring_in_time([plant], [load], [force])
    a, q = ring_linear(small_signal(plant), load, force, STEPS_HZ)
    J, W, R = site_jacobian(plant)
    linear = (a @ J.T + np.cross(q @ W.T, plant.model.opt.gravity)) @ R
    # Without a shift of any part of a step: 130 Hz for 0.6 s would make 0.4 % of phase.
    error = np.linalg.norm(timed - timed[0] - linear) / np.linalg.norm(linear)
    assert error < 0.005


def test_receptances_are_reciprocal(ideal):
    arm = ideal("kr210")
    system = small_signal(compiled(arm.machine(), arm.by_joint(0), 1.0 / RATE_HZ))
    moved = system.receptance(2j * np.pi * np.array([8.0, 30.0]), np.eye(len(system.M)))
    np.testing.assert_allclose(moved, np.swapaxes(moved, 1, 2), rtol=1e-5, atol=1e-12)


def test_a_cut_link_is_the_whole_one_while_nothing_turns_in_it(ideal):
    arm = ideal("iiwa14")
    whole, cut = arm.machine(), arm.machine()
    row = arm.table.links[1]
    outer, _, tangent = outer_half(cut, row)
    centers = [body.inertial.center_m for body in (outer, cut.bodies[row.link])]
    assert np.subtract(*centers) @ tangent > 0.02
    assert {place.body for place in cut.places.values()} >= {row.link, outer.name}
    found, expected = (
        frequencies_hz(small_signal(compiled(m, arm.by_joint(0), 1.0 / RATE_HZ)))
        for m in (cut, whole)
    )
    np.testing.assert_allclose(found, expected, rtol=1e-6)


def wheel(spring, stiffness=400.0, coulomb=0.0):
    """A wheel of 1 kg m^2 on a torsion spring, about the vertical."""
    axis = Axis(
        name="turn",
        direction=np.array([0.0, 0.0, 1.0]),
        at_m=np.zeros(3),
        stiffness=stiffness,
        damping=0.0,
        coulomb=coulomb,
    )
    body = Body(
        name="wheel",
        parent="",
        T_parent_body=np.eye(4),
        inertial=Inertial.of(1.0, np.zeros(3), np.eye(3)),
        axes=[axis],
    )
    rim = Place(body="wheel", at_m=np.array([1.0, 0.0, 0.0]), R_body_sensor=np.eye(3))
    springs = [] if spring is None else [spring]
    return Machine(bodies={"wheel": body}, places={"rim": rim}, springs=springs)


def turned_over_time(machine, force, seconds=4.0):
    """Angular acceleration of the wheel, from the tangential reading at a metre."""
    plant = compiled(machine, {}, 1.0 / STEPS_HZ)
    pulse = np.zeros(int(seconds * STEPS_HZ))
    pulse[:200] = force
    (reading,) = ring_in_time([plant], [np.array([1.0])], [pulse])
    return reading[:, 1]


def peaks(a):
    inner = a[1:-1]
    return inner[(inner > a[:-2]) & (inner >= a[2:]) & (inner > 0.0)]


def swings_of(a, stiffness, moment):
    """Amplitudes, one a half period, of free vibration with a slider of that moment at its limit.

    At a turning point the acceleration is (k x + M) / J, and J is 1 kg m^2.
    """
    turns = a[200:]
    half = np.flatnonzero(np.diff(np.sign(turns)))
    largest = [np.max(np.abs(turns[i:j])) for i, j in pairwise(half)]
    return (np.array(largest) - moment) / stiffness


def expected_swings(first, n, stiffness, moment, give):
    """Amplitudes, one a half period, that an elastic, perfectly plastic slider leaves.

    From turn to turn the spring loses k (a^2 - b^2) / 2 to the moment M over the way a + b less
    twice what the slider gives before it yields, whose own energy is the same at both.
    """
    swings = [first]
    for _ in range(n - 1):
        a = swings[-1]
        M = moment / stiffness
        swings.append(-M + np.sqrt(M * M + a * a - 2.0 * M * (a - 2.0 * give)))
    return np.array(swings)


def test_coulomb_friction_takes_the_same_from_every_swing():
    """Free vibration loses 4 M / k of amplitude a period (Den Hartog), so peaks fall in a line."""
    moment, stiffness = 1.0, 400.0
    machine = wheel(None, coulomb=moment)
    assert machine.nonlinear
    found = swings_of(turned_over_time(machine, 300.0, seconds=2.0), stiffness, moment)[:10]
    expected = expected_swings(found[0], 10, stiffness, moment, 0.0)
    assert expected[-1] == pytest.approx(found[0] - 9 * 2.0 * moment / stiffness)
    # A slider turns round one step early: a step's part of a radian, 2e-3, of what a swing loses.
    np.testing.assert_allclose(found, expected, rtol=2e-3)


def test_a_jenkins_element_is_a_spring_until_it_yields():
    spring = Spring(name="slip", axes={"turn": 1.0}, stiffness=500.0, yields_at=0.02)
    kept = peaks(turned_over_time(wheel(spring), 0.5)[200:])
    assert kept[-1] == pytest.approx(kept[0], rel=2e-3)  # no loss below the limit
    found = swings_of(turned_over_time(wheel(spring), 400.0), 400.0, 10.0)
    yielding = found[: np.argmax(found < 0.02)]  # below it is a spring again
    assert len(yielding) > 5
    expected = expected_swings(found[0], len(yielding), 400.0, 10.0, 0.02)
    np.testing.assert_allclose(yielding, expected, rtol=2e-3)


def test_a_dead_band_stiffens_with_amplitude():
    gap = Spring(name="gap", axes={"turn": 1.0}, stiffness=600.0, dead_band=0.02)
    times = []
    for force in (5.0, 400.0):
        a = turned_over_time(wheel(gap), force)[200:]
        crossings = np.nonzero((a[:-1] < 0.0) & (a[1:] >= 0.0))[0]
        times.append(np.mean(np.diff(crossings)) / STEPS_HZ)
    inside, beyond = 2.0 * np.pi / np.array(times)
    assert inside == pytest.approx(np.sqrt(400.0), rel=0.01)
    assert np.sqrt(400.0) * 1.1 < beyond < np.sqrt(1000.0)


def test_an_undamped_wheel_keeps_its_energy():
    found = peaks(turned_over_time(wheel(None), 100.0)[200:])
    assert found[-1] == pytest.approx(found[0], rel=2e-3)  # sampled peaks: (omega h)^2 / 8


def test_any_urdf_or_mjcf_is_read(ideal):
    mjcf = """<mujoco><worldbody><body name="a" pos="0 0 1"><joint name="j" axis="0 1 0"/>
    <geom size=".1" mass="2"/><body name="plate" pos="0.2 0 0"><geom size=".05" mass="1"/></body>
    </body></worldbody></mujoco>"""
    body = read_machine(mjcf).moved_by("j")
    assert body.inertial.mass_kg == pytest.approx(3.0)
    assert body.inertial.center_m[0] == pytest.approx(0.2 / 3.0)
    np.testing.assert_allclose(body.drive_axis, [0.0, 1.0, 0.0])
    arm = ideal("lrmate200id")
    assert [body.joint for body in arm.machine().bodies.values()][1:] == list(arm.stiffness)
