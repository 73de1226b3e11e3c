"""What a gap analysis begins with."""

from dataclasses import replace

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
