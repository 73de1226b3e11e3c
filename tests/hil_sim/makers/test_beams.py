"""The frame's beams against closed forms."""

from dataclasses import replace

import numpy as np
import pytest

from armodal.hil_sim.makers.arms import arm_table
from armodal.hil_sim.makers.frame.beams import beam_stiffness, flattened, tube
from armodal.hil_sim.makers.frame.everyday import everyday
from armodal.hil_sim.makers.frame.modal import modal
from armodal.hil_sim.makers.frame.standing import stand

TUBE = tube(0.12, 0.004, 70e9, 2700.0)
LENGTH = 2.0


def tip_yields(section):
    """(3, 3) of the tip of a cantilever along x, by forces."""
    K = beam_stiffness(section, np.zeros(3), np.array([LENGTH, 0.0, 0.0]))
    return np.linalg.inv(K[6:, 6:])[:3, :3]


def bends(section):
    """Both principal yields across, less what shear adds."""
    shear = LENGTH / (section.shear_pa * section.shear_area_m2)
    return np.linalg.eigvalsh(tip_yields(section)[1:, 1:]) - shear


@pytest.mark.parametrize("high", [0.5, 1.0, 2.2])
def test_a_box_bends_as_a_thin_box_and_as_its_tube_on_the_mean(high):
    """I = t h^2 (3 w + h) / 6 about the axis along w, of walls that are thin."""
    box = flattened(TUBE, high, (0.3, 0.6, -0.8))
    soft = bends(box)
    assert soft.mean() == pytest.approx(bends(TUBE).mean(), rel=1e-9)
    about = np.array([high**2 * (3.0 + high), 1.0 + 3.0 * high])
    assert soft[1] / soft[0] == pytest.approx(about.max() / about.min(), rel=1e-9)


@pytest.mark.parametrize("roll", [0.0, 0.4, 2.0])
def test_a_box_lies_as_its_width_says(roll):
    """Higher than wide, it moves most along its width: y for a beam along x that is wide there."""
    here = tip_yields(flattened(TUBE, 1.8, (0.0, 1.0, 0.0)))[1:, 1:]
    assert here[0, 0] > 1.5 * here[1, 1]
    turn = np.array([[np.cos(roll), -np.sin(roll)], [np.sin(roll), np.cos(roll)]])
    # What of its direction is along the beam does nothing.
    width = (0.5, *(turn @ [1.0, 0.0]).tolist())
    across = tip_yields(flattened(TUBE, 1.8, width))[1:, 1:]
    np.testing.assert_allclose(across, turn @ here @ turn.T, rtol=1e-9, atol=1e-15)


def test_a_shell_turns_with_its_link():
    """On a round base about a vertical axis the first joint's angle changes no frequency."""
    parts = everyday(arm_table("ur10e"), "elastic", 7).parts
    uneven = [max(own) / min(own) for own in (s.second_moments_m4 for s in parts.sections.values())]
    assert max(uneven) > 1.5
    base = parts.sections["base"]
    parts.sections["base"] = replace(base, second_moments_m4=(base.mean_moment_m4,) * 2)
    q = np.array([0.3, -0.9, 1.2, -0.4, 0.8, 0.1])
    first, second = (
        modal(stand(parts, q + turn * np.eye(6)[0])).frequencies_hz[:10] for turn in (0.0, 0.7)
    )
    np.testing.assert_allclose(first, second, rtol=1e-7)  # rounding of a stiff shell's matrices
