"""Cases of the frame maker."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np

from armodal.hil_sim.makers.arm_table import ArmTable
from armodal.hil_sim.makers.belief import believed_arm
from armodal.hil_sim.makers.case import CaseSpec
from armodal.hil_sim.makers.frame import effects
from armodal.hil_sim.makers.frame.drive_loss import LOSS_AT_HZ
from armodal.hil_sim.makers.frame.everyday import Everyday, Gear, everyday
from armodal.hil_sim.makers.frame.kit import Hidden, HidesInFrame, Kit
from armodal.hil_sim.makers.frame.parts import Parts
from armodal.hil_sim.makers.frame.shop import Shop
from armodal.hil_sim.makers.frame.visibility import VISIBLE, Witness
from armodal.hil_sim.makers.listing import modules_of
from armodal.hil_sim.makers.plan_texts import Campaign, planned
from armodal.hil_sim.streams import stream
from armodal.protocols.arm.records import Arm
from armodal.protocols.arm.reference import STIFFNESS_AT_HZ
from armodal.protocols.errors import PlantError
from armodal.protocols.plan_records import KnownMass, Mode, Plan
from armodal.protocols.session.records import Session

__all__ = ["EFFECTS", "Made", "made"]

EFFECTS: dict[str, HidesInFrame] = modules_of(effects.__name__, effects.__path__)
RATE_HZ, SAMPLES, PRETRIGGER = "1280", 2048, 64
HITS, SENSOR_KG = 3, 0.008
CLOSE = 1.15  # a visibility within this factor of its class is met
LOOKS = 10


@dataclass(frozen=True, slots=True, kw_only=True)
class Made:
    """A case's arm, plan, truth and shop."""

    arm: Arm
    plan: Plan
    truth: dict[str, Any]
    shop: Shop

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
        return self.shop.measure(plan, levels_n, known_mass, run, brakes=brakes)


def made(table: ArmTable, spec: CaseSpec) -> Made:
    """Draw the arm, hide the effects, and write down the truth."""
    drawn = everyday(table, spec.wrist, spec.seed)
    arm = believed_arm(table, drawn.stiffness, drawn.damping, drawn.tolerances)
    campaign = Campaign(
        mode=Mode.ROVING_RESPONSE,
        sensor_kg=SENSOR_KG,
        trigger_n=round(0.05 * table.peaks_n[0], 3),
        rate_hz=RATE_HZ,
        samples=SAMPLES,
        pretrigger=PRETRIGGER,
        hits_per_point=HITS,
    )
    plan = planned(table, arm, campaign)
    witness = Witness(drawn, plan, spec.seed)
    parts, gear, hidden = drawn.parts, drawn.gear, []
    for i, kind in enumerate(spec.kinds):
        hiding = _Hiding(drawn, spec, kind, spec.kinds[:i].count(kind))
        seen = partial(_seen, witness, hiding)
        size = _sized(seen, EFFECTS[kind].RANGE, VISIBLE[spec.size_class])
        alone = hiding.put(drawn.parts, drawn.gear, size)[:2]
        visible = witness.looking_at(alone[1].exchanged).left_by_drives(*alone)
        parts, gear, told = hiding.put(parts, gear, size)
        where = hiding.place.split("|")
        place = where if len(where) > 1 else where[0]
        hidden.append({"name": kind, "place": place, "parameters": told, "visible": visible})
    shop = Shop(seed=spec.seed, arm=arm, drawn=drawn, parts=parts, gear=gear)
    return Made(arm=arm, plan=plan, truth=_truth(drawn, parts, spec, hidden), shop=shop)


@dataclass(frozen=True, slots=True)
class _Hiding:
    """An effect of a case; `copy` counts those of its name before it."""

    drawn: Everyday
    spec: CaseSpec
    kind: str
    copy: int

    @property
    def place(self) -> str:
        """Drawn among the places that the arm has."""
        places = EFFECTS[self.kind].where(self.drawn)
        if not places:
            raise PlantError(
                f"{self.kind} has no place in {self.spec.arm} with the wrist {self.spec.wrist}"
            )
        rng = stream(self.spec.seed, "frame", "where", self.kind, self.copy)
        return places[int(rng.integers(len(places)))]

    def put(self, parts: Parts, gear: Gear, size: float) -> tuple[Parts, Gear, Hidden]:
        """Hide it in a copy; whatever its size, it draws the same."""
        kit = Kit(
            drawn=self.drawn,
            parts=parts.copy(),
            gear=replace(gear, exchanged=dict(gear.exchanged)),
            rng=stream(self.spec.seed, "frame", "effect", self.kind, self.copy, self.place),
        )
        told = EFFECTS[self.kind].hide(kit, self.place, size)
        return kit.parts, kit.gear, told


def _seen(witness: Witness, hiding: _Hiding, size: float) -> float:
    """How visible the effect is alone on the everyday arm."""
    parts, gear, _ = hiding.put(hiding.drawn.parts, hiding.drawn.gear, size)
    return witness.sees(parts, gear)


def _sized(
    seen: Callable[[float], float], span: tuple[float, float] | None, wanted: float
) -> float:
    """Return the size that is visible as wanted: bisection in logarithms."""
    if span is None:
        return 1.0
    low, high = np.log(span)
    best = (0.0, 0.0)
    for _ in range(LOOKS):
        middle = 0.5 * (low + high)
        visible = seen(float(np.exp(middle)))
        if not best[1] or abs(np.log(visible / wanted)) < abs(np.log(best[1] / wanted)):
            best = (float(np.exp(middle)), visible)
        if wanted / CLOSE < visible < wanted * CLOSE:
            break
        low, high = (middle, high) if visible < wanted else (low, middle)
    return best[0]


def _truth(drawn: Everyday, parts: Parts, spec: CaseSpec, hidden: list[Hidden]) -> dict[str, Any]:
    joints, told = {}, 2.0j * np.pi * np.array([STIFFNESS_AT_HZ])
    for joint in drawn.elastic:
        drive, loss = drawn.parts.drives[joint], drawn.loss[joint]
        law = parts.drives[joint].own_law or drive.law
        joints[joint] = {
            "stiffness_n_m_per_rad": drive.stiffness + float(law(told)[0].real),
            "damping_n_m_s_per_rad": loss.factor * drive.stiffness / (2.0 * np.pi * LOSS_AT_HZ),
            "loss_factor": loss.factor,
            "stiffer": loss.stiffer,
            "band_hz": loss.band_hz,
        }
    return {
        "effects": hidden,
        "outside": any(getattr(EFFECTS[kind], "OUTSIDE", False) for kind in spec.kinds),
        "joints": joints,
        "tolerances": drawn.tolerances,
        "encoder_offsets_rad": drawn.parts.offsets_rad,
    }
