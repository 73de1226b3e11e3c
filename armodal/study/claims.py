"""The figures that are claimed of the workflow, maker by maker, from the lines of their studies."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from armodal.study.kept_lines import Line
from armodal.study.summary import study_summary
from armodal.study.tables import StudyTable

__all__ = ["claims"]


def claims(studies: Mapping[str, Sequence[Line]]) -> StudyTable:
    """Return the table of what was reached and wanted.

    Parameters
    ----------
    studies
        Lines of each maker's study, by its name.
    """
    together = [line for own in studies.values() for line in own]
    summaries = [study_summary(own) for own in (*studies.values(), together)]
    rows = tuple((words, *(told(s) for s in summaries), wanted) for words, told, wanted in _FIGURES)
    return StudyTable(
        title="Figures by maker", head=("", *studies, "together", "wanted"), rows=rows
    )


def _of_group(name: str, what: str) -> Callable[[Line], str]:
    return lambda summary: _rate(summary["groups"][name][what])


def _rate(rate: Line | None) -> str:
    if not rate or not rate["n"]:
        return ""
    low, high = (f"{100 * rate[end]:.0f}" for end in ("low", "high"))
    return f"{rate['k']} of {rate['n']} ({low} to {high} %)"


def _percent(value: float, digits: int) -> str:
    return "" if np.isnan(value) else f"{100 * value:.{digits}f} %"


def _seconds(times: Sequence[float]) -> str:
    return "" if np.isnan(times[0]) else f"{times[0]:.0f}, {times[1]:.0f} s"


_FIGURES: tuple[tuple[str, Callable[[Line], str], str], ...] = (
    ("nulls silent", _of_group("nulls", "right"), "95 %"),
    ("— a wrong name", _of_group("nulls", "wrong"), "1 %"),
    ("clear, right and alone", _of_group("clear", "right"), "90 %"),
    ("medium", _of_group("medium", "right"), "75 %"),
    ("faint", _of_group("faint", "right"), ""),
    ("— single ones named right, at their true place", lambda s: _rate(s["place"]), ""),
    ("two at once, both named", _of_group("two at once", "right"), "70 %"),
    ("outside the library, said so", _of_group("outside", "right"), "85 %"),
    ("wrong or surplus names, effects", lambda s: _rate(s["wrong_of_effects"]), "2 %"),
    (
        "k of joints 1 to 3, median error (right verdicts)",
        lambda s: _percent(s["main_k"]["error_median"], 2),
        "1.5 %",
    ),
    (
        "— its 95 % interval covers, every verdict",
        lambda s: _rate(s["main_k"]["interval_covers"]),
        "92 to 98 %",
    ),
    (
        "— its range covers, what nobody would see included",
        lambda s: _rate(s["main_k"]["range_covers"]),
        "95 %",
    ),
    (
        "— half width of the range, median",
        lambda s: _percent(s["main_k"]["half_width_median"], 0),
        "15 %",
    ),
    (
        "size of a named effect in its 95 % interval",
        lambda s: _rate(s["size_covered"]),
        "90 to 98 %",
    ),
    (
        "processor time of a null, median, most",
        lambda s: _seconds(s["groups"]["nulls"]["cpu_s"]),
        "10, 30 s",
    ),
    ("of an effect", lambda s: _seconds(s["cpu_s_effects"]), "10, 30 s"),
)
