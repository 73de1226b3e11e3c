"""A memory on a 1-Wire line, by the data sheets of the DS2430A, DS2431 and DS2433: slots in time.

A line that is pulled down for 480 us or more is a reset; the memory answers 15 to 60 us after it is
let go, for 60 to 240 us. A slot begins when the line goes down: a 1 is up again within 15 us, a 0
after 60 us; for a bit that it sends the memory keeps the line down for some 30 us.
"""

RESET_US, ANSWERS_AT_US, ANSWERS_FOR_US = 480.0, 30.0, 120.0
ONE_BEFORE_US, SENDS_FOR_US = 15.0, 30.0
READ_ROM, READ_MEMORY, READ_REGISTER = 0x33, 0xF0, 0xC3
DS2430A = 0x14


def crc8(data):
    """Of a ROM's number: x^8 + x^5 + x^4 + 1, lowest bit first."""
    crc = 0
    for byte in data:
        for bit in range(8):
            mixed = (crc ^ byte >> bit) & 1
            crc = crc >> 1 ^ (0x8C if mixed else 0)
    return crc


class OneWireMemory:
    """`down(t)` and `up(t)` are the master's edges in us; `holds(t)` whether it pulls the line.

    `data` is the memory's content, checksum bytes within; `register` the application register.
    """

    def __init__(self, family, data, *, register=b"", serial=b"\1\2\3\4\5\6"):
        number = bytes([family]) + serial
        self.rom = number + bytes([crc8(number)])
        self.family, self.data, self.register = family, data, register
        self._fell_us = self._hold_until_us = -1.0
        self._hold_from_us = 0.0
        self._taken: list[int] = []
        self._to_send: list[int] = []
        self._asleep, self._sends = True, False

    def holds(self, t_us):
        return self._hold_from_us <= t_us < self._hold_until_us

    def down(self, t_us):
        self._fell_us = t_us
        self._sends = bool(self._to_send)
        if self._to_send and not self._to_send.pop(0):
            self._hold_from_us, self._hold_until_us = t_us, t_us + SENDS_FOR_US

    def up(self, t_us):
        low_us = t_us - self._fell_us
        if low_us >= RESET_US:
            self._hold_from_us = t_us + ANSWERS_AT_US
            self._hold_until_us = self._hold_from_us + ANSWERS_FOR_US
            self._taken, self._to_send, self._asleep = [], [], False
        elif not self._asleep and not self._sends:
            self._taken.append(int(low_us < ONE_BEFORE_US))
            self._obey()

    def _obey(self):
        said = [
            sum(bit << i for i, bit in enumerate(self._taken[at : at + 8]))
            for at in range(0, len(self._taken) - 7, 8)
        ]
        if len(self._taken) % 8:
            return
        two = self.family != DS2430A
        if said == [READ_ROM]:
            self._send(self.rom)
        elif said[:1] == [READ_ROM] and said[1:2] == [READ_MEMORY] and len(said) == 3 + two:
            self._send(self.data[said[2] :])
        elif said[:1] == [READ_ROM] and said[1:] == [READ_REGISTER, 0] and not two:
            self._send(self.register)

    def _send(self, data):
        self._to_send = [byte >> bit & 1 for byte in data for bit in range(8)]


def paged(data):
    """A data sheet as it lies in the memory: a checksum byte before each 31 bytes."""
    pages = [data[i : i + 31].ljust(31, b"\0") for i in range(0, len(data), 31)]
    return b"".join(bytes([sum(page) & 0xFF]) + page for page in pages)
