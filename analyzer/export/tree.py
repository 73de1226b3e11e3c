"""A corrected arm as bodies, joints and springs between joints, which simulators can hold.

Every elastic joint stays as it is, driven, and gets a twin in series on the same axis, `NAME_flex`,
with its spring and damper: the angle commanded and the angle of the link differ as they do on the
arm. What effects let give way is a joint likewise. All of these rest at zero in every posture.
"""

from __future__ import annotations

import re
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from armodal.analyzer.corrected.chain import Chain, Element
from armodal.protocols.arm.records import Arm
from armodal.protocols.errors import ArmError

__all__ = ["Between", "Freedom", "Rotor", "Tree", "TreeBody", "tree_of"]

Array = npt.NDArray[np.float64]

_NONE = 1e-12  # of the larger of two: rounding
_LEAST = 1e-9  # of the largest moment: above what rounding leaves below zero


@dataclass(frozen=True, slots=True, kw_only=True)
class Freedom:
    """A joint of a body, its line in the body's frame."""

    name: str
    slides: bool
    axis: Array  # (3,) unit
    point_m: Array  # (3,)
    driven: bool = False  # by the user; else elastic
    stiffness: float = 0.0  # N m/rad or N/m
    damping: float = 0.0
    armature: float = 0.0  # kg m^2 or kg
    range_rad: tuple[float, float] | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class TreeBody:
    """A body; its freedoms act one after the other, each on what follows."""

    name: str
    link: int  # -1: the base
    parent: str  # "" for the world
    T_parent_body: Array  # (4, 4)
    freedoms: tuple[Freedom, ...]
    mass_kg: float
    center_m: Array  # (3,)
    inertia_kg_m2: Array  # (3, 3) about the centre


@dataclass(frozen=True, slots=True, kw_only=True)
class Rotor:
    """A drive's rotor, turning by itself; springs of `Between` hold it."""

    freedom: Freedom  # its armature is the inertia


@dataclass(frozen=True, slots=True, kw_only=True)
class Between:
    """A spring and a damper that stretch by first + ratio * second."""

    name: str
    first: str  # freedoms
    second: str
    ratio: float
    stiffness: float
    damping: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Tree:
    """Bodies from the base outwards."""

    bodies: tuple[TreeBody, ...]
    rotors: tuple[Rotor, ...]
    between: tuple[Between, ...]

    @property
    def elastic(self) -> tuple[str, ...]:
        """Return the names of the elastic freedoms, rotors last."""
        own = [f.name for body in self.bodies for f in body.freedoms if not f.driven]
        return (*own, *(rotor.freedom.name for rotor in self.rotors))


def tree_of(arm: Arm, chain: Chain) -> Tree:
    """Return the bodies of an arm.

    Raises
    ------
    ArmError
        If springs or inertias between freedoms are such as no pair of joints can have; all are
        named.
    """
    names = _names(chain)
    moving = [i for i, row in enumerate(chain.combine) if row.any()]
    still = [j for j, column in enumerate(chain.combine.T) if not column.any()]
    n = len(chain.names)
    moved = np.zeros((len(moving) + len(still), n))
    moved[: len(moving)] = chain.combine[moving]
    moved[range(len(moving), len(moved)), still] = 1.0
    if len(moved) != n or abs(np.linalg.det(moved)) < _NONE:
        turned = ", ".join(
            chain.elements[i].name for i in moving if np.count_nonzero(chain.combine[i]) > 1
        )
        raise ArmError(
            f"arm '{arm.name}': wanted joints that each have a spring of their own, got {turned}, "
            "which follows another one's spring without giving way itself; no simulator's joint "
            "does that. Give it a compliance, or leave the effect out"
        )
    back = np.linalg.inv(moved)
    mass, damping, stiffness = (
        back.T @ own @ back for own in (chain.mass, chain.damping, chain.stiffness)
    )
    elastic = [*(names[i] for i in moving), *(f"{_word(chain.names[j])}" for j in still)]
    _refuse_shared_mass(arm, mass, elastic)
    own, between = _pairs(arm, stiffness, damping, elastic)
    springs = {
        name: (k, c, float(m))
        for name, (k, c), m in zip(elastic, own, mass.diagonal(), strict=True)
    }
    bodies = _bodies(arm, chain, names, springs)
    rotors = tuple(
        Rotor(
            freedom=Freedom(
                name=name,
                slides=False,
                axis=np.array([0.0, 0.0, 1.0]),
                point_m=np.zeros(3),
                stiffness=springs[name][0],
                damping=springs[name][1],
                armature=springs[name][2],
            )
        )
        for name in elastic[len(moving) :]
    )
    return Tree(bodies=bodies, rotors=rotors, between=between)


def _word(name: str) -> str:
    return re.sub(r"[^A-Za-z0-9_.-]+", "_", name)


def _names(chain: Chain) -> list[str]:
    """A word for every element that gives way."""
    found: list[str] = []
    for element in chain.elements:
        word = f"{element.name}_flex" if element.joint is not None else _word(element.name)
        same = sum(name == word or name.startswith(f"{word}_again") for name in found)
        found.append(word if not same else f"{word}_again{same}")
    return found


def _bodies(
    arm: Arm, chain: Chain, names: list[str], springs: dict[str, tuple[float, float, float]]
) -> tuple[TreeBody, ...]:
    found: list[TreeBody] = []
    last = ""
    begun: int | None = None
    freedoms: list[Freedom] = []
    for number, element in enumerate(chain.elements):
        if element.link != begun:
            begun, freedoms = element.link, []
        if element.joint is not None:
            freedoms.append(_driven(arm, element))
        if names[number] in springs:
            k, c, m = springs[names[number]]
            freedoms.append(
                Freedom(
                    name=names[number],
                    slides=element.slides,
                    axis=element.direction,
                    point_m=element.point_m,
                    stiffness=k,
                    damping=c,
                    armature=m,
                )
            )
        ends = number + 1 == len(chain.elements) or chain.elements[number + 1].link != element.link
        if not (ends or element.inertia.any()):
            continue
        body = _body(arm, element, tuple(freedoms), last, found)
        found.append(body)
        last, freedoms = body.name, []
    return tuple(found)


def _of_a_body(inertia: Array) -> Array:
    """The tensor, rounding taken out that leaves its second moment below zero anywhere."""
    S = 0.5 * np.trace(inertia) * np.eye(3) - inertia
    values, axes = np.linalg.eigh(0.5 * (S + S.T))
    if values[0] >= 0.0:
        return inertia
    S = axes @ np.diag(np.maximum(values, _LEAST * np.abs(values).max())) @ axes.T
    return np.asarray(np.trace(S) * np.eye(3) - S)


def _driven(arm: Arm, element: Element) -> Freedom:
    joint = arm.joints[element.joint or 0]
    return Freedom(
        name=joint.name,
        slides=False,
        axis=element.direction,
        point_m=element.point_m,
        driven=True,
        range_rad=joint.range_rad,
    )


def _body(
    arm: Arm,
    element: Element,
    freedoms: tuple[Freedom, ...],
    parent: str,
    before: list[TreeBody],
) -> TreeBody:
    link = "base" if element.link < 0 else arm.joints[element.link].link.name
    pieces = sum(body.link == element.link for body in before)
    T = np.eye(4)
    if element.link >= 0 and not pieces:
        T = arm.joints[element.link].T_parent_joint
    mass, moment = float(element.inertia[0, 0]), element.inertia[3:, :3]
    center = np.zeros(3)
    about = element.inertia[3:, 3:]
    if mass > 0.0:
        center = np.array([moment[2, 1], moment[0, 2], moment[1, 0]]) / mass
        about = about - mass * (center @ center * np.eye(3) - np.outer(center, center))
    wanted = (about + about.T) / 2.0
    return TreeBody(
        name=link if not pieces else f"{link}_beyond{pieces}",
        link=element.link,
        parent=parent,
        T_parent_body=T,
        freedoms=freedoms,
        mass_kg=mass,
        center_m=center,
        inertia_kg_m2=_of_a_body(wanted),
    )


def _refuse_shared_mass(arm: Arm, mass: Array, names: list[str]) -> None:
    shared = [
        f"{names[i]} and {names[j]}"
        for i in range(len(names))
        for j in range(i)
        if abs(mass[i, j]) > _NONE * np.abs(mass).max()
    ]
    if shared:
        raise ArmError(
            f"arm '{arm.name}': wanted inertia of single joints, got inertia shared by "
            f"{', '.join(shared)}, which no simulator's joint has"
        )


def _pairs(
    arm: Arm, stiffness: Array, damping: Array, names: list[str]
) -> tuple[list[tuple[float, float]], tuple[Between, ...]]:
    """Each freedom's own spring and damper, and those between two, which add to the matrices."""
    own: dict[str, Array] = {}
    found: list[Between] = []
    for kind, matrix in (("stiffness", stiffness), ("damping", damping)):
        scale = _scale(arm, matrix, names, kind)
        off = np.abs(matrix) - np.diag(np.abs(matrix.diagonal()))
        off[off <= _NONE * np.abs(matrix).max(initial=0.0)] = 0.0
        own[kind] = matrix.diagonal() - off @ scale / scale
        for i, j in zip(*np.nonzero(np.triu(off)), strict=True):
            size = float(off[i, j] * scale[j] / scale[i])
            found.append(
                Between(
                    name=f"{names[i]}_to_{names[j]}_{kind}",
                    first=names[i],
                    second=names[j],
                    ratio=float(np.sign(matrix[i, j]) * scale[i] / scale[j]),
                    stiffness=size if kind == "stiffness" else 0.0,
                    damping=size if kind == "damping" else 0.0,
                )
            )
    both = zip(own["stiffness"], own["damping"], strict=True)
    return [(max(float(k), 0.0), max(float(c), 0.0)) for k, c in both], tuple(found)


def _scale(arm: Arm, matrix: Array, names: list[str], kind: str) -> Array:
    """Units d in which every own spring is positive beside those between two.

    A spring s that stretches by first + r second, with r = d_i / d_j and s r = |K_ij|, takes
    |K_ij| d_j / d_i from K_ii. All stay positive where the comparison matrix times d is: a d > 0
    exists for every H-matrix (Berman and Plemmons, Nonnegative Matrices in the Mathematical
    Sciences (1994), chapter 6).
    """
    compared = -np.abs(matrix)
    np.fill_diagonal(compared, matrix.diagonal())
    one = np.ones(len(names))
    least = -_NONE * np.abs(matrix).max(initial=0.0)
    if (compared @ one >= least).all():
        return one
    used = np.flatnonzero(matrix.diagonal() > 0.0)
    scale = one.copy()
    if len(used):
        inner = compared[np.ix_(used, used)]
        if abs(np.linalg.det(inner / inner.diagonal().max())) > 0.0:
            scale[used] = np.linalg.solve(inner, inner.diagonal())
    if (scale <= 0.0).any() or (compared @ scale < least * scale.max()).any():
        bad = [n for n, row in zip(names, matrix, strict=True) if np.count_nonzero(row) > 1]
        raise ArmError(
            f"arm '{arm.name}': wanted couplings that leave every joint a positive {kind} of its "
            f"own, got others among {', '.join(bad)}, which no simulator's joints can have; check "
            "the coupling's size"
        )
    return scale
