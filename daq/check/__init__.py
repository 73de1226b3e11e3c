"""Conformance checks of boards and controllers, step by step."""

from daq.check.board import BOARD_STEPS, check_board
from daq.check.board_bench import BoardCheckOptions
from daq.check.can import CAN_STEPS, check_can
from daq.check.run import CheckError
from daq.check.verdict import Report, StepResult, Verdict

__all__ = [
    "BOARD_STEPS",
    "CAN_STEPS",
    "BoardCheckOptions",
    "CheckError",
    "Report",
    "StepResult",
    "Verdict",
    "check_board",
    "check_can",
]
