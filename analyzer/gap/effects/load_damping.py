"""A joint whose losses grow with the weight it carries."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from armodal.analyzer.gap.model.assembly import Assembly
from armodal.analyzer.gap.model.effect import EffectWords, Instance
from armodal.analyzer.gap.model.gravity_load import gravity_load
from armodal.analyzer.gap.model.ordinary import Ordinary
from armodal.analyzer.gap.model.space import Parameter

__all__ = ["WORDS", "instances"]


WORDS = EffectWords(
    name="load_damping",
    title="Damping grows with the joint's load",
    changes="a joint's damping by its gravity torque in each posture",
    signature="a mode damped more where its joint carries more, at a frequency that fits",
    confused_with=("hysteretic", "nonproportional", "friction"),
    told_by="two postures that load the joint alike, but one with the inertia far out",
    remedy="give the joint's damping for its load; look at the seals and the gear's lubrication",
)
_MOST = 3.0  # more damping at the largest load, one standard deviation
_MATERIAL = 0.3  # more damping at the largest load


def instances(ordinary: Ordinary) -> tuple[Instance, ...]:
    """One for each elastic joint that weight can load."""
    return tuple(_at(ordinary, i) for i in ordinary.loaded if _largest_load(ordinary, i) > 0.0)


def _at(ordinary: Ordinary, i: int) -> Instance:
    joint = ordinary.arm.joints[i].name
    name = f"damping per load {joint}"
    links = tuple(j.link for j in ordinary.arm.joints)
    column = ordinary.superset.joint_column(i)

    def build(assembly: Assembly, values: Mapping[str, float]) -> None:
        load = abs(gravity_load(assembly.geometry, links, column, assembly.lines.known_mass))
        c = float(np.exp(values[f"ln c {joint}"]))
        row = assembly.joint_row(joint)
        assembly.add_stretch(
            "damping", row, values[name] * load * c, parameter=name, slope=load * c
        )
        # The joint's own damping is a factor of it.
        assembly.stretches_of.setdefault(f"ln c {joint}", []).append(
            ("damping", row, values[name] * load * c)
        )

    largest = _largest_load(ordinary, i)
    return Instance(
        effect=WORDS,
        place=joint,
        parameters=(Parameter(name=name, unit="1/(N m)", mean=0.0, std=_MOST / largest, low=0.0),),
        builder=build,
        size=name,
        material=_MATERIAL / largest,
        last=True,
    )


def _largest_load(ordinary: Ordinary, i: int) -> float:
    """Torque of everything beyond a joint, stretched out halfway."""
    joints = ordinary.arm.joints[i:]
    lengths = [float(np.linalg.norm(j.T_parent_joint[:3, 3])) for j in joints]
    lengths[0] = 0.0
    reach = np.cumsum(lengths)
    g = float(np.linalg.norm(ordinary.arm.gravity_m_s2))
    far = sum(
        j.link.mass_kg * (r + float(np.linalg.norm(j.link.center_m)))
        for j, r in zip(joints, reach, strict=True)
    )
    return 0.5 * g * float(far)
