"""What the tolerance of the inertias leaves of every stiffness, however well it is measured.

In a posture where a joint's mode is its own, k = omega² M_jj (file 002, Eqs. 7, 10 and 11): the
relative error of M_jj is that of k. Every uncertain quantity of the arm moves M_jj a little; their
squares add.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from armodal.analyzer.identification.model_error import STEP, moved_arms
from armodal.analyzer.planning.selective import SelectivePlan
from armodal.analyzer.workspace.batch import ArmBatch

__all__ = ["inertia_std"]

Array = npt.NDArray[np.float64]


def inertia_std(plan: SelectivePlan) -> Array:
    """Relative standard deviation of each elastic joint's k from the arm's tolerances, (n,).

    Of the fitted tests that show the joint's own mode, or are for it, the one that the tolerances
    touch least.
    """
    joints = np.array(plan.elastic.joints)
    tests = plan.tests[: plan.n_fitted]
    q = np.array([test.joints_rad for test in tests])
    own = ArmBatch(plan.arm).mass(q)[joints, joints]  # (n, n_tests)
    square = np.zeros_like(own)
    for arm, angles in moved_arms(plan.arm):
        moved = ArmBatch(arm).mass(q + angles)[joints, joints]
        square += ((moved - own) / own / STEP) ** 2
    std = np.sqrt(square)
    for i, joint in enumerate(plan.elastic.joints):
        shown = [joint in test.serves or joint == test.target for test in tests]
        if any(shown):
            std[i, ~np.array(shown)] = np.inf
    return np.asarray(std.min(axis=1))
