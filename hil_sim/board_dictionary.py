"""The board's self-description, from what the plant file says of its inputs and sensors."""

from __future__ import annotations

import zlib

from armodal.hil_sim.board_id import BOARD_ID
from armodal.hil_sim.plant_file import PlantFile
from armodal.protocols.board.records import BoardDictionary, Channel, IepeState

__all__ = ["board_dictionary"]

FIRMWARE = "sim-1.0"
HALF_RANGE_COUNTS = 1 << 23
LINK_BYTES_PER_S = 1_000_000
BLOCK_CAPACITY = 512 * 1024


def board_dictionary(truth: PlantFile, *, tick_hz: int = 1_000_000) -> BoardDictionary:
    """Describe hammer and accelerometer as they are certified, not as they truly are."""
    hammer, sensor, inputs = truth.hammer, truth.accelerometer, truth.board
    channels = [
        Channel(
            name="hammer",
            quantity="force",
            unit="N",
            scale=inputs.range_v / HALF_RANGE_COUNTS / hammer.sensitivity_v_per_n,
            full_scale=inputs.range_v / hammer.sensitivity_v_per_n,
            iepe=IepeState.OK,
            highpass_hz=hammer.highpass_hz,
            serial_number=hammer.serial_number,
            calibration_date=hammer.calibration_date,
            teds=_basic_teds(hammer.serial_number),
        )
    ]
    channels += [
        Channel(
            name=f"acc_{axis}",
            quantity="acceleration",
            unit="m/s^2",
            scale=inputs.range_v / HALF_RANGE_COUNTS / sensor.sensitivity_v_per_m_s2,
            full_scale=inputs.range_v / sensor.sensitivity_v_per_m_s2,
            iepe=IepeState.OK,
            highpass_hz=sensor.highpass_hz,
            serial_number=sensor.serial_number,
            calibration_date=sensor.calibration_date,
            teds=_basic_teds(sensor.serial_number),
        )
        for axis in "xyz"
    ]
    return BoardDictionary(
        board_id=BOARD_ID,
        firmware=FIRMWARE,
        link_bytes_per_s=LINK_BYTES_PER_S,
        block_capacity=BLOCK_CAPACITY,
        tick_hz=tick_hz,
        filter_group_delay_samples=float(inputs.filter_delay_samples),
        channels=tuple(channels),
    )


def _basic_teds(serial_number: str) -> bytes:
    """Basic TEDS of IEEE 1451.4: 64 bits, the serial number in the last 24, no maker's number.

    Letters do not fit in 24 bits, so a checksum of the serial number stands for it.
    """
    number = zlib.crc32(serial_number.encode()) & 0xFF_FFFF
    return (number << 40).to_bytes(8, "little")
