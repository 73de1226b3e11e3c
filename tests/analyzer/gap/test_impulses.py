"""What moves a joint: the force over time of a hit."""

from dataclasses import replace

import numpy as np
import pytest

from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.gap.model.impulses import IMPULSE_OF_SINE, impulse_n_s
from armodal.analyzer.gap.model.lines import Annealing, own_lines
from armodal.analyzer.modal.spectra import active_channels

LENGTH = 24  # samples of a pulse


def with_pulse(session, shape, peak_n=50.0, offset_n=0.0, lead=200, polarity=1):
    """The session's first hit with another pulse, judged as one of that peak and width."""
    force, _, columns = active_channels(session)
    rate = float(session.header.plan.sampling.rate_hz)
    hit = session.hits[0]
    begin = int(hit.trigger_sample - hit.first_sample)
    pushes = np.zeros(len(hit.counts))
    pushes[begin : begin + LENGTH] = shape(np.arange(LENGTH) / LENGTH)
    counts = hit.counts.copy()
    told = polarity * (peak_n * pushes + offset_n) / force.scale
    counts[:, columns[0]] = np.round(told).astype(np.int64)
    cut = max(begin - lead, 0)
    width_s = float(np.sum(pushes > 0.5)) / rate
    verdict = replace(hit.verdict, peak_n=peak_n, width_s=width_s, polarity=polarity)
    return replace(
        hit, counts=counts[cut:], first_sample=hit.first_sample + cut, verdict=verdict
    ), peak_n * float(np.sum(pushes)) / rate


@pytest.mark.parametrize(
    "shape",
    [
        pytest.param(lambda x: np.sin(np.pi * x), id="half sine"),
        pytest.param(lambda x: np.sin(np.pi * x) ** 2, id="haversine"),
        pytest.param(lambda x: np.minimum(4.0 * x, (1.0 - x) / 0.75), id="leaning"),
    ],
)
@pytest.mark.parametrize("polarity", [1, -1])
def test_a_pulse_of_any_shape_has_its_own_impulse(session, shape, polarity):
    hit, expected = with_pulse(session, shape, offset_n=2.0, polarity=polarity)
    # A count is rounding: beside it nothing is lost.
    assert impulse_n_s(session, hit) == pytest.approx(expected, rel=1e-3)


def test_a_record_that_begins_within_the_pulse_tells_by_peak_and_width(session):
    hit, _ = with_pulse(session, lambda x: np.sin(np.pi * x), lead=-6)
    expected = IMPULSE_OF_SINE * hit.verdict.peak_n * hit.verdict.width_s
    assert impulse_n_s(session, hit) == expected


def test_every_mounting_has_the_impulse_of_its_own_hits(session):
    """One place is hit, once and again for each point where the accelerometer stands."""
    stage = Annealing(sigma_rad_s=2 * np.pi * 6.0, step_hz=8.0, band_hz=(8.0, 60.0))
    superset = Superset(session.header.arm)
    posture = own_lines(superset, session, stage)[0]
    ids = [point.id for point in superset.arm.points]
    assert len(posture.hit_point) == 1
    assert posture.width_s > 0.0
    for sensor, peak_n in zip(posture.sensor_point, posture.peaks_n, strict=True):
        hits = [h for h in session.accepted(posture.name) if h.sensor_point == ids[sensor]]
        own = np.array([impulse_n_s(session, hit) for hit in hits])
        found = IMPULSE_OF_SINE * peak_n * posture.width_s
        assert np.log(found) == pytest.approx(np.sum(own**2 * np.log(own)) / np.sum(own**2))
        # What a law of 1 / F and one of F leave in an average by power: they lie about it.
        low, high = np.sum(own**2) / np.sum(own), np.sum(own**3) / np.sum(own**2)
        assert low * (1.0 - 1e-9) <= found <= high * (1.0 + 1e-9)
    assert np.ptp(np.log(posture.peaks_n)) > 0.1  # a hand is never the same
