"""Where a damper between two links could stand, by a linear look.

A damper adds c r r' to C; r, the levers of its line about the joints between its ends, changes
with the posture. The column by an element of C of two joints is the same for every damper, so in
posture p one of levers r has

    dy / dc = sum_ij r_i r_j dy / dC_ij ,

and every pair of ends is judged from ten columns a posture.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product

import numpy as np
import numpy.typing as npt

from armodal.analyzer.gap.effects import nonproportional
from armodal.analyzer.gap.effects.nonproportional import FLOOR
from armodal.analyzer.gap.inference.fit import Fit, Stage
from armodal.analyzer.gap.model.effect import Instance
from armodal.analyzer.gap.model.geometry import PostureGeometry
from armodal.analyzer.gap.model.ordinary import Ordinary
from armodal.analyzer.gap.model.weighed_sums import summed
from armodal.analyzer.gap.search.scan import Candidate

__all__ = ["linear_candidates"]

Array = npt.NDArray[np.float64]

_RADII_M, _HEIGHTS_M, _TURNS = (0.2, 0.45), (0.0, 0.3), 8
_STEP_M = 0.1
_KEEP = 1


def linear_candidates(stage: Stage, fit: Fit, instances: Sequence[Instance]) -> list[Candidate]:
    """The most promising ends of a damper for each two links, best first."""
    here = {i.place: i for i in instances if i.effect is nonproportional.WORDS}
    ordinary = fit.hypothesis.ordinary
    ways = [
        (near, far)
        for near, far in product((FLOOR, 0), range(len(ordinary.arm.joints)))
        if " and ".join(nonproportional.ends_of(ordinary, near, far)) in here
    ]
    if not ways:
        return []
    furthest = max(far for _, far in ways)
    joints = [i for i in ordinary.elastic if i <= furthest]
    names = [ordinary.arm.joints[i].name for i in joints]
    pairs = [(a, b) for a in range(len(joints)) for b in range(a, len(joints))]
    std = nonproportional.size_std(ordinary)
    n = len(fit.space)
    found_at: dict[int, tuple[Array, Array, PostureGeometry]] = {}
    twice = np.array([1.0 if a == b else 2.0 for a, b in pairs])
    for rows, together in stage.once(fit.hypothesis, range(len(stage.lines))):
        y, fitted = together.columns(fit.hypothesis, fit.space, fit.values)
        columns, posed = together.damping_columns(
            fit.hypothesis, fit.values, [(names[a], names[b]) for a, b in pairs]
        )
        every = fitted.beside(columns * (std * twice)[:, None, None, None, None])
        for p, i in rows:
            part, _ = summed([stage.weighings[p]], y[[i]], every.of_posture(i), [0])
            found_at[p] = part.gradient, part.curvature, posed[i]
    gradients, curvatures, geometries = zip(
        *(found_at[p] for p in range(len(stage.lines))), strict=True
    )
    free = np.flatnonzero(fit.free)
    H = np.stack(curvatures)  # (postures, n + pairs, n + pairs)
    A = H.sum(axis=0)[np.ix_(free, free)] + np.eye(len(free))
    cross = H[:, n:, :n][:, :, free]
    own = H[:, n:, n:]
    slopes = np.stack(gradients)[:, n:]
    found = []
    for near, far in ways:
        ends = _ends(ordinary, near, far)
        levers = np.stack([_levers(ordinary, g, near, far, ends, joints) for g in geometries])
        q = np.stack([levers[..., a] * levers[..., b] for a, b in pairs], axis=-1)
        slope = np.einsum("pkq,pq->k", q, slopes)
        B = np.einsum("pkq,pqf->kf", q, cross)
        follow = np.linalg.solve(A, B.T).T
        left = np.einsum("pkq,pqr,pkr->k", q, own, q, optimize=True) + 1.0
        left = left - np.sum(B * follow, axis=1)
        gain = np.where(slope < 0.0, 0.5 * slope**2 / left, 0.0)
        place = " and ".join(nonproportional.ends_of(ordinary, near, far))
        instance = here[place]
        for k in np.argsort(-gain)[:_KEEP]:
            step = -slope[k] / left[k]
            u = fit.u.copy()
            u[free] = np.clip(u[free] - follow[k] * step, fit.space.low[free], fit.space.high[free])
            begin = fit.space.values(u) | {instance.size: float(step * std)}
            places = np.concatenate(ends[k]).tolist()
            begin |= dict(zip([x.name for x in instance.parameters[1:]], places, strict=True))
            found.append(Candidate(instance=instance, gain=float(gain[k]), begin=begin))
    return sorted(found, key=lambda c: -c.gain)


def _ends(ordinary: Ordinary, near: int, far: int) -> list[tuple[Array, Array]]:
    """Places of both ends that are tried."""
    return list(product(_about(ordinary, near), _about(ordinary, far)))


def _about(ordinary: Ordinary, link: int) -> list[Array]:
    if link == FLOOR:
        turns = 2.0 * np.pi * np.arange(_TURNS) / _TURNS
        return [
            np.array([r * np.cos(t), r * np.sin(t), h])
            for r, t, h in product(_RADII_M, turns, _HEIGHTS_M)
        ]
    middle = nonproportional.middle_of(ordinary, link)
    steps = [sign * _STEP_M * row for sign in (1.0, -1.0) for row in np.eye(3)]
    return [middle, 0.5 * middle, *(middle + step for step in steps)]


def _levers(
    ordinary: Ordinary,
    geometry: PostureGeometry,
    near: int,
    far: int,
    ends: Sequence[tuple[Array, Array]],
    joints: Sequence[int],
) -> Array:
    """(n_ends, n_joints) rate of the damper's length by each joint's."""
    columns = [ordinary.superset.joint_column(i) for i in joints]
    found = []
    for start, end in ends:
        to, v = nonproportional.velocity(geometry, far, end)
        at = start
        if near != FLOOR:
            at, v_from = nonproportional.velocity(geometry, near, start)
            v = v - v_from
        line = to - at
        found.append(line / max(float(np.linalg.norm(line)), 1e-3) @ v[:, columns])
    return np.array(found)
