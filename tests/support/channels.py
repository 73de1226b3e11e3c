"""A channel of a board as any: a hammer or an accelerometer."""

from __future__ import annotations

from armodal.protocols.board.records import Channel, IepeState

__all__ = ["channel"]


def channel(name: str, quantity: str, scale: float, highpass_hz: float = 0.5) -> Channel:
    return Channel(
        name=name,
        quantity=quantity,
        unit="N" if quantity == "force" else "m/s^2",
        scale=scale,
        full_scale=scale * 8388607,
        iepe=IepeState.OK,
        highpass_hz=highpass_hz,
        serial_number="1",
        calibration_date="2026-01-31",
        teds=b"",
    )
