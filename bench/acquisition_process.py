"""The acquisition as a process to be killed: `torture_real_kills.py` starts it.

python bench/acquisition_process.py SOCKET BOARD CAN JOURNAL PLAN TIME_SCALE
"""

from __future__ import annotations

import os
import sys
from multiprocessing.connection import Client
from pathlib import Path

from armodal.daq.acquisition import run_acquisition
from armodal.daq.settings import AcquisitionSettings
from armodal.protocols.arm.files import load_arm
from armodal.protocols.plan import load_plan

if __name__ == "__main__":
    socket, board, can, journal, plan, time_scale = sys.argv[1:]
    arm = load_arm("rv4frl")
    settings = AcquisitionSettings(
        board_port=board,
        can_channel=can,
        arm=arm,
        plan=load_plan(plan, arm),
        journal=Path(journal),
        time_scale=float(time_scale),
        resume=Path(journal).exists(),
    )
    channel = Client(socket, "AF_UNIX")
    channel.send(os.getpid())
    sys.exit(run_acquisition(settings, channel))
