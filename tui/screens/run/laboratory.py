"""The simulated laboratory behind one key: its process, its ports, its hand."""

from __future__ import annotations

from collections.abc import Callable

from armodal.hil_sim.lab import Laboratory, start_laboratory
from armodal.hil_sim.rehearsal import Rehearsal
from armodal.protocols.arm.records import Arm
from armodal.protocols.plan_records import Plan
from armodal.tui.operators import ScriptedOperator
from armodal.tui.screens.run.hand import SimulatedHand
from armodal.tui.screens.run.happenings import HandAtWork, HandIdle

__all__ = ["SimulatedLab"]


class SimulatedLab:
    """A running simulated laboratory with its hand.

    Raises
    ------
    PlantError, DeviceTimeoutError, DeviceLostError
        If it does not start.
    """

    def __init__(
        self,
        arm: Arm,
        plan: Plan,
        *,
        hidden: tuple[tuple[str, str | float], ...] = (),
        seed: int,
        time_scale: float,
        tell: Callable[[HandAtWork | HandIdle], None],
    ) -> None:
        self.laboratory: Laboratory = start_laboratory(
            Rehearsal(arm=arm, plan=plan, hidden=hidden), seed=seed, time_scale=time_scale
        )
        try:
            operator = ScriptedOperator(
                self.laboratory.operator, arm, plan, time_scale=time_scale, timeout_s=60.0
            )
        except BaseException:
            self.laboratory.close()
            raise
        self.hand = SimulatedHand(operator, tell)

    @property
    def alive(self) -> bool:
        """Whether its process runs."""
        return self.laboratory.alive

    def failure(self) -> str | None:
        """Return why it has ended by itself, if it has."""
        return self.laboratory.failure()

    def close(self) -> None:
        """Stop it."""
        self.hand.close()
        self.laboratory.close()
