"""Sound files of known samples, 24 bits, and the front-end file beside them."""

import wave

import numpy as np

FRONT_END = """
format = "armodal-front-end-1"
device = "replay"
source = "{file}"
filter_group_delay_samples = 0.0

[[channels]]
name = "hammer"
quantity = "force"
input = 1
full_scale = 838.8607
serial_number = "H-1"
calibration_date = "2026-03-02"

[[channels]]
name = "acc_x"
quantity = "acceleration"
input = 2
full_scale = 83.88607

[[channels]]
name = "acc_y"
quantity = "acceleration"
input = 3
full_scale = 83.88607

[[channels]]
name = "acc_z"
quantity = "acceleration"
input = 4
full_scale = -83.88607
"""


def write_wav(path, counts, rate_hz):
    """(n, n_channels) counts of 24 bits, as they are."""
    four = np.ascontiguousarray(counts, dtype="<i4").view(np.uint8).reshape(*counts.shape, 4)
    with wave.open(str(path), "wb") as file:
        file.setnchannels(counts.shape[1])
        file.setsampwidth(3)
        file.setframerate(rate_hz)
        file.writeframes(four[:, :, :3].tobytes())


def write_replay(folder, counts, rate_hz=1652):
    """Return the path of a front-end file that replays counts."""
    write_wav(folder / "hits.wav", counts, rate_hz)
    path = folder / "replay.toml"
    path.write_text(FRONT_END.format(file="hits.wav"), encoding="utf-8")
    return path
