"""How visible an effect of the frame is."""

from dataclasses import replace

import numpy as np
import pytest

from armodal.hil_sim.makers.arms import arm_table
from armodal.hil_sim.makers.case import CaseSpec
from armodal.hil_sim.makers.frame.effects import wrong_point
from armodal.hil_sim.makers.frame.everyday import everyday
from armodal.hil_sim.makers.frame.maker import made
from armodal.hil_sim.makers.frame.visibility import EVERY, SEEN, Witness

SEED, ARM = 5, "ur10e"


@pytest.fixture(scope="module")
def witness():
    spec = CaseSpec(
        maker="frame", seed=SEED, arm=ARM, wrist="elastic", kinds=(), size_class="clear"
    )
    table = arm_table(ARM)
    return Witness(everyday(table, "elastic", SEED), made(table, spec).plan, SEED)


def test_another_drive_is_seen_by_slopes_and_not_where_drives_are_fitted(witness):
    """Softer by a third it moves resonances by several of their widths, as other drives do too."""
    drawn = witness.drawn
    parts = drawn.parts.copy()
    for joint, softer in zip(drawn.elastic[:3], (0.7, 1.0, 1.3), strict=True):
        stiffness = softer * parts.drives[joint].stiffness
        parts.drives[joint].stiffness = stiffness
        parts.drives[joint].law = drawn.loss[joint].law(stiffness)
    by_slopes, fitted = witness.sees(parts, drawn.gear), witness.left_by_drives(parts, drawn.gear)
    assert by_slopes > 1.0  # more than a faint effect
    assert fitted < 0.1  # what the modes that are left out make of it


def test_what_no_drive_imitates_is_left(witness):
    """A sensor that tells a tenth too much along one axis: as much as by slopes, or nearly."""
    gear = witness.drawn.gear
    off = replace(gear, response=np.diag([1.1, 1.0, 1.0]) @ gear.response)
    by_slopes = witness.sees(witness.drawn.parts, off)
    left = witness.left_by_drives(witness.drawn.parts, off)
    assert by_slopes > 1.0
    assert left == pytest.approx(by_slopes, rel=0.1)  # drives move by little, so slopes tell most


def test_exchanged_points_are_looked_at(witness):
    """Two of one link that are not among every other: nobody else would see anything."""
    drawn = witness.drawn
    one, other = next(
        place.split("|")
        for place in wrong_point.where(drawn)
        if not set(place.split("|")) & seen_at_all(witness)
    )
    gear = replace(drawn.gear, exchanged={one: other, other: one})
    assert witness.left_by_drives(drawn.parts, gear) == 0.0
    assert witness.looking_at(gear.exchanged).left_by_drives(drawn.parts, gear) > 1.0


def seen_at_all(witness):
    """Points that are looked at in some posture."""
    return {name for i in SEEN for name in witness.plan.postures[i].points[::EVERY]}
