"""Bodies of effects as parts of links."""

import numpy as np
import pytest
from support.added import any_of, axis, with_effects

from armodal.analyzer.corrected.batch import batched
from armodal.analyzer.corrected.loaded import loaded_arm
from armodal.analyzer.workspace.batch import ArmBatch
from armodal.protocols.errors import ArmError

Q = np.array([[0.2, 0.4, 1.1, -0.5, 0.6, 0.3]])


def test_a_payload_is_part_of_its_link_and_what_is_of_the_test_is_said(arm):
    corrected = with_effects(arm, any_of(arm, "payload"), any_of(arm, "hammer_gain"))
    loaded = loaded_arm(corrected)
    wanted = batched(corrected).batch.masses(Q)[0]
    # The same bodies by two ways; rounding of some hundred products.
    np.testing.assert_allclose(ArmBatch(loaded.arm).mass(Q), wanted, rtol=1e-9, atol=1e-12)
    assert np.abs(wanted - ArmBatch(arm).mass(Q)).max() > 1e-3
    assert loaded.arm.effects == ()
    carried, of_the_test = loaded.notes
    assert "the room it takes is not known" in carried
    assert "is of the test" in of_the_test


def test_all_that_is_more_than_a_body_is_named_at_once(arm):
    kinds = ("payload", "rotor", "bearing", "coupling", "servo")
    corrected = with_effects(arm, axis("shoulder"), *(any_of(arm, kind) for kind in kinds))
    with pytest.raises(ArmError) as refused:
        loaded_arm(corrected)
    said = str(refused.value)
    for kind in ("link_axis", "rotor", "bearing", "coupling", "servo"):
        assert f"{kind} (" in said
    assert "payload (" not in said


def test_an_arm_without_effects_is_as_it_was(arm):
    assert loaded_arm(arm).arm is arm
