"""Frequencies over the wrist's position in the meridian plane: file 002, Figs. 14 to 16."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from armodal.analyzer.workspace.batch import ArmBatch
from armodal.analyzer.workspace.meridian import ELBOWS, MeridianPlane, meridian_plane
from armodal.analyzer.workspace.spectrum import ElasticJoints, spectrum
from armodal.protocols.arm.records import Arm

__all__ = ["FrequencyMap", "map_frequencies"]

Array = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class FrequencyMap:
    """First frequencies where the wrist can stand; NaN elsewhere.

    The first index of `f_hz` is the elbow, up then down.
    """

    horizontal_m: Array  # (n_horizontal,)
    vertical_m: Array  # (n_vertical,)
    joints_rad: Array  # (2, n_vertical, n_horizontal, n_joints)
    f_hz: Array  # (2, n_vertical, n_horizontal, n_modes)
    damping_ratio: Array  # as f_hz
    notes: tuple[str, ...]  # where the wrist's centre is, and what is held


def map_frequencies(
    arm: Arm, elastic: ElasticJoints, *, n_lines: int = 121, batch: ArmBatch | None = None
) -> FrequencyMap:
    """Map frequencies and damping over the wrist's reach, all but shoulder and elbow held.

    Parameters
    ----------
    n_lines
        Grid lines each way over the square that holds the wrist's reach.
    batch
        As in `study_workspace`.

    Raises
    ------
    ArmError
        If the arm has no meridian plane.
    """
    plane = meridian_plane(arm)
    sides = np.linspace(-plane.reach_m, plane.reach_m, n_lines)
    horizontal, vertical = sides + plane.shoulder_m.real, sides + plane.shoulder_m.imag
    grid = np.meshgrid(horizontal, vertical)
    q = np.stack([plane.joints(*grid, elbow) for elbow in ELBOWS])
    reached = ~np.isnan(q).any(axis=-1)
    modes = spectrum(batch or ArmBatch(arm), q[reached], elastic)
    f_hz = np.full((*reached.shape, modes.f_hz.shape[1]), np.nan)
    damping = f_hz.copy()
    f_hz[reached], damping[reached] = modes.f_hz, modes.damping_ratio
    return FrequencyMap(
        horizontal_m=horizontal,
        vertical_m=vertical,
        joints_rad=q,
        f_hz=f_hz,
        damping_ratio=damping,
        notes=_notes(plane),
    )


def _notes(plane: MeridianPlane) -> tuple[str, ...]:
    arm, moved = plane.arm, (plane.shoulder, plane.elbow)
    notes = [plane.wrist.words(arm)]
    turned = [i for i in range(plane.shoulder + 1, plane.elbow) if i not in moved]
    if turned:
        names = ", ".join(arm.joints[i].name for i in turned)
        notes.append(
            f"maps are over {arm.joints[plane.shoulder].name} and {arm.joints[plane.elbow].name}: "
            f"{names} can turn the elbow out of the plane, and is held"
        )
    away = [i for i in range(len(arm.joints)) if plane.held_rad[i] != 0.0]
    if away:
        told = ", ".join(
            f"{arm.joints[i].name} at {np.degrees(plane.held_rad[i]):.0f} deg" for i in away
        )
        notes.append(f"in the maps, since zero is out of their range: {told}")
    return tuple(notes)
