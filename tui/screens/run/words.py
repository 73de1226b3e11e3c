"""The operator's words for codes of the judge, errors and states: what it is, and what to do."""

from __future__ import annotations

from armodal.analyzer.ratio_calibration import RatioCalibration
from armodal.daq.session_machine import Prompt, PromptKind
from armodal.protocols.plan_records import Mode, PlannedPosture
from armodal.tui.screens.run.state import FEWEST_MASS_HITS, RunState

__all__ = [
    "advice_for",
    "conditions",
    "error_advice",
    "how_hard",
    "off_words",
    "ratio_words",
    "reason_word",
    "safety_line",
    "what_to_do",
]

# Reason: the large word, and what to do about it.
_REASONS: dict[str, tuple[str, str]] = {
    "double": ("DOUBLE HIT", "The hammer touched twice. Let it swing back at once."),
    "bounce": ("HAMMER STAYED ON", "It pushed again before it left the arm. Hit from the wrist."),
    "stuck": ("SENSOR STUCK", "A channel gives one value only. Check its cable and supply."),
    "swing": ("BAD FORCE SIGNAL", "The force went both ways. Check the hammer's cable and supply."),
    "soft": ("TOO SOFT", "Hit harder."),
    "overload": ("TOO HARD", "A sensor ran out of range. Hit more gently."),
    "noise": ("LOST IN NOISE", "Hit harder, or check the hammer's cable."),
    "late": ("LATE", "The pulse came long after the trigger. Touch nothing but the hit."),
    "cut-off": ("CUT OFF", "Part of the pulse is outside the record. Hit once more."),
    "not-settled": ("STILL SHAKING", "The arm was still moving. Wait a moment, then hit."),
    "gap": ("DATA LOST", "Samples are missing. Check the board's cable, then hit again."),
    "absent": ("NO ANGLES", "The controller sent no joint angles. Check its cable."),
    "stale": ("OLD ANGLES", "The joint angles were too old. Check the controller's cable."),
    "not-held": ("NOT HELD", "The drives did not hold the arm. Step back, switch them on."),
    "posture": ("OFF POSTURE", "The arm is not where it should be. Bring it back."),
    "moved": ("ARM MOVED", "A joint moved during the hit. Let the arm stand still."),
    "withdrawn": ("TAKEN BACK", "Taken back by the operator."),
}

# Type of the error: what it means, and the way back.
_ERRORS: dict[str, tuple[str, str]] = {
    "PortError": ("The port cannot be opened", "Plug the device in, or choose another port."),
    "DeviceTimeoutError": ("The device does not answer", "Check its power and its cable."),
    "DeviceLostError": ("The device is gone", "Plug it in again."),
    "BoardRefusedError": ("The board refuses", "Check the sensors and the plan's sampling."),
    "CanError": ("The controller is silent", "Is it on? Check the CAN cable and its adapter."),
    "JournalError": (
        "The journal cannot be written or read",
        "Make room on the disk, or give another file with --session.",
    ),
    "FrameError": ("The board sends data that cannot be read", "Check its cable and its firmware."),
    "PlanError": ("The plan does not fit this board", "Change the plan file."),
    "ArmError": ("The arm file cannot be used", "Change the arm file."),
    "LabEnded": ("The simulated laboratory has ended by itself", "Devices are not at fault."),
    "ProcessGone": (
        "The acquisition stopped without giving a reason",
        "What it had accepted is in the journal.",
    ),
}


def conditions(posture: PlannedPosture) -> str:
    """Return what else the plan wants of the arm in a posture; empty where nothing.

    A plan without brakes has the drives hold the arm.
    """
    words = " Brakes on." if posture.brakes else ""
    mass = posture.known_mass
    if mass is not None:
        at_mm = ", ".join(f"{1e3 * x:.0f}" for x in mass.center_m)
        words += f" Bolt {mass.mass_kg:g} kg to {mass.link}, its centre at {at_mm} mm in its frame."
    return words


def reason_word(reason: str) -> str:
    """Return the large word for a reason of the judge."""
    return _REASONS.get(reason, (reason.upper(), ""))[0]


def advice_for(reason: str) -> str:
    """Return what to do about a reason of the judge."""
    return _REASONS.get(reason, ("", "Hit once more."))[1]


def error_advice(kind: str, message: str = "") -> tuple[str, str]:
    """Return what an error means, and what to do, in the operator's words."""
    if "no space is left" in message:
        return "The disk is full", "Make room on it; nothing that was accepted is lost."
    return _ERRORS.get(kind, ("The measurement cannot go on", "Read the message below."))


def ratio_words(found: RatioCalibration) -> str:
    """Return a ratio calibration in words; what one hit cannot tell is said."""
    if found.n_hits < FEWEST_MASS_HITS:
        return (
            f"{found.ratio:.4f} from {found.n_hits} hit(s): at least {FEWEST_MASS_HITS} are needed"
        )
    return (
        f"{found.ratio:.4f} ± {found.ratio_std:.4f} from {found.n_hits} hits (should be 1), varies "
        f"over frequency by {100 * found.unevenness:.1f} %"
    )


def off_words(found: RatioCalibration) -> str:
    """Return by how much hammer and accelerometer together are off, and what that does."""
    more = "too large" if found.ratio > 1.0 else "too small"
    return f"every FRF comes out {100 * abs(found.ratio - 1.0):.1f} % {more}"


def safety_line(state: RunState) -> tuple[bool, str]:
    """Return whether the arm may be approached as far as is known, and why or why not."""
    if not state.posture_known:
        return False, "POSTURE UNKNOWN - stay away from the arm"
    if state.held is not True:
        return False, "ARM IS NOT HELD - stay away from the arm"
    return True, "arm is held"


def how_hard(prompt: Prompt, word: str) -> str:
    """Return the peak that the plan wants of the next hit, after a word; empty if it wants none."""
    wanted = None if prompt.posture is None else prompt.posture.peak_wanted_n(prompt.accepted)
    return "" if wanted is None else f", {word} {wanted:.0f} N"


def what_to_do(state: RunState) -> str:
    """Return the one sentence that tells the operator what is wanted now."""
    prompt = state.prompt
    if prompt is None or prompt.posture is None:
        return "Wait." if prompt is None else "Every planned point has its hits."
    if prompt.kind is not PromptKind.POSTURE and not state.safe:
        return "Is the arm held and safe to approach? Enter: yes"
    roving_hammer = state.plan.mode is Mode.ROVING_HAMMER
    words = {
        PromptKind.POSTURE: f"Bring the arm to posture {prompt.posture.name}",
        PromptKind.POINT: f"Sensor stays at {prompt.sensor_point}. Go to point {prompt.hit_point}"
        if roving_hammer
        else f"Mount the sensor at point {prompt.sensor_point}",
        PromptKind.HIT: f"Hit point {prompt.hit_point}{how_hard(prompt, 'about')}",
    }
    hand = " (h: the simulated hand does it)" if state.simulated else ""
    return words[prompt.kind] + hand
