"""Stability lobes against textbooks' closed forms, against delayed equations, and of an arm."""

import numpy as np
import pytest
from support.added import axis, with_effects

from armodal.analyzer.acting.chatter import depth_map, lobe_diagram, tool_frame, tool_frf
from armodal.analyzer.acting.cutting import Cutter, oriented, tooth_stiffness
from armodal.analyzer.acting.lobes import limit_of_depth, lobes
from armodal.analyzer.acting.semi_discretisation import ToolModes, depth_limit, spectral_radius
from armodal.analyzer.corrected.correction import correction_of
from armodal.analyzer.corrected.posture import corrected_posture, stand
from armodal.protocols.errors import ArmError

# The mill that papers on delayed equations use: Insperger and Stepan, Int. J. Numer. Meth. Engng
# 61 (2004) 117.
OMEGA, ZETA, MASS = 922.0 * 2.0 * np.pi, 0.011, 0.03993
KT, KN = 6e8, 2e8
K = MASS * OMEGA**2


def mill(**changes):
    own = {"teeth": 2, "immersion": 1.0, "down": True}
    return Cutter(tangential_n_per_m2=KT, radial_n_per_m2=KN, **{**own, **changes})


def frf(f_hz, *, in_y=True):
    s = 2j * np.pi * f_hz
    g = 1.0 / (MASS * (s**2 + 2.0 * ZETA * OMEGA * s + OMEGA**2))
    found = np.zeros((len(f_hz), 2, 2), dtype=complex)
    found[:, 0, 0] = g
    found[:, 1, 1] = g if in_y else 0.0
    return found


def modes(*, in_y=True):
    n = 2 if in_y else 1
    return ToolModes(
        omega_rad_s=np.full(n, OMEGA),
        damping_ratio=np.full(n, ZETA),
        shape=np.eye(2)[:, :n] / np.sqrt(MASS),
    )


F_HZ = np.linspace(700.0, 1300.0, 6000)


def test_a_full_slot_of_four_teeth_has_the_textbook_s_limit_of_turning():
    """Two teeth always cut: in feed K_n alone works, evenly, as a tool that turns.

    Altintas, Manufacturing Automation, 2nd ed. (2012), section 4.2: a = 2 k zeta (1 + zeta) / K.
    """
    wanted = 2.0 * K * ZETA * (1.0 + ZETA) / KN
    cutter = mill(teeth=4)
    assert tooth_stiffness(cutter, 30)[:, 0, 0] == pytest.approx(KN, rel=1e-3)
    found = limit_of_depth(cutter, frf(F_HZ, in_y=False))
    assert found == pytest.approx(wanted, rel=1e-4)


@pytest.mark.parametrize("f_hz", [940.0, 960.0, 1000.0])
def test_turning_lobes_are_the_closed_form_s(f_hz):
    """Tobias; Tlusty: a = -1 / (2 K Re G), and the phase of G says at which speeds."""
    cutter = mill(teeth=4)
    (g,) = frf(np.array([f_hz]), in_y=False)[:, 0, 0]
    depth = -1.0 / (2.0 * KN * g.real)
    psi = np.arctan2(g.imag, g.real)
    for waves in (2, 3, 4):
        period = (3.0 * np.pi + 2.0 * psi + 2.0 * np.pi * (waves - 1)) / (2.0 * np.pi * f_hz)
        speed = 60.0 / (cutter.teeth * period)
        (lobe,) = lobes(cutter, frf(F_HZ, in_y=False), F_HZ, np.array([speed]))
        # Where another lobe is lower it is that one which limits.
        assert lobe <= depth * (1.0 + 1e-3)
        radius = [
            spectral_radius(modes(in_y=False), cutter, speed, part * lobe, n_steps=120)
            for part in (0.98, 1.02)
        ]
        assert radius[0] < 1.0 < radius[1]


@pytest.mark.parametrize(
    ("depth_mm", "published"), [(0.2, 0.8192), (0.5, 1.0726), (0.7, 1.2197), (1.0, 1.4039)]
)
def test_the_largest_eigenvalue_of_the_usual_mill_is_the_published_one(depth_mm, published):
    """A full slot of two teeth at 5000 rpm, which papers compare methods by.

    Ding, Zhu, Zhang and Ding, Int. J. Mach. Tools Manuf. 50 (2010) 502: their reference values, by
    a discretisation too. From 200 to 400 steps ours changes by 0.25 % at 1 mm, and converges as
    the square of the steps: 0.3 % is what both have left.
    """
    found = spectral_radius(modes(in_y=False), mill(), 5000.0, 1e-3 * depth_mm, n_steps=200)
    assert found == pytest.approx(published, rel=3e-3)


@pytest.mark.parametrize(
    ("changes", "apart"),
    [
        pytest.param({"teeth": 4}, 0.01, marks=pytest.mark.long),
        ({"teeth": 4, "immersion": 0.5, "down": False}, 0.05),
    ],
)
def test_lobes_are_those_of_the_delayed_equations(changes, apart):
    """Of an even cut exactly; of an interrupted one as far as the mean of its forces tells."""
    cutter = mill(**changes)
    speeds = np.array([6000.0, 9000.0, 17000.0])
    found = lobes(cutter, frf(F_HZ), F_HZ, speeds)
    for speed, depth in zip(speeds, found, strict=True):
        other = depth_limit(modes(), cutter, float(speed), 3.0 * depth, n_steps=60)
        assert other == pytest.approx(depth, rel=apart)


def test_the_mean_of_the_forces_is_the_oriented_coefficients():
    for cutter in (mill(), mill(teeth=3, immersion=0.3, down=False), mill(immersion=0.6)):
        mean = tooth_stiffness(cutter, 400).mean(axis=0)
        wanted = -cutter.teeth * KT / (4.0 * np.pi) * oriented(cutter)
        # F = -a H u, and Altintas' alpha has the other sign.
        assert mean == pytest.approx(wanted, abs=2e-3 * KT)


def test_steps_converge():
    radii = [
        spectral_radius(modes(in_y=False), mill(), 5000.0, 5e-4, n_steps=n) for n in (40, 80, 160)
    ]
    # Halved steps leave a quarter, and less, of the difference.
    assert abs(radii[2] - radii[1]) < 0.3 * abs(radii[1] - radii[0])


ARM = with_effects("rv4frl", axis("shoulder"))
Q = np.deg2rad([0.0, 30.0, 60.0, 0.0, 60.0, 0.0])


def test_an_arm_s_lobes_lie_in_their_band_and_agree_with_the_delayed_equations():
    found = lobe_diagram(
        correction_of(ARM),
        Q,
        mill(teeth=4),
        np.linspace(1500.0, 6000.0, 40),
        directions=tool_frame((1, 0, 0), (0, 0, 1)),
        tool_m=(0.0, 0.0, 0.1),
        n_checks=2,
    )
    assert (found.low_m <= found.high_m).all()
    inside = (found.low_m <= found.depth_m) & (found.depth_m <= found.high_m)
    assert inside.mean() > 0.8
    assert found.always_m <= found.depth_m.min() * (1.0 + 1e-9)
    assert found.always_low_m < found.always_m
    for speed, depth in zip(found.checked_rpm, found.checked_m, strict=True):
        own = found.depth_m[found.speeds_rpm == speed][0]
        # Two of four teeth always cut: even forces. Left are modes taken as lightly damped.
        assert depth == pytest.approx(own, rel=0.05)


def test_the_tool_s_frf_is_static_stiffness_at_no_frequency():
    correction = correction_of(ARM)
    posture = corrected_posture(correction, stand(correction, Q), tool_m=(0, 0, 0.1))
    directions = tool_frame((1, 0, 0), (0, 0, 1))
    (G,) = tool_frf(posture, directions, np.array([1e-4]))
    J = directions @ posture.tool_jacobian[:3]
    assert G.real == pytest.approx(J @ np.linalg.solve(posture.stiffness, J.T), rel=1e-6)


def test_a_map_over_feeds_repeats_after_half_a_turn_and_has_a_best():
    cutter = mill(immersion=0.3)
    feeds, depths = depth_map(
        correction_of(ARM), Q[None], cutter, axis=(0, 0, 1), tool_m=(0, 0, 0.1), n_directions=8
    )
    assert depths.shape == (1, 8)
    assert feeds @ [0.0, 0.0, 1.0] == pytest.approx(0.0)
    # Turned by half a turn feed and normal both change their sign.
    assert depths[0, :4] == pytest.approx(depths[0, 4:], rel=1e-9)
    assert depths.max() > 1.05 * depths.min()


def test_no_cutter_and_no_feed_are_refused():
    with pytest.raises(ArmError, match="wanted a cutter of at least one tooth"):
        mill(teeth=0)
    with pytest.raises(ArmError, match="immersion above 0 and at most 1"):
        mill(immersion=1.5)
    with pytest.raises(ArmError, match="got one along it"):
        tool_frame((0, 0, 1), (0, 0, 2))
    with pytest.raises(ArmError, match="got zeros"):
        tool_frame((0, 0, 0), (0, 0, 1))
