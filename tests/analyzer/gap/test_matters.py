"""Which effects are large enough to be worth a name, by what the data tell of them."""

from types import SimpleNamespace

import pytest
from support.made_gap_fits import made_fit

from armodal.analyzer.gap.decision.matters import is_material, matters
from armodal.analyzer.gap.effects import nonproportional, wrong_point
from armodal.analyzer.gap.model.effect import Instance
from armodal.analyzer.gap.model.hypothesis import Hypothesis
from armodal.analyzer.gap.model.space import Parameter, Space


@pytest.mark.parametrize(
    ("std", "moved", "told"), [(0.01, 0.06, True), (0.01, 0.03, False), (0.1, 0.06, False)]
)
def test_a_small_effect_matters_where_a_joint_would_be_told_wrongly_without_it(std, moved, told):
    """By a twentieth, and beyond the interval that it has without."""
    stage = SimpleNamespace(weighings=[SimpleNamespace(n=1000)])
    space = Space([Parameter(name="ln k j", unit="", mean=9.0, std=std)])
    hypothesis = Hypothesis(ordinary=None)
    small = Instance(effect=nonproportional.WORDS, place="floor and l", size="d", material=1.0)
    space_with = space.with_changes({}, [Parameter(name="d", unit="N s/m", mean=0.0, std=1.0)])
    without = made_fit(hypothesis, cost=100.0, space=space, u=[0.0])
    fit = made_fit(hypothesis, cost=90.0, space=space_with, u=[moved / std, 0.5])
    assert matters(stage, without, fit, small, 1.0) is told


@pytest.mark.parametrize(
    ("shifts_m", "stds_m", "is_told"),
    [
        ((0.022, 0.010), (0.08, 0.002), False),  # 2 cm along a way that no hit tells
        ((0.022, 0.010), (0.004, 0.002), True),
        ((0.022, 0.022), (0.08, 0.08), True),  # nothing told of either: as before
    ],
)
def test_what_the_data_do_not_tell_of_a_size_in_several_parts_makes_it_no_larger(
    shifts_m, stds_m, is_told
):
    parameters = [
        Parameter(name=f"shift {axis}", unit="m", mean=0.0, std=std)
        for axis, std in zip("xy", stds_m, strict=True)
    ]
    names = tuple(p.name for p in parameters)
    off = Instance(
        effect=wrong_point.WORDS, place="point 4", size=names[0], sizes=names, material=0.02
    )
    u = [shift / std for shift, std in zip(shifts_m, stds_m, strict=True)]
    # No curvature is known of a made fit: deviations are those of the priors.
    fit = made_fit(Hypothesis(ordinary=None), cost=1.0, space=Space(parameters), u=u)
    assert is_material(fit, off, 1.0) is is_told
