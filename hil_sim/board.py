"""The board on its pseudo-terminal: reads commands, takes samples when due, sends what fits."""

from __future__ import annotations

from armodal.hil_sim.board_state import BoardFirmware
from armodal.hil_sim.faults import Fault, FaultSet
from armodal.hil_sim.link_faults import ChannelFaults, LinkFaults
from armodal.hil_sim.pty_port import PtyPort
from armodal.hil_sim.streams import Streams

__all__ = ["Board"]

# The line is busy while this much waits for it.
LINK_BUFFER = 8192
# Samples taken in one step, so that a late step does not delay answers for long.
MOST_SAMPLES = 4096
LOST_SAMPLES = 100
LARGEST_JUMP_S = 5.0
DRIFT_PPM = 500.0


class Board:
    """The shell around `BoardFirmware`.

    Parameters
    ----------
    firmware
        The device library.
    port
        The line.
    faults
        What goes wrong at present.
    streams
        By fault, for what it leaves to chance.
    """

    def __init__(
        self,
        firmware: BoardFirmware,
        port: PtyPort,
        *,
        faults: FaultSet,
        streams: Streams,
    ) -> None:
        self.firmware = firmware
        self.port = port
        self._faults = faults
        self._reboots, self._jumps = streams(Fault.BOARD_REBOOT), streams(Fault.CLOCK_JUMP)
        self._unread = b""
        self._link = LinkFaults(faults, streams)
        self._channels = ChannelFaults(faults, streams)
        self._plugged = True
        self._drifting = False
        firmware.send = self._send
        firmware.spoil = self._channels.spoil

    @property
    def wants_write(self) -> bool:
        """Whether to be woken when the line has room."""
        return self.port.pending > 0

    def step(self) -> None:
        """Do what is to be done now; never waits."""
        self._suffer()
        if self._plugged:
            if not self._unread:
                self._unread = self.port.read()
            self._answer()
        self._sample()
        while self.firmware.poll():
            if Fault.DEVICE_OVERFLOW in self._faults or not self._flush():
                return
        self._flush()

    def _sample(self) -> None:
        """Take the samples that are due, as far as the next scripted change."""
        due = min(self.firmware.samples_due(), MOST_SAMPLES)
        if due > LOST_SAMPLES and self._faults.take(Fault.ADC_GAP):
            self.firmware.lose_samples(LOST_SAMPLES)
            due -= LOST_SAMPLES
        while due > 0:
            n = min(due, self._faults.until_change(self.firmware.next_sample) or due)
            self.firmware.take_samples(n)
            due -= n
            self._faults.reach(self.firmware.next_sample)

    def _suffer(self) -> None:
        """Let happen to the board what is not of single frames or samples."""
        self._faults.reach(self.firmware.next_sample)
        if self._faults.take(Fault.DICTIONARY_CHANGE):
            self.firmware.open_sensor(len(self.firmware.dictionary.channels) - 1)
        if self._faults.take(Fault.BOARD_REBOOT):
            self.firmware.reboot(int(self._reboots.integers(1, 1 << 32)))
        if self._faults.take(Fault.CLOCK_JUMP):
            sign = 1.0 if self._jumps.random() < 0.5 else -1.0
            self.firmware.jump_clock(sign * float(self._jumps.uniform(0.05, LARGEST_JUMP_S)))
        if (Fault.CLOCK_DRIFT in self._faults) != self._drifting:
            self._drifting = not self._drifting
            self.firmware.drift_clock(DRIFT_PPM if self._drifting else -DRIFT_PPM)
        if (Fault.UNPLUG in self._faults) == self._plugged:
            self._plugged = not self._plugged
            if self._plugged:
                self.port.plug()
            else:
                self._unread = b""
                self.port.unplug()

    def _flush(self) -> bool:
        """Whether the line has taken all."""
        return Fault.LINK_STALL not in self._faults and self._plugged and self.port.flush()

    def _answer(self) -> None:
        if self._unread:
            self._unread = self._unread[self.firmware.receive(self._unread) :]
            self._flush()

    def _send(self, frame: bytes) -> bool:
        """Put a frame on the line, as it is or as a fault will have it; whether there was room."""
        if not self._plugged:
            return True
        if Fault.DEVICE_OVERFLOW in self._faults:
            return False
        if self.port.pending >= LINK_BUFFER and not self._flush():
            return False
        self.port.queue(self._link.carry(frame))
        return True
