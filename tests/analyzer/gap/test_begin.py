"""What a gap analysis begins with."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.gap.begin import ordinary_of
from armodal.protocols.arm.files import load_arm
from armodal.protocols.errors import ArmError


def test_joints_whose_names_make_one_parameter_of_two_are_refused():
    arm = load_arm("bench57")
    first, second, *rest = arm.joints
    named = (replace(first, name="A"), replace(second, name="relaxing A"), *rest)
    with pytest.raises(ArmError, match="'loss relaxing A' twice; rename joints"):
        ordinary_of((), Superset(replace(arm, joints=named)), ())
    assert ordinary_of((), Superset(arm), ()).parameters()


def test_every_point_that_is_hit_has_a_place_of_its_own():
    superset = Superset(load_arm("bench57"))
    roving = SimpleNamespace(name="p", hit_point=np.array([3, 0, 5]))
    fixed = SimpleNamespace(name="q", hit_point=np.array([0]))
    ids = [superset.arm.points[i].id for i in (3, 0, 5)]
    both = ordinary_of((), superset, (roving, fixed))
    assert both.one_is_hit
    assert not ordinary_of((), superset, (roving,)).one_is_hit
    names = [p.name for p in both.parameters() if p.name.startswith("hit place ")]
    assert names == [name for own in ids for name in both.hit_place_names(own)]
