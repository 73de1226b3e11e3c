"""The converter ADS131M04 by its data sheet (TI SBAS890): registers, frames, CRC, its two samples.

Section 8.5.1: a frame has as many words of 24 bits as there are channels, and two more; the answer
to a command comes in the next frame; RESET is acknowledged by FF24. Section 8.5.1.9: two samples
wait in it, the older one comes first. Section 8.6: registers and what they hold after reset.
"""

import binascii

CHANNELS, WORD = 4, 3
FRAME = WORD * (CHANNELS + 2)
ID, STATUS, MODE, CLOCK, GAIN1 = range(5)
AFTER_RESET = {ID: 0x2400, STATUS: 0x0500, MODE: 0x0510, CLOCK: 0x0F0E, GAIN1: 0x0000}
WRITABLE = {MODE: 0x3F1F, CLOCK: 0x0F3F, GAIN1: 0x7777}


class Ads131m04:
    """One chip; `sample` lets it convert once.

    `flips` are bits of the next frame that the line turns over; `sticks` is a register that cannot
    be written.
    """

    def __init__(self, *, id_register=0x2400, sticks=None, dead=False) -> None:
        self.registers = dict(AFTER_RESET) | {ID: id_register}
        self.sticks, self.dead, self.flips = sticks, dead, 0
        self.resync = False
        self.waiting: list[tuple[int, ...]] = []
        self.commands: list[int] = []
        self._answer: int | None = None

    def sample(self, *counts: int) -> None:
        """A conversion is done: the older of two that wait is thrown away."""
        self.waiting = [*self.waiting, counts][-2:]

    def transfer(self, out: bytes) -> bytes:
        """Chip select low, bytes both ways, chip select high."""
        said = self.shift_out()
        self.shift_in(out)
        return said

    def shift_out(self) -> bytes:
        """The chip's half of a frame: what it says, whatever it is told meanwhile."""
        if self.dead:
            return bytes(FRAME)
        words = [self._status() if self._answer is None else self._answer]
        counts = self.waiting.pop(0) if self.waiting else (0,) * CHANNELS
        frame = words[0].to_bytes(2, "big") + b"\0"
        frame += b"".join((count & 0xFFFFFF).to_bytes(WORD, "big") for count in counts)
        crc = binascii.crc_hqx(frame, 0xFFFF)  # CRC-16 CCITT
        sent = int.from_bytes(frame + crc.to_bytes(2, "big") + b"\0", "big") ^ self.flips
        self.flips = 0
        return sent.to_bytes(FRAME, "big")

    def shift_in(self, out: bytes) -> None:
        """The host's half of a frame, obeyed as chip select goes up."""
        assert len(out) == FRAME
        if not self.dead:
            self._obey(int.from_bytes(out[:2], "big"), int.from_bytes(out[WORD : WORD + 2], "big"))

    def _status(self) -> int:
        new = 0b1111 if self.waiting else 0
        reset = self.registers[MODE] & 0x0400
        status = 0x0100 | reset | self.resync << 14 | new
        self.resync = False
        return status

    def _obey(self, command: int, value: int) -> None:
        self.commands.append(command)
        address = command >> 7 & 0x3F
        self._answer = None
        if command == 0x0011:
            self.registers = dict(AFTER_RESET) | {ID: self.registers[ID]}
            self.waiting = []
            self._answer = 0xFF20 | (self.registers[ID] >> 8 & 0xF)
        elif command >> 13 == 0b101:
            self._answer = self.registers[address]
        elif command >> 13 == 0b011:
            if address in WRITABLE and address != self.sticks:
                self.registers[address] = value & WRITABLE[address]
            self._answer = 0x4000 | command & 0x1FFF
