"""Which sizes of effects are refitted for an arm file."""

from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.corrected.to_file import SCALED_UNITS
from armodal.analyzer.gap.library import all_instances
from armodal.analyzer.gap.model.ordinary import Ordinary
from armodal.protocols.arm.files import load_arm


def test_every_compliance_is_refitted_that_of_a_length_too():
    ordinary = Ordinary(superset=Superset(load_arm("bench57")), postures=("p",))
    units = {
        own.unit
        for instance in all_instances(ordinary)
        for own in (*instance.parameters, *instance.relaxes.values())
        if own.unit.startswith("rad/")
    }
    assert units == {"rad/(N m)", "rad/(N m²)"}
    assert units <= set(SCALED_UNITS)
