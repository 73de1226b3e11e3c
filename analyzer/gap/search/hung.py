"""Where something that hangs on a link could pull: a linear look at every line of every link.

What pulls with the law m g(s) along a line w of a link, w (6,) the travel of the link's points on
it, has the column

    dy / dm = -g(s) sum_ab w_a w_b (o H J_a')(J_b x) ,

quadratic in w as a turn about a line is (`search.interfaces`).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from armodal.analyzer.gap.inference.fit import Fit, Stage
from armodal.analyzer.gap.model.effect import Instance
from armodal.analyzer.gap.model.ordinary import Ordinary
from armodal.analyzer.gap.model.weighed_sums import summed
from armodal.analyzer.gap.search.interfaces import PAIRS, Line, best_lines, left_after
from armodal.analyzer.gap.search.scan import Candidate

__all__ = ["pulls_along_lines"]

Array = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complexfloating[Any, Any]]

_STEP = 0.3  # of a frequency to the next one tried: the half-power width of 13 % of critical


def pulls_along_lines(
    stage: Stage,
    fit: Fit,
    at_line: Callable[[Ordinary, int, Array, Array], Instance],
    law: Callable[[ComplexArray, float], ComplexArray],
) -> list[Candidate]:
    """Return an effect along the most promising line of each link that has none, best first.

    Parameters
    ----------
    at_line
        Makes the effect of a link, a direction and a point. Its first parameter is what its law is
        multiplied by, its second the logarithm of a frequency in Hz.
    law
        Dynamic stiffness along the line a unit of the first parameter, of s and 2 pi times the
        frequency in rad/s.
    """
    ordinary = fit.hypothesis.ordinary
    present = {instance.key for instance in fit.hypothesis.instances}
    up = np.eye(3)[2]
    # What hangs on the first link changes little.
    links = [
        link
        for link in range(1, len(ordinary.arm.joints))
        if at_line(ordinary, link, up, np.zeros(3)).key not in present
    ]
    if not links:
        return []
    band = np.concatenate([own.s_rad_s.imag for own in stage.lines]) / (2.0 * np.pi)
    n = 1 + int(np.log(band.max() / band.min()) / np.log1p(_STEP))
    tried_hz = np.geomspace(band.min(), band.max(), n)
    laws = [lambda s, w=2.0 * np.pi * f: law(s, w) for f in tried_hz]
    std = at_line(ordinary, links[0], up, np.zeros(3)).parameters[0].std
    found = []
    for number, line in _best_pulls(stage, fit, laws, std, links):
        instance = at_line(ordinary, line.link, line.direction, line.point_m)
        begin = fit.values | {p.name: p.first for p in instance.parameters}
        size, ln_hz = (p.name for p in instance.parameters[:2])
        begin |= {size: line.size * std, ln_hz: float(np.log(tried_hz[number]))}
        found.append(Candidate(instance=instance, gain=line.gain, begin=begin))
    return found


def _best_pulls(
    stage: Stage,
    fit: Fit,
    laws: Sequence[Callable[[ComplexArray], ComplexArray]],
    std: float,
    links: Sequence[int],
) -> list[tuple[int, Line]]:
    """Each link's most promising line with its law's number, best first."""
    size = len(fit.space) + len(links) * len(PAIRS)
    gradients, curvatures = np.zeros((len(laws), size)), np.zeros((len(laws), size, size))
    for rows, together in stage.once(fit.hypothesis, range(len(stage.lines))):
        y, fitted = together.columns(fit.hypothesis, fit.space, fit.values)
        columns = [together.link_columns(fit.hypothesis, fit.values, i, PAIRS) for i in links]
        s = np.stack([own.s_rad_s for own in together.lines])
        lines, at = zip(*rows, strict=True)
        weighings = [stage.weighings[p] for p in lines]
        for number, law in enumerate(laws):  # one at a time: all at once do not fit the cache
            weight = (std * law(s) / s**2).astype(fitted.shared.dtype)[:, None, None]
            pulls = np.concatenate([c * weight for c in columns])
            part, _ = summed(weighings, y, fitted.beside(pulls), at)
            gradients[number] += part.gradient
            curvatures[number] += part.curvature
    best: dict[int, tuple[int, Line]] = {}
    for number, (gradient, curvature) in enumerate(zip(gradients, curvatures, strict=True)):
        of_links = zip(links, left_after(fit, gradient, curvature), strict=True)
        for link, (gram, slope) in of_links:
            line = best_lines(gram, slope, fit.hypothesis.ordinary, link, travels=True)[0]
            if link not in best or line.gain > best[link][1].gain:
                best[link] = number, line
    return sorted(best.values(), key=lambda pull: -pull[1].gain)
