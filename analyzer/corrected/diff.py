"""What changed between two arm files, in words and numbers."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from armodal.protocols.arm.records import AddedEffect, Arm, Estimate

__all__ = ["Change", "arm_changes"]

_SAME = 1e-9  # relative: rounding of a file


@dataclass(frozen=True, slots=True, kw_only=True)
class Change:
    """One thing that differs; a number that is on one side only has None on the other."""

    what: str
    unit: str
    before: float | None
    after: float | None
    words: str = ""  # for what is no number


def arm_changes(before: Arm, after: Arm) -> tuple[Change, ...]:
    """Return all that differs, but for comments: joints, links, effects, points, bus, history."""
    return (
        *_joints(before, after),
        *_links(before, after),
        *_effects(before, after),
        *_rest(before, after),
    )


def _joints(before: Arm, after: Arm) -> Iterator[Change]:
    old = {joint.name: joint for joint in before.joints}
    new = {joint.name: joint for joint in after.joints}
    yield from _names("joint", old, new)
    for name in [n for n in old if n in new]:
        one, other = old[name], new[name]
        for what, unit, a, b in (
            ("stiffness", "N m/rad", one.stiffness, other.stiffness),
            ("damping", "N m s/rad", one.damping, other.damping),
        ):
            yield from _estimate(f"{what} of {name}", unit, a, b)
        if not np.allclose(one.T_parent_joint, other.T_parent_joint, atol=_SAME):
            moved = float(np.linalg.norm(one.T_parent_joint[:3, 3] - other.T_parent_joint[:3, 3]))
            yield _said(f"{name} stands elsewhere: {1e3 * moved:.3f} mm, or turned")
        if not np.allclose(one.axis, other.axis, atol=_SAME):
            yield _said(f"the axis of {name} points elsewhere")
        if one.range_rad != other.range_rad:
            yield _said(f"the range of {name} differs")
        if one.inertial_std != other.inertial_std:
            yield _said(f"deviations of mass, centre and inertia of the link of {name} differ")


def _links(before: Arm, after: Arm) -> Iterator[Change]:
    old = {joint.link.name: joint.link for joint in before.joints}
    new = {joint.link.name: joint.link for joint in after.joints}
    yield from _names("link", old, new)
    for name in [n for n in old if n in new]:
        one, other = old[name], new[name]
        yield from _number(f"mass of {name}", "kg", one.mass_kg, other.mass_kg)
        for i, a in enumerate("xyz"):
            values = float(one.center_m[i]), float(other.center_m[i])
            yield from _number(f"centre {a} of {name}", "m", *values)
            for j, b in tuple(enumerate("xyz"))[i:]:
                moments = float(one.inertia_kg_m2[i, j]), float(other.inertia_kg_m2[i, j])
                yield from _number(f"inertia {a}{b} of {name}", "kg m²", *moments)


def _effects(before: Arm, after: Arm) -> Iterator[Change]:
    old = {(e.name, e.place): e for e in before.effects}
    new = {(e.name, e.place): e for e in after.effects}
    for key in [k for k in old if k not in new]:
        yield _said(f"taken out: {key[0]} ({key[1]})")
    for key, effect in new.items():
        what = f"{key[0]} ({key[1]})"
        if key not in old:
            sure = effect.evidence.confidence
            yield _said(f"added: {what}" + ("" if sure is None else f", {100 * sure:.0f} % sure"))
        yield from _parameters(what, old.get(key), effect)


def _parameters(what: str, old: AddedEffect | None, new: AddedEffect) -> Iterator[Change]:
    had = {} if old is None else {p.name: p for p in old.parameters}
    for p in new.parameters:
        if p.name not in had:
            yield Change(what=f"{what}: {p.name}", unit=p.unit, before=None, after=p.value)
        else:
            yield from _number(f"{what}: {p.name}", p.unit, had[p.name].value, p.value)
    if old is not None and dict(old.description) != dict(new.description):
        yield _said(f"{what} is described otherwise")


def _rest(before: Arm, after: Arm) -> Iterator[Change]:
    if before.name != after.name:
        yield _said(f"called {after.name}, before {before.name}")
    old = {point.id: point for point in before.points}
    new = {point.id: point for point in after.points}
    yield from _names("point", old, new)
    apart = {n: old[n].position_m - new[n].position_m for n in old if n in new}
    far = {n: 1e3 * float(np.linalg.norm(d)) for n, d in apart.items()}
    moved = [f"{n} by {mm:.2f} mm" for n, mm in far.items() if mm > 1e3 * _SAME]
    if moved:
        yield _said(f"points moved: {', '.join(moved)}")
    both = [(old[name], new[name]) for name in old if name in new]
    turned = [
        a.id for a, b in both if not np.allclose(a.R_link_sensor, b.R_link_sensor, atol=_SAME)
    ]
    if turned:
        yield _said(f"sensors stand otherwise at points {', '.join(turned)}")
    for a, b in both:
        if a.link != b.link:
            yield _said(f"point {a.id} is on {b.link}, before on {a.link}")
    if before.groups != after.groups:
        yield _said("groups of points differ")
    if before.can != after.can:
        yield _said("signals of the bus differ")
    if _boxes(before) != _boxes(after):
        yield _said("boxes that the arm stays out of differ")
    if before.tolerances != after.tolerances:
        yield _said("tolerances differ")
    if not np.array_equal(before.gravity_m_s2, after.gravity_m_s2):
        yield _said("gravity differs")
    known = {own.session_sha256 for own in before.history}
    for own in after.history:
        if own.session_sha256 not in known:
            yield _said(f"from session {own.session_sha256[:12]} by {own.by}, {own.created}")


def _boxes(arm: Arm) -> list[tuple[object, ...]]:
    return [(box.name, box.low_m.tolist(), box.high_m.tolist()) for box in arm.keep_outs]


def _names(what: str, old: Mapping[str, object], new: Mapping[str, object]) -> Iterator[Change]:
    gone = [name for name in old if name not in new]
    come = [name for name in new if name not in old]
    if gone:
        yield _said(f"{what}s gone: {', '.join(gone)}")
    if come:
        yield _said(f"{what}s come: {', '.join(come)}")


def _estimate(what: str, unit: str, a: Estimate | None, b: Estimate | None) -> Iterator[Change]:
    if a is None and b is None:
        return
    if a is None or b is None:
        yield Change(
            what=what,
            unit=unit,
            before=None if a is None else a.value,
            after=None if b is None else b.value,
        )
        return
    yield from _number(what, unit, a.value, b.value)
    yield from _number(f"deviation of {what}", unit, a.std, b.std)


def _number(what: str, unit: str, a: float, b: float) -> Iterator[Change]:
    if abs(a - b) > _SAME * max(abs(a), abs(b)):
        yield Change(what=what, unit=unit, before=a, after=b)


def _said(words: str) -> Change:
    return Change(what=words, unit="", before=None, after=None, words=words)
