"""Input shapers against their definitions, and against an arm that is simulated in time."""

import numpy as np
import pytest
import scipy.signal

from armodal.analyzer.acting.robust import ModeBox, candidates, mode_boxes, recommended
from armodal.analyzer.acting.shaper_page import residual_figure, step_figure, step_response
from armodal.analyzer.acting.shapers import KINDS, convolved, notch, shaper
from armodal.analyzer.corrected.prediction import predict_arm
from armodal.hil_sim.plant import load_plant
from armodal.hil_sim.small_motion import linearise
from armodal.protocols.arm.files import load_arm
from armodal.protocols.errors import EstimateError

F_HZ, DAMPING = 14.0, 0.03


@pytest.mark.parametrize("kind", KINDS)
def test_impulses_sum_to_one_and_leave_what_the_kind_promises(kind):
    own = shaper(kind, F_HZ, DAMPING)
    assert own.amplitude.sum() == pytest.approx(1.0)
    assert own.time_s[0] == 0.0
    left = float(own.residual(F_HZ, 0.0 if kind in ("ei", "2-hump") else DAMPING))
    at = shaper(kind, F_HZ, 0.0).residual(F_HZ, 0.0)
    # ZV and MZV leave nothing, EI a twentieth; of two humps the middle is one of three zeros.
    assert float(at) == pytest.approx(0.05 if kind == "ei" else 0.0, abs=1e-3)
    if kind in ("zv", "mzv"):
        assert left == pytest.approx(0.0, abs=1e-12)


def test_two_humps_stay_below_a_twentieth_over_the_width_of_the_paper():
    own = shaper("2-hump", F_HZ, 0.0)
    # Singhose et al. (1997): 5 % over a band of 0.73 of the frequency for two humps, 0.40 for EI.
    for kind, width in (("2-hump", 0.72), ("ei", 0.39)):
        own = shaper(kind, F_HZ, 0.0)
        f = F_HZ * np.linspace(1.0 - width / 2.0, 1.0 + width / 2.0, 101)
        assert own.residual(f, 0.0).max() < 0.052


def test_the_residual_is_what_an_oscillator_is_left_with():
    own = shaper("ei", 10.0, 0.05)
    f, zeta = 12.5, 0.04
    w = 2.0 * np.pi * f
    s = -zeta * w + 1j * w * np.sqrt(1.0 - zeta**2)
    end = own.time_s[-1]
    # The free motion after impulses is Im of their sum of e^(s (t - t_i)).
    left = abs(np.sum(own.amplitude * np.exp(s * (end - own.time_s))))
    assert float(own.residual(f, zeta)) == pytest.approx(left, rel=1e-12)


def test_a_notch_takes_a_mode_out_of_the_response():
    own = notch(14.0, 0.03, 0.3)
    assert float(own.residual(14.0, 0.03)) == pytest.approx(0.0, abs=1e-12)
    w = 2.0 * np.pi * 14.0
    above, below = [1.0, 2.0 * 0.03 * w, w**2], [1.0, 0.6 * w, w**2]
    ramp = np.linspace(0.0, 4.0, 4001)
    _, out, _ = scipy.signal.lsim((above, below), ramp, ramp)
    assert ramp[-1] - out[-1] == pytest.approx(own.delay_s, rel=1e-3)


def test_two_modes_take_a_shaper_each():
    both = convolved([shaper("zv", 14.0, 0.02), shaper("zv", 22.0, 0.03)])
    assert both.residual([14.0, 22.0], [0.02, 0.03]) == pytest.approx([0.0, 0.0], abs=1e-12)
    assert both.duration_s == pytest.approx(0.5 / 14.0 + 0.5 / 22.0, rel=1e-3)


def test_each_kind_holds_over_its_box_and_the_quickest_good_one_is_taken():
    box = ModeBox(f_hz=(13.0, 15.0), damping_ratio=(0.01, 0.03))
    every = candidates([box])
    by_kind = {own.kind: own for own in every}
    f, z = box.grid()
    for own in every:
        held = own.shaper or own.notches[0]
        assert held.residual(f, z).max() == pytest.approx(own.residual)
    assert by_kind["ei"].residual < 0.06
    assert by_kind["zv"].residual > by_kind["mzv"].residual > by_kind["2-hump"].residual - 0.05
    good = [own for own in every if own.residual <= 0.08]
    assert recommended(every, 0.08).delay_s == min(own.delay_s for own in good)
    assert recommended(every, 0.0).residual == min(own.residual for own in every)


def test_the_simulated_plant_swings_less_than_a_tenth_after_a_shaped_step():
    """A step of joint 1's drive: the plant's own modes, seen by none of the shaper's equations."""
    q = np.array([0.0, 0.5, 0.6, 0.0, 1.4, 0.0])
    plant = load_plant("rv4frl")
    motion = linearise(plant, q, None)
    poles = motion.poles[motion.poles.imag > 0]
    lowest = poles[np.argsort(np.abs(poles))][:2]
    f, zeta = np.abs(lowest) / (2.0 * np.pi), -lowest.real / np.abs(lowest)
    # Known to 3 % of frequency and a fifth of damping.
    boxes = [
        ModeBox(f_hz=(0.97 * a, 1.03 * a), damping_ratio=(0.8 * b, 1.2 * b))
        for a, b in zip(f, zeta, strict=True)
    ]
    n = len(motion.mass)
    drive = np.zeros((2 * n, 1))
    drive[n:, 0] = np.linalg.solve(motion.mass, motion.stiffness[:, 0])
    seen = np.zeros((1, 2 * n))
    seen[0, :n] = 1.0
    system = (motion.state_matrix[: 2 * n, : 2 * n], drive, seen, np.zeros((1, 1)))
    best = {own.kind: own for own in candidates(boxes)}
    step = 2e-4
    time = np.arange(0.0, 1.2, step)

    def swing(command, end_s):
        _, out, _ = scipy.signal.lsim(system, command, time)
        after = out[time > end_s]
        return np.ptp(after[: int(0.3 / step)])

    unshaped = swing(np.ones_like(time), 0.0)
    for kind in ("ei", "2-hump"):
        own = best[kind].shaper
        shaped = sum(a * (time >= t) for a, t in zip(own.amplitude, own.time_s, strict=True))
        left = swing(shaped, own.duration_s)
        assert left < 0.1 * unshaped
        # What was promised of each mode, and what modes above it leave after that time.
        assert left < (best[kind].residual + 0.02) * unshaped


@pytest.mark.parametrize("kind", ["zv", "mzv", "ei", "2-hump", "notch"])
def test_a_drawn_step_is_left_with_what_was_promised(kind):
    """In time, by none of the sums over impulses: the swing after the last, at a box's corners."""
    box = ModeBox(f_hz=(13.0, 15.0), damping_ratio=(0.01, 0.03))
    own = next(one for one in candidates([box]) if one.kind == kind)
    time = np.linspace(0.0, 1.0, 20001)
    for f in box.f_hz:
        for z in box.damping_ratio:
            after = time > own.duration_s + (0.1 if kind == "notch" else 0.0)
            shaped = step_response(own, f, z, time)[after] - 1.0
            # A notch dies away by itself: 0.1 s are several of its time constants.
            loose = 0.02 if kind == "notch" else 0.002
            # Of what a step swings by at once: 1, over the root for a mode that is damped.
            assert np.abs(shaped).max() <= (own.residual + loose) / np.sqrt(1.0 - z**2)
    assert f"after {kind}" in step_figure([box], own).layout.title.text


def test_the_drawn_residual_is_each_kind_s_own():
    box = ModeBox(f_hz=(13.0, 15.0), damping_ratio=(0.02, 0.02))
    every = candidates([box])
    figure = residual_figure([box], every, 0.05)
    for trace, own in zip(figure.data, every, strict=True):
        x, y = np.asarray(trace.x), np.asarray(trace.y)
        inside = (x >= 13.0) & (x <= 15.0)
        # Lines 0.02 Hz apart: a slope of half a per cent a line at most.
        assert y[inside].max() == pytest.approx(100.0 * own.residual, abs=0.6)


def test_boxes_hold_every_posture_s_intervals_and_refuse_what_is_not_known():
    arm = load_arm("ur5")
    found = predict_arm(arm, [(0, -60, 60, 0, 60, 0), (0, -90, 90, 0, 30, 0)])
    with pytest.raises(EstimateError, match="wanted 9 modes"):
        mode_boxes(found, 9)
    box, _ = mode_boxes(found, 2)
    for own in found:
        assert box.f_hz[0] <= own.modes.f_hz[0] - 1.95 * own.f_std_hz[0]
        assert box.f_hz[1] >= own.modes.f_hz[0] + 1.95 * own.f_std_hz[0]
