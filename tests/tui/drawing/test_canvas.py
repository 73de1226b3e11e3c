import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from armodal.tui.drawing import Canvas


def test_each_pixel_of_a_cell_is_its_own_dot():
    seen = set()
    for x in range(2):
        for y in range(4):
            canvas = Canvas(1, 1)
            canvas.dots([[x, y]])
            seen.add(ord(canvas.plain()[0]) - 0x2800)
    assert seen == {1 << bit for bit in range(8)}


def test_a_horizontal_line_fills_every_pixel_between_its_ends():
    canvas = Canvas(3, 1)
    canvas.polyline([[0, 0], [5, 0]])
    assert canvas.plain() == ["⠉⠉⠉"]


def test_what_lies_outside_is_clipped_and_what_is_not_finite_left_out():
    canvas = Canvas(3, 1)
    canvas.segments(
        [[-1e9, 0.0], [0.0, -50.0], [np.nan, 1.0]], [[1e9, 0.0], [5.0, -50.0], [2.0, 2.0]]
    )
    assert canvas.plain() == ["⠉⠉⠉"]


def test_a_label_lies_above_the_dots_and_is_clipped():
    canvas = Canvas(4, 1)
    canvas.label(2, 0, "name", "bold")
    canvas.polyline([[0, 3], [7, 3]])
    assert canvas.plain() == ["⣀⣀na"]


def test_what_is_drawn_last_takes_the_cell():
    canvas = Canvas(2, 1)
    canvas.dots([[0, 0]], "red")
    canvas.dots([[1, 0]], "bold")
    (strip,) = canvas.strips()
    first = next(iter(strip))
    assert first.text == "⠈"
    assert first.style is not None
    assert first.style.bold


def test_text_and_strips_show_the_same():
    canvas = Canvas(7, 3)
    canvas.polyline([[0, 0], [13, 11]], "red")
    canvas.label(1, 1, "ab", "bold")
    assert canvas.text().plain.split("\n") == canvas.plain()
    assert [strip.text for strip in canvas.strips()] == canvas.plain()


coordinate = st.floats(allow_nan=True, allow_infinity=True, width=32)


@given(st.lists(st.tuples(coordinate, coordinate), max_size=8), st.integers(-3, 6))
def test_any_polyline_can_be_drawn_on_any_canvas(points, size):
    canvas = Canvas(size, size)
    canvas.polyline(np.array(points).reshape(-1, 2))
    assert {len(row) for row in canvas.plain()} == {max(size, 1)}
