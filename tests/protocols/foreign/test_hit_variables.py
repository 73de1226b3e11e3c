"""Time records in plain arrays: what the names of their columns tell."""

import numpy as np
import pytest
from support.manifests import RATE, hit_signals, manifest, posture, run

from armodal.protocols.errors import ForeignFileError


def write_csv(path, time, factor):
    t, force, responses = hit_signals()
    names = [time, "force [N]", "acc [m/s^2]"]
    table = np.vstack([t * factor, force, responses]).T
    np.savetxt(path, table, delimiter=",", header=",".join(names), comments="")


@pytest.mark.parametrize(
    ("name", "factor"),
    [
        ("time", 1.0),
        ("t", 1.0),
        ("time [s]", 1.0),
        ("Time (sec)", 1.0),
        ("time_s", 1.0),
        ("time [ms]", 1e3),
        ("t (ms)", 1e3),
        ("time_ms", 1e3),
        ("t_ms", 1e3),
        ("time [µs]", 1e6),
        ("time_us", 1e6),
    ],
)
def test_the_name_of_the_time_column_tells_its_unit(tmp_path, name, factor):
    write_csv(tmp_path / "h.csv", name, factor)
    session = run(manifest(tmp_path, posture('["h.csv"]')))
    assert session.header.plan.sampling.rate_hz == RATE
    assert not any("units are not told" in text for text in session.warnings)


def test_names_in_an_npz_tell_the_unit_of_time_too(tmp_path):
    t, force, responses = hit_signals()
    np.savez(tmp_path / "h.npz", time_ms=1e3 * t, force_n=force, x_m_s2=responses[0])
    session = run(manifest(tmp_path, posture('["h.npz"]')))
    assert session.header.plan.sampling.rate_hz == RATE


@pytest.mark.parametrize("name", ["time [min]", "time_h", "time [samples]", "timestamp"])
def test_another_unit_of_time_is_refused(tmp_path, name):
    write_csv(tmp_path / "h.csv", name, 1.0)
    with pytest.raises(ForeignFileError, match="wanted a time in s, ms or us") as caught:
        run(manifest(tmp_path, posture('["h.csv"]')))
    assert repr(name) in str(caught.value)
    assert "\n" not in str(caught.value)
