"""Postures solved together beside each alone, and starts that share one evaluation."""

from dataclasses import replace

import numpy as np
import pytest

from armodal.analyzer.gap.effects import link_axis
from armodal.analyzer.gap.inference.fit import Stage
from armodal.analyzer.gap.library import all_instances
from armodal.analyzer.gap.model.hypothesis import Hypothesis
from armodal.analyzer.gap.model.lines import PostureLines
from armodal.analyzer.gap.model.ordinary import Ordinary
from armodal.analyzer.gap.model.posed import PosedModel, Postures
from armodal.analyzer.gap.model.weigh import Discrepancy

ANGLES = np.deg2rad(
    [
        [10.0, -35.0, 20.0, 15.0, 40.0, 20.0],
        [-40.0, 15.0, -30.0, 80.0, -25.0, 5.0],
        [75.0, -10.0, 45.0, -60.0, 60.0, -90.0],
    ]
)
DIRECTIONS = np.array([[-0.45, -0.62, -0.6427], [0.0, 0.6, 0.8]])


@pytest.fixture(scope="module")
def lines(superset):
    """Three postures hit at two points each; in the last one point is missing."""
    rng = np.random.default_rng(11)
    n_points = len(superset.arm.points)
    s = 2 * np.pi * (6.0 + 1j * np.array([8.0, 23.0, 51.0, 104.0]))
    found = []
    for i, q in enumerate(ANGLES):
        points = np.arange(n_points - (i == 2))
        shape = (2 * points.size, 3, s.size)
        found.append(
            PostureLines(
                name=f"p{i}",
                joints_rad=q,
                s_rad_s=s,
                sensor_point=np.tile(points, 2),
                hit=np.repeat([0, 1], points.size),
                hit_point=np.array([3, 12]),
                hit_direction=DIRECTIONS,
                values=rng.normal(size=shape) + 1j * rng.normal(size=shape),
                variance=np.full(shape, 0.1),
                sensor_mass_kg=0.0093,
            )
        )
    return found


@pytest.fixture(scope="module")
def ordinary(superset):
    return Ordinary(superset=superset, postures=("p0", "p1", "p2"))


@pytest.fixture(scope="module")
def stage(superset, lines):
    return Stage(superset, lines, Discrepancy())


def effects(ordinary, *names):
    every = all_instances(ordinary)
    return tuple(next(i for i in every if i.effect.name == name) for name in names)


def test_postures_solved_together_are_each_alone(superset, lines, ordinary):
    names = ("gravity_compensator", "link_bending", "nonproportional", "channel_gain")
    hypothesis = Hypothesis(ordinary=ordinary, instances=effects(ordinary, *names))
    space = hypothesis.space()
    u = np.clip(space.start() + 0.1, space.low, space.high)
    values = space.values(u)
    models = [PosedModel(superset, q) for q in ANGLES]
    y, dy = Postures(models[:2], lines[:2]).derivatives(hypothesis, space, values)
    for p in range(2):
        alone, by_each = models[p].derivatives(hypothesis, lines[p], space, values)
        np.testing.assert_allclose(y[p], alone, rtol=1e-10)
        size = np.abs(by_each).max(axis=(1, 2, 3), keepdims=True)
        # Sums in another order: differences of parameters that act by them lose some digits.
        np.testing.assert_allclose(dy[:, p] / (size + 1e-30), by_each / (size + 1e-30), atol=1e-6)


def test_derivatives_in_single_precision_are_those_in_double(superset, lines, ordinary):
    """All effects at once, each beside any other: sums that cancel to a thousandth at most.

    But for a base's turn, which is what one of its lines does less what the other does: a 3000th.
    """
    kinds = {instance.effect.name: instance for instance in all_instances(ordinary)}
    hypothesis = Hypothesis(ordinary=ordinary, instances=tuple(kinds.values()))
    space = hypothesis.space()
    values = space.values(np.clip(space.start() + 0.1, space.low, space.high))
    values["base rock x"] *= 30.0  # as soft about both lines its turn would change nothing
    y, dy = Postures([PosedModel(superset, ANGLES[0])], lines[:1]).derivatives(
        hypothesis, space, values
    )
    exact = Postures([PosedModel(superset, ANGLES[0])], lines[:1], single=False).derivatives(
        hypothesis, space, values
    )
    assert (dy.dtype, exact[1].dtype) == (np.complex64, np.complex128)
    np.testing.assert_array_equal(y, exact[0])
    size = np.abs(exact[1]).max(axis=(1, 2, 3, 4), keepdims=True)
    assert np.count_nonzero(size) > 100
    parts = np.full(size.shape, 1000.0)
    parts[space.index["base turn"]] = 3000.0
    off = np.abs(dy - exact[1])
    assert np.all(off <= parts * np.finfo(np.float32).eps * (size + 1e-30))


@pytest.mark.parametrize(("largest", "dtype"), [(900.0, np.complex64), (1100.0, np.complex128)])
def test_a_motion_beyond_all_sense_is_left_in_double_precision(
    superset, lines, ordinary, largest, dtype
):
    """1000 m/N: squares of more, times masses and s^2, leave the range of single precision."""
    hypothesis = Hypothesis(ordinary=ordinary)
    space = hypothesis.space()
    posed = Postures([PosedModel(superset, ANGLES[0])], lines[:1])
    exact = posed.response(hypothesis, space.values(space.start()))
    far = replace(exact, x=exact.x * (largest / np.abs(exact.x).max()))
    assert far.for_derivatives.x.dtype == dtype


def test_what_does_not_act_is_zero_whatever_memory_held_before(
    superset, lines, ordinary, monkeypatch
):
    """An effect given twice acts once: the linear look asks so where one link has two starts."""
    axis = link_axis.at_axis(ordinary, 2, np.eye(3)[0], np.zeros(3))
    hypothesis = Hypothesis(ordinary=ordinary, instances=(axis, axis))
    space = hypothesis.space()
    empty = np.empty

    def spoilt(*args, **options):
        found = empty(*args, **options)
        if found.dtype.kind in "fc":
            found.fill(np.nan)
        return found

    monkeypatch.setattr(np, "empty", spoilt)
    posed = Postures([PosedModel(superset, ANGLES[0])], lines[:1])
    _, dy = posed.derivatives(hypothesis, space, {p.name: p.first for p in space.parameters})
    assert len(space) == len(space.index) + len(axis.parameters)
    assert np.isfinite(dy).all()


def test_postures_of_other_shape_are_solved_apart(stage):
    assert [own for own, _ in stage.together()] == [[0, 1], [2]]
    assert [own for own, _ in stage.together([2, 0])] == [[2], [0]]


def test_a_mounting_answers_its_own_hit(superset, lines, ordinary):
    """Two hits at once are each hit alone: half of the mountings each."""
    hypothesis = Hypothesis(ordinary=ordinary)
    values = hypothesis.space().values(hypothesis.space().start())
    model, both = PosedModel(superset, ANGLES[0]), lines[0]
    y = model.values(hypothesis, both, values)
    for hit in (0, 1):
        mine = both.hit == hit
        alone = replace(
            both,
            sensor_point=both.sensor_point[mine],
            hit=np.zeros(mine.sum(), dtype=int),
            hit_point=both.hit_point[[hit]],
            hit_direction=both.hit_direction[[hit]],
            values=both.values[mine],
            variance=both.variance[mine],
        )
        more = replace(ordinary, postures=("p0",))
        np.testing.assert_allclose(
            model.values(Hypothesis(ordinary=more), alone, values), y[mine], rtol=1e-10
        )
