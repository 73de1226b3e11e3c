"""An arm file's effects, read for calculations: what they say of the arm, and their values.

A session's fit has every ordinary error free; here none is made. Bearings, links and the base give
way where an effect says so, joints have the stiffness and damping of the arm file, and a loss
factor only if an effect gives one.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.gap.add import file_key, instances_of_file
from armodal.analyzer.gap.model.base_body import BASE_BODY, BASE_MASS_NAME
from armodal.analyzer.gap.model.effect import Instance
from armodal.analyzer.gap.model.hypothesis import Hypothesis
from armodal.analyzer.gap.model.ordinary import Ordinary
from armodal.protocols.arm.records import Arm
from armodal.protocols.errors import ArmError

__all__ = ["Correction", "correction_of", "stepped"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Correction:
    """A hypothesis that is believed, with the values of all its parameters."""

    hypothesis: Hypothesis  # with the effects that are of the arm
    values: Mapping[str, float]
    plain: dict[str, float]  # likewise, of the arm without effects
    names: tuple[tuple[str, str, float], ...]  # parameter, its effect's title, one deviation
    notes: tuple[str, ...]  # what the file holds that no calculation of the arm needs

    @property
    def ordinary(self) -> Ordinary:
        """Return the arm as believed."""
        return self.hypothesis.ordinary

    def only(self, instances: Sequence[Instance]) -> Correction:
        """Return it with some of its effects alone."""
        owned = {name for instance in instances for name in instance.owned}
        return replace(
            self,
            hypothesis=replace(self.hypothesis, instances=tuple(instances)),
            values=self.plain | {name: self.values[name] for name in owned if name in self.values},
        )

    @property
    def titles(self) -> tuple[str, ...]:
        """Return the effects in words."""
        return tuple(instance.title for instance in self.hypothesis.instances)


def correction_of(arm: Arm) -> Correction:
    """Read an arm's effects.

    Raises
    ------
    ArmError
        If an effect is not in the library or not at that place, or lacks a parameter; all of the
        missing ones are named.
    """
    ordinary = Ordinary(superset=Superset(arm), postures=())
    instances, told = instances_of_file(ordinary)
    _refuse_missing(arm, instances)
    hypothesis = Hypothesis(
        ordinary=ordinary, instances=tuple(i for i in instances if not i.effect.of_the_test)
    )
    plain = {p.name: p.mean for p in hypothesis.space().parameters} | _plain(ordinary)
    stds = tuple(
        (name, instance.title, known[file_key(name, instance.place)])
        for instance, effect in zip(instances, arm.effects, strict=True)
        if not instance.effect.of_the_test
        for known in [{p.name: p.std for p in effect.parameters}]
        for name in instance.owned
        if name in told and file_key(name, instance.place) in known
    )
    return Correction(
        hypothesis=hypothesis,
        values=plain | told,
        plain=plain,
        names=stds,
        notes=tuple(
            f"{instance.title} is of the test that found it: the arm itself moves as without it"
            for instance in instances
            if instance.effect.of_the_test
        ),
    )


def stepped(correction: Correction, steps: Mapping[str, float]) -> Correction:
    """Return it with steps added to some of its values."""
    moved = {name: correction.values[name] + step for name, step in steps.items()}
    return replace(correction, values={**correction.values, **moved})


def _plain(ordinary: Ordinary) -> dict[str, float]:
    """Values by which nothing gives way beside the drives and nothing is lost beside dashpots."""
    found = {}
    for p in ordinary.parameters():
        if p.unit in ("rad/(N m)", "m/N") or p.name.startswith("loss "):
            found[p.name] = 0.0
    found[BASE_MASS_NAME] = 0.0
    for i in ordinary.elastic:
        damping = ordinary.arm.joints[i].damping
        if damping is None or damping.value == 0.0:
            found[f"ln c {ordinary.arm.joints[i].name}"] = -np.inf
    return found


def _refuse_missing(arm: Arm, instances: tuple[Instance, ...]) -> None:
    missing = [
        f"{key} of {effect.name} ({effect.place})"
        for instance, effect in zip(instances, arm.effects, strict=True)
        for key in _wanted(instance)
        if key not in {p.name for p in effect.parameters}
    ]
    if missing:
        raise ArmError(
            f"arm '{arm.name}': wanted {', '.join(missing)} in its [[effects]], found nothing; "
            "write the arm file anew with `armodal gap --arm-out`"
        )


def _wanted(instance: Instance) -> list[str]:
    """Keys without which it would be another effect: where an axis lies its description tells.

    What it frees the arm has without it, but for the base's body.
    """
    body = [p for p in instance.relaxes.values() if p.name in BASE_BODY]
    return [
        file_key(p.name, instance.place)
        for p in (*instance.parameters, *body)
        if p.untold is None and p.name not in instance.begins_at
    ]
