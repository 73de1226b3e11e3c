"""Trial hits: the trigger level they suggest."""

from __future__ import annotations

from statistics import median

from armodal.tui.screens.run.state import RunState

__all__ = ["FEWEST_TRIALS", "suggested_level_n"]

FEWEST_TRIALS = 3
SHARE_OF_PEAK = 0.1  # so that a pulse is caught near its foot, and half as hard a hit still is
NOISES = 8.0  # standard deviations of the force that must not trigger


def suggested_level_n(state: RunState) -> float | None:
    """Return a trigger level from the trial hits, N; None while there are too few.

    A tenth of the median peak, and never below eight standard deviations of the force's noise.
    """
    peaks = [trial.verdict.peak_n for trial in state.trials if trial.verdict.peak_n > 0.0]
    if len(peaks) < FEWEST_TRIALS:
        return None
    noise_n = max(trial.force_noise_n for trial in state.trials)
    level_n = max(SHARE_OF_PEAK * median(peaks), NOISES * noise_n)
    return float(f"{level_n:.2g}")
