"""A mass m on a spring and a damper on a link: y = m z, z its stretch, yields by m / w^2."""

from collections.abc import Mapping

import numpy as np

from armodal.analyzer.gap.inference.fit import Fit, Stage
from armodal.analyzer.gap.model.assembly import Assembly
from armodal.analyzer.gap.model.effect import EffectWords, Instance
from armodal.analyzer.gap.model.lines_in_links import Array, LineInLink
from armodal.analyzer.gap.model.ordinary import Ordinary
from armodal.analyzer.gap.model.space import Parameter
from armodal.analyzer.gap.search.hung import pulls_along_lines
from armodal.analyzer.gap.search.scan import Candidate

__all__ = ["WORDS", "at_line", "linear_candidates"]

WORDS = EffectWords(
    name="absorber",
    title="Something swings on a link",
    changes="one more degree of freedom: a mass on a spring and a damper along a line of a link",
    signature="a mode near one frequency in every posture, which splits the arm's own beside it",
    confused_with=("payload", "link_axis"),
    told_by="a sensor on what may swing; the same posture with it held",
    remedy="fasten covers, boxes and hoses on that link, or take them off",
    one_with=("absorber",),
    one_such_as="a hose or a box that swings more ways than one",
)
_STD, _MATERIAL, _LEAST_KG = 0.05, 0.02, 1e-6  # of the arm, of that, kg; no source: assumed
_LN_HZ, _LN_HZ_STD, _LOSS_S = np.log(20.0), 0.7, 1e-3  # beyond two deviations it is a payload


def at_line(ordinary: Ordinary, link: int, direction: Array, point_m: Array) -> Instance:
    """Return one that swings near a line of a link's frame; on a stiff spring it is a payload."""
    line = LineInLink(ordinary, link, direction, point_m, of="absorber")
    mass, ln_hz, loss = (f"absorber {own} {line.name}" for own in ("mass", "ln frequency", "loss"))
    body, carried = line.body(mass)
    std = _STD * sum(joint.link.mass_kg for joint in ordinary.arm.joints)
    own = (
        Parameter(name=mass, unit="kg", mean=0.0, std=std, low=0.0),
        Parameter(name=ln_hz, unit="ln Hz", mean=float(_LN_HZ), std=_LN_HZ_STD),
        Parameter(name=loss, unit="s", mean=_LOSS_S, std=_LOSS_S, low=0.0),
        *body,
    )

    def build(assembly: Assembly, values: Mapping[str, float]) -> None:
        carried(assembly, values)
        m, soft = max(values[mass], _LEAST_KG), (2.0 * np.pi * np.exp(values[ln_hz])) ** -2.0
        row, turns = line.travel(assembly, values, mass, m)
        at = assembly.add_compliance(assembly.still, m, values[loss], mass, loss, part=soft)
        assembly.compliance_of[ln_hz] = [(at, -2.0 * m * soft)]
        assembly.add_stretch("mass", row, m, parameter=mass, slope=1.0, turns=turns)

    stiff = ("payload", ln_hz, _LN_HZ + 2.0 * _LN_HZ_STD)
    return line.instance(WORDS, own, build, material=_MATERIAL * std, is_also=stiff)


def linear_candidates(stage: Stage, fit: Fit, _: object) -> list[Candidate]:
    """Return one along the most promising line of each link, best first."""
    return pulls_along_lines(stage, fit, at_line, lambda s, w: s**2 / (1.0 + (s / w) ** 2))
