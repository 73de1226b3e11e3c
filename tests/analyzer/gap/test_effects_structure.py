"""Effects of links, drives and dampers beside small models that share nothing with them."""

from dataclasses import replace

import numpy as np
import pytest
from support.bench_effects import JOINTS, instance_of, start_of

from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.gap.effects import link_axis
from armodal.analyzer.gap.effects.gravity_compensator import shares
from armodal.analyzer.gap.effects.load_damping import gravity_load
from armodal.analyzer.gap.effects.nonproportional import FLOOR
from armodal.analyzer.gap.effects.yielding_line import YieldingLine
from armodal.analyzer.gap.library import all_instances
from armodal.analyzer.gap.model.assembly import spatial_inertia
from armodal.analyzer.gap.model.geometry import GeometryNear, skew
from armodal.analyzer.gap.model.hypothesis import Hypothesis
from armodal.analyzer.gap.model.long_links import SLICES, LongLink, long_links, span_m
from armodal.analyzer.gap.model.ordinary import Ordinary
from armodal.analyzer.gap.model.system import Pieces
from armodal.analyzer.gap.search.candidates import goes_with
from armodal.hil_sim.study import study_arm
from armodal.protocols.arm.files import load_arm
from armodal.protocols.plan_records import KnownMass

WAYS = 2  # directions across about which a bending link has hinges at each place
INERTIA = spatial_inertia(3.0, np.array([0.2, 0.05, -0.1]), np.diag([0.05, 0.2, 0.22]))


def test_a_heavier_sensor_is_one_whose_file_says_so(ordinary, lines, posed):
    heavy = Hypothesis(ordinary=ordinary, instances=(instance_of(ordinary, "sensor_mass"),))
    values = start_of(heavy)
    told = replace(lines, sensor_mass_kg=lines.sensor_mass_kg + 0.08)
    np.testing.assert_allclose(
        posed.values(heavy, lines, values | {"sensor mass": 0.08}),
        posed.values(Hypothesis(ordinary=ordinary), told, values),
        rtol=1e-12,
    )


@pytest.mark.parametrize("bolted_kg", [0.0, 5.0])
def test_the_load_of_a_joint_is_the_slope_of_the_potential_energy(superset, bolted_kg):
    links = tuple(joint.link for joint in superset.arm.joints)
    at_m = np.array([0.02, -0.05, 0.1])
    bolted_on = KnownMass(link=links[-1].name, mass_kg=bolted_kg, center_m=at_m)

    def energy(q):
        T = superset.posture(q).T_base_link
        centers = [T[i, :3, :3] @ link.center_m + T[i, :3, 3] for i, link in enumerate(links)]
        weight = np.asarray(superset.arm.gravity_m_s2)
        there = T[len(links) - 1, :3, :3] @ at_m + T[len(links) - 1, :3, 3]
        own = sum(link.mass_kg * weight @ c for link, c in zip(links, centers, strict=True))
        return -own - bolted_kg * weight @ there

    geometry = GeometryNear(superset, JOINTS).at(np.zeros(6))
    for i in range(6):
        step = np.zeros(6)
        step[i] = 1e-5
        slope = (energy(JOINTS + step) - energy(JOINTS - step)) / 2e-5
        load = gravity_load(geometry, links, superset.joint_column(i), bolted_on)
        assert load == pytest.approx(-slope, abs=1e-6 + 1e-6 * abs(slope))


def test_load_damping_adds_to_the_joint_s_own_by_its_load(superset, ordinary, lines, posed):
    instance = instance_of(ordinary, "load_damping", "axis_3")
    loaded = Hypothesis(ordinary=ordinary, instances=(instance,))
    values = start_of(loaded)
    links = tuple(joint.link for joint in superset.arm.joints)
    geometry = GeometryNear(superset, JOINTS).at(np.zeros(6))
    load = abs(gravity_load(geometry, links, superset.joint_column(2)))
    more = values | {"ln c axis_3": values["ln c axis_3"] + np.log(1.0 + 0.02 * load)}
    np.testing.assert_allclose(
        posed.values(loaded, lines, values | {instance.size: 0.02}),
        posed.values(Hypothesis(ordinary=ordinary), lines, more),
        rtol=1e-10,
    )


@pytest.mark.parametrize("ratio", [0.7, 1.5])
def test_a_compensator_is_as_stiff_as_its_energy_curves(ratio):
    """Over k min(r_a, r_b)^2, by differences; the length from the law of cosines.

    Differences of a step of 1e-3 leave 1e-6 of the curvature.
    """
    phi, step = np.linspace(0.3, 2.9, 7), 1e-3
    aside, stretch, growth = 0.2, 0.1, 0.6
    shorter = min(1.0, ratio) ** 2
    right = np.sqrt(1.0 + ratio**2 + aside)

    def length(angle):
        return np.sqrt(right**2 - 2.0 * ratio * np.cos(angle))

    def energy(angle):
        """Of a steady pull and a spring; what of k does not grow turns by the lever alone."""
        pull = stretch * right - growth * right
        return pull * length(angle) + 0.5 * growth * length(angle) ** 2

    curved = (energy(phi + step) - 2.0 * energy(phi) + energy(phi - step)) / step**2
    slope = (length(phi + step) - length(phi - step)) / (2.0 * step)
    stiffens, damps = shares(phi, ratio, aside, stretch, growth)
    np.testing.assert_allclose(damps, slope**2 / shorter, rtol=1e-5)
    expected = (curved + (1.0 - growth) * slope**2) / shorter
    np.testing.assert_allclose(stiffens, expected, rtol=1e-5)


def test_wound_wrist_gears_are_a_stiff_spring_on_both_turns(superset, ordinary, lines, posed):
    """A 7th power of ten N m/rad on x6 + ratio x5 leaves 1e-3 of x5's turn at most."""
    instance = instance_of(ordinary, "wrist_coupling")
    wound = Hypothesis(ordinary=ordinary, instances=(instance,))
    values = start_of(wound) | {instance.size: 0.8}
    still = replace(lines, sensor_mass_kg=0.0)
    got = posed.values(wound, still, values)
    dynamics, arm = superset.posture(JOINTS), superset.arm
    columns = [superset.joint_column(i) for i in range(6)]
    own = [(j.stiffness.value, j.damping.value) if j.stiffness else (0.0, 0.0) for j in arm.joints]
    K = np.diag([k for k, _ in own]) + dynamics.gravity_stiffness[np.ix_(columns, columns)]
    C = np.diag([c for _, c in own])
    row = np.array([0.0, 0.0, 0.0, 0.0, 0.8, 1.0])
    K = K + 1e8 * np.outer(row, row)
    M = dynamics.mass[np.ix_(columns, columns)]
    b = dynamics.point_jacobian[0][:3, columns].T @ still.hit_direction[0]
    for m in (0, 4, 9):
        J, R = dynamics.point_jacobian[m][:, columns], dynamics.point_rotation[m]
        for i, s in enumerate(still.s_rad_s):
            x = np.linalg.solve(s * s * M + s * C + K, b)
            want = R.T @ (s * s * J[:3] @ x + np.cross(J[3:] @ x, dynamics.gravity_m_s2))
            size = np.abs(want).max()
            np.testing.assert_allclose(got[m, :, i], want, atol=2e-3 * size)


def test_slices_bend_as_a_cantilever_and_twist_as_a_tube():
    """Tip force: L^3 / 3 EI (1 - 1 / 4 n^2); tip moment: L / GJ."""
    along, length, stiffness = np.array([0.0, 0.6, 0.8]), 0.4, 5e4
    line = LongLink(link=0, name="l", along=along, length_m=length)
    part, tip = length / stiffness / len(line.places_m), length * along
    bends = turns = 0.0
    for s in line.places_m:
        twist, turn = (
            own.hinge(dict.fromkeys((p.name for p in own.parameters), 0.0), s, 0)[0]
            for own in (YieldingLine(line=line, bends=of, word="w") for of in (True, False))
        )
        at_tip = twist[:3] + np.cross(twist[3:], tip)
        bends += part * (at_tip @ np.cross(twist[3:], along)) ** 2
        turns += part * (turn[3:] @ along) ** 2
    assert bends == pytest.approx(length**3 / (3 * stiffness) * (1 - 1 / (4 * SLICES**2)))
    assert turns == pytest.approx(length / stiffness)


def test_long_links_are_those_that_bend(ordinary):
    assert [line.name for line in long_links(ordinary.superset)] == [
        "lower_arm",
        "knuckle",
        "fore_tube",
    ]


def test_the_line_of_an_arm_with_offsets_is_its_tube():
    """A UR5's upper arm stands 0.11 m beside its joints, its forearm goes across their line."""
    superset = Superset(study_arm("ur5").arm)
    upper, fore = long_links(superset)
    for line in (upper, fore):
        body = superset.arm.joints[line.link].link
        center = np.asarray(body.center_m)
        assert np.linalg.norm(np.cross(center - line.start_m, line.along)) < 1e-12
        across = np.linalg.eigvalsh(body.inertia_kg_m2)[1]
        assert line.along @ body.inertia_kg_m2 @ line.along < 0.1 * across
    assert np.linalg.norm(upper.start_m) > 0.1
    root, tip = span_m(superset, fore.link)
    assert 0.9 < (tip - root) @ fore.along / np.linalg.norm(tip - root) < 0.98


def moved_along_its_axis(arm, number, by_m):
    """The same arm, but for where on its axis a joint's frame stands."""
    joint, beyond = arm.joints[number : number + 2]
    shift = by_m * np.asarray(joint.axis)

    def moved(by_m):
        T = np.eye(4)
        T[:3, 3] = by_m
        return T

    center = joint.link.center_m - shift
    joints = list(arm.joints)
    joints[number] = replace(
        joint,
        T_parent_joint=joint.T_parent_joint @ moved(shift),
        link=replace(joint.link, center_m=center),
    )
    joints[number + 1] = replace(beyond, T_parent_joint=moved(-shift) @ beyond.T_parent_joint)
    points = [
        replace(p, position_m=p.position_m - shift) if p.link == joint.link.name else p
        for p in arm.points
    ]
    return replace(arm, joints=tuple(joints), points=tuple(points))


def test_a_link_begins_at_its_root_wherever_on_its_axis_its_joint_is_described():
    """A description may put a wrist's joints where their axes meet: at the tip of the forearm."""
    arm = load_arm("rv4frl")
    at = [joint.link.name for joint in arm.joints].index("forearm")
    told = Ordinary(superset=Superset(arm), postures=("p",))
    length = float(arm.joints[at + 1].T_parent_joint[2, 3])
    other = Ordinary(superset=Superset(moved_along_its_axis(arm, at, length)), postures=("p",))
    lines = [next(x for x in long_links(o.superset) if x.link == at) for o in (told, other)]
    np.testing.assert_allclose(lines[0].along, lines[1].along, atol=1e-12)
    roots = [line.start_m for line in lines]
    tips = [line.start_m + line.length_m * line.along for line in lines]
    shift = np.array([0.0, 0.0, length])
    np.testing.assert_allclose(tips[1] + shift, tips[0], atol=1e-3)
    # Its root is told by its centre alone there: within an eighth of its length on this arm.
    np.testing.assert_allclose(roots[1] + shift, roots[0], atol=length / 8)
    assert link_axis.splits(other, at) == link_axis.splits(told, at)


def test_under_an_even_moment_points_follow_a_beam_s_parabola(ordinary, lines, posed):
    """Hinges that yield alike: at s the link turns by kappa s and moves by kappa s^2 / 2."""
    instance = instance_of(ordinary, "link_bending", "lower_arm")
    hypothesis = Hypothesis(ordinary=ordinary, instances=(instance,))
    values = start_of(hypothesis) | {instance.size: 1e-5, "bending stretch lower_arm": 1.0}
    system = posed.system(hypothesis, lines, values)
    line = next(x for x in long_links(ordinary.superset) if x.name == "lower_arm")
    one_way = system.moved[..., -WAYS * SLICES :: WAYS].sum(axis=-1)  # (m, 3): a unit at each hinge
    turned = system.turned[..., -WAYS * SLICES :: WAYS].sum(axis=-1)
    kappa, checked = SLICES / line.length_m, 0
    for m, point in enumerate(ordinary.arm.points):
        off = point.position_m - (point.position_m @ line.along) * line.along - line.start_m
        s = float(point.position_m @ line.along)
        if point.link != "lower_arm" or not 0.0 < s < line.length_m:
            continue
        checked += 1
        assert np.linalg.norm(turned[m]) == pytest.approx(kappa * s, rel=1e-9)
        # On the line; beside it a point also moves by its lever, at most its distance.
        reach = kappa * s * np.linalg.norm(off)
        assert abs(np.linalg.norm(one_way[m]) - kappa * s**2 / 2.0) <= reach + 1e-12
    assert checked >= 2


def test_before_a_hinge_neither_mass_nor_points_move(ordinary, lines, posed):
    """A point or a piece follows the hinges before it; the pieces together are the link."""
    instance = instance_of(ordinary, "link_bending", "lower_arm")
    hypothesis = Hypothesis(ordinary=ordinary, instances=(instance,))
    values = start_of(hypothesis) | {instance.size: 1e-5, "bending stretch lower_arm": 1.0}
    system = posed.system(hypothesis, lines, values)
    line = next(x for x in long_links(ordinary.superset) if x.name == "lower_arm")
    n = system.moved.shape[-1]
    hinges = range(n - WAYS * SLICES, n)
    for m, point in enumerate(ordinary.arm.points):
        if point.link != "lower_arm":
            continue
        at = float(point.position_m @ line.along)
        for k in hinges:
            moves = bool(np.any(system.moved[m, :, k] != 0.0))
            # A hinge stands for a stretch, from whose start on points move.
            assert moves == (at > (k - hinges.start) // WAYS * line.length_m / SLICES)
    pieces = system.pieces[1]
    still = ~pieces.motion[..., hinges.start :].any(axis=1)  # (pieces, hinges)
    # Pieces begin at the middle of each stretch: of those before it one reaches into it.
    np.testing.assert_array_equal(still.sum(axis=0), np.repeat(np.arange(SLICES), WAYS))
    np.testing.assert_allclose(pieces.split(INERTIA).sum(axis=0), INERTIA, atol=1e-12)


@pytest.mark.parametrize("named", ["link_bending", None])
def test_what_is_not_there_changes_nothing(ordinary, lines, posed, named):
    """All other effects, their sizes at zero, beside a bending link or none."""
    instances, values = (), {}
    if named is not None:
        bending = instance_of(ordinary, named, "lower_arm")
        instances = (bending,)
        values = {bending.size: 1e-5, "bending spread lower_arm": 0.2}
    alone = Hypothesis(ordinary=ordinary, instances=instances)
    values = start_of(alone) | values
    others = [
        i
        for i in all_instances(ordinary)
        if i.parameters
        and not i.relaxes
        and i.effect.name != "base"
        and all(i.key != own.key for own in instances)
    ]
    beside = Hypothesis(ordinary=ordinary, instances=(*instances, *others))
    space = beside.space()
    zero = {n: 0.0 for i in others for n in (i.size, *i.sizes)}
    every = space.values(space.start()) | zero | values
    np.testing.assert_allclose(
        posed.values(beside, lines, every),
        posed.values(alone, lines, values),
        rtol=1e-8,
    )


def test_pieces_of_a_rod_are_rods_where_they_lie():
    """A straight rod of 6 kg and 0.6 m in four pieces, each its own m (c^2 + l^2 / 12)."""
    along = np.array([1.0, 0.0, 0.0])
    shares = np.array([1.0, 2.0, 2.0, 1.0]) / 6.0
    edges = np.concatenate([[0.0], np.cumsum(shares)]) * 0.6
    middles = 0.5 * (edges[1:] + edges[:-1])
    whole = spatial_inertia(6.0, 0.3 * along, np.diag([0.0, 1.0, 1.0]) * 6.0 * 0.6**2 / 12.0)
    pieces = Pieces(
        shares=shares,
        offsets_m=np.outer(middles - 0.3, along),
        motion=np.zeros((4, 6, 1)),
    )
    total = 0.0
    for piece, part, middle in zip(pieces.split(whole), shares, middles, strict=True):
        np.testing.assert_allclose(piece[0, 0], 6.0 * part)
        np.testing.assert_allclose(piece[3:, :3], 6.0 * part * skew(middle * along), atol=1e-12)
        total += piece[5, 5] - 6.0 * part * middle**2
    # Their own inertia: what the rod has less what its pieces' centres make, shared by mass.
    own = np.sum(6.0 * shares * (0.6 * shares) ** 2 / 12.0)
    assert total == pytest.approx(own)


@pytest.mark.parametrize("near", [FLOOR, 0])
def test_a_damper_resists_the_rate_of_its_length(superset, ordinary, lines, posed, near):
    start, end = np.array([0.1, 0.2, 0.05]), np.array([0.05, -0.1, 0.02])
    place = "floor and fore_tube" if near == FLOOR else "carousel and fore_tube"
    instance = instance_of(ordinary, "nonproportional", place)
    hypothesis = Hypothesis(ordinary=ordinary, instances=(instance,))
    names = [p.name for p in instance.parameters]
    places = dict(zip(names[1:], np.concatenate([start, end]).tolist(), strict=True))
    plain = start_of(hypothesis) | places | {instance.size: 0.0}
    damped = plain | {instance.size: 700.0}

    def length(q):
        T = superset.posture(q).T_base_link
        far = T[3, :3, :3] @ end + T[3, :3, 3]
        here = start if near == FLOOR else T[0, :3, :3] @ start + T[0, :3, 3]
        return np.linalg.norm(far - here)

    rate = []
    for i in range(6):
        step = np.zeros(6)
        step[i] = 1e-5
        rate.append((length(JOINTS + step) - length(JOINTS - step)) / 2e-5)
    more, less = (posed.system(hypothesis, lines, v).damping for v in (damped, plain))
    elastic = len(ordinary.elastic)
    want = 700.0 * np.outer(rate[:elastic], rate[:elastic])
    np.testing.assert_allclose(
        (more - less)[:elastic, :elastic], want, atol=1e-5 * np.abs(want).max()
    )


def test_a_link_that_twists_may_be_an_axis_in_it_with_each_of_its_first_points_before(ordinary):
    """As soft as the whole link, and along its line."""
    line = long_links(ordinary.superset)[0]
    twists = instance_of(ordinary, "link_torsion", line.name)
    values = {p.name: p.first for p in twists.parameters} | {twists.size: 2e-5}
    axes = [(i, at) for i, at in twists.alternatives(values) if i.effect is link_axis.WORDS]
    splits = link_axis.splits(ordinary, line.link)
    assert len(splits) > 1
    told = [i.describe({p.name: p.first for p in i.parameters}) for i, _ in axes]
    assert [tuple(own["points_before"].split()) for own in told] == list(splits)
    for own, (axis, at) in zip(told, axes, strict=True):
        assert at[axis.size] == pytest.approx(2e-5 * line.length_m, rel=1e-12)
        assert np.linalg.norm(np.cross(own["direction"], line.along)) < 1e-9


def test_beside_a_link_that_gives_way_along_a_line_no_axis_of_it_nor_bearing_at_its_ends_is_sought(
    ordinary,
):
    every = all_instances(ordinary)
    for name in ("link_bending", "link_torsion"):
        link = next(i for i in every if i.effect.name == name)
        present = Hypothesis(ordinary=ordinary, instances=(link,))
        numbers = {joint.link.name: n for n, joint in enumerate(ordinary.arm.joints)}
        axes = {
            own: link_axis.at_axis(ordinary, n, np.eye(3)[0], np.zeros(3))
            for own, n in numbers.items()
        }
        assert {own for own, axis in axes.items() if not goes_with(axis, present)} == {link.place}
        # The line's ends are the bearings of its own joint and of the next one.
        number = numbers[link.place]
        turned_down = {
            i.place for i in every if i.effect.name == "bearing" and not goes_with(i, present)
        }
        ends = {joint.name for joint in ordinary.arm.joints[number : number + 2]}
        assert turned_down == ends == set(link.ends_at)
        others = [i for i in every if i is not link]
        assert len(others) == len(every) - 1
        assert all(goes_with(link, Hypothesis(ordinary=ordinary, instances=(i,))) for i in others)
