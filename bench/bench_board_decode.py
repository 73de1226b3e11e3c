"""Decode pipeline of the board's stream on one core: COBS, CRC-32, sequence, 24-bit unpack.

OPENBLAS_NUM_THREADS=1 .venv/bin/python bench/bench_board_decode.py

Exit code 1 if the median is below 60 MB/s of samples. Wire bytes come in reads of 4095 bytes, the
most a pseudo-terminal returns.
"""

from __future__ import annotations

import statistics
import sys
import time

import numpy as np

from armodal.protocols.board import (
    FrameDecoder,
    FrameType,
    Header,
    Samples,
    SequenceTracker,
    decode_samples,
    encode_frame,
    encode_samples,
)

N_FRAMES, N_SAMPLES, N_CHANNELS, READ = 20_000, 64, 4, 4095
ROUNDS, WANTED_MB_S = 7, 60.0


def wire_bytes() -> bytes:
    """A stream of noise with the amplitude of a measurement at one hundredth of full scale."""
    rng = np.random.default_rng(0)
    frames = []
    for sequence in range(N_FRAMES):
        counts = rng.normal(0.0, 8e4, (N_SAMPLES, N_CHANNELS)).astype(np.int32)
        first = sequence * N_SAMPLES
        header = Header(
            type=FrameType.STREAM, session=1, sequence=sequence, first_sample=first, ticks=first
        )
        frames.append(encode_frame(header, encode_samples(Samples(first_sample=0, counts=counts))))
    return b"".join(frames)


def decode(wire: bytes) -> int:
    """Decode all; return the samples found."""
    decoder, tracker, samples = FrameDecoder(), SequenceTracker(), 0
    for start in range(0, len(wire), READ):
        for frame in decoder.feed(wire[start : start + READ]):
            tracker.check(frame.header)
            samples += len(decode_samples(frame).counts)
    if decoder.bad_frames or tracker.missing:
        raise RuntimeError(f"{decoder.bad_frames} bad, {tracker.missing} missing frames")
    return samples


def main() -> int:
    wire = wire_bytes()
    seconds = []
    for _ in range(ROUNDS):
        start = time.perf_counter()
        samples = decode(wire)
        seconds.append(time.perf_counter() - start)
        assert samples == N_FRAMES * N_SAMPLES
    median = statistics.median(seconds)
    sample_mb_s = N_FRAMES * N_SAMPLES * N_CHANNELS * 3 / median / 1e6
    print(
        f"decode: {sample_mb_s:.0f} MB/s of samples, {len(wire) / median / 1e6:.0f} MB/s on the "
        f"wire, {median / N_FRAMES * 1e6:.1f} us a frame (wanted: {WANTED_MB_S:.0f} MB/s)"
    )
    return 0 if sample_mb_s >= WANTED_MB_S else 1


if __name__ == "__main__":
    sys.exit(main())
