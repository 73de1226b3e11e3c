"""The demo: a whole test in the simulated laboratory, and the truth beside what was found."""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.gap.records import GapResult
from armodal.analyzer.gap.workflow import find_gap
from armodal.analyzer.identification.identify import estimate_frfs, identify
from armodal.analyzer.identification.records import AxisResult, Identification
from armodal.analyzer.report import write_report
from armodal.analyzer.screws import line_angle_rad, line_distance_m
from armodal.daq.events import Event
from armodal.daq.settings import AcquisitionSettings
from armodal.hil_sim.lab import start_laboratory
from armodal.hil_sim.ledger import AxisTruth, LedgerTruth, read_ledger
from armodal.protocols.arm.files import load_arm
from armodal.protocols.arm.records import Arm
from armodal.protocols.plan import load_plan
from armodal.protocols.session.recovery import rebuild
from armodal.tui.command_parts.demo_simulator import through_the_simulator
from armodal.tui.command_parts.gap_results import gap_json, keep_gap
from armodal.tui.command_parts.identification_results import identification_json
from armodal.tui.operators import ScriptedOperator, acquire

__all__ = ["run_demo"]

DEMO_TIME_SCALE = 16.0  # lab seconds a second


def run_demo(
    directory: Path,
    *,
    seed: int,
    software: str,
    show: Callable[[Event], None],
    say: Callable[[str], None],
    time_scale: float = DEMO_TIME_SCALE,
    plan_name: str = "rv4frl-three-postures",
) -> tuple[dict[str, Any], Identification, GapResult]:
    """Capture, fit, identify, find the gap, report; then set the ledger's truth beside.

    Returns
    -------
    object, identification, gap
        The object `armodal demo --json` prints, and what is behind it.
    """
    began = time.monotonic()
    directory.mkdir(parents=True, exist_ok=True)
    arm = load_arm("rv4frl")
    plan = load_plan(plan_name, arm)
    journal, session_path = directory / "demo.journal", directory / "demo.h5"
    report_path, lab_directory = directory / "report.html", directory / "lab"
    journal.unlink(missing_ok=True)
    with start_laboratory(
        "rv4frl", seed=seed, time_scale=time_scale, directory=lab_directory
    ) as laboratory:
        operator = ScriptedOperator(laboratory.operator, arm, plan, time_scale=time_scale)
        settings = AcquisitionSettings(
            board_port=laboratory.board,
            can_channel=laboratory.can,
            arm=arm,
            plan=plan,
            journal=journal,
            time_scale=time_scale,
            software=software,
            measured_by="the simulated hand",
        )
        say("capture")
        finished = acquire(settings, operator, show)
        operator.close()
    captured_s = time.monotonic() - began
    superset = Superset(arm)
    recovered = rebuild(
        journal,
        session_path,
        software=software,
        estimate_frfs=lambda session: estimate_frfs(session, superset),
    )
    result = identify(recovered.session, say)
    say("gap between model and measurement")
    gap_began = time.monotonic()
    outcome = find_gap(recovered.session, tell=say)
    arm_path = directory / "demo.arm.toml"
    arm_path.unlink(missing_ok=True)
    written = keep_gap(recovered.session, session_path, outcome, arm_path)
    gap_s = time.monotonic() - gap_began
    say("report")
    write_report(recovered.session, result, report_path, gap=outcome.result)
    found = identification_json(recovered.session, result)
    found["gap"] = gap_json(outcome.result, written)
    if "arm_file" in written:
        say("the corrected arm in a simulator")
        found["simulator"] = through_the_simulator(
            recovered.session, result, written["arm_file"], directory
        )
    # Only now, with everything written down, is the laboratory's own book opened.
    truth = read_ledger(lab_directory / "ledger.jsonl").truth
    _set_truth_beside(found, result, arm, truth)
    _set_truth_beside_gap(found["gap"], truth)
    found |= {
        "complete": finished.complete,
        "capture_s": captured_s,
        "gap_s": gap_s,
        "wall_s": time.monotonic() - began,
        "session": str(session_path),
        "report": str(report_path),
    }
    return found, result, outcome.result


def _set_truth_beside_gap(gap: dict[str, Any], truth: LedgerTruth) -> None:
    for effect in gap["effects"]:
        axis = truth.axis
        if effect["name"] == "link_axis" and axis is not None and axis.link == effect["place"]:
            effect["k_n_m_per_rad"] = 1.0 / effect["parameters"][effect["size"]]
            effect["truth_k_n_m_per_rad"] = axis.k_n_m_per_rad


def _set_truth_beside(
    found: dict[str, Any], result: Identification, arm: Arm, truth: LedgerTruth
) -> None:
    for joint in found["joints"]:
        true = truth.joint(joint["joint"])
        joint["truth_k_n_m_per_rad"] = true.k_n_m_per_rad
        joint["truth_c_n_m_s_per_rad"] = true.c_n_m_s_per_rad
    for row, axis in zip(found["structural"], result.axes, strict=True):
        if truth.axis is None or truth.axis.link != axis.link:
            continue
        angle_deg, distance_mm = axis_errors(arm, axis, truth.axis)
        row["truth_k_n_m_per_rad"] = truth.axis.k_n_m_per_rad
        row["truth_c_n_m_s_per_rad"] = truth.axis.c_n_m_s_per_rad
        row["axis_angle_error_deg"] = angle_deg
        row["axis_distance_error_mm"] = distance_mm


def axis_errors(arm: Arm, axis: AxisResult, truth: AxisTruth) -> tuple[float, float]:
    """Angle in degrees and perpendicular distance in mm of an axis from the true one.

    The distance is taken from the point of the true axis nearest the crossing of joints 1 and 2,
    which is the origin of joint 2 in link 1's frame.
    """
    crossing = arm.joints[1].T_parent_joint[:3, 3]
    direction = truth.direction_link
    nearest = truth.point_link_m + direction * (direction @ (crossing - truth.point_link_m))
    angle = np.rad2deg(line_angle_rad(axis.direction_link, direction))
    distance = line_distance_m(nearest, axis.point_link_m, axis.direction_link)
    return float(angle), 1e3 * distance
