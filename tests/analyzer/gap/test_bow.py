"""How a joint's damping goes with the level, found on lines of three levels made of known laws."""

from dataclasses import replace

import numpy as np
import pytest
from scipy import stats
from support.made_gap_fits import made_fit

from armodal.analyzer.gap.effects import softening
from armodal.analyzer.gap.effects.level import any_bow
from armodal.analyzer.gap.effects.slips_or_softens import bow_of, told_by_bow
from armodal.analyzer.gap.inference.fit import Stage
from armodal.analyzer.gap.model.hypothesis import Hypothesis
from armodal.analyzer.gap.model.lines import PostureLines
from armodal.analyzer.gap.model.ordinary import Ordinary
from armodal.analyzer.gap.model.posed import PosedModel
from armodal.analyzer.gap.model.weigh import Discrepancy
from armodal.hil_sim.streams import stream

SPAN = 1.1  # of ln level, from the middle to the hardest
JOINTS_RAD = np.deg2rad(
    [[10.0, 60.0, -20.0, 15.0, 40.0, 20.0], [-40.0, 100.0, -30.0, 80.0, -25.0, 5.0]]
)
NOISE = 0.01  # of a channel's rms
FALL = 0.2  # of ln k a unit of ln level


@pytest.fixture(scope="module")
def ordinary(superset):
    return Ordinary(superset=superset, postures=("p0", "p1"), level_span=SPAN)


def blank(superset, name, joints_rad, level):
    s = 2.0 * np.pi * (2.0 + 1j * np.linspace(8.0, 90.0, 12))
    points = np.arange(0, len(superset.arm.points), 2)
    shape = (points.size, 3, s.size)
    return PostureLines(
        name=name,
        joints_rad=joints_rad,
        s_rad_s=s,
        sensor_point=points,
        hit=np.zeros(points.size, dtype=int),
        hit_point=np.array([0]),
        hit_direction=np.array([[-0.45, -0.62, -0.6427]]),
        values=np.zeros(shape, dtype=complex),
        variance=np.ones(shape),
        sensor_mass_kg=0.0093,
        level=level,
    )


def measured(rng, ordinary, joint, slope, bow):
    """Lines of soft hits, those between and hard ones, of a joint whose damping goes so."""
    instance, (by_k, by_c, bow_c) = any_bow(joint, SPAN)
    bowed = Hypothesis(ordinary=ordinary, instances=(instance,))
    space = bowed.space()
    values = space.values(space.start())
    values |= {by_k: FALL, by_c: slope * FALL, bow_c: bow * FALL * SPAN}
    lines = []
    for name, q in zip(ordinary.postures, JOINTS_RAD, strict=True):
        posed = PosedModel(ordinary.superset, q)
        for level in (-SPAN, 0.0, SPAN):
            own = blank(ordinary.superset, name, q, level)
            y = posed.values(bowed, own, values)
            std = NOISE * np.sqrt(np.mean(np.abs(y) ** 2, axis=-1, keepdims=True))
            error = rng.standard_normal((2, *y.shape)) / np.sqrt(2.0)
            variance = np.broadcast_to(std**2, y.shape)
            noisy = y + std * (error[0] + 1j * error[1])
            lines.append(replace(own, values=noisy, variance=variance))
    return Stage(ordinary.superset, lines, Discrepancy())


@pytest.mark.parametrize("draw", [0, pytest.param(1, marks=pytest.mark.long)])
@pytest.mark.parametrize(
    ("slope", "bow", "told"),
    [
        (0.35, 0.2, "softening"),
        (1.0, 1.7, "microslip"),
        (-1.0, 0.45, "microslip"),  # slides whole
    ],
)
def test_the_bow_of_a_known_law_is_found_within_its_covariance(ordinary, slope, bow, told, draw):
    joint = ordinary.arm.joints[1].name
    stage = measured(stream(draw, "bow", told), ordinary, joint, slope, bow)
    softens = next(i for i in softening.instances(ordinary) if i.place == joint)
    hypothesis = Hypothesis(ordinary=ordinary, instances=(softens,))
    space = hypothesis.space()
    begun = made_fit(hypothesis, cost=0.0, space=space, u=space.start())
    found = bow_of(stage, begun, joint, 1.0)
    off = np.array([found.slope - slope, found.bow - bow])
    # One in ten thousand; the covariance allows for a discrepancy too, of which there is none.
    assert off @ np.linalg.solve(found.covariance, off) < stats.chi2(2).ppf(0.9999)
    # Sharp enough to tell: a fifth of what lies between the laws of both names, 1.5.
    assert np.sqrt(found.covariance[1, 1]) < 0.3
    assert told_by_bow(found) == told
