"""FRFs of a hypothesis beside other ways to the same number, and their derivatives."""

from dataclasses import replace

import numpy as np
import pytest
from support.bench_effects import FIRST, JOINTS, OTHERS, at_end
from support.without_errors import without_errors, without_soft_parts

from armodal.analyzer.arm.reduced import reduce_model
from armodal.analyzer.arm.structure import believed_structure
from armodal.analyzer.gap.effects import channel_gain, link_axis, sensor_axes, wrong_point
from armodal.analyzer.gap.library import all_instances
from armodal.analyzer.gap.model.dynamic_stiffness import resists
from armodal.analyzer.gap.model.hypothesis import Hypothesis
from armodal.analyzer.gap.model.posed import Postures

AXIS = np.array([0.6, 0.0, 0.8])


def test_without_errors_it_is_the_reduced_model_mounting_by_mounting(
    superset, lines, ordinary, posed
):
    """Every compliance and error at zero: the FRFs of joints on springs, solved point by point."""
    space = Hypothesis(ordinary=ordinary).space()
    values = without_errors(space.values(space.start()))
    got = posed.values(Hypothesis(ordinary=ordinary), lines, values)
    dynamics = superset.posture(JOINTS)
    gravity = dynamics.gravity_m_s2
    for m in (0, 7, 16):
        added = np.zeros(len(superset.arm.points))
        added[m] = lines.sensor_mass_kg
        model = reduce_model(
            superset, dynamics, believed_structure(superset.arm), added_mass_kg=added
        )
        J, R = model.point_jacobian[m], dynamics.point_rotation[m]
        b = model.point_jacobian[0][:3].T @ lines.hit_direction[0]
        for i, s in enumerate(lines.s_rad_s):
            x = np.linalg.solve(s * s * model.mass + s * model.damping + model.stiffness, b)
            want = R.T @ (s * s * J[:3] @ x + np.cross(J[3:] @ x, gravity))
            np.testing.assert_allclose(got[m, :, i], want, rtol=1e-9, atol=1e-14)


def test_a_gain_is_a_straight_line_of_masses_springs_and_dampers(lines, ordinary, posed):
    """An arm 1.3 times as heavy, stiff and damped answers as one whose hammer reads 1.3 too much.

    As logarithms they all move alike, so that a fit can go from one to the other in one step.
    """
    hypothesis = Hypothesis(ordinary=ordinary)
    space = hypothesis.space()
    values = without_soft_parts(space.values(space.start()))
    without_sensor = replace(lines, sensor_mass_kg=0.0)
    step = np.log(1.3)
    heavier = {
        name: value + step if name.startswith(("ln mass ", "ln k ", "ln c ")) else value
        for name, value in values.items()
    }
    gain = {**values, "ln hammer": values["ln hammer"] + step}
    got = posed.values(hypothesis, without_sensor, heavier)
    want = posed.values(hypothesis, without_sensor, gain)
    assert np.max(np.abs(want)) > 0.0
    # Equal by the equations: what is left is rounding, 1e-16 times their condition, about 1e4.
    np.testing.assert_allclose(got, want, rtol=1e-9, atol=1e-12 * np.max(np.abs(want)))


def test_a_compliance_of_zero_is_the_model_without_it(lines, ordinary, posed):
    axis = link_axis.at_axis(ordinary, 1, AXIS, np.array([0.1, 0.0, 0.05]))
    plain, with_axis = (
        Hypothesis(ordinary=ordinary),
        Hypothesis(ordinary=ordinary, instances=(axis,)),
    )
    space = with_axis.space()
    values = space.values(space.start())
    np.testing.assert_allclose(
        posed.values(with_axis, lines, values),
        posed.values(plain, lines, values),
        rtol=1e-10,
    )


def test_axis_in_a_joint_s_own_line_is_a_spring_in_series(lines, ordinary, posed):
    """Joint 2 and a compliance about its own axis: 1/k adds, checked without either's damper."""
    joint = ordinary.arm.joints[1]
    axis = link_axis.at_axis(ordinary, 1, np.asarray(joint.axis), np.zeros(3))
    plain = Hypothesis(ordinary=ordinary)
    both = Hypothesis(ordinary=ordinary, instances=(axis,))
    space = both.space()
    values = without_errors(space.values(space.start())) | {f"ln c {joint.name}": -40.0}
    gamma = 0.3 / joint.stiffness.value
    names = [p.name for p in axis.parameters]
    in_series = values | {names[0]: gamma, names[1]: 0.0, names[2]: 0.0}
    softer = values | {f"ln k {joint.name}": -np.log(1.0 / joint.stiffness.value + gamma)}
    np.testing.assert_allclose(
        posed.values(both, lines, in_series),
        posed.values(plain, lines, softer),
        rtol=2e-6,  # gravity's stiffness, a thousandth of k, acts on each of the two: its square
    )


def _in_files_and_tests(ordinary):
    axis = link_axis.at_axis(ordinary, 2, AXIS, np.array([0.02, 0.03, 0.01]))
    gain = channel_gain.at_point(ordinary, "y", "k2")
    swap = sensor_axes.turned_sensor(ordinary, np.eye(3)[[1, 0, 2]], "l1")
    place = np.array([0.1, 0.0, 0.02])
    split = link_axis.at_axis(ordinary, 2, AXIS, place, before=("k1",))
    moved = wrong_point.beside(ordinary, "k2")
    return (axis, gain, swap, split, moved)


def _by_central_differences(posed, hypothesis, lines, u, i, h=1e-4):
    space, step = hypothesis.space(), h * np.eye(len(u))[i]
    more, less = (posed.values(hypothesis, lines, space.values(u + s * step)) for s in (1, -1))
    return (more - less) / (2 * h)


@pytest.mark.parametrize("places", [FIRST, pytest.param(OTHERS, marks=pytest.mark.long)])
def test_derivatives_are_those_of_differences_for_every_effect(lines, ordinary, posed, places):
    """One hypothesis at a time, at its first and its last place, away from zero.

    2 % where gravity's part of an inertia is left.
    """
    instances = at_end(all_instances(ordinary), places)
    if places is FIRST:
        instances += _in_files_and_tests(ordinary)
    for instance in instances:
        rng = np.random.default_rng(5)
        hypothesis = Hypothesis(ordinary=ordinary, instances=(instance,))
        space = hypothesis.space()
        u = np.clip(space.start() + 0.2 * rng.random(len(space)), space.low, space.high)
        own = [space.index[name] for name in instance.owned]
        u[own] = np.clip(u[own] + 0.05, space.low[own], space.high[own])
        _, dy = posed.derivatives(hypothesis, lines, space, space.values(u))
        angles = [space.index[f"encoder {ordinary.arm.joints[i].name}"] for i in (1, 2)]
        if instance.effect.name in ("load_damping", "nonproportional"):
            angles = []  # their damping follows the angles too, by 3 %, which is left out
        checked = {*own, *angles, *rng.choice(len(space), 6, replace=False).tolist()}
        for i in checked:
            want = _by_central_differences(posed, hypothesis, lines, u, i)
            size = np.abs(want).max()
            name = space.parameters[i].name
            np.testing.assert_allclose(
                dy[i], want, atol=0.02 * size + 1e-12, err_msg=f"{instance.title}: {name}"
            )


def test_derivatives_by_what_is_locked_are_those_of_its_first_bit(lines, ordinary, posed):
    """Every second compliance is zero: its coordinate is left out, and beside it others move."""
    axis = link_axis.at_axis(ordinary, 1, AXIS, np.array([0.1, 0.0, 0.05]))
    hypothesis = Hypothesis(ordinary=ordinary, instances=(axis,))
    space = hypothesis.space()
    values = space.values(np.clip(space.start() + 0.1, space.low, space.high))
    together = Postures([posed], [lines])
    (assembly,) = together.assembled(hypothesis, values)
    locked = [axis.size, *[name for name in assembly.compliance_of if name != axis.size][::2]]
    values |= dict.fromkeys(locked, 0.0)
    found = together.response(hypothesis, values)
    assert 0 < len(found.moving) < found.whole.compliance.shape[1]
    y, dy = together.derivatives(hypothesis, space, values)
    for name in locked:
        step = 1e-4 * space.std[space.index[name]]  # one-sided: its square is left out
        more = posed.values(hypothesis, lines, values | {name: step})
        want = (more - y[0]) / 1e-4
        atol = 2e-3 * np.abs(want).max() + 1e-12
        np.testing.assert_allclose(dy[space.index[name], 0], want, atol=atol, err_msg=name)


def test_a_damper_stretches_with_what_moves_a_coordinate_otherwise(lines, ordinary, posed):
    """The base's pivot, an axis's place and a wrist's ratio, beside a damper of one deviation."""
    kinds = {i.effect.name: i for i in all_instances(ordinary)}
    axis = link_axis.at_axis(ordinary, 2, AXIS, np.array([0.02, 0.03, 0.01]))
    damper = kinds["nonproportional"]
    others = [
        (kinds["base"], ["base pivot", "base turn"]),
        (axis, [p.name for p in axis.parameters[2:]]),
        (kinds["wrist_coupling"], [kinds["wrist_coupling"].size]),
    ]
    for other, names in others:
        hypothesis = Hypothesis(ordinary=ordinary, instances=(other, damper))
        space = hypothesis.space()
        u = np.clip(space.start() + 0.3, space.low, space.high)
        u[space.index[damper.size]] = 1.0
        u[space.index["base rock x"]] += 0.5  # not as soft as about the other line
        _, dy = posed.derivatives(hypothesis, lines, space, space.values(u))
        for name in names:
            i = space.index[name]
            want = _by_central_differences(posed, hypothesis, lines, u, i)
            # Central differences, derivatives in single precision.
            np.testing.assert_allclose(
                dy[i], want, atol=1e-3 * np.abs(want).max(), rtol=0, err_msg=name
            )


def test_a_base_turned_a_quarter_is_one_that_rocks_about_the_other_line(lines, ordinary, posed):
    (base,) = (i for i in all_instances(ordinary) if i.effect.name == "base")
    hypothesis = Hypothesis(ordinary=ordinary, instances=(base,))
    space = hypothesis.space()
    values = space.values(space.start())
    soft, stiff = 2e-6, 5e-7

    def response(x, y, turn):
        here = {**values, "base rock x": x, "base rock y": y, "base turn": turn}
        return Postures([posed], [lines]).response(hypothesis, here).values

    along = response(soft, stiff, 0.0)
    np.testing.assert_allclose(
        response(stiff, soft, np.pi / 2), along, rtol=1e-9, atol=1e-9 * np.abs(along).max()
    )
    between = response(soft, stiff, np.pi / 4)
    assert np.abs(between - along).max() > 1e-3 * np.abs(along).max()


def test_the_equations_are_reciprocal(lines, ordinary, posed):
    """H is symmetric: loads and motions of the coordinates exchange."""
    hypothesis = Hypothesis(ordinary=ordinary)
    space = hypothesis.space()
    found = Postures([posed], [lines]).response(hypothesis, space.values(space.start()))
    system = found.system
    scale = np.where(
        np.isfinite(system.compliance[0]),
        system.compliance[0] / resists(system, lines.s_rad_s[None])[0],
        1.0,
    )
    H = found.inner[0] * scale[:, None, :]
    np.testing.assert_allclose(H, H.swapaxes(1, 2), rtol=1e-8, atol=1e-18)
