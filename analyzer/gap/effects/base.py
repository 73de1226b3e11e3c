"""A base that rocks and shifts on its floor."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import numpy.typing as npt

from armodal.analyzer.gap.effects.compliance import compliance_parameter
from armodal.analyzer.gap.model.assembly import Assembly
from armodal.analyzer.gap.model.base_body import BASE_BODY
from armodal.analyzer.gap.model.effect import EffectWords, Instance
from armodal.analyzer.gap.model.geometry import skew
from armodal.analyzer.gap.model.interface import loss_factor_parameter
from armodal.analyzer.gap.model.ordinary import Ordinary
from armodal.analyzer.gap.model.priors import BASE_FARTHEST_M
from armodal.analyzer.gap.model.scales import foot_m
from armodal.analyzer.gap.model.soft_parts import BASE_TURN, BASE_WAYS
from armodal.analyzer.gap.model.space import Parameter

__all__ = ["WORDS", "instances"]

Array = npt.NDArray[np.float64]

WORDS = EffectWords(
    name="base",
    title="Base rocks or shifts on its floor",
    changes="releases the six motions of the base on springs",
    signature="points on the base move with the arm, more in postures that reach far",
    confused_with=("bearing", "link_axis"),
    told_by="a sensor on the base plate and one on the floor beside it",
    remedy="retorque the base bolts, grout or shim the plate, or test on a stiffer foundation",
)
_START = 0.05  # of the arm's compliance, rocking: from nothing a fit finds its way slowly
# Of its bolts, about the foot. No source: assumed.
_PIVOT_STD_M = 0.1
_UP = skew(np.array([0.0, 0.0, 1.0]))


def _told(name: str) -> str:
    """Of "base rock x" and its like; the level lines it rocks about are told beside."""
    _, way, axis = name.split()
    line = "line " if way == "rock" and axis in "xy" else ""
    return f"{way}ing stiffness {'along' if way == 'shift' else 'about'} {line}{axis}"


def instances(ordinary: Ordinary) -> tuple[Instance, ...]:
    """The one base."""
    names = [f"base {way}" for way in BASE_WAYS]
    pivot, turn, factor = "base pivot", BASE_TURN.name, "base loss factor"

    def build(assembly: Assembly, values: Mapping[str, float]) -> None:
        c, s = np.cos(values[turn]), np.sin(values[turn])
        rocking = np.zeros((2, ordinary.superset.n))  # about lines through the pivot
        lower = np.zeros((2, ordinary.superset.n))
        rocking[:, 3:5], lower[:, :3] = np.eye(2), _UP[:, :2].T
        rocking[:, :3] += np.cross(foot_m(ordinary.superset), np.eye(3)[:2])
        rocking += values[pivot] * lower
        turned, across = np.array([[c, s], [-s, c]]), np.array([[-s, c], [-c, -s]])
        at = [assembly.names[name] for name in names[3:5]]
        for i, column in zip(at, turned @ rocking, strict=True):
            assembly.columns[i] = column
        assembly.motion_of[pivot] = list(zip(at, turned @ lower, strict=True))
        assembly.motion_of[turn] = list(zip(at, across @ rocking, strict=True))

    def describe(values: Mapping[str, float]) -> dict[str, object]:
        """Level lines in the base's frame that it rocks about."""
        c, s = float(np.cos(values[turn])), float(np.sin(values[turn]))
        return {"rock_x_about": [c, s, 0.0], "rock_y_about": [-s, c, 0.0]}

    rock = compliance_parameter("", ordinary, 0)
    relaxes = {
        name: Parameter(
            name=name,
            unit="rad/(N m)" if i >= 3 else "m/N",
            mean=0.0,
            low=0.0,
            std=rock.std * (1.0 if i >= 3 else ordinary.base_lever_m**2),
            start=_START * ordinary.compliance if name in names[3:5] else None,
        )
        for i, name in enumerate(names)
    }
    body = {p.name: p for p in ordinary.parameters() if p.name in BASE_BODY}
    return (
        Instance(
            effect=WORDS,
            place="base",
            parameters=(
                Parameter(
                    name=pivot,
                    unit="m",
                    mean=0.0,
                    std=_PIVOT_STD_M,
                    low=-BASE_FARTHEST_M,
                    high=BASE_FARTHEST_M,
                ),
            ),
            # As they were, but told.
            relaxes=relaxes | body | {turn: BASE_TURN, factor: loss_factor_parameter(factor)},
            builder=build,
            describe=describe,
            details=BASE_BODY[2:],
            size=names[3],
            words={name: _told(name) for name in names},
            sizes=tuple(names[3:6]),
            side_sizes=tuple(
                (name, ordinary.floor_limit * ordinary.base_lever_m**2) for name in names[:3]
            ),
            material=ordinary.floor_limit,
            drives=ordinary.drives(),
        ),
    )
