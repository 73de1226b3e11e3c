"""A soft servo behind the transmission, the rotor a freedom of its own."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from armodal.analyzer.gap.effects.rotor import carried_moment
from armodal.analyzer.gap.model.assembly import Assembly
from armodal.analyzer.gap.model.effect import EffectWords, Instance
from armodal.analyzer.gap.model.ordinary import Ordinary
from armodal.analyzer.gap.model.space import Parameter

__all__ = ["WORDS", "instances"]

WORDS = EffectWords(
    name="servo",
    title="Servo and rotor behind the transmission",
    changes="servo, rotor, transmission, link in a row: one more freedom behind the joint's spring",
    signature="a joint that is softer below the rotor's frequency than above; a good fit hides it",
    confused_with=("rotor",),
    least_shared=6.0,  # mountings' worth; a peak of one posture is brought by two to four
    told_by="brakes on against servo; a posture in which the joint carries little inertia",
    remedy="test with brakes on; at rest the joint has the k told and the servo's in series",
)
_BRAKED = 1e-3  # of its compliance, a brake leaves a servo
# Of the carried moment: drives are chosen for a reflected inertia of a tenth to all of the load's.
_ROTOR = 0.3
# Of the rotor on its servo: from hardly damped to critical, as loops of a position are tuned.
_DAMPING_RATIO = 0.5
_MATERIAL = 0.05  # servo compliance over the joint's
# Its part of the joint's compliance, its rotor and its lag, of what is typical, where a fit may
# begin: of no size at all it changes nothing, and a loop whose delay outweighs its damping is on
# the other side of one that damps.
_PARTS, _ROTORS, _LAGS = (0.2,), (0.15, 0.5, 1.5, 5.0), (0.5, -0.2)


def instances(ordinary: Ordinary) -> tuple[Instance, ...]:
    """One for each elastic joint."""
    found = []
    for i in ordinary.elastic:
        joint = ordinary.arm.joints[i].name
        soft, inertia, loss = (
            f"servo compliance {joint}",
            f"servo rotor {joint}",
            f"servo loss {joint}",
        )
        gamma = ordinary.scale(i)

        def build(
            assembly: Assembly,
            values: Mapping[str, float],
            joint: str = joint,
            soft: str = soft,
            inertia: str = inertia,
            loss: str = loss,
        ) -> None:
            link = assembly.names[joint]
            none = np.zeros(ordinary.superset.n)
            part = _BRAKED if assembly.lines.brakes else 1.0
            own = assembly.add_compliance(none, values[soft], values[loss], soft, loss, part=part)
            k = float(np.exp(values[f"ln k {joint}"]))
            c = float(np.exp(values[f"ln c {joint}"]))
            # The joint's spring stretches by the difference of link and rotor.
            for kind, value in assembly.drive_terms(joint, k, c, values):
                assembly.add_term(kind, own, own, value)
                assembly.add_term(kind, own, link, -value)
            assembly.add_term("mass", own, own, values[inertia], parameter=inertia)
            assembly.stretched_by[joint] = own

        moment = carried_moment(ordinary, i)
        # Of c/k, with stiffness and rotor as they typically are. What a loop's delay takes from it
        # may be more than it has.
        lag = 2.0 * _DAMPING_RATIO * float(np.sqrt(gamma * _ROTOR * moment))

        def starting_points(
            values: Mapping[str, float],
            joint: str = joint,
            soft: str = soft,
            inertia: str = inertia,
            loss: str = loss,
            lag: float = lag,
            typical: float = _ROTOR * moment,
        ) -> Sequence[Mapping[str, float]]:
            """Leave the joint as soft as it was."""
            ln_k = values[f"ln k {joint}"]
            return [
                {
                    **values,
                    soft: float(part * np.exp(-ln_k)),
                    inertia: turns * typical,
                    loss: part_of_lag * lag,
                    f"ln k {joint}": ln_k - float(np.log(1.0 - part)),
                }
                for part in _PARTS
                for turns in _ROTORS
                for part_of_lag in _LAGS
            ]

        found.append(
            Instance(
                effect=WORDS,
                place=joint,
                parameters=(
                    Parameter(name=soft, unit="rad/(N m)", mean=0.0, std=gamma, low=0.0),
                    Parameter(name=loss, unit="s", mean=lag, std=lag, low=-lag),
                    Parameter(
                        name=inertia,
                        unit="kg m²",
                        mean=_ROTOR * moment,
                        std=_ROTOR * moment,
                        low=0.0,
                    ),
                ),
                builder=build,
                initial_values=starting_points,
                size=soft,
                shapes=(inertia,),
                hides_in=f"ln k {joint}",
                material=_MATERIAL * gamma,
                drives=ordinary.drives(i),
            )
        )
    return tuple(found)
