"""Sealed cases for the study of gap naming: sessions in which an effect is hidden.

The analysis gets the arm, the plan and the session. The truth stays in the case; its hash can be
printed before the first verdict.
"""

import hashlib
import json
from dataclasses import dataclass, field, replace
from datetime import UTC, datetime
from functools import cached_property

import numpy as np

from hil_sim.board_dictionary import board_dictionary
from hil_sim.hand import blow
from hil_sim.source import SensorSource
from protocols.arm.files import load_arm
from protocols.board.messages import encode_dictionary
from protocols.plan import load_plan
from protocols.session.records import Hit, JointReading, Session, SessionHeader, Verdict
from tests.support.model_error import erring_plant_tables, plant_of_tables
from tests.support.sealed_effects import LIBRARY, OUTSIDE, ArmPlaces

MAGNITUDES = {"clear": 1.0, "medium": 0.5, "faint": 0.25}
ARMS = {  # arm file, plan, peak force N
    "rv4frl": ("rv4frl-three-postures", (40.0, 90.0)),
    "bench57": ("bench57-five-postures", (30.0, 70.0)),
}
AIM_DEG = 0.8  # how far the wanted direction of a posture's hits is missed, about each axis
SETTLE = 200  # samples before the block, so that filters and noise are running
# Stiffness that two effects both change is drawn once: these never stand together.
ALIKE = ({"rotor", "servo"}, {"flipped_axis", "swapped_axes"}, {"flipped_axis", "channel_gain"})


@dataclass(frozen=True, slots=True, kw_only=True)
class CaseSpec:
    """What is hidden, and how large: () for a null. This is the truth; the analysis never sees it."""

    number: int
    arm: str
    seed: int
    kinds: tuple[str, ...]
    magnitude: str  # "clear", "medium", "faint"; "none" for nulls


@dataclass(frozen=True, kw_only=True)
class SealedCase:
    """A case as the analysis gets it: `number`, `arm`, `plan`, `truth_sha256`, `session()`."""

    number: int
    arm: object
    plan: object
    _spec: CaseSpec = field(repr=False)

    @cached_property
    def _hidden(self):
        return _hide(self._spec, self.arm)

    @property
    def truth_sha256(self):
        """Hash of the truth's text, to be printed before any verdict."""
        return hashlib.sha256(self.truth_text().encode()).hexdigest()

    def truth_text(self):
        """The sealed truth as JSON: only the marker of a study opens it."""
        return json.dumps(self._hidden[1], sort_keys=True)

    def session(self):
        """The session, made in process in some seconds."""
        plant = plant_of_tables(self._hidden[0])
        return measured(plant, self.arm, self.plan, self._spec.seed)

    def plant_tables(self):
        """Tables of the plant file; they hold the truth."""
        return self._hidden[0]


def study(seed, *, nulls=30, effects=60, pairs=12, outside=12, arms=tuple(ARMS)):
    """Draw the cases of a study, in an order that tells nothing.

    Effects go round the library, arms and magnitudes; pairs and outside cases are clear.
    """
    rng = np.random.default_rng([seed, 0x6A9])
    wanted = [((), "none")] * nulls
    names, sizes = list(LIBRARY), list(MAGNITUDES)
    start = int(rng.integers(len(names)))
    for i in range(effects):
        wanted.append(((names[(start + i) % len(names)],), sizes[(i // len(names) + i) % 3]))
    for _ in range(pairs):
        wanted.append((_pair(rng, names), "clear"))
    beyond = list(OUTSIDE)
    wanted += [((beyond[i % len(beyond)],), "clear") for i in range(outside)]
    specs = [
        CaseSpec(
            number=0,
            arm=arms[i % len(arms)],
            seed=int(rng.integers(1 << 62)),
            kinds=kinds,
            magnitude=size,
        )
        for i, (kinds, size) in enumerate(wanted)
    ]
    order = rng.permutation(len(specs))
    return tuple(replace(specs[j], number=i + 1) for i, j in enumerate(order))


def sealed(spec):
    """Close a case."""
    arm = load_arm(spec.arm)
    return SealedCase(number=spec.number, arm=arm, plan=plan_of(arm), _spec=spec)


def plan_of(arm):
    """The arm's plan, every point measured in each of its five postures."""
    plan = load_plan(ARMS[arm.name][0], arm)
    everywhere = tuple(point.id for point in arm.points)
    return replace(
        plan, postures=tuple(replace(posture, points=everywhere) for posture in plan.postures)
    )


def _pair(rng, names):
    while True:
        one, two = (names[i] for i in rng.choice(len(names), 2, replace=False))
        if not any({one, two} <= alike for alike in ALIKE):
            return one, two


def _hide(spec, arm):
    """Tables of the plant with its effects, and the truth about them."""
    rng = np.random.default_rng([spec.seed, 1])
    tables = erring_plant_tables(arm, rng, peak_n=ARMS[spec.arm][1])
    places = ArmPlaces(arm, tables)
    truths = []
    for name in spec.kinds:
        make = LIBRARY.get(name) or OUTSIDE[name]
        added, truth = make(places, rng, MAGNITUDES[spec.magnitude])
        replaced = [(t["kind"], t["joint"]) for t in added if t["kind"] == "bearing"]
        kept = [
            t
            for t in tables["effects"]
            if (t["kind"], t.get("joint")) not in replaced
            and not (t["kind"] == "hysteretic" == name)
        ]
        # Compliances of joints come before what cuts their links.
        tables["effects"] = [*kept, *added]
        truths.append(truth)
    joints = {
        link["joint"]: {
            "stiffness_n_m_per_rad": link["stiffness_n_m_per_rad"],
            "damping_n_m_s_per_rad": link["damping_n_m_s_per_rad"],
        }
        for link in tables["links"]
        if link["stiffness_n_m_per_rad"] is not None
    }
    verdict = "named" if truths else "nothing_detectable"
    if any(name in OUTSIDE for name in spec.kinds):
        verdict = "outside_library"
    truth = {
        "number": spec.number,
        "arm": spec.arm,
        "seed": spec.seed,
        "magnitude": spec.magnitude,
        "verdict": verdict,
        "effects": truths,
        "joints": joints,
        "plant": tables,
    }
    return tables, truth


def measured(plant, arm, plan, seed):
    """A session of the plan: every point, good hits only, aim and mounting as a person's."""
    streams = np.random.default_rng([seed, 2]).spawn(4)
    source = SensorSource(plant, plan.sampling.rate_hz, streams[0])
    hand = plant.truth.hand.model_copy(
        update={"double_probability": 0.0, "soft_probability": 0.0, "overload_probability": 0.0}
    )
    hits = []
    for posture in plan.postures:
        source.set_posture(posture.joints_rad)
        aim = _missed(posture.hit_direction, np.deg2rad(AIM_DEG), streams[3])
        for point in posture.points:
            source.mount(point)
            for _ in range(plan.hits_per_point):
                hits.append(_hit(source, plan, posture, point, hand, aim, streams, len(hits) + 1))
    dictionary = board_dictionary(plant.truth, tick_hz=1_000_000)
    header = SessionHeader(
        session_id=f"{seed:032x}",
        created=datetime(2026, 1, 1, tzinfo=UTC).isoformat(),
        software="armodal sealed case",
        arm=arm,
        plan=plan,
        dictionary=dictionary,
        dictionary_bytes=encode_dictionary(dictionary),
        channel_mask=0b1111,
        time_scale=1.0,
    )
    return Session(header=header, hits=tuple(hits), losses=(), complete=True)


def _missed(direction, std_rad, rng):
    """The direction that all hits of a posture truly have on average."""
    across = np.linalg.svd(direction[None, :])[2][1:]
    wanted = direction + std_rad * np.clip(rng.standard_normal(2), -2.0, 2.0) @ across
    return wanted / np.linalg.norm(wanted)


def _hit(source, plan, posture, point, hand, aim, streams, number):
    _, swings, encoders, _ = streams
    begin = source.next_sample
    filter_delay = 20
    at = SETTLE + plan.sampling.pretrigger - filter_delay + swings.uniform()
    source.strike(begin + at, blow(hand, swings, plan.fixed_point, aim))
    source.read(SETTLE)
    counts = source.read(plan.sampling.samples)
    source.rest()
    noise = np.deg2rad(1e-3) * encoders.standard_normal(len(posture.joints_rad))
    reading = JointReading(
        joints_rad=posture.joints_rad + noise,
        drive_state=2,
        held=True,
        age_s=0.004,
        host_s=float(number),
    )
    return Hit(
        number=number,
        posture=posture.name,
        sensor_point=point,
        hit_point=plan.fixed_point,
        hit_direction=posture.hit_direction,
        first_sample=begin + SETTLE,
        trigger_sample=begin + SETTLE + plan.sampling.pretrigger,
        trigger_host_s=float(number),
        counts=counts,
        before=reading,
        after=reading,
        verdict=Verdict(
            accepted=True, reasons=(), notes=(), peak_n=float(counts[:, 0].max()), width_s=0.003
        ),
    )
