"""What is recorded of a hit is what the plant does: FRFs of noiseless records are the plant's."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from armodal.hil_sim.makers import make_case
from armodal.hil_sim.makers.arms import arm_table
from armodal.hil_sim.makers.frame.everyday import everyday
from armodal.hil_sim.makers.frame.frfs import felt_per_wrench
from armodal.hil_sim.makers.frame.modal import modal
from armodal.hil_sim.makers.frame.shop import Shop
from armodal.hil_sim.makers.frame.standing import stand
from armodal.hil_sim.makers.mujoco.compiled import compiled, jacobian
from armodal.hil_sim.makers.mujoco.laboratory import Laboratory, site_jacobian, true_angles
from armodal.hil_sim.makers.mujoco.ordinary import ordinary
from armodal.hil_sim.makers.mujoco.small_signal import small_signal
from armodal.protocols.plan_records import KnownMass

SHIFT_RAD_S = 8.0  # by which records have died away at their end to some 1e-6
LINES_HZ = np.array([8.0, 17.0, 33.0, 61.0, 97.0])


@pytest.fixture(scope="module")
def cases():
    return {maker: make_case(maker, 11, "lrmate200id") for maker in ("mujoco", "frame")}


def small_plan(case):
    """One posture, one point, one hit."""
    posture = replace(case.plan.postures[0], points=("4",))
    return replace(case.plan, postures=(posture,), hits_per_point=1)


def frf_of(hit, header):
    """Accelerance, (3, lines), on the shifted lines."""
    scale = np.array([channel.scale for channel in header.dictionary.channels])
    record = hit.counts * scale
    t = np.arange(len(record)) / float(header.plan.sampling.rate_hz)
    kernel = np.exp(-np.outer(SHIFT_RAD_S + 2j * np.pi * LINES_HZ, t))
    spectra = kernel @ record
    return (spectra[:, 1:] / spectra[:, :1]).T


def test_frame_records_hold_the_frames_frfs(cases):
    case, table = cases["frame"], arm_table("lrmate200id")
    drawn = everyday(table, "elastic", 11)
    still = {"tilt_rad": 0.0, "aim_rad": 0.0, "off_m": 0.0, "noise_m_s2": 0.0, "hum_m_s2": 0.0}
    gear = replace(drawn.gear, noise_n=0.0, **still)
    shop = Shop(seed=11, arm=case.arm, drawn=drawn, parts=drawn.parts, gear=gear)
    plan = small_plan(case)
    session = shop.measure(plan, None, None, 0, brakes=False)
    standing = stand(drawn.parts, plan.postures[0].joints_rad)
    s = SHIFT_RAD_S + 2j * np.pi * LINES_HZ
    spot, axes = standing.point("4")
    hit = standing.point(plan.fixed_point)[0]
    (felt,) = felt_per_wrench(standing, modal(standing), s, [spot], [hit], plan.sensor.mass_kg)
    expected = felt[:, :, 0, :3] @ plan.postures[0].hit_direction @ axes
    expected = expected @ gear.response.T / gear.force_gain
    # The highest line lies where counts and the filter's ringing are 1e-4 of the record.
    np.testing.assert_allclose(
        frf_of(session.hits[0], session.header),
        expected.T,
        atol=1e-3 * np.max(np.abs(expected)),
    )


def test_mujocos_records_hold_its_frfs(cases):
    case, table = cases["mujoco"], arm_table("lrmate200id")
    drawn = ordinary(table, "elastic", 11)
    bench = replace(drawn.bench, tilt_rad=0.0, aim_rad=0.0, blow_m=0.0, noise_m_s2=0.0, noise_n=0.0)
    laboratory = Laboratory(
        seed=11, arm=case.arm, ordinary=drawn, machine=drawn.machine, bench=bench
    )
    plan = small_plan(case)
    session = laboratory.measure(plan)
    machine = drawn.machine.copy()
    struck, place = machine.places["4"], machine.places[plan.fixed_point]
    machine.places = {plan.fixed_point: place}
    angles = true_angles(drawn, plan.postures[0].joints_rad)
    plant = compiled(machine, angles, 1e-3)
    J, W, R = site_jacobian(plant)
    linear, _, R_struck = jacobian(plant, struck.body, struck.at_m)
    load = linear.T @ (-R_struck @ struck.R_body_sensor[:, 2])
    s = SHIFT_RAD_S + 2j * np.pi * LINES_HZ
    system = small_signal(plant).with_mass(plan.sensor.mass_kg, J)
    moved = system.receptance(s, load[:, None])[..., 0]
    felt = (moved @ J.T) * (s**2)[:, None] + np.cross(moved @ W.T, plant.model.opt.gravity)
    expected = felt @ R @ bench.sensor.T / bench.hammer_gain
    # The sensor is a cube of a centimetre in the plant, a point here.
    np.testing.assert_allclose(
        frf_of(session.hits[0], session.header),
        expected.T,
        atol=3e-3 * np.max(np.abs(expected)),
    )


@pytest.mark.parametrize("maker", ["mujoco", "frame"])
def test_hits_are_short_pushes_that_reach_the_band(cases, maker):
    session = cases[maker].session(small_plan(cases[maker]), levels_n=(10.0, 30.0, 90.0))
    rate = float(session.header.plan.sampling.rate_hz)
    widths = []
    for hit in session.hits:
        force = hit.counts[:, 0] * session.header.dictionary.channels[0].scale
        peak = int(np.argmax(force))
        assert abs(peak - session.header.plan.sampling.pretrigger) < 0.005 * rate
        # A hammer does not pull: a sharp low pass rings by a seventh at a pulse as short as it.
        assert np.min(force) > -0.15 * force[peak]
        spectrum = np.abs(np.fft.rfft(force))
        hz = np.fft.rfftfreq(len(force), 1.0 / rate)
        band = spectrum[(hz > 3.0) & (hz < 120.0)]
        assert np.min(band) > 0.3 * np.max(band)  # no zero in the band
        widths.append(float(np.max(band) / force[peak]))
    assert widths[0] > widths[2]  # hard hits are short


@pytest.mark.parametrize("maker", ["mujoco", "frame"])
def test_a_known_mass_and_another_run_change_what_they_should(cases, maker):
    case, plan = cases[maker], small_plan(cases[maker])
    once, again, other = (case.session(plan, run=run) for run in (0, 0, 1))
    np.testing.assert_array_equal(once.hits[0].counts, again.hits[0].counts)
    assert np.any(once.hits[0].counts != other.hits[0].counts)
    mass = KnownMass(link="flange", mass_kg=4.0, center_m=np.array([0.0, 0.0, 0.06]))
    loaded = case.session(plan, known_mass=mass)
    before, after = (frf_of(session.hits[0], session.header) for session in (once, loaded))
    assert np.linalg.norm(after - before) > 0.3 * np.linalg.norm(before)  # twice the tool's mass
