"""Conformance checks of boards and controllers, step by step."""

from armodal.daq.check.board import BOARD_STEPS, check_board
from armodal.daq.check.board_bench import BoardCheckOptions
from armodal.daq.check.can import CAN_STEPS, check_can
from armodal.daq.check.run import CheckError
from armodal.daq.check.verdict import Report, StepResult, Verdict

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
