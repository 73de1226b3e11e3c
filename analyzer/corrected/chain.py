"""A corrected arm as one chain of hinges and slides that is the same in every posture.

What an effect lets give way is a joint nobody drives, between a link's own joint and its mass. A
chain of real and such joints, with springs between them, serves where many postures are evaluated
at once and where other programs are to have the arm.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.corrected.correction import Correction
from armodal.analyzer.corrected.posture import assembly_at, coordinate_names, stand
from armodal.analyzer.gap.model.assembly import Assembly
from armodal.analyzer.gap.model.effect import Instance
from armodal.analyzer.gap.model.system import Pieces
from armodal.protocols.errors import ArmError

__all__ = ["LOCKED", "Chain", "Element", "chain_of"]

Array = npt.NDArray[np.float64]

LOCKED = 1e-11  # rad/(N m) or m/N: a millionth of what a joint gives way by
_SAME = 1e-9  # relative
_SCREW_M = 1e-9  # pitch of a turn that is none


@dataclass(frozen=True, slots=True, kw_only=True)
class Element:
    """A hinge or a slide; it moves the mass it carries and everything behind it in the chain."""

    name: str  # of the joint, or of what gives way
    link: int  # whose frame the rest is in; -1: the base
    joint: int | None  # of the arm; None: nobody drives it
    slides: bool
    direction: Array  # (3,) unit, link frame
    point_m: Array  # (3,) of the line, link frame; the link's origin for a slide
    inertia: Array  # (6, 6) carried, about the link frame's origin, linear first


@dataclass(frozen=True, slots=True, kw_only=True)
class Chain:
    """k elements from the base outwards, and n coordinates.

    Equations: (T' M T + mass) x'' + damping x' + (stiffness + h(s) loss) x = T' J' f, M and J of
    the elements.
    """

    elements: tuple[Element, ...]
    offset_rad: Array  # (n_joints,) of the encoders
    names: tuple[str, ...]  # (n,)
    combine: Array  # T (k, n): how each element moves by each coordinate
    mass: Array  # (n, n) beside the elements'
    damping: Array  # (n, n)
    stiffness: Array  # (n, n), gravity's not included
    loss: Array  # (n, n) stiffness times loss factor


def chain_of(correction: Correction, *, level: float = 0.0) -> Chain:
    """Return the chain of an arm.

    Raises
    ------
    ArmError
        If an effect is not the same in every posture, or turns and slides at once; all are named.
    """
    superset = correction.ordinary.superset
    low, high = np.array([joint.range_rad for joint in correction.ordinary.arm.joints]).T
    first, second = (stand(correction, low + part * (high - low)) for part in (0.37, 0.61))

    def both(instances: tuple[Instance, ...]) -> tuple[Assembly, Assembly]:
        own = correction.only(instances)
        return assembly_at(own, first, level=level), assembly_at(own, second, level=level)

    every = correction.hypothesis.instances
    moving = [i.title for i in every if not _alike(*both((i,)))]
    if moving:
        raise ArmError(
            f"arm '{correction.ordinary.arm.name}': wanted effects that are the same in every "
            f"posture, got {'; '.join(moving)}; `armodal predict --arm` calculates with "
            f"{'it' if len(moving) == 1 else 'them'}"
        )
    return _chain(superset, both(every)[0], correction)


def _chain(superset: Superset, assembly: Assembly, correction: Correction) -> Chain:
    gives = [
        at for at, gamma in enumerate(assembly.compliance) if np.isnan(gamma) or gamma > LOCKED
    ]
    name_of = coordinate_names(assembly)
    by_link: dict[int, list[tuple[int, Element, tuple[int, float]]]] = {}
    for at in gives:
        name = name_of[at]
        for link, twist, size in _parts(superset, assembly.columns[at], name):
            inside = assembly.inside.get(at)
            before = inside.before if inside is not None and inside.link == link else 0
            element = _element(name, link, twist)
            by_link.setdefault(link, []).append((before, element, (at, size)))
    elements: list[Element] = []
    moved_by: list[list[tuple[int, float]]] = []
    for link in range(-1, superset.n_joints):
        own = sorted(by_link.get(link, []), key=lambda row: row[0])
        bodies = _bodies(assembly, link)
        if link >= 0:
            elements.append(_drive(superset, link))
            moved_by.append(_driven_by(superset, assembly, link, gives))
        begun = len(elements) - (link >= 0)
        for number, body in enumerate(bodies):
            for before, element, by in own:
                if before == number:
                    elements.append(element)
                    moved_by.append([by])
            if len(elements) > begun:
                last = elements[-1]
                elements[-1] = replace(last, inertia=last.inertia + body)
    combine = np.zeros((len(elements), len(gives)))
    for row, terms in enumerate(moved_by):
        for at, size in terms:
            combine[row, gives.index(at)] += size
    matrices = _matrices(assembly, gives)
    return Chain(
        elements=tuple(elements),
        offset_rad=correction.ordinary.encoder(correction.values),
        names=tuple(name_of[at] for at in gives),
        combine=combine,
        **matrices,
    )


def _parts(superset: Superset, column: Array, name: str) -> Iterator[tuple[int, Array, float]]:
    """Links whose interface a coordinate moves, with the twist in the link's frame."""
    for link in range(-1, superset.n_joints):
        twist = column[:6] if link < 0 else column[superset.interface_columns(link)]
        size = float(np.linalg.norm(twist[3:])) or float(np.linalg.norm(twist))
        if not size:
            continue
        unit = twist / size
        if unit[3:].any() and abs(unit[:3] @ unit[3:]) > _SCREW_M:
            raise ArmError(
                f"wanted hinges and slides, got '{name}', which turns and slides along its line at "
                "once; `armodal predict --arm` calculates with it"
            )
        yield link, unit, size


def _element(name: str, link: int, twist: Array) -> Element:
    linear, angular = twist[:3], twist[3:]
    slides = not angular.any()
    return Element(
        name=name,
        link=link,
        joint=None,
        slides=slides,
        direction=linear if slides else angular,
        point_m=np.zeros(3) if slides else np.cross(angular, linear),
        inertia=np.zeros((6, 6)),
    )


def _drive(superset: Superset, link: int) -> Element:
    joint = superset.arm.joints[link]
    return Element(
        name=joint.name,
        link=link,
        joint=link,
        slides=False,
        direction=np.asarray(joint.axis),
        point_m=np.zeros(3),
        inertia=np.zeros((6, 6)),
    )


def _driven_by(
    superset: Superset, assembly: Assembly, link: int, gives: Sequence[int]
) -> list[tuple[int, float]]:
    row = superset.joint_column(link)
    return [(at, float(assembly.columns[at][row])) for at in gives if assembly.columns[at][row]]


def _bodies(assembly: Assembly, link: int) -> list[Array]:
    """What a link carries, piece by piece from its joint outwards: (6, 6) each."""
    if link < 0:
        return [assembly.base_inertia]
    whole = assembly.link_inertia[link]
    if link not in assembly.pieces:
        return [whole]
    shares, offsets = assembly.pieces[link]
    pieces = Pieces(shares=shares, offsets_m=offsets, motion=np.zeros((len(shares), 6, 0)))
    return list(pieces.split(whole))


def _matrices(assembly: Assembly, gives: Sequence[int]) -> dict[str, Array]:
    n = len(assembly.columns)
    found = {kind: np.zeros((n, n)) for kind in ("mass", "damping", "stiffness", "loss")}
    for kind, i, j, value in assembly.terms:
        found[kind][i, j] += value
    for kind, row, value in assembly.stretches:
        found[kind][: row.size, : row.size] += value * np.outer(row, row)
    for at in gives:
        gamma = assembly.compliance[at]
        if not np.isnan(gamma):
            found["stiffness"][at, at] += 1.0 / gamma
            found["damping"][at, at] += assembly.compliance_loss_s[at] / gamma
            found["loss"][at, at] += assembly.compliance_loss_factor[at] / gamma
    return {kind: matrix[np.ix_(gives, gives)] for kind, matrix in found.items()}


def _alike(one: Assembly, other: Assembly) -> bool:
    """Whether two postures' equations differ by their geometry alone."""
    pairs = [
        (np.stack(one.columns), np.stack(other.columns)),
        (np.array(one.compliance), np.array(other.compliance)),
        (np.array(one.compliance_loss_s), np.array(other.compliance_loss_s)),
        (np.array(one.compliance_loss_factor), np.array(other.compliance_loss_factor)),
        (np.array([v for *_, v in one.terms]), np.array([v for *_, v in other.terms])),
        (np.stack(one.link_inertia), np.stack(other.link_inertia)),
    ]
    pairs += [
        (np.append(row, value), np.append(there, of))
        for (_, row, value), (_, there, of) in zip(one.stretches, other.stretches, strict=True)
    ]
    return all(
        np.allclose(a, b, rtol=_SAME, atol=_SAME * np.abs(np.nan_to_num(a)).max(), equal_nan=True)
        for a, b in pairs
    )
