"""Arms of one or two joints, of no weight, all in one place, or standing somewhere in a room."""

from dataclasses import replace

import numpy as np
import pytest

from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.gap.inference.fit import Stage, fit_hypothesis
from armodal.analyzer.gap.library import all_instances
from armodal.analyzer.gap.model.hypothesis import Hypothesis
from armodal.analyzer.gap.model.lines import PostureLines
from armodal.analyzer.gap.model.ordinary import Ordinary
from armodal.analyzer.gap.model.posed import PosedModel
from armodal.analyzer.gap.model.weigh import Discrepancy
from armodal.analyzer.gap.search.candidates import all_candidates
from armodal.protocols.arm.files import arm_from_texts

JOINT = """
[[joints]]
name = "J{i}"
range_deg = [-100.0, 100.0]
stiffness_n_m_per_rad = {{ value = 10000.0, std = 3000.0, source = "x" }}
damping_n_m_s_per_rad = {{ value = 10.0, std = 5.0, source = "x" }}
[joints.dh]
alpha_deg = {alpha}
a_m = {a}
theta_offset_deg = 0.0
d_m = {d}
[joints.link]
name = "L{i}"
mass_kg = 5.0
center_m = {center}
inertia_kg_m2 = [0.03, 0.03, 0.02, 0.0, 0.0, 0.0]
"""
POINT = """
[[points]]
id = "p{i}{k}"
link = "L{i}"
position_m = [{x}, 0.05, 0.0]
normal = [0.0, 1.0, 0.0]
x_axis = [1.0, 0.0, 0.0]
"""


def ordinary_of(turned_deg, *, a=0.3, d=0.2, center=(0.1, 0.01, 0.02), gravity=None):
    """An arm of as many joints as there are twists between them."""
    text = 'format = "armodal-arm-1"\nname = "x"\nsource = "x"\n'
    text += "" if gravity is None else f"gravity_m_s2 = {list(gravity)}\n"
    for i, alpha in enumerate(turned_deg, 1):
        text += JOINT.format(i=i, alpha=alpha, a=a if i > 1 else 0.0, d=d, center=list(center))
    for i in range(1, len(turned_deg) + 1):
        text += "".join(POINT.format(i=i, k=k, x=0.05 + 0.1 * k) for k in range(3))
    arm = arm_from_texts(text, urdf_text=None, database_text=None)
    return Ordinary(
        superset=Superset(arm), postures=("p", "q"), hit_points=(arm.points[0].id,), one_is_hit=True
    )


def lines_of(ordinary, name, joints_rad):
    n, s = len(ordinary.arm.points), 2.0 * np.pi * (2.0 + 1j * np.arange(8.0, 120.0, 8.0))
    return PostureLines(
        name=name,
        joints_rad=joints_rad,
        s_rad_s=s,
        sensor_point=np.arange(n),
        hit=np.zeros(n, dtype=np.int64),
        hit_point=np.array([0]),
        hit_direction=np.array([[-0.45, -0.62, -0.6427]]),
        values=np.ones((n, 3, s.size), dtype=np.complex128),
        variance=np.ones((n, 3, s.size)),
        sensor_mass_kg=0.01,
    )


@pytest.mark.parametrize("turned_deg", [(0.0,), (0.0, 90.0)])
def test_every_effect_is_looked_at_on_an_arm_of_one_joint_or_two(turned_deg):
    """Of one joint no link is left for an absorber: nothing to look at, and no exception."""
    ordinary = ordinary_of(turned_deg)
    present = Hypothesis(ordinary=ordinary)
    space = present.space()
    values = space.values(space.start())
    found = []
    for name, part in (("p", 0.3), ("q", -0.5)):
        lines = lines_of(ordinary, name, np.full(len(turned_deg), part))
        y = PosedModel(ordinary.superset, lines.joints_rad).values(present, lines, values)
        found.append(replace(lines, values=y, variance=np.full(y.shape, np.mean(abs(y) ** 2))))
    stage = Stage(ordinary.superset, found, Discrepancy())
    fit = fit_hypothesis(stage, present, start=values, max_iterations=0)
    seen = all_candidates(stage, fit, values, from_start=False)
    assert {"bearing", "base", "payload"} <= {c.instance.effect.name for c in seen}
    # The data are the model's own: nothing is promised by any effect.
    assert max(c.gain for c in seen) < 0.1


def test_an_arm_all_in_one_place_has_finite_errors_and_response():
    ordinary = ordinary_of((0.0,), d=0.0)
    space = Hypothesis(ordinary=ordinary).space()
    assert np.isfinite(space.std).all()
    assert (space.std > 0.0).all()
    lines = lines_of(ordinary, "p", np.zeros(1))
    y = PosedModel(ordinary.superset, lines.joints_rad).values(
        Hypothesis(ordinary=ordinary), lines, space.values(space.start())
    )
    assert np.isfinite(y).all()


@pytest.mark.parametrize(
    ("given", "loaded"),
    [
        ({"gravity": (0.0, 0.0, 0.0)}, ()),
        ({"turned_deg": (0.0, 0.0, 0.0, 0.0)}, ()),  # all axes upright
        ({"gravity": (9.8, 0.0, 0.0)}, (0, 1, 2)),
        ({}, (1, 2)),
    ],
)
def test_weight_loads_what_it_can_turn(given, loaded):
    ordinary = ordinary_of(**{"turned_deg": (0.0, 90.0, 0.0), **given})
    assert ordinary.loaded == loaded
    assert all(np.isfinite(i.material) for i in all_instances(ordinary))


def test_what_weighs_nothing_beyond_a_joint_has_no_damping_by_load():
    """The last body's centre on its axis, and nothing beyond."""
    ordinary = ordinary_of((0.0, 90.0, 0.0), center=(0.0, 0.0, 0.0))
    places = [i.place for i in all_instances(ordinary) if i.effect.name == "load_damping"]
    assert places == ["J2"]


def moved_in_a_room(ordinary, offset_m):
    first, *others = ordinary.arm.joints
    T = first.T_parent_joint.copy()
    T[:3, 3] += offset_m
    joints = (replace(first, T_parent_joint=T), *others)
    return replace(ordinary, superset=Superset(replace(ordinary.arm, joints=joints)))


def test_where_in_a_room_an_arm_stands_changes_nothing():
    """A base rocks where it stands, not about the origin that a file counts from."""
    here = ordinary_of((0.0, 90.0, 0.0))
    there = moved_in_a_room(here, np.array([3.0, -2.0, 0.0]))
    one, other = (Hypothesis(ordinary=o).space() for o in (here, there))
    np.testing.assert_allclose(other.std, one.std)
    values = one.values(one.start()) | {"base rock x": 3e-7, "base shift y": 1e-8}
    lines = lines_of(here, "p", np.array([0.2, 0.4, -0.3]))
    for instances in ((), tuple(i for i in all_instances(here) if i.effect.name == "base")):
        y = [
            PosedModel(o.superset, lines.joints_rad).values(
                Hypothesis(ordinary=o, instances=instances_of(o, instances)),
                lines,
                values | {"base pivot": 0.2},
            )
            for o in (here, there)
        ]
        np.testing.assert_allclose(y[1], y[0], rtol=1e-9)


def instances_of(ordinary, alike):
    keys = {i.key for i in alike}
    return tuple(i for i in all_instances(ordinary) if i.key in keys)
