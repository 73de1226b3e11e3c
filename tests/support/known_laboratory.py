"""The laboratory around the known arm, as a process that keeps every sample its converter gave.

Beside the ledger it writes `samples-N.bin` for the N-th START: records of the first index and the
count of samples as two 64-bit integers, then the counts as int32, four a sample.
"""

import struct
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))

from support.known_arm import KnownArm, KnownBlow, known_truth

from armodal.hil_sim.__main__ import options_of, parse, run
from armodal.hil_sim.lab_process import ArmInCell, LabProcess
from armodal.hil_sim.plant import build_plant
from armodal.protocols.errors import ArmodalError

PEAK_COUNTS = 100_000
HEAD = struct.Struct("<qq")


class Recorder:
    """Writes what the firmware is given."""

    def __init__(self, laboratory, folder):
        self._firmware = laboratory.board.firmware
        self._spoil = self._firmware.spoil
        self._folder = folder
        self._file = None
        self._epochs = 0
        self._firmware.spoil = self._record

    def begin(self):
        self._epochs += 1
        self._file = (self._folder / f"samples-{self._epochs}.bin").open("wb", buffering=0)

    def _record(self, counts):
        counts = self._spoil(counts)
        self._file.write(HEAD.pack(self._firmware.next_sample, len(counts)) + counts.tobytes())
        return counts


def main():
    given = parse()
    recorders, made = [], []

    def make_source(_rate_hz):
        made.append(1)
        recorders[0].begin()
        return KnownArm(len(made))

    arm = ArmInCell(
        plant=build_plant(known_truth()),
        make_source=make_source,
        swing=lambda point, direction, peak_n: (
            KnownBlow(peak_counts=PEAK_COUNTS),
            {"peak_counts": PEAK_COUNTS},
        ),
        mounted=lambda: {"tilt_rad": [0.0, 0.0, 0.0]},
    )
    try:
        laboratory = LabProcess(arm, options_of(given))
    except ArmodalError as error:
        sys.stderr.write(f"hil_sim: {error}\n")
        return 2
    recorders.append(Recorder(laboratory, given.directory))
    run(laboratory, watch_stdin=given.watch_stdin)
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
