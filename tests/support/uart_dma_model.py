"""A UART with two channels of DMA, as those of microcontrollers: a circular one that receives, its
counter falling from the ring's size to 0 and beginning anew with an interrupt; one that sends
what it is given, byte by byte, from the memory as it then is.
"""


class UartDma:
    """`receive` lets bytes come, `transmit` lets bytes go; interrupts are calls.

    `delay` keeps the interrupt of a lap back until `interrupt` is called.
    """

    def __init__(self, ffi, c, *, ring_size, out_size):
        self.ffi, self.c = ffi, c
        self.ring = ffi.new("uint8_t[]", ring_size)
        self.out = ffi.new("uint8_t[]", out_size)
        self.left, self.size = ring_size, ring_size
        self.delay, self.due = False, 0
        self.memory, self.gone = None, 0  # of the transfer under way
        self.line = bytearray()
        self._keep = [
            ffi.callback("uint32_t(void *)", lambda _context: self.left),
            ffi.callback("void(void *, const uint8_t *, size_t)", self._send),
        ]
        self.port = ffi.new("dma_port *", {"left": self._keep[0], "send": self._keep[1]})
        self.link = ffi.new("dma_link *")
        c.dma_link_begin(self.link, self.port, self.ring, ring_size, self.out, out_size)

    def receive(self, data):
        for byte in data:
            self.ring[self.size - self.left] = byte
            self.left -= 1
            if self.left == 0:
                self.left = self.size
                self.due += 1
                if not self.delay:
                    self.interrupt()

    def interrupt(self):
        while self.due:
            self.due -= 1
            self.c.dma_link_lap(self.link)

    def _send(self, _context, memory, n):
        assert self.memory is None, "a transfer is under way"
        assert n > 0
        self.memory, self.gone = (memory, n), 0

    def transmit(self, n):
        """Let at most n bytes go; with the last of a transfer comes its interrupt."""
        while n and self.memory is not None:
            memory, size = self.memory
            self.line.append(memory[self.gone])
            self.gone += 1
            n -= 1
            if self.gone == size:
                self.memory = None
                self.c.dma_link_sent(self.link)

    def write(self, data):
        return self.c.dma_link_write(self.link, data, len(data))

    def read(self, n):
        into = self.ffi.new("uint8_t[]", max(n, 1))
        return bytes(self.ffi.buffer(into, self.c.dma_link_read(self.link, into, n)))
