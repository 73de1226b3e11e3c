"""The tables of `armodal plan`: tests, their modes, what to expect, and another plan beside."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from rich.table import Table

from armodal.analyzer.planning.compared_plan import ComparedPlan
from armodal.analyzer.planning.made import MadePlan
from armodal.analyzer.planning.selective import PlannedTest, SelectivePlan

__all__ = ["made_lines", "plan_tables"]

Array = npt.NDArray[np.float64]

SEEN = 1.0  # relative: a k no better known than to its own size is not seen


def plan_tables(
    plan: SelectivePlan, beside: ComparedPlan | None, inertia_std: Array
) -> list[Table]:
    """The tests as tables for people."""
    return [
        _selective(plan, beside),
        _tests(plan),
        _modes(plan),
        _expected(plan, inertia_std),
        _gravity(plan),
    ]


def _selective(plan: SelectivePlan, beside: ComparedPlan | None) -> Table:
    names = [joint.name for joint in plan.arm.joints]
    table = Table(title="Most selective posture of each joint")
    for column in ("joint", "posture deg", "largest M_ij/M_ii"):
        table.add_column(column, justify="right")
    if beside is not None:
        table.add_column(beside.name, justify="right")
        table.add_column("there in", justify="right")
    for i, joint in enumerate(plan.elastic.joints):
        row = [names[joint], _angles(plan.most_selective[i]), f"{plan.least_coupling[i]:.4f}"]
        if beside is not None:
            row += [f"{beside.least_coupling[i]:.4f}", beside.postures[i]]
        table.add_row(*row)
    return table


def _tests(plan: SelectivePlan) -> Table:
    names = [joint.name for joint in plan.arm.joints]
    table = Table(title=f"Tests for {plan.arm.name}: the first {plan.n_needed} are needed")
    for column in ("", "posture deg", "for", "shows", "worst M_ij/M_ii", "hit", "purity %"):
        table.add_column(column)
    table.add_column("seen by")
    for number, test in enumerate(plan.tests, start=1):
        tied = [names[joint] for joint in test.separable if joint != test.target]
        table.add_row(
            str(number),
            _angles(test.joints_rad),
            names[test.target] + (f" with {', '.join(tied)}" if tied else ""),
            _good_for(plan, number, names),
            f"{test.coupling.max():.4f}",
            _hit(test),
            f"{100 * test.hit.purity:.0f}",
            " ".join(test.points),
        )
    return table


def _good_for(plan: SelectivePlan, number: int, names: list[str]) -> str:
    if number > plan.n_fitted:
        return "for validation, not fitted"
    served = plan.tests[number - 1].serves
    return ", ".join(names[joint] for joint in served) or "adds to the others"


def _modes(plan: SelectivePlan) -> Table:
    names = [joint.name for joint in plan.arm.joints]
    table = Table(title="Modes to expect, and each joint's part of the strain energy, %")
    for column in ("test", "f Hz", "damping %", *(names[j] for j in plan.elastic.joints)):
        table.add_column(column, justify="right")
    for number, test in enumerate(plan.tests, start=1):
        for i, f_hz in enumerate(test.modes.f_hz):
            table.add_row(
                str(number) if i == 0 else "",
                f"{f_hz:.1f}",
                f"{100 * test.modes.damping_ratio[i]:.1f}",
                *(f"{100 * share:.0f}" for share in test.modes.joint_share[:, i]),
            )
    return table


def _expected(plan: SelectivePlan, inertia_std: Array) -> Table:
    names = [joint.name for joint in plan.arm.joints]
    table = Table(title="Least standard deviation of k to expect after each test, %")
    table.add_column("tests", justify="right")
    for joint in plan.elastic.joints:
        table.add_column(names[joint], justify="right")
    for number, row in enumerate(plan.expected_std, start=1):
        table.add_row(
            str(number),
            *(f"{100 * std:.2g}" if std < SEEN else "not seen" for std in row),
        )
    both = np.hypot(plan.expected_std[-1], inertia_std)
    table.add_section()
    table.add_row("inertias", *(f"{100 * std:.2g}" for std in inertia_std))
    table.add_row("both", *(f"{100 * std:.2g}" if std < SEEN else "not seen" for std in both))
    return table


def made_lines(made: MadePlan) -> list[str]:
    """What is to be known before the plan is run."""
    chosen = made.equipment
    hammer, sensor = chosen.hammer, chosen.accelerometer
    pulse = f"pulse of {1e3 * chosen.pulse_s:.2g} ms, hits of some {chosen.told_peak_n} N"
    trigger = f"trigger {chosen.trigger_n:g} N"
    lines = [
        f"hammer: {hammer.name}, head {hammer.head_kg:g} kg, {pulse}, {trigger}",
        f"accelerometer: {sensor.name}, {1e3 * sensor.mass_kg:g} g, to {sensor.range_m_s2:g} m/s²",
        f"time: some {made.minutes:.0f} minutes, {made.mountings} mountings",
        _validation(made.plan),
    ]
    if made.by_capsules:
        lines.append("collisions: by capsules between the joints; look before you move")
    if made.touching:
        lines.append(f"not checked, they meet in all postures: {'; '.join(made.touching)}")
    for number, leg in enumerate(made.legs, start=2):
        if leg.stops_rad is None:
            lines.append(f"to test {number}: no free straight way found, move joint by joint")
        elif leg.stops_rad:
            by = "; ".join(_angles(stop) for stop in leg.stops_rad)
            lines.append(f"to test {number}: go by {by} degrees")
    return lines


def _validation(plan: SelectivePlan) -> str:
    if plan.n_fitted < len(plan.tests):
        return f"validation: test {len(plan.tests)} is predicted from the others, never fitted"
    return "validation: none; plan four tests or more, of which one is kept for it"


def _gravity(plan: SelectivePlan) -> Table:
    names = [joint.name for joint in plan.arm.joints]
    table = Table(
        title="Gravity: torque N m, the turn it costs the spring mrad, dg/dq in % of k",
        title_justify="left",
    )
    table.add_column("test", justify="right")
    for joint in plan.elastic.joints:
        table.add_column(names[joint], justify="right")
    k = plan.elastic.stiffness_n_m_per_rad
    for number, test in enumerate(plan.tests, start=1):
        found = test.gravity
        table.add_row(
            str(number),
            *(
                f"{torque:+.1f} {1e3 * torque / spring:+.2f} {100 * part:+.2f}"
                for torque, spring, part in zip(
                    found.torque_n_m, k, found.part_of_spring, strict=True
                )
            ),
        )
    return table


def _angles(joints_rad: Array) -> str:
    return " ".join(f"{angle:.0f}" for angle in np.rad2deg(joints_rad))


def _hit(test: PlannedTest) -> str:
    direction = " ".join(f"{value:+.2f}" for value in test.hit.direction_base)
    return f"{test.hit.point} along {direction}{'' if test.hit.along_normal else ' (block)'}"
