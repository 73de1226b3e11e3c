"""Parameters of a hypothesis have a name each."""

import pytest

from armodal.analyzer.gap.model.assembly import relaxing_name
from armodal.analyzer.gap.model.space import Parameter, Space
from armodal.protocols.errors import ArmError


def test_two_parameters_of_one_name_are_refused_with_that_name():
    losses = (f"loss {'relaxing elbow'}", relaxing_name("elbow"))  # of two joints
    parameters = [Parameter(name=name, unit="", mean=0.0, std=1.0) for name in losses]
    with pytest.raises(ArmError, match="got 'loss relaxing elbow' twice; rename the joints"):
        Space(parameters)
