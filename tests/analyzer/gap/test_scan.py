"""What a linear look promises, where an effect frees what is there and brings its own beside."""

from dataclasses import replace

import numpy as np
import pytest
from support.bench_effects import JOINTS, instance_of, start_of

from armodal.analyzer.gap.inference.fit import Stage, fit_hypothesis
from armodal.analyzer.gap.model.hypothesis import Hypothesis
from armodal.analyzer.gap.model.ordinary import Ordinary
from armodal.analyzer.gap.model.posed import PosedModel
from armodal.analyzer.gap.model.weigh import Discrepancy
from armodal.analyzer.gap.search.scan import scan_instances
from armodal.analyzer.gap.stiffness_ranges import extreme_sizes, largest_size

POSTURES = {"p": 1.0, "q": 0.4, "r": -0.2}


@pytest.fixture(scope="module")
def ordinary(superset):
    return Ordinary(superset=superset, postures=tuple(POSTURES))


def looked_at(ordinary, lines, hidden, values, *wanted):
    """The null fitted to what another model has, 0.4 % off, and candidates beside it."""
    rng = np.random.default_rng(3)
    measured = []
    for name, part in POSTURES.items():
        s = 2 * np.pi * (2.0 + 1j * np.arange(6.0, 150.0, 6.0))
        own = replace(lines, name=name, joints_rad=part * JOINTS, s_rad_s=s)
        y = PosedModel(ordinary.superset, own.joints_rad).values(hidden, own, values)
        noise = rng.standard_normal((*y.shape, 2)) @ [1.0, 1.0j] / np.sqrt(2.0)
        y = y * (1.0 + 0.004 * noise)
        measured.append(replace(own, values=y, variance=(0.004 * np.abs(y)) ** 2))
    stage = Stage(ordinary.superset, measured, Discrepancy())
    null = fit_hypothesis(stage, Hypothesis(ordinary=ordinary), max_iterations=10)
    return null, {c.instance.effect.name: c for c in scan_instances(stage, null, wanted)}


def test_a_ratio_of_wrist_gears_is_seen_where_nothing_else_gives_way(ordinary, lines):
    """Its own column counts, not only the compliance that it frees beside."""
    gears = instance_of(ordinary, "wrist_coupling")
    driven = gears.place.split(" and ")[1]
    hidden = Hypothesis(ordinary=ordinary, instances=(gears,))
    values = start_of(hidden) | {gears.size: 0.02}
    released = instance_of(ordinary, "released_joint", driven)
    null, seen = looked_at(ordinary, lines, hidden, values, gears, released)
    promised = seen["wrist_coupling"]
    assert promised.size == pytest.approx(0.02, abs=3.0 * promised.size_std)
    # Nothing of it is the joint's own spring: that the noise alone brings.
    assert promised.gain > 10.0 * max(seen["released_joint"].gain, 1.0)
    assert extreme_sizes(promised, null, 1.0) == pytest.approx(
        [s * largest_size(promised, 1.0) for s in (1.0, -1.0)]
    )


def test_no_compliance_below_none_is_promised_or_hides(ordinary, lines):
    present = Hypothesis(ordinary=ordinary)
    released = instance_of(ordinary, "released_joint")
    name = released.size
    values = start_of(present)
    null, seen = looked_at(ordinary, lines, present, values, released)
    candidate = seen["released_joint"]
    assert candidate.size >= 0.0
    low, high = extreme_sizes(candidate, null, 1.0)
    assert null.values[name] + low >= 0.0
    assert high > 0.0
