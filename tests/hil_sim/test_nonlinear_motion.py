import numpy as np
import pytest
from scipy.integrate import solve_ivp
from support.modal_response import modal_response
from support.plain_plants import LENGTH, MASS, OWN, K, chain, motion_of

from armodal.hil_sim.elements import Gap, OneSided, Sliders, Softening
from armodal.hil_sim.nonlinear_motion import Drive, nonlinear_response

FINE_HZ = 13_000.0
INERTIA = OWN + MASS * LENGTH**2
ROW = np.array([1.0])


def one_link(element, c=0.02):
    motion = motion_of(chain("z", c=c), point="p1")
    return type(motion)(
        **{
            name: getattr(motion, name) if name != "elements" else (element,)
            for name in motion.__dataclass_fields__
        }
    )


def kicked(motion, impulse, n):
    """Angular acceleration after a short push of a force on the link's end, and the push."""
    force = impulse * FINE_HZ / 8.0 * np.array([0.0, *np.ones(8), 0.0])
    drive = Drive(motion=motion, torque=np.array([LENGTH]), force=force)
    felt = nonlinear_response([drive], FINE_HZ, n)[0]
    return felt[:, 1] / LENGTH, force


def turns(acceleration):
    """Times at which the acceleration changes sign upwards."""
    up = np.flatnonzero((acceleration[:-1] < 0.0) & (acceleration[1:] >= 0.0))
    part = -acceleration[up] / (acceleration[up + 1] - acceleration[up])
    return (up + part) / FINE_HZ


def test_an_element_that_does_nothing_leaves_the_linear_response():
    motion = one_link(OneSided(row=ROW, lost=0.0, opening=0.0))
    felt, force = kicked(motion, 0.3, 4000)
    full = np.concatenate([force, np.zeros(4000 - len(force))])
    linear = modal_response(motion, np.array([LENGTH]), full, FINE_HZ)[:, 1] / LENGTH
    # Both are exact for a force linear between grid points: rounding of 4000 steps is left.
    assert felt == pytest.approx(linear, abs=1e-9 * np.max(np.abs(linear)))


@pytest.mark.long
def test_a_crack_without_gap_swings_half_a_period_on_each_stiffness():
    motion = one_link(OneSided(row=ROW, lost=0.75 * K, opening=0.0))
    felt, _ = kicked(motion, 0.3, 20_000)
    both = np.pi * (np.sqrt(INERTIA / K) + np.sqrt(INERTIA / (0.25 * K)))
    # Each change of sides falls between grid points: a step of 2500 is 4e-4 at most.
    assert np.diff(turns(felt)) == pytest.approx(both, rel=1e-4)


@pytest.mark.long
def test_dry_friction_takes_four_limits_over_stiffness_from_every_cycle():
    limit = 0.4
    stuck = 400.0 * K  # nearly rigid before it slips
    motion = one_link(Sliders(row=ROW, k=np.array([stuck]), limit=np.array([limit])), c=1e-6)
    felt, _ = kicked(motion, 2.0, 9000)
    turning = (INERTIA * np.abs(felt)).reshape(-1)
    period = 2.0 * np.pi * np.sqrt(INERTIA / K) * FINE_HZ
    peaks = [turning[int(i * period) : int((i + 1) * period)].max() for i in range(1, 5)]
    # At the turning point the spring's torque and the friction pull alike: k A + limit. The
    # slider's own stretch of limit / stuck adds 1 / 400.
    assert -np.diff(peaks) == pytest.approx(4.0 * limit, rel=0.01)


@pytest.mark.parametrize(
    "element",
    [
        pytest.param(Softening(row=ROW, soft=0.4 * K, at=5e-4), marks=pytest.mark.long),
        pytest.param(Gap(row=ROW, k=K, half=2e-4, load=0.0), marks=pytest.mark.long),
        Gap(row=ROW, k=K, half=2e-4, load=0.7),
        pytest.param(Gap(row=ROW, k=K, half=2e-4, load=-0.7), marks=pytest.mark.long),
    ],
)
def test_stepping_agrees_with_an_adaptive_integrator(element):
    c, n = 0.02, 2000
    felt, force = kicked(one_link(element, c), 0.3, n)
    t = np.arange(n) / FINE_HZ

    def rate(at, x):
        push = LENGTH * np.interp(at, t[: len(force) + 1], [*force, 0.0], right=0.0)
        extra, _ = element.resist(x[:1], np.zeros((1, 0)))
        return [x[1], (push - K * x[0] - c * x[1] - extra[0]) / INERTIA]

    run = solve_ivp(rate, (0.0, t[-1]), [0.0, 0.0], t_eval=t, rtol=1e-9, atol=1e-12, max_step=1e-4)
    truth = np.array([rate(at, x)[1] for at, x in zip(t, run.y.T, strict=True)])
    # The torque is taken as linear over a step of 1 / 400 of a period: its curvature costs 1e-5 of
    # the phase a period; a corner between two grid points costs a part of a step.
    assert felt == pytest.approx(truth, abs=2e-3 * np.max(np.abs(truth)))


def test_hits_run_side_by_side_as_they_do_alone():
    motion = one_link(Softening(row=ROW, soft=0.4 * K, at=5e-4))
    drives = [
        Drive(motion=motion, torque=np.array([LENGTH]), force=level * np.ones(8))
        for level in (100.0, 800.0)
    ]
    together = nonlinear_response(drives, FINE_HZ, 500)
    for drive, felt in zip(drives, together, strict=True):
        alone = nonlinear_response([drive], FINE_HZ, 500)[0]
        # Newton's method stops a little earlier beside a larger hit.
        assert felt == pytest.approx(alone, abs=1e-7 * np.max(np.abs(alone)))
