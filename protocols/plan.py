"""Read a test plan and check it against the arm it is for.

The format is specified in `docs/plan-file.md`.
"""

from __future__ import annotations

import hashlib
import math
from pathlib import Path

import numpy as np

from armodal.protocols.arm.records import Arm
from armodal.protocols.arrays import frozen_array
from armodal.protocols.errors import PlanError
from armodal.protocols.frf_records import FrfEstimator
from armodal.protocols.plan_model import PlanFile, PostureTable, exact_rate
from armodal.protocols.plan_records import (
    Averaging,
    KnownMass,
    Mode,
    Plan,
    PlannedPosture,
    Sampling,
    SensorOnArm,
    Trigger,
    Windows,
)
from armodal.protocols.toml_reader import parse_toml, read_text, refuse, shown, validate

__all__ = ["PLANS_DIRECTORY", "load_plan", "plan_from_text", "shipped_plans"]

PLANS_DIRECTORY = Path(__file__).parent / "plans"

_PLAN_LIMIT = 512 * 1024
# Ranges are printed in radians or whole degrees; 120 degrees must fit 2.0944 rad.
_RANGE_ROUNDING_RAD = 1e-4


def shipped_plans() -> tuple[str, ...]:
    """Return the names of the plans that come with armodal."""
    return tuple(sorted(path.stem for path in PLANS_DIRECTORY.glob("*.toml")))


def load_plan(source: str | Path, arm: Arm) -> Plan:
    """Load a plan file, or a shipped plan by its name.

    Parameters
    ----------
    source
        A path, or a shipped plan's name such as "rv4frl-three-postures" (a string with neither
        folder nor `.toml`).
    arm
        The arm the plan is for: postures must lie in its ranges, points on its links.

    Raises
    ------
    PlanError
        If the file cannot be read, or a value is not possible; the message has the key's path.
    """
    path = Path(source)
    if isinstance(source, str) and path.suffix != ".toml" and path.name == source:
        if source not in shipped_plans():
            raise PlanError(
                f"plan {source!r}: wanted a path to a plan file or one of the shipped plans "
                f"{', '.join(shipped_plans())}"
            )
        path = PLANS_DIRECTORY / f"{source}.toml"
    text = read_text(path, what="plan file", limit_bytes=_PLAN_LIMIT, error=PlanError)
    return plan_from_text(text, arm, origin=f"plan file {path.name}")


def plan_from_text(text: str, arm: Arm, *, origin: str = "plan file") -> Plan:
    """Build the plan from the text a session keeps, or raise PlanError as `load_plan` does."""
    data = parse_toml(text, origin=origin, error=PlanError)
    file = validate(PlanFile, data, origin=origin, error=PlanError)
    if file.arm != arm.name:
        raise PlanError(
            f"{origin}: arm: wanted {arm.name}, the arm that is given, got {shown(file.arm)}; give "
            "the arm file of this plan, or another plan"
        )
    _check_point(file.fixed_point, "fixed_point", arm, origin)
    names = [posture.name for posture in file.postures]
    for index, name in enumerate(names):
        if name in names[:index]:
            path = f"postures[{index}].name"
            refuse(PlanError, origin, path, wanted="a name of its own", got=name)
    if all(posture.validation for posture in file.postures):
        wanted = "at least one posture that is not for validation"
        refuse(PlanError, origin, "postures", wanted=wanted, got="only validation postures")
    return Plan(
        name=file.name,
        arm=file.arm,
        mode=Mode(file.mode),
        fixed_point=file.fixed_point,
        hits_per_point=file.hits_per_point,
        max_attempts=file.max_attempts,
        sampling=Sampling(
            rate_hz=exact_rate(file.sampling.rate_hz),
            samples=file.sampling.samples,
            pretrigger=file.sampling.pretrigger,
        ),
        trigger=Trigger(level_n=file.trigger.level_n, rising=file.trigger.slope == "rising"),
        windows=Windows(exponential_end=file.windows.exponential_end, force_s=file.windows.force_s),
        averaging=Averaging(
            estimator=FrfEstimator(file.averaging.estimator), keep_hits=file.averaging.keep_hits
        ),
        sensor=SensorOnArm(mass_kg=file.sensor.mass_kg),
        postures=tuple(
            _posture(table, f"postures[{index}]", arm, origin)
            for index, table in enumerate(file.postures)
        ),
        text=text,
        sha256=hashlib.sha256(text.encode("utf-8")).hexdigest(),
    )


def _posture(table: PostureTable, path: str, arm: Arm, origin: str) -> PlannedPosture:
    if len(table.joints_deg) != len(arm.joints):
        wanted = f"{len(arm.joints)} joint angles"
        refuse(PlanError, origin, f"{path}.joints_deg", wanted=wanted, got=table.joints_deg)
    joints_rad = np.radians(table.joints_deg)
    for index, (joint, angle) in enumerate(zip(arm.joints, joints_rad, strict=True)):
        low, high = joint.range_rad
        if not low - _RANGE_ROUNDING_RAD <= angle <= high + _RANGE_ROUNDING_RAD:
            wanted = (
                f"{math.degrees(low):.2f} to {math.degrees(high):.2f}, the range of {joint.name} "
                f"(posture {table.name!r})"
            )
            got = table.joints_deg[index]
            refuse(PlanError, origin, f"{path}.joints_deg[{index}]", wanted=wanted, got=got)
    for index, point in enumerate(table.points):
        point_path = f"{path}.points[{index}]"
        _check_point(point, point_path, arm, origin)
        if point in table.points[:index]:
            refuse(PlanError, origin, point_path, wanted="each point once a posture", got=point)
    direction = None
    if table.hit_direction is not None:
        length = math.hypot(*table.hit_direction)
        direction = frozen_array(np.array(table.hit_direction) / length, np.float64)
    mass = None
    if table.known_mass is not None:
        links = [joint.link.name for joint in arm.joints]
        if table.known_mass.link not in links:
            wanted = f"a link of the arm: {', '.join(links)}"
            named = table.known_mass.link
            refuse(PlanError, origin, f"{path}.known_mass.link", wanted=wanted, got=named)
        mass = KnownMass(
            link=table.known_mass.link,
            mass_kg=table.known_mass.mass_kg,
            center_m=frozen_array(table.known_mass.center_m, np.float64),
        )
    return PlannedPosture(
        name=table.name,
        joints_rad=frozen_array(joints_rad, np.float64),
        tolerance_rad=math.radians(table.tolerance_deg),
        points=tuple(table.points),
        hit_direction=direction,
        validation=table.validation,
        brakes=table.brakes,
        known_mass=mass,
        peaks_n=tuple(table.peaks_n or ()),
    )


def _check_point(point: str, path: str, arm: Arm, origin: str) -> None:
    known = [known_point.id for known_point in arm.points]
    if point not in known:
        listed = ", ".join(known[:20]) + (", ..." if len(known) > 20 else "")
        refuse(PlanError, origin, path, wanted=f"a point of the arm ({listed})", got=point)
