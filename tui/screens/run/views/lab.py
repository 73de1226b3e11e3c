"""Lab: what is connected, whether it is well, and what must be confirmed before the session."""

from __future__ import annotations

import math

import numpy as np
from rich.text import Text

from armodal.daq.preview import PREVIEW_EVERY_WALL_S
from armodal.protocols.board.records import Channel, IepeState
from armodal.protocols.sensor_memory import unlike_before
from armodal.protocols.teds import contradictions
from armodal.tui.screens.run.measured import active_channels
from armodal.tui.screens.run.sensitivity import sensitivity_words
from armodal.tui.screens.run.state import FEWEST_MASS_HITS, RATIO_OFF, Phase, RunState
from armodal.tui.screens.run.trials import suggested_level_n
from armodal.tui.screens.run.views.parts import BAD, DIM, GOOD, WARN
from armodal.tui.screens.run.words import off_words, ratio_words, reason_word

__all__ = ["devices_text", "levels_text", "next_step", "trials_text"]

HIGH = 0.9  # of full scale: nearly too much
WIDE = 104  # columns, from which supply and calibration are told of every sensor
_IEPE = {IepeState.OFF: "off", IepeState.OK: "ok", IepeState.OPEN: "OPEN", IepeState.SHORT: "SHORT"}


def next_step(state: RunState) -> tuple[str, str]:
    """Return what the operator does next before the session, and its style."""
    if state.phase is not Phase.LAB:
        return "The session is being opened ...", WARN
    if state.lab_starting:
        return "The simulated laboratory is being started ...", WARN
    if state.lab_ended is not None:
        return "The simulated laboratory has ended by itself. s: start it again", BAD
    if not state.board_port:
        words = "s: simulated laboratory   1-9: press the number of the board's port"
        if state.board_choice:
            words = f"The board is on {state.board_choice}. Now press the controller's number."
        return words, WARN
    return _next_with_ports(state)


def _next_with_ports(state: RunState) -> tuple[str, str]:
    if state.board is None:
        return "Waiting for the board. Check its cable and power.", BAD
    if not state.angles_will_come:
        return "Waiting for the controller's joint angles. Is it on, and its CAN cable in?", BAD
    if state.mass_kg is not None:
        return _mass_step(state, state.mass_kg), WARN
    if not state.sensors_confirmed:
        return "Are these sensors mounted, with these sensitivities? Enter: yes", WARN
    if state.ratio_asks and state.ratio is not None:
        return f"By the known mass {off_words(state.ratio)}. Enter: go on all the same", WARN
    return _ready(state), GOOD


def _mass_step(state: RunState, mass_kg: float) -> str:
    left = FEWEST_MASS_HITS - sum(hit.verdict.accepted for hit in state.mass_hits)
    hand = " (h: the simulated hand does it)" if state.simulated else ""
    if left > 0:
        return f"Hit the mass of {mass_kg:g} kg, {left} more{hand}. Enter: back to the arm"
    return f"Enter: done with the mass. More hits make it surer{hand}"


def _ready(state: RunState) -> str:
    if state.resuming:
        done = sum(p.accepted for p in state.progress)
        return f"{done} accepted hits are safe in the journal. Enter: go on at the same point"
    trial = "h: trial hit   " if state.simulated else ""
    take = "a: take the suggested trigger" if suggested_level_n(state) is not None else ""
    return f"Enter: begin the session   {trial}{take}".rstrip()


def devices_text(state: RunState) -> Text:
    """Return ports, board, controller, clock."""
    text = Text()
    if not state.board_port:
        text.append("ports found\n", style="bold")
        for i, (path, words) in enumerate(state.ports[:9], 1):
            text.append(f" {i} {path}  {words}\n")
        if not state.ports and not state.lab_starting:
            text.append(" none: plug the board in, or s for the simulated laboratory\n", style=WARN)
        return text
    if state.lab_ended is not None:
        text.append(f"✗ {state.lab_ended}\n", style=BAD)
        return text
    troubles = dict(state.troubles)
    text.append("board       ", style="bold")
    board = state.board
    if "board" in troubles:
        text.append(f"✗ {troubles['board']}\n", style=BAD)
    elif board is None:
        text.append(f"… {state.board_port}\n", style=WARN)
    else:
        text.append("✓ ", style=GOOD)
        text.append(f"{board.dictionary.board_id} {board.dictionary.firmware}, {board.port}\n")
    text.append("controller  ", style="bold")
    reading = state.joints
    if "can" in troubles:
        text.append(f"✗ {troubles['can']}\n", style=BAD)
    elif state.told_rad is not None:
        text.append("✓ ", style=GOOD)
        text.append(f"none: you read the joint angles, to {math.degrees(state.told_rad):g}°\n")
    elif reading is None or reading.joints_rad is None:
        text.append(f"✗ no joint angles on {state.can_channel or 'no port'}\n", style=BAD)
    else:
        degrees = " ".join(f"{round(x) + 0.0:.0f}" for x in np.degrees(reading.joints_rad))
        text.append("✓ ", style=GOOD)
        text.append(f"joints {degrees}°, {'held' if reading.held else 'NOT HELD'}\n")
    _health(text, state)
    return text


def _health(text: Text, state: RunState) -> None:
    health = state.health
    text.append("clock       ", style="bold")
    if health is None or health.clock_uncertainty_s is None or health.clock_rate_ppm is None:
        text.append("unknown yet\n", style=DIM)
        return
    text.append(f"± {1e3 * health.clock_uncertainty_s:.2f} ms, ")
    text.append(f"board runs {health.clock_rate_ppm:+.0f} ppm\n")
    text.append("traffic     ", style="bold")
    text.append(f"{health.stream_samples} samples, {health.can_frames} CAN frames")
    if health.can_faults:
        text.append(f", {health.can_faults} CAN lines unreadable", style=WARN)
    text.append("\n")


def levels_text(state: RunState, width: int) -> Text:
    """Return the channels with serial number, sensitivity and live level."""
    text = Text(no_wrap=True)
    channels = active_channels(state)
    if not channels:
        return text
    mark = "✓ confirmed" if state.sensors_confirmed else "? to confirm"
    style = GOOD if state.sensors_confirmed else WARN
    text.append("sensors     ", style="bold")
    text.append(mark, style=style)
    if state.input_range_v is None:
        text.append("  --input-range VOLTS shows them in mV", style=DIM)
    text.append("\n")
    wide = width >= WIDE
    bar = max(width - (99 if wide else 71), 6)
    lowest, highest = _extremes(state, len(channels))
    for i, channel in enumerate(channels):
        full = abs(channel.full_scale)
        text.append(f" {channel.name:<8}")
        text.append(f"S/N {channel.serial_number:<9} ")
        text.append(f"{sensitivity_words(channel, state.input_range_v):<16} ", style=style)
        text.append(f"± {full:<7.5g}{channel.unit.replace('^2', '²'):<6}")
        if wide or channel.iepe in {IepeState.OPEN, IepeState.SHORT}:
            text.append_text(_calibrated(channel))
        if lowest is None or highest is None:
            text.append("  no samples\n", style=WARN)
            continue
        share = max(abs(lowest[i]), abs(highest[i])) * abs(channel.scale) / full
        filled = round(bar * float(np.clip(1.0 + np.log10(max(share, 1e-6)) / 5.0, 0.0, 1.0)))
        word, colour = ("TOO HIGH", BAD) if share > HIGH else ("", "")
        text.append("█" * filled + "·" * (bar - filled), style=colour)
        text.append(f" {100 * share:5.2f} % {word}\n", style=colour)
    contradicted = [s for c in channels for s in contradictions(c, state.input_range_v)]
    contradicted += unlike_before(channels, state.input_range_v, state.known_sensors)
    for said in contradicted:
        text.append(f" ✗ {said}\n", style=BAD)
    return text


def _calibrated(channel: Channel) -> Text:
    state = _IEPE[channel.iepe]
    style = BAD if channel.iepe in {IepeState.OPEN, IepeState.SHORT} else ""
    return Text().append(
        f"cal {channel.calibration_date or 'unknown':<10} supply {state:<5} ", style=style
    )


def _extremes(state: RunState, n: int) -> tuple[tuple[float, ...] | None, tuple[float, ...] | None]:
    """Return lowest and highest counts of the last second, about their middle."""
    if not state.previews:
        return None, None
    last = state.previews[-round(1.0 / PREVIEW_EVERY_WALL_S) :]
    lowest = np.min([p.lowest.min(axis=0) for p in last], axis=0)
    highest = np.max([p.highest.max(axis=0) for p in last], axis=0)
    if len(lowest) != n:
        return None, None
    middle = (lowest + highest) / 2.0
    return tuple(map(float, lowest - middle)), tuple(map(float, highest - middle))


def trials_text(state: RunState) -> Text:
    """Return the trial hits, and the trigger level they suggest."""
    text = Text(no_wrap=True)
    text.append("trigger     ", style="bold")
    text.append(f"{state.plan.trigger.level_n:g} N")
    level = suggested_level_n(state)
    if state.resuming:
        text.append("  fixed since the session began\n", style=DIM)
    elif level is None:
        text.append("  three trial hits suggest a level\n", style=DIM)
    else:
        text.append(f"  suggested {level:g} N (a: take it)\n", style=WARN)
    if state.mass_kg is not None:
        text.append("mass        ", style="bold")
        text.append(f"{state.mass_kg:g} kg, {len(state.mass_hits)} hits so far\n")
    if state.ratio is not None:
        text.append("ratio       ", style="bold")
        off = abs(state.ratio.ratio - 1.0)
        text.append(f"{ratio_words(state.ratio)}\n", style=WARN if off > RATIO_OFF else GOOD)
        if off > RATIO_OFF:
            text.append(f" {off_words(state.ratio)}: check both certificates\n")
    for trial in (state.trials if state.mass_kg is None else state.mass_hits)[-4:]:
        verdict = trial.verdict
        word = "good" if verdict.accepted else reason_word(verdict.reasons[0]).lower()
        text.append(f" trial  {verdict.peak_n:7.1f} N  {1e3 * verdict.width_s:5.2f} ms  ")
        text.append(f"{'✓' if verdict.accepted else '✗'} {word}\n")
    return text
