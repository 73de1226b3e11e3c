"""Stiffness at the tool against the deflection under a load, and over the reach."""

import numpy as np
import pytest
from support.added import any_of, axis, with_effects

from armodal.analyzer.acting.stiffness import stiffness_in_plane, tool_stiffness
from armodal.analyzer.acting.stiffness_page import plane_figure, stiffness_csv
from armodal.analyzer.corrected.batch import batched
from armodal.analyzer.statics.deflection import deflect
from armodal.analyzer.workspace.postures import random_postures
from armodal.protocols.arm.files import load_arm
from armodal.protocols.errors import ArmError

VIPER = load_arm("viper_s650")
ARM = with_effects(VIPER, axis(VIPER.joints[1].link.name), any_of(VIPER, "coupling"))
FORCE, TOOL = (30.0, 40.0, -120.0), (0.0, 0.02, 0.1)
SIZE = 130.0  # of the force


def test_it_is_force_over_the_displacement_along_it():
    ready = batched(ARM)
    q = random_postures(ARM, 5, np.random.default_rng(1))
    found = tool_stiffness(ready, q, FORCE, tool_m=TOOL)
    wanted = deflect(ready.batch, ready.elastic, q, [*FORCE, 0, 0, 0], tool_m=TOOL)
    assert found.displacement_m == pytest.approx(wanted.displacement_m, rel=1e-9)
    along = wanted.displacement_m @ np.array(FORCE) / SIZE
    assert found.along_n_per_m == pytest.approx(SIZE / along, rel=1e-9)
    # The softest of all directions is not stiffer than any single one.
    assert (found.softest_n_per_m <= found.along_n_per_m * (1 + 1e-9)).all()
    assert found.best == int(np.argmin(along))
    assert found.compliance_m_per_n == pytest.approx(
        found.compliance_m_per_n.swapaxes(1, 2), abs=1e-18
    )


def test_over_the_plane_the_stiffer_elbow_is_taken_within_the_ranges():
    ready = batched(ARM)
    whole = stiffness_in_plane(ready, FORCE, tool_m=TOOL, n_lines=15)
    reached = whole.elbow >= 0
    assert 20 < reached.sum() < reached.size
    assert np.isnan(whole.along_n_per_m[~reached]).all()
    found = tool_stiffness(ready, whole.joints_rad[reached], FORCE, tool_m=TOOL)
    assert found.along_n_per_m == pytest.approx(whole.along_n_per_m[reached], rel=1e-9)
    low, high = np.array([joint.range_rad for joint in ARM.joints]).T
    assert ((found.joints_rad >= low) & (found.joints_rad <= high)).all()
    assert whole.best.along_n_per_m[0] == pytest.approx(np.nanmax(whole.along_n_per_m))
    (contour,) = plane_figure(ARM, whole).data
    assert np.nanmax(np.array(contour.z, dtype=float)) == pytest.approx(
        np.log10(1e-6 * np.nanmax(whole.along_n_per_m)), abs=1e-5
    )


def test_a_csv_has_a_head_and_a_line_a_posture():
    q = random_postures(ARM, 3, np.random.default_rng(1))
    found = tool_stiffness(batched(ARM), q, FORCE, tool_m=TOOL)
    head, *rows = stiffness_csv(ARM, found).splitlines()
    assert len(rows) == 3
    values = dict(zip(head.split(","), map(float, rows[1].split(",")), strict=True))
    assert values["stiffness_along_n_per_m"] == pytest.approx(found.along_n_per_m[1], rel=1e-6)


def test_no_force_is_refused():
    with pytest.raises(ArmError, match="wanted a force"):
        tool_stiffness(batched(VIPER), np.zeros((1, 6)), (0, 0, 0), tool_m=TOOL)
