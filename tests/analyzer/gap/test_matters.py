"""Which effects are large enough to be worth a name, by what the data tell of them."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from support.made_gap_fits import made_fit, made_words

from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.gap.decision.matters import is_material, matters
from armodal.analyzer.gap.effects import nonproportional, wrong_point
from armodal.analyzer.gap.library import all_instances
from armodal.analyzer.gap.model.effect import Instance
from armodal.analyzer.gap.model.hypothesis import Hypothesis
from armodal.analyzer.gap.model.ordinary import Ordinary
from armodal.analyzer.gap.model.space import Parameter, Space
from armodal.protocols.arm.files import load_arm


@pytest.mark.parametrize(
    ("std", "moved", "told"), [(0.01, 0.06, True), (0.01, 0.03, False), (0.1, 0.06, False)]
)
def test_a_small_effect_matters_where_a_joint_would_be_told_wrongly_without_it(std, moved, told):
    """By a twentieth, and beyond the interval that it has without."""
    stage = SimpleNamespace(weighings=[SimpleNamespace(n=1000)], lines=())
    space = Space([Parameter(name="ln k j", unit="", mean=9.0, std=std)])
    hypothesis = Hypothesis(ordinary=None)
    small = Instance(effect=nonproportional.WORDS, place="floor and l", size="d", material=1.0)
    space_with = space.with_changes({}, [Parameter(name="d", unit="N s/m", mean=0.0, std=1.0)])
    without = made_fit(hypothesis, cost=100.0, space=space, u=[0.0])
    fit = made_fit(hypothesis, cost=90.0, space=space_with, u=[moved / std, 0.5])
    assert matters(stage, without, fit, small, 1.0) is told


ONE_POSTURE = SimpleNamespace(lines=[SimpleNamespace(name="p")] * 2)  # hit softly and hard


@pytest.mark.parametrize(("std", "is_told"), [(0.4, True), (0.6, False)])
def test_another_size_that_would_be_material_alone_must_be_told_too(std, is_told):
    """Two, where one is material: 1.2 or more, or 0.8."""
    parameters = [Parameter(name=name, unit="", mean=0.0, std=1.0) for name in ("turn", "shift")]
    moves = Instance(
        effect=made_words("made"),
        place="",
        size="turn",
        material=5.0,
        side_sizes=(("shift", 1.0),),
    )
    fit = replace(
        made_fit(Hypothesis(ordinary=None), cost=1.0, space=Space(parameters), u=(0.0, 2.0)),
        curvature=np.diag([1.0, std**-2 - 1.0]),  # the prior's is counted besides
    )
    assert is_material(ONE_POSTURE, fit, moves, 1.0) is is_told


_APART = ((1.0, 0.0), (0.0, 1.0))  # each part told by itself, or not
_TOGETHER = ((0.5, 0.5), (-0.5, 0.5))  # the sum, and the difference


@pytest.mark.parametrize(
    ("shifts_m", "ways", "stds_m", "is_told"),
    [
        ((0.030, 0.010), _APART, (0.08, 0.002), False),  # 3 cm along a way that no hit tells
        ((0.030, 0.010), _APART, (0.004, 0.002), True),  # 22 mm or more
        ((0.030, 0.010), _APART, (0.006, 0.002), False),  # 18 mm or more
        ((0.030, 0.030), _APART, (0.08, 0.08), False),
        ((0.026, 0.026), _TOGETHER, (0.002, 0.08), True),  # neither told alone, but their sum is
        ((0.060, -0.040), _TOGETHER, (0.002, 0.08), False),  # of which the sum is 2 cm
    ],
)
def test_what_the_data_do_not_tell_of_a_size_in_several_parts_makes_it_no_larger(
    shifts_m, ways, stds_m, is_told
):
    prior_m = 1.0  # far beyond what the data tell, so that it adds nothing
    parameters = [Parameter(name=f"shift {axis}", unit="m", mean=0.0, std=prior_m) for axis in "xy"]
    names = tuple(p.name for p in parameters)
    off = Instance(
        effect=wrong_point.WORDS, place="point 4", size=names[0], sizes=names, material=0.02
    )
    W = np.array(ways)
    fit = replace(
        made_fit(Hypothesis(ordinary=None), cost=1.0, space=Space(parameters), u=shifts_m),
        curvature=W.T @ np.diag(1.0 / np.square(stds_m)) @ W,
    )
    assert is_material(ONE_POSTURE, fit, off, 1.0) is is_told


@pytest.mark.parametrize(("some_is_ordinary", "is_told"), [(False, True), (True, False)])
def test_what_every_arm_has_some_of_is_large_whatever_its_shape(some_is_ordinary, is_told):
    """Three, where two are material: 0.3 either way in one shape, 1.5 over all of them."""
    parameters = [Parameter(name=name, unit="", mean=0.0, std=1.0) for name in ("much", "where")]
    words = replace(made_words("made"), some_is_ordinary=some_is_ordinary)
    soft = Instance(effect=words, place="", size="much", shapes=("where",), material=2.0)
    in_one, over_all = 0.3 / 1.96, 1.5 / 1.96
    # Of a covariance with over_all^2 for the size, and in_one^2 once the shape, of 0.7, is given.
    covariance = np.array([[over_all**2, np.sqrt(over_all**2 - in_one**2) * 0.7], [0.0, 0.7**2]])
    covariance[1, 0] = covariance[0, 1]
    fit = replace(
        made_fit(Hypothesis(ordinary=None), cost=1.0, space=Space(parameters), u=(3.0, 0.0)),
        curvature=np.linalg.inv(covariance) - np.eye(2),  # the priors' is counted besides
    )
    assert is_material(ONE_POSTURE, fit, soft, 1.0) is is_told
    # Errors that all postures share: as many times the variance as there are postures.
    many = SimpleNamespace(lines=[SimpleNamespace(name=str(n)) for n in range(25)])
    assert not is_material(many, fit, soft, 1.0)


def test_what_is_a_part_of_a_drive_is_one_of_the_drive_as_it_is():
    """Where a data sheet has it half as soft, a bearing of twice as much is ordinary."""
    ordinary = Ordinary(superset=Superset(load_arm("ur5")), postures=("p",))
    of_drives = [i for i in all_instances(ordinary) if i.drives]
    assert {"bearing", "base", "servo", "link_bending"} <= {i.effect.name for i in of_drives}
    for instance in of_drives:
        for softer in (1.0, 2.0):
            least = softer * instance.material
            values = {name: believed - np.log(softer) for name, believed in instance.drives}
            values |= {name: 0.0 for name, _ in instance.side_sizes}
            names = instance.sizes or (instance.size,)
            for size, is_large in ((0.99 * least, False), (1.01 * least, True)):
                values |= dict.fromkeys(names, 0.0) | {names[-1]: size}
                assert instance.is_material(values) is is_large


def test_a_joint_that_is_believed_rigid_goes_with_the_elastic_ones():
    arm = load_arm("rv4frl")
    ordinary = Ordinary(superset=Superset(arm), postures=("p",))
    told = [(f"ln k {j.name}", np.log(j.stiffness.value)) for j in arm.joints if j.stiffness]
    rigid = [i for i, joint in enumerate(arm.joints) if joint.stiffness is None]
    assert rigid
    assert dict(ordinary.drives(rigid[0])) == pytest.approx(dict(told))
    assert dict(ordinary.drives()) == pytest.approx(dict(told[:3]))


def test_ordinary_compliances_go_with_the_drives_that_are_there():
    """Where a data sheet has one drive twice as stiff, its sound bearing may give way twice."""
    arm = load_arm("ur5")
    believed = Ordinary(superset=Superset(arm), postures=("p",))
    soft = arm.joints[1]
    told = [joint for joint in arm.joints if joint.stiffness]
    values = {f"ln k {j.name}": np.log(j.stiffness.value) for j in told}
    values[f"ln k {soft.name}"] -= np.log(2.0)
    found = believed.beside_drives(values)
    before, after = (ordinary.parameters() for ordinary in (believed, found))
    every = {now.name: now.std / own.std for own, now in zip(before, after, strict=True)}
    times = {name: ratio for name, ratio in every.items() if ratio != pytest.approx(1.0)}
    of_base = {name for name in times if name.startswith("base")}
    own = {name for name in times if name.endswith((soft.name, soft.link.name))}
    rigid = set(times) - own - of_base  # as much as the elastic ones on average
    assert {f"bearing a {soft.name}", f"bend a {soft.link.name}"} <= own
    assert of_base
    assert rigid
    assert not any(name.startswith("ln k") for name in times)
    for names, part in ((own, 1.0), (of_base, 1.0 / 3.0), (rigid, 1.0 / len(told))):
        assert [times[name] for name in names] == pytest.approx([2.0**part] * len(names))
    assert found.bearing_limit(1) == pytest.approx(2.0 * believed.bearing_limit(1))
    assert dict(found.drives(1)) == pytest.approx(
        {f"ln k {soft.name}": values[f"ln k {soft.name}"]}
    )
