"""Hit: the verdict in one large word, why, and what is left."""

from __future__ import annotations

from rich.text import Text

from armodal.daq.events import HitJudged
from armodal.tui.screens.run.state import RunState
from armodal.tui.screens.run.views.parts import BAD, DIM, GOOD, WARN, big
from armodal.tui.screens.run.words import advice_for, how_hard, reason_word, what_to_do

__all__ = ["last_hit_text", "left_text", "verdict_text"]


def verdict_text(state: RunState, width: int, height: int) -> Text:
    """Return the verdict on the last hit; only what the journal holds is called accepted."""
    judged = state.last_hit
    large = 5 if height >= 8 else 3
    if state.last_taken_back is not None:
        text = big("TAKEN BACK", WARN, width=width, height=large)
        return text.append(f"\nHit {state.last_taken_back} no longer counts. Hit again.", style="")
    if judged is None or not _of_this_point(state, judged):
        text = big("HIT NOW", "bold", width=width, height=large)
        return text.append(f"\n{what_to_do(state)}", style="")
    hit, verdict = judged.hit, judged.hit.verdict
    if verdict.accepted:
        text = big("ACCEPTED", GOOD, width=width, height=large)
        kept = f"✓ record {hit.number} is in the journal"
        pulse = f"  {verdict.peak_n:.0f} N, {1e3 * verdict.width_s:.1f} ms"
        between = "\n" if len(kept) + len(pulse) > width else ""
        text.append(f"\n{kept}", style=GOOD).append(f"{between}{pulse}")
        for note in verdict.notes[:1]:
            text.append(f"\n{note}", style=DIM)
        return text
    reason = verdict.reasons[0]
    text = big(reason_word(reason), BAD, width=width, height=large)
    others = ", ".join(reason_word(other).lower() for other in verdict.reasons[1:])
    text.append(f"\n✗ not accepted (record {hit.number}): {advice_for(reason)}", style=BAD)
    if others:
        text.append(f" Also: {others}.")
    for note in verdict.notes[:1]:
        text.append(f"\n{note}", style=DIM)
    return text


def last_hit_text(state: RunState) -> Text:
    """Return the verdict on the last hit in one line; empty before any."""
    judged = state.last_hit
    if judged is None:
        return Text("")
    number = judged.hit.number
    if judged.hit.verdict.accepted and number not in state.withdrawn:
        return Text(f"Last hit accepted: ✓ record {number} is in the journal.", style=GOOD)
    return Text(f"Last hit not accepted: ✗ record {number}.", style=BAD)


def _of_this_point(state: RunState, judged: HitJudged) -> bool:
    """Whether a verdict still concerns the operator: at this point, or the one just finished."""
    prompt = state.prompt
    return (
        prompt is None
        or prompt.attempts > 0
        or prompt.kind.value != "hit"
        or (
            judged.hit.posture,
            judged.hit.sensor_point,
            judged.hit.hit_point,
        )
        == (
            prompt.posture.name if prompt.posture else "",
            prompt.sensor_point,
            prompt.hit_point,
        )
    )


def left_text(state: RunState, width: int, height: int) -> Text:
    """Return the hits of the point in hand: how many there are, and how many are wanted."""
    prompt = state.prompt
    if prompt is None or prompt.posture is None:
        return Text("")
    text = big(f"{prompt.accepted}/{prompt.wanted}", "bold", width=width, height=min(height, 3))
    text.append(f"\nhits at point {state.here[1] if state.here else ''}{how_hard(prompt, 'next')}")
    text.append(f"\nhammer at {prompt.hit_point}, sensor at {prompt.sensor_point}", style=DIM)
    if prompt.exhausted:
        text.append(f"\n{prompt.attempts} tried: t again, k skip", style=WARN)
    elif state.hand_doing:
        text.append(f"\nhand {state.hand_doing}", style=DIM)
    return text
