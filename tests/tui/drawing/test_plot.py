import numpy as np
import pytest

from armodal.tui.drawing import (
    Cursor,
    Scale,
    Series,
    envelope,
    linear_scale,
    log_scale,
    plot,
    plot_frame,
)


def test_one_sample_among_many_thousand_is_not_hidden():
    t = np.linspace(0.0, 1.0, 50_000)
    y = np.zeros_like(t)
    y[31_234] = 1.0
    picture = plot(60, 12, [Series(x=t, y=y)], x=linear_scale(t), y=Scale(low=-0.1, high=1.1))
    rows = picture.plain()
    spike = [row for row in rows[1:8] if any(ord(c) >= 0x2800 for c in row)]
    assert len(spike) == 7


def test_the_envelope_is_the_least_and_largest_of_every_bin():
    x, y = np.arange(6.0), np.array([3.0, 1.0, 2.0, np.nan, 7.0, 5.0])
    middle, low, high = envelope(x, y, np.array([0.0, 3.0, 6.0, 9.0]))
    assert middle.tolist() == [1.5, 4.5]
    assert low.tolist() == [1.0, 5.0]
    assert high.tolist() == [3.0, 7.0]


def test_logarithmic_ticks_are_decades():
    assert Scale(low=0.009, high=150.0, log=True).ticks(5) == (0.01, 0.1, 1.0, 10.0, 100.0)


def test_linear_ticks_are_round():
    assert Scale(low=0.0, high=400.0).ticks(8) == (
        0.0,
        50.0,
        100.0,
        150.0,
        200.0,
        250.0,
        300.0,
        350.0,
        400.0,
    )


def test_zero_has_no_place_on_a_logarithmic_axis_and_breaks_the_line():
    scale = log_scale([1.0, 10.0])
    assert np.isnan(scale.share(0.0))
    picture = plot(20, 5, [Series(x=[0, 1, 2], y=[1, 0, 10])], x=Scale(low=0, high=2), y=scale)
    assert picture.rows == 5


@pytest.mark.parametrize("values", [[], [np.nan], [3.0, 3.0], [0.0]])
def test_scales_of_nothing_and_of_constants_have_a_span(values):
    for scale in (linear_scale(values), log_scale(values)):
        assert scale.high > scale.low


def test_zooming_keeps_the_value_under_the_cursor_in_place():
    scale = Scale(low=10.0, high=100.0).zoomed(3.0, 40.0)
    assert scale.share(40.0) == pytest.approx((40 - 10) / 90)
    assert scale.high - scale.low == pytest.approx(30.0)


def test_a_cell_of_the_field_tells_its_value():
    x, y = Scale(low=0.0, high=10.0), Scale(low=0.0, high=1.0)
    frame = plot_frame(40, 12, x, y, title="t")
    value = frame.value_at(frame.left + frame.columns - 1, frame.top)
    assert value is not None
    assert value[0] == pytest.approx(10.0, abs=10.0 / frame.columns)
    assert frame.value_at(0, 0) is None


def test_the_title_the_unit_and_the_cursor_are_written():
    picture = plot(
        50, 10, [], x=Scale(low=0, high=9), y=Scale(low=0, high=1), title="FRF", x_name="Hz",
        cursors=[Cursor(x=5.0, name="5.0")],
    )  # fmt: skip
    rows = picture.plain()
    assert "FRF" in rows[0]
    assert "5.0" in rows[1]
    assert rows[-1].endswith("Hz")


@pytest.mark.parametrize("size", [(1, 1), (3, 2), (10, 3)])
def test_a_tiny_plot_is_still_a_plot(size):
    one = Scale(low=0, high=1)
    picture = plot(*size, [Series(x=[0, 1], y=[0, 1])], x=one, y=one, title="long title")
    assert [len(row) for row in picture.plain()] == [size[0]] * size[1]
