"""A device of openDAQ whose signals are ours, by native streaming: a program.

    python opendaq_server.py VOLTS.npy RATE_HZ

plays (n, channels) volts again and again as signals AI0, AI1, ... with one clock, a tick a sample.
It prints its port. A number on its standard input is how many samples it leaves out there and then,
which its clock alone tells; it ends when its input does.
"""

from __future__ import annotations

import select
import socket
import sys
import time

import numpy as np
import opendaq

EVERY_S = 0.01


def described(name: str, rule: object, sample_type: object) -> object:
    """A builder of what a signal's samples are."""
    builder = opendaq.DataDescriptorBuilder()
    builder.name, builder.rule, builder.sample_type = name, rule, sample_type
    return builder


def main(volts: np.ndarray, rate_hz: int) -> None:
    instance = opendaq.Instance()
    folder = instance.get_item("Sig")
    clock = described("time", opendaq.LinearDataRule(1, 0), opendaq.SampleType.Int64)
    clock.unit = opendaq.Unit(-1, "s", "seconds", "time")
    clock.tick_resolution = opendaq.Ratio(1, rate_hz)
    clock.origin = "1970-01-01T00:00:00Z"
    time_descriptor = clock.build()
    domain = opendaq.SignalWithDescriptor(instance.context, time_descriptor, folder, "clock", None)
    opendaq.IFolderConfig.cast_from(folder).add_item(domain)
    signals = []
    for i in range(volts.shape[1]):
        value = described(f"AI{i}", opendaq.ExplicitDataRule(), opendaq.SampleType.Float64)
        value.unit = opendaq.Unit(-1, "V", "volts", "voltage")
        descriptor = value.build()
        signal = opendaq.SignalWithDescriptor(instance.context, descriptor, folder, f"AI{i}", None)
        signal.domain_signal = domain
        opendaq.IFolderConfig.cast_from(folder).add_item(signal)
        signals.append((signal, descriptor))
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    config = opendaq.PropertyObject()
    number = opendaq.Integer(port)
    config.add_property(
        opendaq.IntProperty(opendaq.String("NativeStreamingPort"), number, opendaq.Boolean(True))
    )
    instance.add_server("OpenDAQNativeStreaming", config)
    sys.stdout.write(f"{port}\n")
    sys.stdout.flush()

    def send(first: int, end: int) -> None:
        rows = volts[np.arange(first, end) % len(volts)]
        ticks = opendaq.DataPacket(time_descriptor, end - first, first)
        domain.send_packet(ticks)
        for i, (signal, descriptor) in enumerate(signals):
            packet = opendaq.DataPacketWithDomain(ticks, descriptor, end - first, 0)
            np.frombuffer(memoryview(packet.raw_data))[:] = rows[:, i]
            signal.send_packet(packet)

    begun_s, sent, told = time.monotonic(), 0, "0"
    while told:
        due = int((time.monotonic() - begun_s) * rate_hz)
        if sent < due:
            send(sent, due)
            sent = due
        asked = select.select([sys.stdin], [], [], EVERY_S)[0]
        told = sys.stdin.readline() if asked else "0"
        sent += int(told or 0)


if __name__ == "__main__":
    main(np.load(sys.argv[1]), int(sys.argv[2]))
