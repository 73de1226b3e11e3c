"""The penalty method of file 002 on an identified session, beside the fit of whole FRFs."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from armodal.analyzer.arm.structure import believed_structure
from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.corrected.held import held_arm
from armodal.analyzer.identification.doubted_axes import DoubtedAxis, doubted_axes
from armodal.analyzer.identification.mode_fit import MeasuredModes
from armodal.analyzer.identification.penalty import PenaltyFit, fit_by_penalty
from armodal.analyzer.identification.prediction import roving_mass
from armodal.analyzer.identification.records import Identification
from armodal.protocols.arm.records import Arm
from armodal.protocols.errors import EstimateError
from armodal.protocols.session.records import Session

__all__ = ["SessionPenalty", "chosen_joints", "penalty_of_session"]


@dataclass(frozen=True, slots=True, kw_only=True)
class SessionPenalty:
    """The penalty method's stiffness of the chosen joints, and where it started."""

    joints: tuple[str, ...]  # of the structure
    postures: tuple[str, ...]
    start_n_m_per_rad: tuple[float, ...]
    start_from: tuple[str, ...]  # "one-joint" or "believed"
    fit: PenaltyFit
    doubted: tuple[DoubtedAxis, ...] = ()  # axes of the arm file that the modes do not bear out


def chosen_joints(arm: Arm, wanted: list[str]) -> tuple[int, ...]:
    """Positions among the elastic joints of joints given by name or by number from 1.

    Raises
    ------
    EstimateError
        If one is no joint of the arm, rigid, or given twice.
    """
    names = [joint.name for joint in arm.joints]
    elastic = list(believed_structure(arm).joints)
    chosen: list[int] = []
    for text in wanted:
        number = names.index(text) if text in names else -1
        if number < 0 and text.isascii() and text.isdigit():
            number = int(text) - 1
        if not 0 <= number < len(names):
            raise EstimateError(
                f"wanted joints of arm '{arm.name}' by name or number 1 to {len(names)} "
                f"({', '.join(names)}), got {text!r}"
            )
        if number not in elastic:
            raise EstimateError(
                f"{names[number]} of arm '{arm.name}' has no stiffness in the arm file, so it is "
                "rigid: give it a first guess there, or choose other joints"
            )
        if elastic.index(number) in chosen:
            raise EstimateError(f"wanted each joint once, got {names[number]} again")
        chosen.append(elastic.index(number))
    return tuple(chosen)


def penalty_of_session(
    session: Session, result: Identification, chosen: tuple[int, ...]
) -> SessionPenalty:
    """Fit the chosen joints by Eq. (13) to the modes of all postures but those for validation.

    As in file 002, section 5, every joint starts from its one-joint stiffness where it has a mode
    of its own, else from the arm file's belief; those not chosen stay there. Structural axes that
    the fit found are no part of this method: modes with their shapes find no partner and have no
    say. The arm file's own axes and other effects stay as the file has them.

    Raises
    ------
    EstimateError
        As `fit_by_penalty` does.
    ArmError
        If an effect of the arm file cannot stay as it is while joints are fitted.
    """
    ready = held_arm(session.header.arm)
    arm = ready.arm
    superset = Superset(arm)
    structure = replace(believed_structure(arm), axes=ready.axes, held=ready.held)
    own = {row.joint: row.k_one_joint_n_m_per_rad for row in result.joints}
    names = tuple(arm.joints[joint].name for joint in structure.joints)
    start = np.array(
        [
            believed if own.get(name) is None else own[name]
            for name, believed in zip(names, structure.stiffness_n_m_per_rad, strict=True)
        ],
        dtype=np.float64,
    )
    held_out = {p.name for p in session.header.plan.postures if p.validation}
    used = [
        (frf, model)
        for frf, model in zip(result.frfs, result.modal_models, strict=True)
        if frf.posture not in held_out and frf.joints_rad is not None
    ]
    mass_kg = session.header.plan.sensor.mass_kg
    start_structure = replace(structure, stiffness_n_m_per_rad=start)
    postures = tuple(
        MeasuredModes.of(superset, superset.posture(frf.joints_rad), model)
        for frf, model in used
        if frf.joints_rad is not None
    )
    masses = tuple(roving_mass(superset, frf, mass_kg) for frf, _ in used)
    fit = fit_by_penalty(superset, start_structure, postures, chosen, added_mass_kg=masses)
    return SessionPenalty(
        joints=names,
        postures=tuple(frf.posture for frf, _ in used),
        start_n_m_per_rad=tuple(start.tolist()),
        start_from=tuple("believed" if own.get(name) is None else "one-joint" for name in names),
        fit=fit,
        doubted=doubted_axes(superset, start_structure, postures, fit, added_mass_kg=masses),
    )
