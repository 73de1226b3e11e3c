import numpy as np
import pytest
from support.plain_plants import LENGTH, MASS, K, chain, motion_of

from armodal.hil_sim.elements import Sliders


def element_of(effect, **how):
    (element,) = motion_of(chain("y", effects=[effect | {"joint": "joint_1"}], **how)).elements
    return element


def loop(element, amplitude, n=4000):
    """Torque over one closed cycle, the first run-in left out, and the work it takes."""
    memory = np.zeros((1, element.n_memory))
    turns = amplitude * np.sin(np.linspace(0.0, 4.0 * np.pi, 2 * n))
    torque = np.empty(len(turns))
    for i, s in enumerate(turns):
        at = np.array([s])
        torque[i] = element.resist(at, memory)[0][0]
        memory = element.remember(at, memory)
    return torque[n:], float(np.trapezoid(torque[n:], turns[n:]))


def test_coulomb_friction_takes_four_limits_times_the_slip_from_a_cycle():
    friction = {"kind": "friction", "limit_n_m": 0.5, "stiffness_n_m_per_rad": 5000.0}
    element = element_of(friction)
    torque, work = loop(element, 4e-4)
    assert np.max(np.abs(torque)) == pytest.approx(0.5)
    # Slip is the amplitude less the seat's stretch, 0.5 / 5000. A step in 4000 is left.
    assert work == pytest.approx(4.0 * 0.5 * (4e-4 - 1e-4), rel=2e-3)
    assert loop(element, 0.9e-4)[1] == pytest.approx(0.0, abs=1e-9)


@pytest.mark.long
def test_microslip_softens_and_loses_more_the_larger_the_swing():
    friction = {"kind": "friction", "limit_n_m": 0.5, "stiffness_n_m_per_rad": 5000.0}
    element = element_of(friction | {"elements": 6})
    assert isinstance(element, Sliders)
    assert (element.k.sum(), element.limit.sum()) == pytest.approx((5000.0, 0.5))
    sizes = np.array([1e-5, 3e-5, 6e-5, 1e-4])
    loops = [loop(element, size) for size in sizes]
    stiffness = [torque.max() / size for (torque, _), size in zip(loops, sizes, strict=True)]
    lost = np.array([work for _, work in loops]) / sizes**2
    assert np.all(np.diff(stiffness) < 0.0)
    assert np.all(np.diff(lost) > 0.0)


def test_a_softening_joint_keeps_its_stiffness_for_small_motion_and_loses_the_part_for_large():
    element = element_of({"kind": "softening", "part": 0.3, "at_rad": 1e-4})
    small, large = np.array([1e-7]), np.array([2e-3])
    none = np.zeros((1, 0))
    assert (K * small + element.resist(small, none)[0]) / small == pytest.approx(K, rel=1e-5)
    assert K + element.resist(large, none)[1] == pytest.approx(0.7 * K, rel=1e-5)


@pytest.mark.parametrize(("gravity", "load"), [(0.0, 0.0), (9.8, -9.8 * MASS * LENGTH)])
def test_play_is_crossed_only_where_the_swing_outgrows_the_weight(gravity, load):
    # The link lies along x and y points into the picture: weight turns it by +g m L, which the
    # spring holds with -load at rest.
    half = 1e-3
    element = element_of({"kind": "backlash", "half_rad": half}, gravity=gravity)
    none = np.zeros((1, 0))
    stiffness = float(motion_of(chain("y", gravity=0.0)).stiffness[0, 0])
    assert element.load == pytest.approx(-load, rel=1e-9)
    rest = abs(load) / stiffness

    def total(s):
        s = np.array([s])
        return (element.load + stiffness * s + element.resist(s, none)[0])[0]

    assert total(0.0) == pytest.approx(element.load, abs=1e-9)
    side = np.sign(element.load) or 1.0
    # Back through the torque at rest, then nothing over the whole play.
    through = rest if gravity else -half
    assert total(-side * 0.5 * through) == pytest.approx(
        0.5 * element.load if gravity else 0.0, abs=1e-6
    )
    if gravity:
        assert total(-side * (rest + half)) == pytest.approx(0.0, abs=1e-9)
        assert total(-side * (rest + 2.0 * half + 1e-4)) == pytest.approx(
            -side * stiffness * 1e-4, rel=1e-6
        )
