"""An arm file's effects as fixed parts of the structure that `armodal identify` fits."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from armodal.analyzer.arm.hysteresis import REFERENCE_RAD_S
from armodal.analyzer.arm.structure import Axis, Held
from armodal.analyzer.corrected.chain import LOCKED, chain_of
from armodal.analyzer.corrected.correction import Correction, correction_of, stepped
from armodal.analyzer.corrected.posture import assembly_at, coordinate_names, stand
from armodal.analyzer.gap.model.assembly import Assembly
from armodal.protocols.arm.records import Arm, InertialLink
from armodal.protocols.errors import ArmError

__all__ = ["HeldArm", "held_arm", "with_bodies"]

Array = npt.NDArray[np.float64]

_STEP = 0.1  # of ln k and ln c, to see what hangs on them


@dataclass(frozen=True, slots=True, kw_only=True)
class HeldArm:
    """An arm whose links hold the bodies of its effects, and what else gives way."""

    arm: Arm
    axes: tuple[Axis, ...]  # inside links: where their fit begins
    held: Held | None  # None without effects
    notes: tuple[str, ...]


def held_arm(arm: Arm) -> HeldArm:
    """Return what a fit of joints' stiffness and damping keeps as the arm file has it.

    Raises
    ------
    ArmError
        If an effect is not the same in every posture, hangs on a joint's stiffness or damping
        itself, divides a link, turns a joint by another one's spring or an angle by an offset, or
        gives a joint a loss factor; all are named.
    """
    if not arm.effects:
        return HeldArm(arm=arm, axes=(), held=None, notes=())
    correction = correction_of(arm)
    chain_of(correction)  # names what is not the same in every posture
    refused = [
        f"{instance.title} ({why})"
        for instance in correction.hypothesis.instances
        for why in [_why_not(correction.only([instance]))]
        if why
    ]
    if refused:
        raise ArmError(
            f"arm '{arm.name}': wanted effects that stay as they are while stiffness and damping "
            f"are fitted, got {'; '.join(refused)}; give the session's arm without "
            f"{'it' if len(refused) == 1 else 'them'}, or use `armodal gap --arm`, which fits them"
        )
    at = assembly_at(correction, stand(correction, np.zeros(len(arm.joints))))
    lines = {i.size: i.title for i in correction.hypothesis.instances if i.is_line}
    names = ", ".join(title for title in correction.titles if title not in lines.values())
    notes = [f"as the arm file has them, not fitted: {names}"] if names else []
    if lines:
        notes.append(f"fitted anew from where the arm file has them: {', '.join(lines.values())}")
    if any(f and g > LOCKED for f, g in zip(at.compliance_loss_factor, at.compliance, strict=True)):
        at_hz = REFERENCE_RAD_S / (2.0 * np.pi)
        notes.append(f"their loss factors count as dashpots that lose as much at {at_hz:.0f} Hz")
    return HeldArm(
        arm=with_bodies(arm, at),
        axes=tuple(_axis(correction, at, at.names[size]) for size in lines),
        held=_held(correction, at, [at.names[size] for size in lines]),
        notes=(*notes, *correction.notes),
    )


def _axis(correction: Correction, at: Assembly, column: int) -> Axis:
    superset = correction.ordinary.superset
    twists = at.columns[column][6:].reshape(superset.n_joints, 7)[:, 1:]
    (link,) = np.flatnonzero(twists.any(axis=1))
    linear, angular = twists[link, :3], twists[link, 3:]
    k = 1.0 / at.compliance[column]
    return Axis(
        link=int(link),
        direction=angular,
        point_m=np.cross(angular, linear),
        stiffness_n_m_per_rad=k,
        damping_n_m_s_per_rad=k * _loss_s(at, column),
    )


def _held(correction: Correction, at: Assembly, free: Sequence[int]) -> Held:
    elastic = len(correction.ordinary.elastic)
    gives = [
        i
        for i, gamma in enumerate(at.compliance)
        if i >= elastic and gamma > LOCKED and i not in free
    ]
    chosen = [*range(elastic), *gives]
    n = len(at.columns)
    found = {kind: np.zeros((n, n)) for kind in ("mass", "damping", "stiffness")}
    for kind, i, j, value in _beside_drives(correction, at):
        if kind != "loss":  # all zero, or the effect is refused
            found[kind][i, j] += value
    for i in gives:
        found["stiffness"][i, i] += 1.0 / at.compliance[i]
        found["damping"][i, i] += _loss_s(at, i) / at.compliance[i]
    moved = np.stack(at.columns, axis=1)
    found["mass"] += moved[:6].T @ at.base_inertia @ moved[:6]
    name_of = coordinate_names(at)
    return Held(
        names=tuple(name_of[i] for i in gives),
        motion=moved[:, gives],
        **{kind: matrix[np.ix_(chosen, chosen)] for kind, matrix in found.items()},
    )


def _loss_s(at: Assembly, column: int) -> float:
    """Damping over stiffness: of a loss factor, that which loses as much at the reference."""
    return at.compliance_loss_s[column] + at.compliance_loss_factor[column] / REFERENCE_RAD_S


def _beside_drives(correction: Correction, at: Assembly) -> list[tuple[str, int, int, float]]:
    """Terms that are not joints' own springs and dampers."""
    plain = correction.only(())
    own = assembly_at(plain, stand(plain, np.zeros(len(correction.ordinary.arm.joints)))).terms
    return at.terms[len(own) :]


def _why_not(own: Correction) -> str:
    """Why an effect cannot be held; empty if it can."""
    still = np.zeros(len(own.ordinary.arm.joints))
    at = assembly_at(own, stand(own, still))
    elastic = [own.ordinary.arm.joints[i].name for i in own.ordinary.elastic]
    steps = {f"ln {what} {joint}": _STEP for what in "kc" for joint in elastic}
    other = assembly_at(stepped(own, steps), stand(own, still))
    columns = np.eye(at.columns[0].size)[
        [own.ordinary.superset.joint_column(i) for i in own.ordinary.elastic]
    ]
    reasons = {
        "hangs on a joint's stiffness or damping": (
            _beside_drives(own, at) != _beside_drives(own, other)
        ),
        "gives a joint a loss factor": any(
            kind == "loss" and value for kind, _, _, value in at.terms
        ),
        "acts between links": bool(at.stretches),
        "divides a link": bool(at.pieces),
        "moves an angle": own.ordinary.encoder(own.values).any(),
        "turns a joint by another one's spring": not np.array_equal(
            np.stack(at.columns[: len(elastic)]), columns
        ),
    }
    return next((why for why, is_so in reasons.items() if is_so), "")


def with_bodies(arm: Arm, at: Assembly) -> Arm:
    """Return an arm whose links hold the bodies that its effects put on them."""
    joints = tuple(
        replace(joint, link=_body(joint.link, inertia))
        for joint, inertia in zip(arm.joints, at.link_inertia, strict=True)
    )
    return replace(arm, joints=joints)


def _body(link: InertialLink, inertia: Array) -> InertialLink:
    mass, moment = float(inertia[0, 0]), inertia[3:, :3]
    center = np.array([moment[2, 1], moment[0, 2], moment[1, 0]]) / mass
    square = center @ center * np.eye(3) - np.outer(center, center)
    return replace(
        link, mass_kg=mass, center_m=center, inertia_kg_m2=inertia[3:, 3:] - mass * square
    )
