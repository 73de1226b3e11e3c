"""Craft: what the hits so far say about tip, driving point, drift and scatter, worst first."""

from __future__ import annotations

from rich.text import Text

from armodal.analyzer.checks.records import Fault, Finding
from armodal.analyzer.modal.usable_band import UsableBand
from armodal.tui.screens.run.craft import Moved, Scatter
from armodal.tui.screens.run.views.parts import BAD, DIM, WARN

__all__ = [
    "craft_text",
    "drift_line",
    "driving_line",
    "reciprocity_line",
    "scatter_line",
    "tip_line",
]

_ORDER = (BAD, WARN, "", DIM)
_BETWEEN = " · "


def craft_text(lines: tuple[Text, ...], width: int, rows: int) -> Text:
    """Return what fits, those lines first that ask for something; short ones share a row."""
    packed: list[Text] = []
    for line in sorted(lines, key=lambda line: _ORDER.index(str(line.style))):
        if packed and packed[-1].cell_len + len(_BETWEEN) + line.cell_len <= width:
            packed[-1] = Text.assemble(packed[-1], (_BETWEEN, DIM), line)
        else:
            packed.append(line)
    text = Text("\n").join(packed[:rows])
    text.no_wrap, text.overflow = True, "ellipsis"
    return text


def tip_line(band: UsableBand) -> Text:
    """Say how far the last pulse reaches, and which tip reaches further."""
    if band.by_force:
        return Text(f"harder tip for more: energy ends at {band.high_hz:.0f} Hz", style=DIM)
    return Text(f"tip: energy up to {band.high_hz:.0f} Hz, where the board ends", style=DIM)


def driving_line(found: Finding) -> Text:
    """Say what the FRF says of the point where hammer and sensor are together."""
    if found.fault is Fault.SIGN_FLIPPED:
        words = "it gives energy: the polarity of sensor or hammer is reversed"
        return Text(f"driving point: {words}", style=BAD)
    if found.fault is not None:
        words = "point, sensor axis or direction of the hit is not as stated"
        return Text(f"driving point: {words}", style=BAD)
    return Text("driving point: every clear resonance takes energy", style=DIM)


def drift_line(moved: Moved, before: str) -> Text:
    """Say whether resonances stand where they stood at the point before."""
    if moved.clear:
        words = f"{moved.now_hz:.1f} Hz was {moved.before_hz:.1f} Hz at point {before}"
        return Text(f"{words}: check mounting, drives, temperature", style=WARN)
    far = abs(moved.now_hz - moved.before_hz)
    return Text(f"resonances as at point {before}, at most {far:.1f} Hz off", style=DIM)


def reciprocity_line(found: Finding) -> Text:
    """Say whether a path is the same in both directions."""
    pair = f"points {' and '.join(found.points)}"
    if found.fault is Fault.SIGN_FLIPPED:
        return Text(
            f"reciprocity of {pair}: the polarity of sensor or hammer is reversed", style=BAD
        )
    if found.fault is Fault.GAIN:
        return Text(f"reciprocity of {pair}: a sensitivity differs from the other day's", style=BAD)
    if found.fault is not None:
        return Text(f"reciprocity of {pair}: a point or an axis is not as stated", style=BAD)
    return Text(f"reciprocity of {pair} holds", style=DIM)


def scatter_line(found: Scatter | None, n_left: int, std_wanted: float | None = None) -> Text:
    """Say how well the FRF is known, and what the hits still wanted will do to it."""
    more = f"{n_left} more hit{'' if n_left == 1 else 's'} wanted"
    if found is None:
        return Text(more) if n_left else Text("one hit shows no scatter", style=DIM)
    words = f"FRF at {found.f_hz:.1f} Hz: ± {_percent(found.relative_std)} from {found.n_hits} hits"
    if std_wanted is not None:
        lacking = max(found.hits_for(std_wanted) - found.n_hits, 0)
        wanted = f"± {_percent(std_wanted)} "
        if not lacking:
            return Text(f"{words}, {wanted}is reached")
        beyond = f", {lacking - n_left} beyond the plan (t)" if lacking > n_left else ""
        hits = f"{lacking} more hit{'' if lacking == 1 else 's'}"
        return Text(f"{words}, {wanted}wants {hits}{beyond}", style=WARN if beyond else "")
    if not n_left:
        return Text(words)
    return Text(f"{words}, {more}: ± {_percent(found.after(found.n_hits + n_left))}")


def _percent(share: float) -> str:
    return f"{100.0 * share:.2g} %"
