"""The lines that `armodal review` fits where nobody asked for a band."""

from dataclasses import replace

import numpy as np
from support.plain_structure import FREQ, plate_session

from armodal.tui.screens.review.posture_view import opened_session

SIGNAL_TO_HZ = 120.0


def with_noise_above(session):
    """The FRFs with nothing but noise on the lines above, as where the hammer excites nothing."""
    frf = session.frfs[0]
    rng = np.random.default_rng(0)
    noise = rng.normal(size=(2, *frf.values.shape)) * np.sqrt(np.mean(np.abs(frf.values) ** 2))
    values = np.where(frf.freq_hz > SIGNAL_TO_HZ, noise[0] + 1j * noise[1], frf.values)
    told = np.zeros(values.shape)
    return replace(session, frfs=(replace(frf, values=values, variance=told),))


def test_lines_of_noise_are_left_out_and_it_is_said(tmp_path):
    session = with_noise_above(plate_session(tmp_path))
    view = opened_session(tmp_path / "plate.h5", session).views[0]
    assert SIGNAL_TO_HZ - 5.0 < view.frf.freq_hz[-1] < SIGNAL_TO_HZ + 15.0
    (said,) = view.said
    assert "no band was asked for" in said


def test_a_band_asked_for_is_taken_as_it_is(tmp_path):
    session = with_noise_above(plate_session(tmp_path))
    band = (10.0, float(FREQ[-1]))
    view = opened_session(tmp_path / "plate.h5", session, band_hz=band).views[0]
    assert (view.frf.freq_hz[0], view.frf.freq_hz[-1]) == band
    assert view.said == ()
