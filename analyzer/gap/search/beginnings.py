"""Effects that of no size change nothing, looked at from where their own files begin.

A linear look about no size is blind to them: a servo of no compliance is none, and of little it is
a part of the joint's own. From a beginning of some size the quadratic tells what is left at its
least, once ordinary errors have followed.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from armodal.analyzer.gap.inference.fit import Fit, Stage, fit_hypothesis
from armodal.analyzer.gap.model.effect import Instance

__all__ = ["promising_beginnings"]


def promising_beginnings(
    stage: Stage, about: Fit, instances: Sequence[Instance]
) -> list[tuple[Instance, list[tuple[float, Mapping[str, float]]]]]:
    """Return each instance with its beginnings and the cost each promises to take off, best first.

    Parameters
    ----------
    stage
        Lines broad enough that a beginning finds its way, and sharp enough to tell such an effect.
    about
        The present hypothesis on them.
    instances
        Those without beginnings of their own, and laws of joints, are left out.
    """
    present = about.hypothesis
    found: list[tuple[Instance, list[tuple[float, Mapping[str, float]]]]] = []
    for instance in instances:
        if instance.initial_values is None or instance.law is not None:
            continue
        richer = replace(present, instances=(*present.instances, instance))
        promised: list[tuple[float, Mapping[str, float]]] = []
        for begin in instance.initial_values(about.values):
            try:
                there = fit_hypothesis(stage, richer, start=begin, max_iterations=0)
            except np.linalg.LinAlgError:
                continue
            promised.append((about.cost - there.cost + there.promised, begin))
        if promised:
            found.append((instance, sorted(promised, key=lambda entry: -entry[0])))
    return sorted(found, key=lambda entry: -entry[1][0][0])
