"""`armodal run`: start the operator's app."""

from __future__ import annotations

import math
from pathlib import Path

from armodal.protocols.arm.files import load_arm
from armodal.protocols.arm.records import Arm
from armodal.protocols.errors import SessionError
from armodal.protocols.plan import load_plan
from armodal.tui.run.app import RunApp
from armodal.tui.run.conductor import RunOptions
from armodal.tui.run.place import find_place

__all__ = ["run_app"]

SIMULATED_PLAN = "rv4frl-three-postures"


def run_app(
    *,
    plan: str | None,
    arm: str | Arm,
    session: Path,
    simulated: bool,
    software: str,
    board: str = "",
    can: str = "",
    baud: int = 921_600,
    seed: int = 1,
    time_scale: float = 1.0,
    input_range_v: float | None = None,
) -> int:
    """Run the app to its end; return the exit code.

    Raises
    ------
    ArmodalError
        If arm, plan, an existing journal or the input range cannot be used.
    """
    if input_range_v is not None and not 0.0 < input_range_v < math.inf:
        raise SessionError(
            "--input-range: wanted the largest input voltage of the board in V, above 0, got "
            f"{input_range_v:g}; its data sheet tells it"
        )
    the_arm = load_arm(arm) if isinstance(arm, str) else arm
    if plan is None and not session.exists() and simulated:
        plan = SIMULATED_PLAN
    place = find_place(session, the_arm, None if plan is None else load_plan(plan, the_arm))
    options = RunOptions(
        place=place,
        board=board,
        can=can,
        baud=baud,
        input_range_v=input_range_v,
        simulated=simulated,
        seed=seed,
        time_scale=time_scale,
        software=software,
    )
    app = RunApp(options)
    app.run()
    return app.return_code or 0
