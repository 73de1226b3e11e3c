"""Tables in windows of any width: whole, narrower, or as a list; never a word a line."""

from __future__ import annotations

import io

import pytest
from rich.console import Console
from rich.table import Table

from armodal.tui.fitting_table import FittingTable

NUMBERS = ("20001", "± 15.25", "19986 to 20016")
SENTENCE = "the rate that was asked for, within a hundred ppm of the clock"


def drawn(table, width):
    """Rows of a table printed in a window of some width."""
    console = Console(file=io.StringIO(), width=width, markup=False, highlight=False)
    console.print(FittingTable(table))
    return [row.rstrip() for row in console.file.getvalue().splitlines()]


def numbers(n_columns=3, rows=2):
    table = Table("joint", *(f"quantity {i}" for i in range(n_columns)), title="Joints")
    for row in range(rows):
        table.add_row(f"shoulder_{row}", *(NUMBERS[i % 3] for i in range(n_columns)))
    return table


def test_a_table_that_fits_is_drawn_as_it_is():
    table = numbers()
    console = Console(file=io.StringIO(), width=100, markup=False, highlight=False)
    console.print(table)
    plain = [row.rstrip() for row in console.file.getvalue().splitlines()]
    assert drawn(table, 100) == plain


@pytest.mark.parametrize("n_columns", [3, 6, 12])
@pytest.mark.parametrize("width", [40, 60, 80, 120])
def test_no_cell_is_broken_or_cut_off_at_any_width(n_columns, width):
    rows = drawn(numbers(n_columns), width)
    assert max(map(len, rows)) <= width
    text = "\n".join(rows)
    assert "…" not in text
    for i, number in enumerate(NUMBERS):
        assert text.count(number) == 2 * len(range(i, n_columns, 3))


def test_what_has_no_room_as_a_table_is_a_list_with_every_heading_at_its_cell():
    rows = drawn(numbers(12), 60)
    assert rows[:3] == ["Joints", "shoulder_0", "  quantity 0 20001 · quantity 1 ± 15.25"]
    assert sum("quantity 11 19986 to 20016" in row for row in rows) == 2


def test_a_sentence_is_folded_while_it_keeps_room_for_words():
    table = Table("step", "wanted", "verdict")
    table.add_row("samples", SENTENCE, "passed")
    folded = drawn(table, 60)
    assert any("samples" in row and "passed" in row for row in folded)
    assert " ".join(" ".join(folded).split()).count("the rate that was asked") == 1


def test_a_folded_sentence_never_has_a_word_a_line():
    table = Table("step", "wanted", "came", "and then", "verdict")
    table.add_row("samples", SENTENCE, SENTENCE, SENTENCE, "passed")
    rows = drawn(table, 80)
    assert rows[1] == f"  wanted {SENTENCE}"


def test_empty_cells_of_a_list_are_left_out():
    table = Table("joint", "k of the first kind", "k of the second kind")
    table.add_row("shoulder_of_the_arm", "", "20001")
    assert drawn(table, 30) == ["shoulder_of_the_arm", "  k of the second kind 20001"]


def test_brackets_in_a_cell_are_no_markup():
    table = Table("step", "came")
    table.add_row("samples", "[12800] of them")
    assert any("[12800] of them" in row for row in drawn(table, 80))
    assert any("[12800] of them" in row for row in drawn(table, 22))
