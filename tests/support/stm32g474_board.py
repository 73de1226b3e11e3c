"""The board with an STM32G474RE, compiled for this machine, on the model of its chip.

Its program, `main` of ports/board.c, runs in a thread of its own, as far as it is given virtual
time: that of the clock of its host, which passes while the host waits.
"""

from __future__ import annotations

import shutil
import subprocess
import threading
from pathlib import Path

from cffi import FFI
from support.ads131m04_model import Ads131m04
from support.stm32g474_model import Stm32g474
from support.virtual_board import VirtualClock
from support.virtual_lab import BOARD_FD, LINE_HOLDS, MemoryLine

from armodal.protocols.c.build import HERE, INCLUDE, SOURCES, STRICT, compilers
from armodal.protocols.c.firmware import options

PORTS = HERE / "ports"
SHIM = Path(__file__).with_name("stm32g474_host.c")
DECLARED = """
extern uint32_t (*host_read)(uint32_t address);
extern void (*host_write)(uint32_t address, uint32_t value);
extern uint32_t (*host_place)(const void *memory);
extern void (*host_halt)(void);
int board_main(void);
void on_tim2(void);
void on_dma_converter(void);
void on_dma_link_in(void);
void on_dma_link_out(void);
"""
HANDLERS = {11: "on_dma_converter", 13: "on_dma_link_in", 14: "on_dma_link_out", 28: "on_tim2"}
OK_MV = 11_000.0
BOOT_S = 3.3  # data sheets, and three seconds for the supplies


def compiled(folder: Path) -> Path | None:
    """The board as a shared library; None where there is no compiler."""
    compiler = next(compilers(), None)
    if compiler is None:
        return None
    library = folder / "board.so"
    files = [*SOURCES, *(PORTS / f"{n}.c" for n in ("board", "ads131m04", "dma_link", "teds_wire"))]
    files += [p for p in sorted((PORTS / "stm32g474").glob("*.c")) if p.name != "startup.c"]
    command = [*compiler, *STRICT, *options("stm32g474"), "-DBSP_ON_HOST=1", "-Dmain=board_main"]
    command += ["-O1", "-shared", "-fPIC", f"-I{INCLUDE}", f"-I{PORTS}", str(SHIM)]
    subprocess.run([*command, *map(str, files), "-o", str(library)], check=True)
    return library


class Stm32Board:
    """A board that is switched on; time passes in `run` alone."""

    def __init__(self, library: Path, **model):
        own = library.with_name(f"board-{id(self)}.so")  # its variables are this board's alone
        shutil.copy(library, own)
        ffi = FFI()
        ffi.cdef(DECLARED)
        self._c = ffi.dlopen(str(own))
        own.unlink()
        self._until_s = 0.0
        self._may_run, self._is_parked = threading.Event(), threading.Event()
        self.halted = False
        described = {
            "convert": lambda i: (0, 0, 0, 0),
            "bias_mv": lambda channel, t_s: OK_MV,
            "memories": {},
        }
        chip = model.pop("chip", None) or Ads131m04()
        crystal = model.pop("crystal", True)
        self.model = Stm32g474(chip, call=self._call, **(described | model))
        self.model.has_crystal = crystal

        def read(address):
            self._park()
            return self.model.read(address)

        def place(memory):
            key = int(ffi.cast("uintptr_t", memory))
            return self.model.place(key, memoryview(ffi.buffer(memory, 8192)).cast("B"))

        def halt(*_what):
            self.halted = True
            self._is_parked.set()
            threading.Event().wait()

        def broken(_kind, error, _where):
            self.model.faults.append(repr(error))
            halt()

        self._keep = [
            ffi.callback("uint32_t(uint32_t)", read, onerror=broken),
            ffi.callback("void(uint32_t, uint32_t)", self.model.write, onerror=broken),
            ffi.callback("uint32_t(const void *)", place, onerror=broken),
            ffi.callback("void(void)", halt),
        ]
        self._c.host_read, self._c.host_write, self._c.host_place, self._c.host_halt = self._keep
        threading.Thread(target=self._c.board_main, daemon=True).start()
        self.clock = VirtualClock()
        self.line = MemoryLine("board", BOARD_FD)
        self.clock.line, self.clock.step = self.line, self._step
        self._began_s = self.clock.now_s() - BOOT_S
        self.run(BOOT_S)

    def run(self, until_s: float) -> None:
        """Let virtual time pass, up to so many seconds after power came."""
        self._until_s = until_s
        self._is_parked.clear()
        self._may_run.set()
        self._is_parked.wait()

    def open(self):
        """The host's end of the UART's line."""
        return self.line.host()

    def _step(self):
        """Go on with the clock. What the host's buffer has no room for is lost: no flow control."""
        came = self.line.read()
        if came:
            self.model.receive(came)
        self.run(self.clock.now_s() - self._began_s)
        self.line.flush()
        self.line.queue(bytes(self.model.sent[: LINE_HOLDS - len(self.line.to_host)]))
        self.model.sent.clear()
        self.line.flush()

    def _park(self):
        while self.model.t_s >= self._until_s:
            self._may_run.clear()
            self._is_parked.set()
            self._may_run.wait()

    def _call(self, line):
        getattr(self._c, HANDLERS[line])()
