"""Cases of the MuJoCo maker."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from armodal.hil_sim.makers.arm_table import ArmTable
from armodal.hil_sim.makers.belief import believed_arm
from armodal.hil_sim.makers.case import CaseSpec
from armodal.hil_sim.makers.listing import modules_of
from armodal.hil_sim.makers.mujoco import effects
from armodal.hil_sim.makers.mujoco.laboratory import PRETRIGGER, RATE_HZ, SAMPLES, Laboratory
from armodal.hil_sim.makers.mujoco.ordinary import Ordinary, ordinary
from armodal.hil_sim.makers.mujoco.rig import Effect, Parameters, Rig
from armodal.hil_sim.makers.mujoco.sizing import size_to_stand_out
from armodal.hil_sim.makers.mujoco.standing import POSTURES, Bystander
from armodal.hil_sim.makers.plan_texts import Campaign, planned
from armodal.hil_sim.streams import stream
from armodal.protocols.arm.records import Arm
from armodal.protocols.errors import PlantError
from armodal.protocols.plan_records import KnownMass, Mode, Plan
from armodal.protocols.session.records import Session

__all__ = ["EFFECTS", "Made", "made"]

EFFECTS: dict[str, Effect] = modules_of(effects.__name__, effects.__path__)

HITS, SENSOR_KG = 3, 0.011


@dataclass(frozen=True, slots=True, kw_only=True)
class Made:
    """A case's arm, plan, truth and laboratory."""

    arm: Arm
    plan: Plan
    truth: dict[str, Any]
    laboratory: Laboratory

    def measure(
        self,
        plan: Plan,
        *,
        levels_n: tuple[float, ...] | None,
        known_mass: KnownMass | None,
        brakes: bool,
        run: int,
    ) -> Session:
        """Measure a plan."""
        return self.laboratory.measure(plan, levels_n, known_mass, run, brakes=brakes)


def made(table: ArmTable, spec: CaseSpec) -> Made:
    """Draw the arm, hide the effects, and write down the truth."""
    drawn = ordinary(table, spec.wrist, spec.seed)
    arm = believed_arm(table, drawn.stiffness, drawn.damping, drawn.tolerances)
    campaign = Campaign(
        mode=Mode.ROVING_HAMMER,
        rate_hz=str(RATE_HZ),
        samples=SAMPLES,
        pretrigger=PRETRIGGER,
        hits_per_point=HITS,
        sensor_kg=SENSOR_KG,
        trigger_n=round(0.04 * table.peaks_n[0], 3),
    )
    plan = planned(table, arm, campaign)
    told = tuple(plan.postures[i].joints_rad for i in POSTURES)
    bystander = Bystander(drawn, told)
    machine, bench, truths = drawn.machine, drawn.bench, []
    for i, kind in enumerate(spec.kinds):
        hiding = _Hiding(spec, kind, spec.kinds[:i].count(kind), drawn, bystander)
        place, size, found = hiding.sized()
        rig = hiding.rig(Rig(drawn=drawn, machine=machine, bench=bench, rng=hiding.rng(place)))
        parameters = EFFECTS[kind].put(rig, place, size)
        machine, bench = rig.machine, rig.bench
        parts = place.split("|")
        truths.append(
            {
                "name": kind,
                "place": parts if len(parts) > 1 else place,
                "parameters": parameters,
                "stands_out": found,
            }
        )
    truth = {
        "effects": truths,
        "outside": any(getattr(EFFECTS[kind], "OUTSIDE", False) for kind in spec.kinds),
        "joints": _joints(drawn, truths),
        "tolerances": drawn.tolerances,
        "encoder_offsets_rad": drawn.offsets_rad,
    }
    laboratory = Laboratory(seed=spec.seed, arm=arm, ordinary=drawn, machine=machine, bench=bench)
    return Made(arm=arm, plan=plan, truth=truth, laboratory=laboratory)


def _joints(drawn: Ordinary, effects: Sequence[Parameters]) -> dict[str, Parameters]:
    """Stiffness and damping of each joint; with a seat that slips, of what is beside it."""
    axes = {name: drawn.machine.axis(name) for name in drawn.elastic}
    beside = {
        effect["place"]: effect["parameters"]["beside_n_m_per_rad"]
        for effect in effects
        if "beside_n_m_per_rad" in effect["parameters"]
    }
    return {
        name: {
            "stiffness_n_m_per_rad": beside.get(name, axis.stiffness),
            "damping_n_m_s_per_rad": axis.damping,
        }
        for name, axis in axes.items()
    }


@dataclass(frozen=True, slots=True)
class _Hiding:
    """An effect of a case; `copy` counts those of the same name before it."""

    spec: CaseSpec
    kind: str
    copy: int
    drawn: Ordinary
    bystander: Bystander

    def rng(self, place: str) -> np.random.Generator:
        """Begin the stream of the effect at a place: whatever its size, it draws the same."""
        return stream(self.spec.seed, "mujoco", "effect", self.kind, self.copy, place)

    def rig(self, rig: Rig) -> Rig:
        """Return a rig to be edited."""
        bench = rig.bench
        copied = type(bench)(
            **{name: _own(getattr(bench, name)) for name in type(bench).__dataclass_fields__}
        )
        return Rig(drawn=rig.drawn, machine=rig.machine.copy(), bench=copied, rng=rig.rng)

    def sized(self) -> tuple[str, float, float]:
        """Place, size, and how far it stands out alone on the ordinary arm."""
        effect = EFFECTS[self.kind]
        places = effect.places(self.drawn)
        if not places:
            raise PlantError(
                f"{self.kind} has no place in {self.spec.arm} with the wrist {self.spec.wrist}"
            )
        chosen = stream(self.spec.seed, "mujoco", "place", self.kind, self.copy)
        place = places[int(chosen.integers(len(places)))]
        if effect.SPAN is None:
            return place, 1.0, self._stands_out(place, 1.0)
        size, found = size_to_stand_out(
            lambda size: self._stands_out(place, size), effect.SPAN, self.spec.size_class
        )
        return place, size, found

    def _stands_out(self, place: str, size: float) -> float:
        drawn = self.drawn
        rig = self.rig(
            Rig(drawn=drawn, machine=drawn.machine, bench=drawn.bench, rng=self.rng(place))
        )
        EFFECTS[self.kind].put(rig, place, size)
        return self.bystander.stands_out(rig.machine, rig.bench)


def _own(value: Any) -> Any:
    return value.copy() if hasattr(value, "copy") else value
