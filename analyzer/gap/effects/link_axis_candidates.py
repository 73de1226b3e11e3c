"""Where an axis in a link could lie, by the linear look at every interface's lines."""

from __future__ import annotations

from collections.abc import Sequence

from armodal.analyzer.gap.effects import link_axis
from armodal.analyzer.gap.inference.fit import Fit, Stage
from armodal.analyzer.gap.model.effect import Instance
from armodal.analyzer.gap.search.interfaces import lines_of_interfaces
from armodal.analyzer.gap.search.scan import Candidate

__all__ = ["linear_candidates"]


def linear_candidates(stage: Stage, fit: Fit, instances: Sequence[Instance]) -> list[Candidate]:
    """Return an axis along the most promising lines of every link without one, best first."""
    del instances
    present = fit.hypothesis.instances
    taken = [i.place for i in present if i.effect is link_axis.WORDS]
    ordinary = fit.hypothesis.ordinary
    return [
        Candidate(
            instance=link_axis.at_axis(ordinary, line.link, line.direction, line.point_m),
            gain=line.gain,
        )
        for line in lines_of_interfaces(stage, fit, exclude=taken)
    ]
