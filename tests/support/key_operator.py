"""Somebody who has never seen the app: reads the screen, presses the key it names."""

from __future__ import annotations

import re
import time
from collections.abc import Callable

from support.terminal import LOOK_EVERY_S, PATIENCE, Terminal

# What the screen says, and the key that follows from it; the first that fits is pressed.
RULES: tuple[tuple[str, str], ...] = (
    (r"Enter: look at the modes", ""),
    (r"STOPPED|try again and go on", ""),
    (r"Enter: yes, it is", "Enter"),
    (r"Are these sensors mounted", "Enter"),
    (r"Enter: (begin the session|go on at the same point)", "Enter"),
    (r"simulated hand moves it", "h"),
    (r"the simulated hand has mounted it", "Enter"),
    (r"h: the simulated hand mounts it", "h"),
    (r"Enter: mounted, ready to hit", "Enter"),
    (r"hits at point", "h"),
)
ANSWER_S = 4.0  # for the screen to answer a key: a hit below the trigger leaves no trace


def act_until_done(
    terminal: Terminal, timeout_s: float, seen: Callable[[str], None] = lambda screen: None
) -> str:
    """Press keys as the screen says until the session is done; return the last screen."""
    end_s = time.monotonic() + PATIENCE * timeout_s
    pressed, pressed_s = "", 0.0
    while time.monotonic() < end_s:
        screen = terminal.screen()
        seen(screen)
        now_s = time.monotonic()
        said = next(((words, key) for words, key in RULES if re.search(words, screen)), None)
        if said is None:
            time.sleep(LOOK_EVERY_S)
            continue
        words, key = said
        if not key:
            return screen
        # A key is pressed once for what the screen says; hits and points count themselves.
        place = re.search(r"point \S+ ", screen)
        record = re.findall(r"record (\d+)", screen)
        state = f"{words} {place and place.group()} {record}"
        if state != pressed or now_s - pressed_s > ANSWER_S:
            pressed, pressed_s = state, now_s
            terminal.keys(key)
        time.sleep(LOOK_EVERY_S)
    raise AssertionError(
        f"the session was not done in {PATIENCE * timeout_s:g} s:\n{terminal.screen()}"
    )
