"""Whether a round of the search adds a name: what stands, what it explains, what it foretells."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from armodal.analyzer.gap.decision.added_effect import Step
from armodal.analyzer.gap.decision.calibration import Calibration
from armodal.analyzer.gap.decision.judge import Judged, judge
from armodal.analyzer.gap.decision.matters import MOST
from armodal.analyzer.gap.decision.without_levels import LEVELS_NEEDED, is_alike
from armodal.analyzer.gap.inference.fit import Fit, Stage
from armodal.analyzer.gap.inference.left_out import foretold_by_priors, left_out
from armodal.analyzer.gap.inference.misfit import misfit_per_line
from armodal.analyzer.gap.search.rivals import Rivals

__all__ = ["judge_round", "step_to"]

_MOST_EFFECTS, _MOST_ROUNDS = 3, 5
_LEAST_EXPLAINED = 0.25  # of a misfit, by a first name: one for less would be a guess

Tell = Callable[[str], None]


def judge_round(
    stage: Stage,
    found: Rivals,
    calibration: Calibration,
    n_named: int,
    rounds: int,
    notes: list[str],
) -> Judged:
    """Return what stands; nothing where as many are named as are looked for.

    What would earn a name beyond these counts as what is left.

    Parameters
    ----------
    calibration
        Limits for these rivals.
    n_named, rounds
        Effects named before, and which round this is.
    notes
        Gets a line for what was told or left out.
    """
    judged = judge(stage, found.present, found.rivals, calibration)
    if judged.named is not None and is_alike(judged.named):
        notes.append(f"{judged.named.last.title}: {LEVELS_NEEDED}; it was not named")
        return replace(judged, named=None, standing=(judged.named, found.present))
    if judged.named is None or (n_named < _MOST_EFFECTS and rounds <= _MOST_ROUNDS):
        return judged
    notes.append(f"{judged.named.last.title} is clear too, but the search stops here")
    return replace(judged, named=None, standing=())


def step_to(
    stage: Stage,
    present: Fit,
    judged: Judged,
    better: Fit,
    leaves: Callable[[Fit], float],
    n_named: int,
    tell: Tell,
) -> tuple[Step | None, str]:
    """Return the step to a better model if it holds; else why it does not.

    Parameters
    ----------
    present, better
        Fits without and with the name.
    leaves
        The misfit that replicas of a fit leave at most.
    n_named
        Effects named before: one beside others must explain more.
    """
    beyond = misfit_per_line(stage, better) > leaves(better)
    least = MOST if n_named else _LEAST_EXPLAINED
    if beyond and _explained(stage, present, better) < least:
        return None, "is the best of the library, but leaves most of what is missing"
    tell(f"each posture from the others: {better.hypothesis.name}")
    ways = [left_out]
    if not better.last.parameters:
        # What only widens a prior changes no prediction from postures that tell the same anyway:
        # each of them, alone, must speak against what is believed.
        ways.append(foretold_by_priors)
    gains = max((_gains(stage, present, better, way) for way in ways), key=_sum)
    if _sum(gains) < judged.calibration.apart:
        return None, "fits better but does not predict a posture from the others"
    return Step(without=present, fit=better, gains=gains, judged=judged), ""


def _gains(
    stage: Stage, present: Fit, better: Fit, way: Callable[[Stage, Fit], dict[str, float]]
) -> dict[str, float]:
    """How much better each posture is foretold in a way, nats by its name."""
    with_it = way(stage, better)
    return {name: s - with_it[name] for name, s in way(stage, present).items()}


def _sum(gains: dict[str, float]) -> float:
    return sum(gains.values())


def _explained(stage: Stage, present: Fit, better: Fit) -> float:
    """Part of the misfit that a better model takes off."""
    before, after = misfit_per_line(stage, present), misfit_per_line(stage, better)
    return (before - after) / before
