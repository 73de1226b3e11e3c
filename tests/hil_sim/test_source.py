from dataclasses import replace
from fractions import Fraction
from functools import partial

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from support.modal_response import modal_response

from armodal.hil_sim.arm_in_cell import arm_in_cell
from armodal.hil_sim.front_end import FULL_SCALE_COUNTS, FrontEnd
from armodal.hil_sim.hand import Blow, Pulse
from armodal.hil_sim.marked_point import with_point
from armodal.hil_sim.newton_euler import (
    inverse_dynamics,
    mass_matrix,
    place,
    point_jacobian,
    with_point_mass,
)
from armodal.hil_sim.operator import Marking
from armodal.hil_sim.plant import build_plant, load_plant
from armodal.hil_sim.ringing import force_history
from armodal.hil_sim.small_motion import Mounting, force_torque, linearise
from armodal.hil_sim.source import SensorSource
from armodal.hil_sim.streams import stream
from armodal.protocols.errors import PlantError

RATE = Fraction(51_200, 31)
POSTURE = np.deg2rad([-25.0, 90.0, 0.0, 0.0, 90.0, 0.0])
SILENT = {"noise_n": 0.0, "flicker_n": 0.0}
SILENT_SENSOR = {"noise_m_s2": 0.0, "flicker_m_s2": 0.0}
# So slow a high pass passes a second unchanged to 1e-5.
NO_HIGHPASS = {"highpass_hz": 1e-6}


def plant_with(hammer=(), sensor=()):
    truth = load_plant("rv4frl").truth
    return build_plant(
        truth.model_copy(
            update={
                "hammer": truth.hammer.model_copy(update=dict(hammer)),
                "accelerometer": truth.accelerometer.model_copy(update=dict(sensor)),
            }
        )
    )


@pytest.fixture(scope="module")
def quiet():
    return plant_with({**SILENT, **NO_HIGHPASS}, {**SILENT_SENSOR, **NO_HIGHPASS})


def straight(plant, point_id):
    """A sensor mounted without tilt."""
    return Mounting(point_id=point_id, R_link_sensor=plant.point(point_id).R_link_sensor)


def source_of(plant, rate=RATE, seed=1):
    source = SensorSource(
        plant, rate, partial(stream, seed), mount=lambda point: straight(plant, point)
    )
    source.set_posture(POSTURE)
    source.mount("5")
    return source


def blow_of(peak_n=100.0, width_s=0.003, point_id="1", direction=(0.0, -0.6, -0.8)):
    return Blow(
        point_id=point_id,
        offset_m=np.zeros(3),
        direction=np.array(direction),
        kind="good",
        pulses=(Pulse(delay_s=0.0, peak_n=peak_n, width_s=width_s),),
    )


def poles_of(decay, order, rate_hz):
    """Continuous poles of sums of decaying exponentials, by the matrix pencil (Hua and Sarkar)."""
    columns = len(decay) // 2
    blocks = [np.lib.stride_tricks.sliding_window_view(c, columns) for c in decay.T]
    V = np.linalg.svd(np.vstack(blocks), full_matrices=False)[2][:order].T
    z = np.linalg.eigvals(np.linalg.pinv(V[:-1]) @ V[1:])
    poles = np.log(z.astype(complex)) * rate_hz
    poles = poles[poles.imag > 0.0]
    return poles[np.argsort(np.abs(poles))]


def test_free_decay_has_the_frequencies_and_damping_of_the_linearised_arm(quiet):
    source = source_of(quiet)
    source.strike(10.3, blow_of())
    counts = source.read(1000)[:, 1:]
    # Force and filter have passed 2 x 20 samples after a 3 ms pulse.
    decay = counts[60:460].astype(float)
    motion = linearise(quiet, POSTURE, straight(quiet, "5"))
    n = len(quiet.springs)
    found = poles_of(decay, 2 * n, float(RATE))
    # Rounding to counts, 0.3 beside 1e4 and more, over 400 samples of decay.
    true = motion.poles[motion.poles.imag > 0.0]
    true = true[np.argsort(np.abs(true))]
    assert np.abs(found) == pytest.approx(np.abs(true), rel=2e-4)
    damping = -found.real / np.abs(found)
    assert damping == pytest.approx(-true.real / np.abs(true), rel=0.01)


def test_counts_do_not_depend_on_how_they_are_read():
    def run(portions):
        source = source_of(load_plant("rv4frl"))
        source.strike(30.25, blow_of())
        source.strike(210.75, blow_of(peak_n=60.0))
        return np.concatenate([source.read(n) for n in portions])

    whole = run([600])
    assert np.array_equal(run([1, 30, 2, 67, 0, 150, 350]), whole)
    assert np.array_equal(run([7] * 85 + [5]), whole)


def test_a_strike_before_the_samples_read_is_felt_from_there_on(quiet):
    early, late = source_of(quiet), source_of(quiet)
    early.strike(5.5, blow_of())
    late.read(20)
    late.strike(5.5, blow_of())
    assert np.array_equal(late.read(300), early.read(320)[20:])


def test_a_sensor_at_rest_reads_white_noise_of_the_stated_level():
    plant = plant_with({"flicker_n": 0.0}, {"flicker_m_s2": 0.0})
    n = 20_000
    counts = source_of(plant).read(n)
    sensor = plant.truth.accelerometer
    per_unit = FrontEnd(plant.truth, RATE).counts_per_unit
    wanted = per_unit * [plant.truth.hammer.noise_n, *(sensor.noise_m_s2,) * 3]
    # Deviation of a deviation from n samples is 1/sqrt(2 n); four of it.
    assert counts.std(axis=0) == pytest.approx(wanted, rel=4.0 / np.sqrt(2.0 * n))
    assert np.all(np.abs(counts.mean(axis=0)) < 4.0 * wanted / np.sqrt(n))


def test_slow_noise_has_the_stated_level():
    plant = plant_with({"noise_n": 0.0}, {"noise_m_s2": 0.0})
    rate, seconds = Fraction(100), 1000
    counts = source_of(plant, rate).read(100 * seconds)
    sensor = plant.truth.accelerometer
    per_unit = FrontEnd(plant.truth, rate).counts_per_unit
    wanted = per_unit * [plant.truth.hammer.flicker_n, *(sensor.flicker_m_s2,) * 3]
    # Noise through a pole at w = 2 pi rad/s: the variance from T seconds scatters by
    # sqrt(2 / (w T)), the deviation by half of that; four of it.
    scatter = 0.5 * np.sqrt(2.0 / (2.0 * np.pi * seconds))
    assert counts.std(axis=0) == pytest.approx(wanted, rel=4.0 * scatter)


def test_a_moving_arm_shakes_the_sensor_and_not_the_hammer(quiet):
    source = source_of(quiet)
    source.set_moving(True)
    n = 5000
    counts = source.read(n)
    sensor = quiet.truth.accelerometer
    wanted = FrontEnd(quiet.truth, RATE).counts_per_unit[1:] * sensor.moving_vibration_m_s2
    assert np.all(counts[:, 0] == 0)
    assert counts[:, 1:].std(axis=0) == pytest.approx(wanted, rel=4.0 / np.sqrt(2.0 * n))


def test_an_overload_stops_at_both_ends_of_the_converter(quiet):
    source = source_of(quiet)
    # Beyond the hammer's range of 5 V / 0.25 mV/N = 20 kN, and far beyond the sensor's 100 m/s2.
    source.strike(5.0, blow_of(peak_n=50_000.0))
    counts = source.read(400)
    assert counts[:, 0].max() == FULL_SCALE_COUNTS
    assert counts[:, 1:].max() == FULL_SCALE_COUNTS
    assert counts[:, 1:].min() == -FULL_SCALE_COUNTS - 1


def test_the_hammer_counts_the_impulse_of_a_half_sine(quiet):
    peak_n, width_s = 100.0, 0.003
    source = source_of(quiet)
    source.strike(5.37, blow_of(peak_n, width_s))
    impulse = source.read(100)[:, 0].sum() / float(RATE)
    hammer = quiet.truth.hammer
    volts = hammer.sensitivity_v_per_n * (1.0 + hammer.gain_error)
    per_n = volts / quiet.truth.board.range_v * FULL_SCALE_COUNTS
    # A half sine on a grid of 79 steps: trapezoids lose (pi/79)^2 / 12 = 1.3e-4 of it.
    assert impulse == pytest.approx(per_n * 2.0 * peak_n * width_s / np.pi, rel=4e-4)


def sampled(front, fine):
    """Through the front end, with nothing that goes on ringing."""
    return front.sample(fine, np.zeros((0, 4)), np.zeros(0), 0)


def test_the_front_end_delays_by_the_stated_samples_on_every_channel(quiet):
    front = FrontEnd(quiet.truth, RATE)
    centre = 30.0
    t = np.arange(100 * front.oversampling) / front.oversampling
    pulse = np.exp(-0.5 * ((t - centre) / 2.0) ** 2)
    counts = sampled(front, np.outer(pulse, np.ones(4)))
    index = np.arange(len(counts))
    centroid = index @ counts / counts.sum(axis=0)
    # A filter linear in phase: exact but for the high pass of 1e-6 Hz, about 1e-5 samples.
    assert centroid == pytest.approx(centre + front.delay_samples, abs=1e-3)


def test_the_front_end_stops_what_would_alias(quiet):
    front = FrontEnd(quiet.truth, RATE)
    t = np.arange(400 * front.oversampling) / front.fine_hz
    per_n = sampled(front, np.outer(np.ones_like(t), [1.0, 0.0, 0.0, 0.0]))[200, 0]

    def passed(part_of_rate):
        tone = np.sin(2.0 * np.pi * part_of_rate * float(RATE) * t)
        inside = slice(2 * front.delay_samples, 400)
        return np.ptp(sampled(front, np.outer(tone, [1.0, 0, 0, 0]))[inside, 0]) / 2.0 / per_n

    # Kaiser window of 8.6: -90 dB; the edges lie at the transition's ends, within 2 dB.
    assert passed(0.53) < 10.0 ** (-85.0 / 20.0)
    assert passed(0.31) == pytest.approx(1.0, abs=0.01)


def full_response(plant, mounting, blow, t):
    """Specific force (n, 3) from the full equations, the mass matrix following the motion."""
    q0 = plant.hinge_angles(POSTURE)
    sensor, hit = plant.point(mounting.point_id), plant.point(blow.point_id)
    chain = with_point_mass(
        plant.chain, sensor.body, sensor.position_m, plant.truth.accelerometer.mass_kg
    )
    springs = list(plant.springs)
    n = len(springs)
    hold = inverse_dynamics(chain, q0, np.zeros(chain.n), np.zeros(chain.n))[springs]

    def angles(free):
        q = q0.copy()
        q[springs] += free
        return q

    def rates(free):
        qd = np.zeros(chain.n)
        qd[springs] = free
        return qd

    def jacobian(at, point):
        position = at.origin_m[point.body] + at.R[point.body] @ point.position_m
        return point_jacobian(at, point.body, position)[:3, springs]

    def acceleration(time, state):
        q, qd = angles(state[:n]), rates(state[n:])
        force = sum(
            p.peak_n * np.sin(np.pi * (time - p.delay_s) / p.width_s)
            for p in blow.pulses
            if p.delay_s < time < p.delay_s + p.width_s
        )
        bias = inverse_dynamics(chain, q, qd, np.zeros(chain.n))[springs]
        torque = jacobian(place(chain, q), hit).T @ (force * blow.direction)
        torque += hold - plant.stiffness * state[:n] - plant.damping * state[n:]
        return np.linalg.solve(mass_matrix(chain, q)[np.ix_(springs, springs)], torque - bias)

    def slope(time, state):
        return np.concatenate([state[n:], acceleration(time, state)])

    width_s = blow.pulses[0].width_s
    during = solve_ivp(
        slope, (0.0, width_s), np.zeros(2 * n), "DOP853", dense_output=True, rtol=1e-9, atol=1e-14
    )
    after = solve_ivp(
        slope, (width_s, t[-1]), during.y[:, -1], "DOP853", dense_output=True, rtol=1e-9, atol=1e-14
    )
    rest = place(chain, q0).R[sensor.body] @ mounting.R_link_sensor
    felt = []
    for time in t:
        state = during.sol(time) if time <= width_s else after.sol(time)
        q, qd = angles(state[:n]), state[n:]
        at = place(chain, q)
        h = 1e-4
        turning = jacobian(place(chain, q + h * rates(qd)), sensor)
        turning -= jacobian(place(chain, q - h * rates(qd)), sensor)
        a = jacobian(at, sensor) @ acceleration(time, state) + turning @ qd / (2.0 * h)
        R = at.R[sensor.body] @ mounting.R_link_sensor
        g = chain.gravity_m_s2
        felt.append(R.T @ (a - g) + rest.T @ g)
    return np.array(felt)


@pytest.mark.long
def test_freezing_the_mass_matrix_costs_less_than_a_thousandth(quiet):
    mounting = straight(quiet, "5")
    blow = blow_of(peak_n=150.0, width_s=0.003)
    fine_hz, every = 100_000.0, 100
    n = 15_001
    motion = linearise(quiet, POSTURE, mounting)
    hit = quiet.point(blow.point_id)
    torque = force_torque(quiet, motion.at, hit.body, hit.position_m, blow.direction)
    force = force_history(blow, 0.0, fine_hz, n)
    frozen = modal_response(motion, torque, force, fine_hz)[::every]
    full = full_response(quiet, mounting, blow, np.arange(n)[::every] / fine_hz)
    error = np.abs(full - frozen).max() / np.abs(frozen).max()
    spread = np.sqrt(np.mean((full - frozen) ** 2) / np.mean(frozen**2))
    # A blow so small that squares of the motion vanish leaves integration and force grid alone.
    faint = replace(blow, pulses=(replace(blow.pulses[0], peak_n=0.15),))
    small = full_response(quiet, mounting, faint, np.arange(n)[::every] / fine_hz)
    faint_error = np.abs(small - frozen / 1000.0).max() / np.abs(frozen / 1000.0).max()
    # Trapezoids of a half sine of 300 steps lose (pi/300)^2 / 12 = 1e-5.
    assert faint_error < 3e-5
    # Motions of 0.1 to 1 mrad turn levers and axes by as much: below a thousandth.
    assert 3e-5 < error < 1e-3
    assert spread < 1e-3


def test_a_freely_hung_mass_moves_by_force_over_mass_along_z():
    mass_kg = 0.8
    plant = plant_with(
        {**SILENT, **NO_HIGHPASS, "gain_error": 0.0},
        {**SILENT_SENSOR, **NO_HIGHPASS, "response": ((1, 0, 0), (0, 1, 0), (0, 0, 1))},
    )
    source = SensorSource(plant, RATE, partial(stream, 1), lambda name: straight(plant, name))
    source.set_posture(POSTURE)
    source.mount("1")
    blow = Blow(
        point_id="1",
        offset_m=np.zeros(3),
        direction=np.array([0.0, 0.0, 1.0]),
        kind="good",
        pulses=(Pulse(delay_s=0.0, peak_n=50.0, width_s=3e-3),),
        free_mass_kg=mass_kg,
    )
    source.strike(50.3, blow)
    units = source.read(400) / FrontEnd(plant.truth, RATE).counts_per_unit
    # Rounding to whole counts on both sides.
    assert units[:, 3] @ units[:, 0] / (units[:, 0] @ units[:, 0]) == pytest.approx(
        1.0 / mass_kg, rel=1e-3
    )
    assert np.abs(units[:, 1:3]).max() < 1e-3 * np.abs(units[:, 3]).max()


@pytest.mark.parametrize("moved", ["1", "5"])
def test_a_point_marked_anew_is_hit_and_measured_where_it_is(quiet, moved):
    """Against a source whose arm had the point there from the beginning."""
    old = quiet.point(moved)
    marking = Marking(
        position_m=tuple(old.position_m + 0.03 * old.R_link_sensor[:, 0]),
        normal=tuple(old.R_link_sensor[:, 1]),
        x_axis=tuple(old.R_link_sensor[:, 2]),
    )
    elsewhere = with_point(quiet, moved, marking)
    late, early, still = (
        SensorSource(quiet, RATE, partial(stream, 1)),
        *(SensorSource(plant, RATE, partial(stream, 1)) for plant in (elsewhere, quiet)),
    )
    counts = []
    for source in (late, early, still):
        source.set_posture(POSTURE)
        if source is late:
            source.take_points(elsewhere)
        source.mount("5")
        source.strike(3.4, blow_of())
        counts.append(source.read(400))
    np.testing.assert_array_equal(counts[0], counts[1])
    assert np.abs(counts[0] - counts[2])[:, 1:].max() > 100


def test_a_sensor_that_sits_on_a_point_is_taken_along_when_it_is_marked_anew(quiet):
    old = quiet.point("5")
    R = old.R_link_sensor
    marking = Marking(
        position_m=tuple(old.position_m), normal=tuple(-R[:, 2]), x_axis=tuple(R[:, 0])
    )
    turned = with_point(quiet, "5", marking)
    hands = arm_in_cell(quiet, seed=1)
    source = hands.make_source(RATE)
    source.set_posture(POSTURE)
    source.mount("5")
    before = np.array(hands.mounted()["R_link_sensor"])
    hands.mark("5", marking)
    after = np.array(hands.mounted()["R_link_sensor"])
    tilt = np.deg2rad(10.0 * quiet.truth.accelerometer.mount_tilt_deg + 1e-6)
    assert np.arccos(before[:, 2] @ after[:, 2]) > np.pi - 2.0 * tilt
    assert after[:, 0] @ turned.point("5").R_link_sensor[:, 0] > np.cos(tilt)


def test_a_point_that_the_arm_has_not_and_a_place_without_axes_are_refused(quiet):
    marking = Marking(position_m=(0.0, 0.0, 0.1), normal=(0.0, 0.0, 1.0), x_axis=(1.0, 0.0, 0.0))
    with pytest.raises(PlantError, match="no test point '99'"):
        with_point(quiet, "99", marking)
    crooked = replace(marking, x_axis=(0.0, 0.6, 0.8))
    with pytest.raises(PlantError, match="at right angles"):
        with_point(quiet, "1", crooked)
