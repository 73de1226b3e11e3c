"""The parts of an STM32G474RE that ports/stm32g474 uses, by ST's RM0440: registers in virtual time.

Time goes on with every access of a register: `IN_INTERRUPT_S` in an interrupt, `IN_LOOP_S` else,
which stands for the instructions around it; who waits by the cycle counter is moved on in steps of
a 20th of his wait. What the chip would not do is kept in `faults`: a peripheral without its clock,
a pin that is not the peripheral's, a speed that the supply or the flash does not allow.
"""

from __future__ import annotations

from collections import deque
from functools import cache

from support.ads131m04_model import CLOCK, FRAME, MODE

RCC, FLASH_ACR, DMA1, DMAMUX, TIM2 = 0x40021000, 0x40022000, 0x40020000, 0x40020800, 0x40000000
SPI1, UART, ADC1, ADC12_CCR, RNG = 0x40013000, 0x40008000, 0x50000000, 0x50000308, 0x50060800
GPIO = {"A": 0x48000000, "B": 0x48000400, "C": 0x48000800}
NVIC_ISER, NVIC_IPR, DWT, CYCCNT = 0xE000E100, 0xE000E400, 0xE0001000, 0xE0001004
HSI_HZ, HSE_HZ = 16e6, 24e6
IN_INTERRUPT_S, IN_LOOP_S = 0.2e-6, 3e-6
# Where a peripheral's clock is switched on: base, register, bit.
CLOCKS = [
    (DMA1, 0x800, RCC + 0x48, 0),
    (DMAMUX, 0x400, RCC + 0x48, 2),
    *((base, 0x400, RCC + 0x4C, i) for i, base in enumerate(GPIO.values())),
    (ADC1, 0x400, RCC + 0x4C, 13),
    (RNG, 0x400, RCC + 0x4C, 26),
    (TIM2, 0x400, RCC + 0x58, 0),
    (UART, 0x400, RCC + 0x5C, 0),
    (SPI1, 0x400, RCC + 0x60, 12),
]
# Read again and again by who waits for something else than the cycle counter.
POLLED = frozenset({RCC, RCC + 8, RCC + 0x98, FLASH_ACR, SPI1 + 8, ADC1, ADC1 + 8})
CAPTURED, DATA_READY_PIN, CLOCK_PIN = 1 << 2, ("A", 1, 1), ("A", 15, 14)


@cache
def clock_of(address):
    """Register and bit that switch on the clock of what has the address; None if it needs none."""
    found = [c[2:] for c in CLOCKS if c[0] <= address < c[0] + c[1] and address != DMAMUX]
    return found[0] if found else None


class Stm32g474:
    """The chip. `chip` is the converter on SPI1; `oscillator_hz` its clock, 0 where it stands.

    `convert(i)` gives the counts of sample i; `bias_mv(channel, t_s)` a sensor's bias voltage;
    `memories` are by channel what is on PB10 to PB13. `call(line)` runs an interrupt's function.
    `masked_until_s` keeps all interrupts back, as a longer one would.
    """

    def __init__(self, chip, *, convert, bias_mv, memories, call, oscillator_hz=8_192_000):
        self.chip, self.convert, self.bias_mv = chip, convert, bias_mv
        self.memories, self.call, self.oscillator_hz = memories, call, oscillator_hz
        self.has_crystal = True
        self.t_s, self.faults, self.masked_until_s = 0.0, [], 0.0
        self.regs: dict[int, int] = {RCC: 0x500, RCC + 8: 1, FLASH_ACR: 0x600, ADC1 + 8: 1 << 29}
        self.places: dict[int, object] = {}
        self.incoming: deque[int] = deque()
        self.sent = bytearray()
        self.samples = 0
        self.ready_ticks: list[int] = []  # of each sample, by the timer
        self._running = [256]  # priorities of what runs: the loop's is beyond all
        self._waited_from_s = None
        self._counter_from = 0.0
        self._flags = 0  # of DMA1
        self._next_sample_s = self._next_in_s = self._next_out_s = float("inf")
        self._frame_done_s = float("inf")
        self._captured = False
        self._received: deque[int] = deque()
        self._adc_s = float("inf")
        self._clock, self._mv, self._ring, self._gone = None, 0.0, 0, 0
        self._to_chip, self._said = bytearray(), b""
        self._readers = {
            CYCCNT: lambda: int(self.t_s * self.system_hz()) & 0xFFFFFFFF,
            TIM2 + 0x24: self.counter,
            TIM2 + 0x38: self._captured_at,
            SPI1 + 0x08: lambda: 2 | bool(self._received),
            SPI1 + 0x0C: lambda: self._received.popleft() if self._received else 0,
            ADC1: lambda: self.regs.get(ADC1, 0) | 4 * (self.t_s >= self._adc_s),
            ADC1 + 0x40: self._bias_counts,
            RNG + 4: self._rng_runs,
            RNG + 8: lambda: 0x5EED * self._rng_runs(),
            GPIO["B"] + 0x10: self._lines,
        }

    # -- what the processor does ------------------------------------------------------------------

    def read(self, address):
        self._pass(address)
        self._check_clock(address)
        reader = self._readers.get(address)
        return self.regs.get(address, 0) if reader is None else reader()

    def _captured_at(self):
        self._captured = False  # reading takes the flag away
        return self.regs.get(TIM2 + 0x38, 0)

    def _bias_counts(self):
        self._adc_s = float("inf")
        return min(int(self._mv / 36_300 * 4096), 4095)

    def _rng_runs(self):
        return bool(self.regs.get(RNG, 0) & 4 and self.regs.get(RCC + 0x98, 0) & 1)

    def write(self, address, value):
        self._pass(address)
        self._check_clock(address)
        if address == RCC + 8:
            value = value & ~12 | (value & 3) << 2  # SWS follows SW
        if address == RCC:
            ready = 0 if not self.has_crystal else (value & 1 << 16) << 1
            value = value & ~(1 << 17 | 1 << 25) | ready | (value & 1 << 24) << 1
        if address == RCC + 0x98:
            value |= (value & 1) << 1
        old = self.regs.get(address, 0)
        if address == DMA1 + 4:
            self._flags &= ~value
            return
        self.regs[address] = value
        if address == RCC + 8:
            self._check_speed()
        port = next((p for p, base in GPIO.items() if address == base + 0x18), None)
        if port is not None:
            self._set_pins(port, value)
        elif address == SPI1 + 0x0C:
            self._byte_to_chip(value & 0xFF)
        elif DMA1 + 8 <= address < DMA1 + 8 + 20 * 4 and (address - DMA1 - 8) % 20 == 0:
            self._dma(1 + (address - DMA1 - 8) // 20, old, value)
        elif address == ADC1 + 8:
            self._adc(old, value)
        elif address == NVIC_ISER:
            self.regs[address] = old | value

    def receive(self, data):
        """Bytes begin to come on the UART's line."""
        self.incoming.extend(data)
        self._next_in_s = max(self.t_s, min(self._next_in_s, self.t_s + self._byte_s()))

    def place(self, key, memory):
        """The address of memory, as DMA is told it."""
        handle = 0x20000000 + 4 * len(self.places)
        found = next((h for h, (k, _) in self.places.items() if k == key), handle)
        self.places[found] = (key, memory)
        return found

    # -- time -------------------------------------------------------------------------------------

    def system_hz(self):
        """Frequency of the processor, by the registers of the clocks."""
        cfgr, pll = self.regs[RCC + 8], self.regs.get(RCC + 0x0C, 0)
        half = 2 if cfgr >> 4 & 15 == 8 else 1
        if cfgr & 3 != 3:
            return HSI_HZ / half
        source = {2: HSI_HZ, 3: HSE_HZ}[pll & 3]
        vco = source / ((pll >> 4 & 15) + 1) * (pll >> 8 & 127)
        return vco / (2 * (1 + (pll >> 25 & 3))) / half

    def counter(self):
        """TIM2's counter, by its external clock or its own."""
        if not self.regs.get(TIM2, 0) & 1:
            return 0
        smcr = self.regs.get(TIM2 + 8, 0)
        if smcr & 1 << 14:
            hz = self.oscillator_hz / (1 << (smcr >> 12 & 3)) if self._is(CLOCK_PIN) else 0
        else:
            hz = self.system_hz() / (self.regs.get(TIM2 + 0x28, 0) + 1)
        return int(self.t_s * hz) & 0xFFFFFFFF

    def _pass(self, address):
        in_loop = self._running[-1] == 256
        step_s = IN_LOOP_S if in_loop else IN_INTERRUPT_S
        if address == CYCCNT:
            if self._waited_from_s is None:
                self._waited_from_s = self.t_s
            step_s = max(IN_INTERRUPT_S, (self.t_s - self._waited_from_s) / 20)
        elif address not in POLLED:
            self._waited_from_s = None
        end_s = self.t_s + step_s
        while True:
            due_s = min(self._next_sample_s, self._next_in_s, self._next_out_s, self._frame_done_s)
            if due_s > end_s:
                break
            self.t_s = max(self.t_s, due_s)
            self._happen(due_s)
            self._interrupt()
        self.t_s = max(self.t_s, end_s)
        self._interrupt()

    def _happen(self, due_s):
        if due_s == self._frame_done_s:
            self._frame_done_s = float("inf")
            self._finish_frame()
        elif due_s == self._next_sample_s:
            self._sample()
        elif due_s == self._next_in_s:
            self._byte_in()
        else:
            self._byte_out()

    def _interrupt(self):
        captured = self._captured and self.regs.get(TIM2 + 0x0C, 0) & CAPTURED
        if not (self._flags or captured) or self.t_s < self.masked_until_s:
            return
        wanted = {
            11: self._flags & 0x2 and self._dma_on(1) & 2,
            28: captured,
            13: self._flags & 0x200 and self._dma_on(3) & 2,
            14: self._flags & 0x2000 and self._dma_on(4) & 2,
        }
        for line, is_due in wanted.items():
            priority = self.regs.get(NVIC_IPR + line, 0)
            enabled = self.regs.get(NVIC_ISER, 0) >> line & 1
            if is_due and enabled and priority < self._running[-1]:
                self._running.append(priority)
                self.call(line)
                self._running.pop()

    # -- pins, clocks -----------------------------------------------------------------------------

    def _is(self, wanted):
        port, number, function = wanted
        base = GPIO[port]
        mode = self.regs.get(base, 0) >> 2 * number & 3
        chosen = self.regs.get(base + 0x20 + 4 * (number // 8), 0) >> 4 * (number % 8) & 15
        return mode == 2 and chosen == function

    def _need(self, what, *pins):
        for wanted in pins:
            if not self._is(wanted):
                self.faults.append(f"{what}: P{wanted[0]}{wanted[1]} is not its pin")

    def _check_clock(self, address):
        clock = clock_of(address)
        if clock is not None and not self.regs.get(clock[0], 0) >> clock[1] & 1:
            self.faults.append(f"{address:#x} is used without its clock")

    def _check_speed(self):
        hz, states = self.system_hz(), self.regs[FLASH_ACR] & 15
        if hz > 30e6 * (states + 1) or hz > 150e6:
            self.faults.append(f"{hz:.4g} Hz with {states} wait states in range 1")
        pll = self.regs.get(RCC + 0x0C, 0)
        if self.regs[RCC + 8] & 3 == 3:
            into = {2: HSI_HZ, 3: HSE_HZ}[pll & 3] / ((pll >> 4 & 15) + 1)
            if not (2.66e6 <= into <= 16e6 and 96e6 <= into * (pll >> 8 & 127) <= 344e6):
                self.faults.append("the PLL is out of its range")

    def _set_pins(self, port, value):
        old = self.regs.get(GPIO[port] + 0x14, 0)
        new = (old | value & 0xFFFF) & ~(value >> 16 & ~value)
        self.regs[GPIO[port] + 0x14] = new & 0xFFFF
        if port == "B":
            for channel, memory in self.memories.items():
                bit = 1 << 10 + channel
                supply_on = self.regs.get(GPIO["C"] + 0x14, 0) >> 6 + channel & 1
                if (old ^ new) & bit and not supply_on:
                    (memory.up if new & bit else memory.down)(self.t_s * 1e6)
            if (old ^ new) & 1 << 6:
                self._selected(not new & 1 << 6)

    def _lines(self):
        up = 0xFFFF & self.regs.get(GPIO["B"] + 0x14, 0)
        for channel, memory in self.memories.items():
            if memory.holds(self.t_s * 1e6):
                up &= ~(1 << 10 + channel)
        return up

    def supply_on(self, channel):
        """Whether a sensor's supply is switched on."""
        return bool(self.regs.get(GPIO["C"] + 0x14, 0) >> 6 + channel & 1)

    # -- converter --------------------------------------------------------------------------------

    def _selected(self, selected):
        if selected:
            self._to_chip, self._received = bytearray(), deque()
            control = self.regs.get(SPI1, 0)
            if control & 0x47 != 0x45 or self.system_hz() / (2 << (control >> 3 & 7)) > 25e6:
                self.faults.append("SPI1 is not a master of mode 1 at 25 MHz or less")
            self._need("SPI1", ("A", 5, 5), ("A", 6, 5), ("A", 7, 5))
        elif len(self._to_chip) == FRAME:
            self.chip.shift_in(bytes(self._to_chip))
            self._rate_anew()

    def _byte_to_chip(self, byte):
        """The chip shifts out while it is shifted into: it says what it knew at the first bit."""
        if not self._to_chip:
            self._said = self.chip.shift_out()
        self._received.append(self._said[len(self._to_chip)])
        self._to_chip.append(byte)

    def _rate_anew(self):
        mode, clock = self.chip.registers[MODE], self.chip.registers[CLOCK]
        if mode & 0x0400 or not self.oscillator_hz or self.chip.dead:
            self._next_sample_s = float("inf")
            return
        self.period_s = 2 * (128 << (clock >> 2 & 7)) / self.oscillator_hz
        if self._next_sample_s == float("inf") or self._clock != clock:
            self._next_sample_s = self.t_s + 3 * self.period_s
        self._clock = clock

    def _sample(self):
        self._next_sample_s += self.period_s
        self.chip.sample(*self.convert(self.samples))
        self.samples += 1
        self.ready_ticks.append(self.counter())
        if self._is(DATA_READY_PIN) and self.regs.get(TIM2 + 0x20, 0) & 0x30 == 0x30:
            self.regs[TIM2 + 0x38] = self.counter()
            self._captured = True

    # -- DMA --------------------------------------------------------------------------------------

    def _dma_on(self, channel):
        return self.regs.get(DMA1 + 8 + 20 * (channel - 1), 0)

    def _channel(self, channel):
        base = DMA1 + 8 + 20 * (channel - 1)
        _, memory = self.places[self.regs[base + 12]]
        return base, memory

    def _dma(self, channel, old, value):
        if old & 1 or not value & 1:
            return
        request = self.regs.get(DMAMUX + 4 * (channel - 1), 0)
        base = DMA1 + 8 + 20 * (channel - 1)
        n = self.regs.get(base + 4, 0)
        wanted = {
            1: (10, SPI1 + 12),
            2: (11, SPI1 + 12),
            3: (34, UART + 0x24),
            4: (35, UART + 0x28),
        }
        if (request, self.regs.get(base + 8)) != wanted[channel] or not n or not value & 0x80:
            self.faults.append(f"DMA channel {channel} is not set up: {request}, {n}, {value:#x}")
        if channel == 2 and self._dma_on(1) & 1 and self.regs.get(SPI1 + 4, 0) & 3 == 3:
            control = self.regs.get(SPI1, 0)
            self._said = self.chip.shift_out()
            self._frame_done_s = self.t_s + 8 * n * (2 << (control >> 3 & 7)) / self.system_hz()
        elif channel == 3:
            self._ring = n
        elif channel == 4:
            self._gone = 0
            self._next_out_s = self.t_s + self._byte_s()

    def _finish_frame(self):
        _, out = self._channel(2)
        _, into = self._channel(1)
        n = self.regs[DMA1 + 8 + 4]
        self._to_chip = bytearray(bytes(out[0:n]))
        into[0:n] = self._said
        self.regs[DMA1 + 8 + 4] = 0
        self._flags |= 0x3

    def _byte_s(self):
        baud = 256 * self.system_hz() / self.regs[UART + 0x0C]
        if abs(baud / 921_600 - 1) > 0.02 or self.regs.get(UART, 0) & 0xD != 0xD:
            self.faults.append(f"LPUART1 is not on at 921600 baud: {baud:.6g}")
        self._need("LPUART1", ("A", 2, 12), ("A", 3, 12))
        return 10 / baud

    def _byte_in(self):
        base, memory = self._channel(3)
        left = self.regs[base + 4]
        memory[self._ring - left] = self.incoming.popleft()
        left -= 1
        if left == 0:
            left = self._ring
            self._flags |= 0x300
        self.regs[base + 4] = left
        self._next_in_s = self.t_s + self._byte_s() if self.incoming else float("inf")

    def _byte_out(self):
        base, memory = self._channel(4)
        self.sent.append(memory[self._gone])
        self._gone += 1
        self.regs[base + 4] -= 1
        self._next_out_s = self.t_s + self._byte_s()
        if self.regs[base + 4] == 0:
            self._next_out_s = float("inf")
            self._flags |= 0x3000

    # -- the slow converter -----------------------------------------------------------------------

    def _adc(self, old, value):
        if value & 1 << 28 and old & 1 << 29:
            self.faults.append("the ADC's regulator is switched on in deep sleep")
        if value & 1 << 31:
            self.regs[ADC1 + 8] = value & ~(1 << 31)
        if value & 1 and value & 1 << 28:
            self.regs[ADC1] = 1
        if value & 4:
            if not (self.regs.get(ADC1, 0) & 1 and self.regs.get(ADC12_CCR, 0) >> 16 & 3):
                self.faults.append("the ADC is started before it is on")
            channel = (self.regs.get(ADC1 + 0x30, 0) >> 6 & 31) - 6
            if self.regs.get(GPIO["C"], 0) >> 2 * channel & 3 != 3:
                self.faults.append(f"PC{channel} is not analog")
            self._mv = self.bias_mv(channel, self.t_s) if self.supply_on(channel) else 0.0
            self._adc_s = self.t_s + 653 / 37.5e6
            self.regs[ADC1 + 8] = value & ~4
