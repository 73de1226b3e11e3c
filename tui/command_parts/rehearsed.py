"""An arm that is rehearsed in the simulated laboratory: its bus, its plan, its truth afterwards."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from armodal.hil_sim.ledger import LedgerTruth, read_ledger
from armodal.hil_sim.study import rehearsal_plan
from armodal.protocols.arm.generic_can import with_generic_can
from armodal.protocols.arm.records import Arm
from armodal.protocols.errors import PlanError
from armodal.protocols.plan import load_plan, shipped_plans
from armodal.protocols.plan_records import Plan
from armodal.tui.console import out, print_json, say

__all__ = ["plan_to_rehearse", "show_truth", "spoken_arm"]

FIRST_PLAN = {"rv4frl": "rv4frl-three-postures"}  # of several shipped ones


def spoken_arm(arm: Arm) -> Arm:
    """Return the arm with a bus: the generic one where its file has no [can] section.

    Raises
    ------
    CanError
        If it has more joints than the generic description.
    """
    if arm.can is not None:
        return arm
    say(
        f"{arm.name} has no [can] section: the simulated controller speaks the generic one, "
        "nine_joints.dbc"
    )
    for effect in arm.effects_left_out():
        say(effect)
    return with_generic_can(arm)


def plan_to_rehearse(arm: Arm) -> Plan:
    """Return a shipped plan of the arm, else one of the laboratory's own.

    Raises
    ------
    PlantError
        If the arm has nothing that gives way, or nothing to hit.
    """
    for name in (FIRST_PLAN.get(arm.name, ""), *shipped_plans()):
        if name.startswith(f"{arm.name}-"):
            with suppress(PlanError):  # of the shipped arm, and this one is another
                return load_plan(name, arm)
    say(f"no plan is given: the laboratory draws one, {arm.name}-rehearsal")
    return rehearsal_plan(arm)


def show_truth(ledger: Path, *, as_json: bool) -> None:
    """Print what a laboratory kept to itself.

    Raises
    ------
    PlantError
        If there is no ledger.
    """
    truth = read_ledger(ledger).truth
    if as_json:
        print_json(_plain(truth))
        return
    out.print(f"{truth.plant}, seed {truth.seed}")
    for joint in truth.joints:
        k, c = joint.k_n_m_per_rad, joint.c_n_m_s_per_rad
        out.print(f"{joint.name}: {k:.6g} N m/rad, {c:.4g} N m s/rad")
    if truth.axis is not None:
        out.print(f"hidden axis in {truth.axis.link}: {truth.axis.k_n_m_per_rad:.6g} N m/rad")
    for effect in truth.effects:
        told = ", ".join(f"{key} = {value}" for key, value in effect["parameters"].items())
        out.print(f"{effect['name']} ({effect['place']}): {told}")
    if truth.axis is None and not truth.effects:
        out.print("nothing is hidden beside ordinary errors")


def _plain(truth: LedgerTruth) -> dict[str, Any]:
    told = asdict(truth)
    if told["axis"] is not None:
        told["axis"] = {
            key: value.tolist() if isinstance(value, np.ndarray) else value
            for key, value in told["axis"].items()
        }
    return told
