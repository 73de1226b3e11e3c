"""Effects that change a joint's stiffness from posture to posture, by a linear look.

The derivative by ln k of a joint is known posture by posture. A stiffness that is w_p of the
joint's in posture p has the column sum_p w_p dy_p / d ln k, so every law w of the joint's angle is
judged from products that are there already.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from armodal.analyzer.gap.effects import gravity_compensator
from armodal.analyzer.gap.inference.fit import Fit, Stage
from armodal.analyzer.gap.model.effect import Instance
from armodal.analyzer.gap.search.scan import Candidate

__all__ = ["linear_candidates"]

Array = npt.NDArray[np.float64]

_ANGLES = np.linspace(-np.pi, np.pi, 36, endpoint=False)
_RATIOS = (1.2, 1.5, 2.2)


def linear_candidates(stage: Stage, fit: Fit, instances: Sequence[Instance]) -> list[Candidate]:
    """Angles of a compensator that promise more than those beside them, best first."""
    here = [i for i in instances if i.effect is gravity_compensator.WORDS]
    if not here:
        return []
    parts = stage.quadratics(fit.hypothesis, fit.space, fit.values, range(len(stage.lines)))
    gradient = np.stack([p.gradient for p in parts])
    curvature = np.stack([p.curvature for p in parts])
    free = np.flatnonzero(fit.free)
    A = curvature.sum(axis=0)[np.ix_(free, free)] + np.eye(len(free))
    arm = fit.hypothesis.ordinary.arm
    found = []
    for instance in here:
        joint = next(i for i, j in enumerate(arm.joints) if j.name == instance.place)
        at = fit.space.index[f"ln k {instance.place}"]
        believed = arm.joints[joint].stiffness
        scale = (
            0.0
            if believed is None
            else believed.value / np.exp(fit.values[f"ln k {instance.place}"])
        )
        q = np.array([lines.joints_rad[joint] for lines in stage.lines])
        grid = [(angle, ratio) for ratio in _RATIOS for angle in _ANGLES]
        w = np.stack([gravity_compensator.shares(q + a, r)[0] for a, r in grid])
        w = w * scale / fit.space.std[at] * gravity_compensator.STD
        slope = w @ gradient[:, at]
        B = w @ curvature[:, at][:, free]  # (n_grid, n_free)
        follow = np.linalg.solve(A, B.T).T
        left = w**2 @ curvature[:, at, at] + 1.0 - np.sum(B * follow, axis=1)
        gain = np.where(slope < 0.0, 0.5 * slope**2 / left, 0.0)
        stiff, _, angle, ratio, *_, growth = gravity_compensator.names_at(instance.place)
        for i in _peaks(gain.reshape(len(_RATIOS), len(_ANGLES))):
            step = -slope[i] / left[i]
            u = fit.u.copy()
            u[free] = np.clip(u[free] - follow[i] * step, fit.space.low[free], fit.space.high[free])
            begin = {
                **fit.space.values(u),
                stiff: float(step * gravity_compensator.STD),
                angle: float(grid[i][0]),
                ratio: float(np.log(grid[i][1])),
                growth: 0.0,  # as it was looked at
            }
            found.append(Candidate(instance=instance, gain=float(gain[i]), begin=begin))
    return sorted(found, key=lambda c: -c.gain)


def _peaks(gain: Array) -> list[int]:
    """Where gains (n_ratios, n_angles) are above those of the angles beside: minima of cost."""
    best = gain.max(axis=0)
    is_peak = (best > 0.0) & (best >= np.roll(best, 1)) & (best > np.roll(best, -1))
    angles = np.flatnonzero(is_peak)
    return [int(at) for at in gain[:, angles].argmax(axis=0) * gain.shape[1] + angles]
