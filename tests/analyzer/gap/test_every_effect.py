"""Every effect of the library: from a file, in any order, beside any other."""

from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest
from support.bench_effects import FIRST, OTHERS, at_end, start_of
from support.gap_results import made_result

from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.gap.add import added_effects, instances_of_file
from armodal.analyzer.gap.effects import absorber, sensor_axes, wrong_point
from armodal.analyzer.gap.effects.level import any_change
from armodal.analyzer.gap.library import all_instances
from armodal.analyzer.gap.model.hypothesis import Hypothesis
from armodal.analyzer.gap.model.ordinary import Ordinary
from armodal.analyzer.gap.records import EffectFound, Interval
from armodal.protocols.arm.files import arm_from_texts
from armodal.protocols.arm.rewrite import text_with_effects


@pytest.mark.parametrize("places", [FIRST, pytest.param(OTHERS, marks=pytest.mark.long)])
def test_every_effect_of_the_library_comes_back_from_the_arm_file(ordinary, places):
    """Named, written as text, read: the same place, and a fit begins with the same values."""
    arm = ordinary.arm
    for instance in at_end(all_instances(ordinary), places):
        space = Hypothesis(ordinary=ordinary, instances=(instance,)).space()
        start = space.values(space.start())
        found = {n: 0.9 * start[n] + 0.02 for n in instance.owned}
        units = {p.name: p.unit for p in space.parameters}
        effect = EffectFound(
            name=instance.effect.name,
            title=instance.effect.title,
            place=instance.place,
            parameters={
                n: Interval(unit=units[n], value=v, std=0.01, low=v - 0.02, high=v + 0.02)
                for n, v in found.items()
            },
            size=instance.size,
            description={} if instance.describe is None else instance.describe(start | found),
            confidence=0.99,
            gain=100.0,
            held_out_gain=10.0,
            signature="",
            confused_with=(),
            told_by="",
            remedy="",
        )
        result = replace(made_result("named", []), effects=(effect,))
        added = added_effects(result, session_sha256="0" * 64, created="2026-01-31T12:00:00+00:00")
        if instance.place == "posture p":  # no other session has that posture's aim
            assert added == ()
            continue
        again = arm_from_texts(
            text_with_effects(arm, added),
            urdf_text=arm.urdf_text,
            database_text=None if arm.can is None else arm.can.database_text,
        )
        instances, values = instances_of_file(
            Ordinary(superset=Superset(again), postures=ordinary.postures)
        )
        assert [i.key for i in instances] == [instance.key]
        for name, value in found.items():
            assert values[name] == pytest.approx(value, rel=1e-4), instance.title


def test_the_order_of_effects_changes_nothing(ordinary, lines, posed):
    """A damper between links or by load sees every freedom, whichever was named first."""
    every = all_instances(ordinary)
    kinds = {"base", "servo", "link_torsion", "nonproportional", "load_damping", "bearing"}
    one_each = list({i.effect.name: i for i in every if i.effect.name in kinds}.values())
    assert len(one_each) == len(kinds)
    for one, other in combinations(one_each, 2):
        first, second = (
            Hypothesis(ordinary=ordinary, instances=pair) for pair in ((one, other), (other, one))
        )
        values = off_zero(first, np.random.default_rng(7))
        np.testing.assert_allclose(
            posed.values(first, lines, values),
            posed.values(second, lines, values),
            rtol=1e-9,  # a sum in another order, and a solution of it
            err_msg=f"{one.title}, {other.title}",
        )


def test_shapes_do_nothing_while_there_is_nothing(ordinary, lines, posed):
    """What the look leaves out is zero: any shape, size zero, the same response."""
    rng = np.random.default_rng(11)
    for instance in all_instances(ordinary):
        if not instance.shapes:
            continue
        hypothesis = Hypothesis(ordinary=ordinary, instances=(instance,))
        values = start_of(hypothesis) | {instance.size: 0.0}
        std = {p.name: p.std for p in instance.parameters}
        other = values | {
            n: values[n] + 0.3 * std[n] * rng.standard_normal() for n in instance.shapes
        }
        one, two = (posed.values(hypothesis, lines, v) for v in (values, other))
        np.testing.assert_allclose(one, two, rtol=1e-9, err_msg=instance.title)


def test_what_is_built_later_brings_coordinates_of_its_own(ordinary, lines, posed):
    """Derivatives by what stretched before, where two masses swing and a joint's load damps."""
    damped = next(i for i in all_instances(ordinary) if i.effect.name == "load_damping")
    hung = [absorber.at_line(ordinary, link, np.eye(3)[1], np.zeros(3)) for link in (2, 4)]
    hypothesis = Hypothesis(ordinary=ordinary, instances=(damped, *hung))
    space, values = hypothesis.space(), off_zero(hypothesis, np.random.default_rng(3))
    _, dy = posed.derivatives(hypothesis, lines, space, values)
    for name in (damped.size, *(i.size for i in hung), *(s for i in hung for s in i.shapes)):
        h = 1e-4 * space.std[space.index[name]]
        more, less = (
            posed.values(hypothesis, lines, values | {name: values[name] + step})
            for step in (h, -h)
        )
        want = (more - less) / 2e-4
        assert np.linalg.norm(dy[space.index[name]] - want) < ALLOWED * np.linalg.norm(want), name


def off_zero(hypothesis, rng):
    """Values about the start, inside their bounds; no size is zero."""
    space = hypothesis.space()
    values = space.values(space.start())
    for name, i in space.index.items():
        step = 0.15 * rng.standard_normal() * space.std[i]
        values[name] += abs(step) if space.low[i] == space.start()[i] else step
    return values


# Of the whole column. What effects add turns with the joints' angles, which derivatives by those
# leave out: 4.5 % of an encoder's column with a damper is the most that was seen. Steps are
# one-sided.
ALLOWED = 0.05


@pytest.mark.long
def test_derivatives_by_everything_are_those_of_differences_with_any_effect(ordinary, lines, posed):
    """Aims beside turned hits, gains beside exchanged axes, joints beside what they carry."""
    levelled = replace(ordinary, level_span=0.4)
    ids = [point.id for point in ordinary.arm.points]
    turned = sensor_axes.turned_sensor(
        levelled, np.array([[0, -1, 0], [1, 0, 0], [0, 0, 1.0]]), None
    )
    others = [turned, wrong_point.exchanged(levelled, *ids[:2])]
    rng = np.random.default_rng(5)
    own = replace(lines, level=0.4)
    # Of each effect two places are enough: an early one in the arm and a late one.
    of_kind = {}
    for instance in (*all_instances(levelled), *any_change(levelled)):
        of_kind.setdefault(instance.effect.name, []).append(instance)
    ends = [own[at] for own in of_kind.values() for at in {0, len(own) - 1}]
    for instance in [*ends, *others]:
        hypothesis = Hypothesis(ordinary=levelled, instances=(instance,))
        space, values = hypothesis.space(), off_zero(hypothesis, rng)
        y, dy = posed.derivatives(hypothesis, own, space, values)
        for name, i in space.index.items():
            h = 1e-4 * space.std[i]
            more = posed.values(hypothesis, own, values | {name: values[name] + h})
            less = posed.values(hypothesis, own, values | {name: values[name] - h})
            want = (more - less) / 2e-4
            allowed = ALLOWED * np.linalg.norm(want) + 1e-6 * np.linalg.norm(y)
            assert np.linalg.norm(dy[i] - want) < allowed, (instance.title, name)
