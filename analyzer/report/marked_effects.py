"""What was found, marked on a drawing of the arm."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.gap.records import EffectFound
from armodal.analyzer.report.arm_svg import MarkedAxis, found_svg
from armodal.analyzer.report.effect_words import axis_of_effect

__all__ = ["drawn_effects", "marked_effects"]


def drawn_effects(
    superset: Superset, joints_rad: npt.NDArray[np.float64], effects: Sequence[EffectFound]
) -> str:
    """Return the arm at some angles (joints,) with effects marked, as SVG; without any nothing."""
    axes, places = marked_effects(superset, effects)
    return found_svg(superset, joints_rad, axes, places) if axes or places else ""


def marked_effects(
    superset: Superset, effects: Sequence[EffectFound]
) -> tuple[tuple[MarkedAxis, ...], tuple[str, ...]]:
    """Return axes to draw, and names of joints and links to mark where there is no axis."""
    links = {joint.link.name for joint in superset.arm.joints}
    axes, places = [], []
    for effect in effects:
        axis = axis_of_effect(effect)
        if axis is not None and axis.link in links:
            axes.append(axis)
        else:
            places += effect.place.split()  # "joint_1 and joint_2"
    return tuple(axes), tuple(places)
