"""Matrices of the equations of several postures at once, and how they change with the angles."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace

import numpy as np
import numpy.typing as npt

from armodal.analyzer.gap.model.assembly import Assembly
from armodal.analyzer.gap.model.geometry import GeometrySlopes, skew
from armodal.analyzer.gap.model.system import Pieces, System

__all__ = [
    "MotionSlopes",
    "Slopes",
    "angle_slopes",
    "motion_slopes",
    "stacked_slopes",
    "systems",
]

Array = npt.NDArray[np.float64]
Indices = npt.NDArray[np.int64]


@dataclass(frozen=True, slots=True, kw_only=True)
class Slopes:
    """Change of P systems with each of k joint angles, per rad; all else stays.

    The mass changes by before' carried + carried' before.
    """

    before: Array  # (P, k, 6, n) twist of what is before the joint
    carried: Array  # (P, k, 6, n) minus the momentum of what is beyond
    moved: Array  # (P, k, m, 3, n)
    seen: Array  # (P, k, m, 3, n)
    tilted: Array  # (P, k, m, 3, n)
    hit: Array  # (P, k, n_hits, 3, n)

    def among(self, coordinates: Indices) -> Slopes:
        """Return those of some coordinates, the others locked."""
        return Slopes(**{f.name: getattr(self, f.name)[..., coordinates] for f in fields(self)})


@dataclass(frozen=True, slots=True, kw_only=True)
class MotionSlopes:
    """Change of P systems with k ways in which one coordinate moves otherwise.

    Of a matrix its row and column `at` change: the mass by both alike.
    """

    at: Indices  # (k,) coordinate
    mass: Array  # (P, k, n)
    stiffness_row: Array  # (P, k, n)
    stiffness_column: Array  # (P, k, n)
    moved: Array  # (P, m, 3, k)
    seen: Array  # (P, m, 3, k)
    tilted: Array  # (P, m, 3, k)
    hit: Array  # (P, n_hits, 3, k)

    def among(self, coordinates: Indices, ways: npt.NDArray[np.bool_]) -> MotionSlopes:
        """Return those of some coordinates, the others locked, and of some ways."""
        rows = ("mass", "stiffness_row", "stiffness_column")
        return replace(
            self,
            at=self.at[ways],
            **{name: getattr(self, name)[:, ways][..., coordinates] for name in rows},
            **{n: getattr(self, n)[..., ways] for n in ("moved", "seen", "tilted", "hit")},
        )


def systems(assemblies: Sequence[Assembly]) -> System:
    """Return the equations of postures with the same coordinates, mountings and hits, stacked."""
    first, T = assemblies[0], _columns(assemblies)
    P, N, n = T.shape
    links = np.array([own.geometry.link_jacobian for own in assemblies])
    link_motion = (links.reshape(P, -1, N) @ T).reshape(P, -1, 6, n)
    inertia = _inertias(assemblies)
    pieces = {
        link: Pieces(
            shares=shares,
            offsets_m=offsets,
            motion=first.motion_of_pieces(link, link_motion[:, link], range(n)),
        )
        for link, (shares, offsets) in first.all_pieces.items()
    }
    whole = [link for link in range(inertia.shape[1]) if link not in pieces]
    mass = _together(link_motion[:, whole], _pull(inertia[:, whole], link_motion[:, whole]))
    for link, piece in pieces.items():
        mass += _together(piece.motion, _pull(piece.split(inertia[:, link]), piece.motion))
    base = T[:, :6]
    base_inertia = np.array([own.base_inertia for own in assemblies])
    mass += base.swapaxes(1, 2) @ base_inertia @ base
    gravity = _gravity(assemblies)
    matrices = {
        "mass": mass,
        "damping": np.zeros((P, n, n)),
        "stiffness": T.swapaxes(1, 2) @ gravity @ T,
        "loss": np.zeros((P, n, n)),
    }
    relaxing = np.zeros((len(first.relaxing_rad_s), P, n, n))
    matrices |= dict(zip(first.relaxing_rad_s, relaxing, strict=True))
    values = np.array([[value for *_, value in own.terms] for own in assemblies])
    for term, (kind, i, j, _) in enumerate(first.terms):
        matrices[kind][:, i, j] += values[:, term]
    for at, (kind, row, _) in enumerate(first.stretches):
        rows = np.array([own.stretches[at][1] for own in assemblies])
        value = np.array([own.stretches[at][2] for own in assemblies])
        square = value[:, None, None] * rows[:, :, None] * rows[:, None, :]
        matrices[kind][:, : row.size, : row.size] += square
    where, hits = _mountings(assemblies)
    motion = _point_motion(assemblies, T, range(n))
    J = _at(motion, where)
    R = _turned_back(assemblies, where)
    turned = R @ J[..., 3:, :]
    unmixed = np.broadcast_to(np.eye(3), (where.shape[1], 3, 3))
    return System(
        **{kind: matrices[kind] for kind in ("mass", "damping", "stiffness", "loss")},
        relaxing=relaxing.swapaxes(0, 1),
        relaxing_rad_s=np.array([[*own.relaxing_rad_s.values()] for own in assemblies]),
        loss_power=np.array([own.loss_power for own in assemblies]),
        compliance=np.array([own.compliance for own in assemblies]),
        compliance_loss_s=np.array([own.compliance_loss_s for own in assemblies]),
        compliance_loss_factor=np.array([own.compliance_loss_factor for own in assemblies]),
        link_motion=link_motion,
        base_motion=base,
        pieces=pieces,
        moved=J[..., :3, :],
        seen=R @ J[..., :3, :] - skew(_places(assemblies, where.shape[1])) @ turned,
        tilted=R @ (_weights(assemblies)[:, None] @ J[..., 3:, :]),
        turned=turned,
        mix=np.array([unmixed if own.mix is None else own.mix for own in assemblies]),
        hit=_moved_beside(_at(motion, hits), _beside(assemblies, hits)),
        hit_turned=_at(motion, hits)[..., 3:, :],
        force=np.array([own.forces @ own.hit_turn.T for own in assemblies]),
        log_scale=np.array([own.log_scale for own in assemblies]),
        delay_s=np.array([own.delay_s for own in assemblies]),
        decay_rad_s=np.array([own.decay_rad_s for own in assemblies]),
        sensor_mass_kg=np.array(
            [own.lines.sensor_mass_kg + own.sensor_mass_kg for own in assemblies]
        ),
    )


def stacked_slopes(slopes: Sequence[GeometrySlopes]) -> GeometrySlopes:
    """Return geometries' slopes with postures as the first axis of every array."""
    return GeometrySlopes(
        before=np.array([own.before for own in slopes]),
        to_link=np.array([own.to_link for own in slopes]),
        link_jacobian=np.array([own.link_jacobian for own in slopes]),
        point_jacobian=np.array([own.point_jacobian for own in slopes]),
        point_rotation=np.array([own.point_rotation for own in slopes]),
    )


def angle_slopes(
    assemblies: Sequence[Assembly], system: System, geometry: GeometrySlopes
) -> Slopes:
    """Return how the matrices change with the angles; effects' own terms and gravity's stay.

    `system` and `geometry` stacked.
    """
    T = _columns(assemblies)
    n = T.shape[-1]
    momentum = _pull(_inertias(assemblies), system.link_motion)  # (P, n_links, 6, n)
    for link, piece in system.pieces.items():
        split = piece.split(_inertias(assemblies)[:, link])
        momentum[:, link] = _pull(split, piece.motion).sum(axis=1)
    momentum = geometry.to_link.swapaxes(-1, -2) @ momentum
    beyond = momentum[:, ::-1].cumsum(axis=1)[:, ::-1]  # of each joint's link and all after it
    where, hits = _mountings(assemblies)
    motion = _point_motion(assemblies, T, range(n))
    slopes = _point_slopes(assemblies, motion, geometry, T)
    J, dJ = _at(motion, where)[:, None], _along(slopes, where)
    R = _turned_back(assemblies, where)[:, None]
    dR = _along(geometry.point_rotation, where).swapaxes(-1, -2)
    weights = _weights(assemblies)[:, None, None]
    off = _beside(assemblies, hits)
    turned_off = skew(
        (_along(geometry.point_rotation, hits) @ _hit_places(assemblies, hits)[:, None, ..., None])[
            ..., 0
        ]
    )
    return Slopes(
        before=geometry.before @ T[:, None],
        carried=-beyond,
        moved=dJ[..., :3, :],
        seen=dR @ J[..., :3, :] + R @ dJ[..., :3, :],
        tilted=dR @ (weights @ J[..., 3:, :]) + R @ (weights @ dJ[..., 3:, :]),
        hit=_along(slopes, hits)[..., :3, :]
        - turned_off @ _at(motion, hits)[:, None, :, 3:]
        - off[:, None] @ _along(slopes, hits)[..., 3:, :],
    )


def motion_slopes(
    assemblies: Sequence[Assembly], system: System, names: Sequence[str]
) -> MotionSlopes:
    """Return how the matrices change with parameters that `Assembly.motion_of` knows, in turn.

    Each coordinate that a parameter moves has a row of its own. `system` stacked.
    """
    first, T = assemblies[0], _columns(assemblies)
    at = [coordinate for name in names for coordinate, _ in first.motion_of[name]]
    by = [name for name in names for _ in first.motion_of[name]]
    changes = [[way for name in names for _, way in own.motion_of[name]] for own in assemblies]
    dT = np.array(changes).swapaxes(1, 2)  # (P, N, k)
    P, N, k = dT.shape
    links = np.array([own.geometry.link_jacobian for own in assemblies])
    by_link = (links.reshape(P, -1, N) @ dT).reshape(P, -1, 6, k)
    inertia = _inertias(assemblies)
    whole = [link for link in range(inertia.shape[1]) if link not in system.pieces]
    pull = _pull(inertia[:, whole], system.link_motion[:, whole])
    mass = _together(by_link[:, whole], pull)
    for link, piece in system.pieces.items():
        turned = first.motion_of_pieces(link, by_link[:, link], at)
        for column, (coordinate, name) in enumerate(zip(at, by, strict=True)):
            inside = first.inside.get(coordinate)
            if inside is not None and inside.link == link and name in inside.by:
                unit = system.link_motion[:, link, :, coordinate]
                turned[..., column] += inside.moved_slope(unit, piece.shares, name)
        mass += _together(turned, _pull(piece.split(inertia[:, link]), piece.motion))
    base_inertia = np.array([own.base_inertia for own in assemblies])
    mass += dT[:, :6].swapaxes(1, 2) @ base_inertia @ T[:, :6]
    gravity = _gravity(assemblies)
    where, hits = _mountings(assemblies)
    motion = _point_motion(assemblies, dT, at, by)
    J = _at(motion, where)
    R = _turned_back(assemblies, where)
    return MotionSlopes(
        at=np.array(at),
        mass=mass,
        stiffness_row=dT.swapaxes(1, 2) @ gravity @ T,
        stiffness_column=(T.swapaxes(1, 2) @ (gravity @ dT)).swapaxes(1, 2),
        moved=J[..., :3, :],
        seen=R @ J[..., :3, :] - skew(_places(assemblies, where.shape[1])) @ (R @ J[..., 3:, :]),
        tilted=R @ (_weights(assemblies)[:, None] @ J[..., 3:, :]),
        hit=_moved_beside(_at(motion, hits), _beside(assemblies, hits)),
    )


def _gravity(assemblies: Sequence[Assembly]) -> Array:
    """(P, N, N) stiffness by gravity."""
    found = []
    for own in assemblies:
        per_mass = own.geometry.gravity_per_mass
        N = per_mass.shape[-1]
        found.append(np.concatenate(own.link_moments) @ per_mass.reshape(-1, N * N))
    return np.stack(found).reshape(len(found), N, N)


def _columns(assemblies: Sequence[Assembly]) -> Array:
    """(P, N, n) motion of the superset by each coordinate."""
    return np.array([own.columns for own in assemblies]).swapaxes(1, 2)


def _inertias(assemblies: Sequence[Assembly]) -> Array:
    """(P, n_links, 6, 6)."""
    return np.array([own.link_inertia for own in assemblies])


def _pull(inertia: Array, motion: Array) -> Array:
    """Momentum (..., bodies, 6, n) of unit motions (..., bodies, 6, n)."""
    return np.asarray(inertia @ motion)


def _together(motion: Array, pull: Array) -> Array:
    """Sum over bodies of motion' pull: (..., k, n) of (..., bodies, 6, k) and (..., 6, n)."""
    one, other = (a.reshape(*a.shape[:-3], -1, a.shape[-1]) for a in (motion, pull))
    return np.asarray(one.swapaxes(-1, -2) @ other)


def _mountings(assemblies: Sequence[Assembly]) -> tuple[Indices, Indices]:
    """Points (P, m) where sensors are taken to stand, and (P, n_hits) that are hit."""
    return (
        np.array([own.where for own in assemblies]),
        np.array([own.struck for own in assemblies]),
    )


def _at(of_points: Array, points: Indices) -> Array:
    """(P, k, ...) of (P, n_points, ...) at points (P, k)."""
    return np.asarray(of_points[np.arange(len(points))[:, None], points])


def _along(of_points: Array, points: Indices) -> Array:
    """(P, k, m, ...) of (P, k, n_points, ...) at points (P, m)."""
    return np.array([own[:, here] for own, here in zip(of_points, points, strict=True)])


def _turned_back(assemblies: Sequence[Assembly], where: Indices) -> Array:
    """(P, m, 3, 3) from the base frame to the sensors' axes."""
    R = np.array([own.geometry.point_rotation for own in assemblies])
    return _at(R, where).swapaxes(-1, -2)


def _places(assemblies: Sequence[Assembly], m: int) -> Array:
    """(P, m, 3) by which each sensor stands off its point, along its axes."""
    none = np.zeros((m, 3))
    return np.array([none if own.place_m is None else own.place_m for own in assemblies])


def _hit_places(assemblies: Sequence[Assembly], hits: Indices) -> Array:
    """(P, n_hits, 3) by which hits fall off their points, along the axes a sensor there has."""
    none = np.zeros((hits.shape[1], 3))
    return np.array([none if own.hit_place_m is None else own.hit_place_m for own in assemblies])


def _beside(assemblies: Sequence[Assembly], hits: Indices) -> Array:
    """(P, n_hits, 3, 3) cross products of that, base axes."""
    R = _at(np.array([own.geometry.point_rotation for own in assemblies]), hits)
    return skew((R @ _hit_places(assemblies, hits)[..., None])[..., 0])


def _moved_beside(motion: Array, off: Array) -> Array:
    """(P, n_hits, 3, k) motion of places off the points that move by (P, n_hits, 6, k)."""
    return np.asarray(motion[..., :3, :] - off @ motion[..., 3:, :])


def _weights(assemblies: Sequence[Assembly]) -> Array:
    """(P, 3, 3): a - g seen in axes turned by theta changes by theta x g."""
    return -skew(np.array([own.geometry.gravity_m_s2 for own in assemblies]))


def _point_motion(
    assemblies: Sequence[Assembly],
    T: Array,
    coordinates: Sequence[int],
    by: Sequence[str] = (),
) -> Array:
    """(P, n_points, 6, k) motion of points by columns (P, N, k), each of one of the coordinates.

    Points that stand elsewhere are shifted. If columns are changes of the coordinates' own, `by`
    names the parameter of each.
    """
    P, N, k = T.shape
    points = np.array([own.geometry.point_jacobian for own in assemblies]).reshape(P, -1, N)
    motion = (points @ T).reshape(P, -1, 6, k)
    for column, coordinate in enumerate(coordinates):
        if (inside := assemblies[0].inside.get(coordinate)) is not None:
            by_it, here = motion[..., column], inside.points
            arms = _arms(assemblies, here, inside.shift_m)
            by_it[:, here] = inside.part[:, None] * _turned_about(arms, by_it[:, here])
            if by and by[column] in inside.by:
                q = inside.by.index(by[column])
                unit = np.array([of.columns[coordinate] for of in assemblies])[..., None]
                whole = (points @ unit).reshape(P, -1, 6)[:, here]
                by_it[:, here] += inside.part_slopes[q][:, None] * _turned_about(arms, whole)
                further = _arms(assemblies, here, inside.shift_slopes_m[q])
                turns = inside.part[:, None] * whole[..., 3:]
                by_it[..., :3][:, here] -= _times(further, turns)
    for own, moved in zip(assemblies, motion, strict=True):
        for point, shift in own.shifts_m.items():
            arm = skew(own.geometry.point_rotation[point] @ shift)
            moved[point, :3] -= arm @ moved[point, 3:]
    return motion


def _times(M: Array, v: Array) -> Array:
    """Matrices (..., 3, 3) times vectors (..., 3)."""
    return np.asarray(np.matmul(M, v[..., None])[..., 0])


def _arms(assemblies: Sequence[Assembly], points: Indices, shift_m: Array) -> Array:
    """(P, k, 3, 3) cross products of shifts (k, 3) at points, along sensors' axes there."""
    R = np.array([own.geometry.point_rotation[points] for own in assemblies])
    return skew((R @ shift_m[..., None])[..., 0])


def _turned_about(arms: Array, motion: Array) -> Array:
    """Motion (P, k, 6) of points that turn about what is elsewhere by arms (P, k, 3, 3)."""
    linear = motion[..., :3] - _times(arms, motion[..., 3:])
    return np.concatenate([linear, motion[..., 3:]], axis=-1)


def _point_slopes(
    assemblies: Sequence[Assembly], motion: Array, geometry: GeometrySlopes, T: Array
) -> Array:
    """(P, k, n_points, 6, n) change of the points' motion with each angle."""
    P, N, n = T.shape
    k = geometry.point_jacobian.shape[1]
    found = (geometry.point_jacobian.reshape(P, -1, N) @ T).reshape(P, k, -1, 6, n)
    for at, inside in assemblies[0].inside.items():
        by_it = found[..., at]
        turns = by_it[:, :, inside.points]
        arms = _arms(assemblies, inside.points, inside.shift_m)[:, None]
        turns[..., :3] -= _times(arms, turns[..., 3:])
        turns *= inside.part[:, None]
        shift = geometry.point_rotation[:, :, inside.points] @ inside.shift_m[..., None]
        turns[..., :3] -= _times(skew(shift[..., 0]), motion[..., 3:, at][:, None, inside.points])
        by_it[:, :, inside.points] = turns
    for p, own in enumerate(assemblies):
        for point, shift in own.shifts_m.items():
            arm = skew(own.geometry.point_rotation[point] @ shift)
            turned = skew(geometry.point_rotation[p, :, point] @ shift)
            change = turned @ motion[p, point, 3:] + arm @ found[p, :, point, 3:]
            found[p, :, point, :3] -= change
    return found
