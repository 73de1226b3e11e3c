"""What a fit says, in plain words: the first page of a plain structure's report."""

from __future__ import annotations

import numpy as np

from armodal.analyzer.confidence import TWO_SIDED_95
from armodal.analyzer.modal import ModalModel, drift_told, mac_matrix, missing_mode_hints
from armodal.analyzer.modal.modes import Mode
from armodal.protocols.frf_records import FrequencyResponse

__all__ = ["answer", "long_side", "open_questions", "shape_of"]

_MOST_HINTS = 5


def long_side(model: ModalModel) -> bool:
    """Whether the shape was measured where the hammer went."""
    return len(model.references) > len(model.responses)


def shape_of(model: ModalModel, mode: Mode) -> np.ndarray:
    """Shape at the places measured: participation where the hammer roved. Complex, largest 1."""
    shape = mode.participation if long_side(model) else mode.shape
    return np.asarray(shape / np.max(np.abs(shape)))


def answer(frf: FrequencyResponse, model: ModalModel) -> list[str]:
    """Sentences: what was found, how well it is known, and whether it moves."""
    n_frf, points = frf.values.shape[0] * frf.values.shape[1], len(model.mountings)
    low, high = model.band_hz
    measured = f"{_count(n_frf, 'FRF')} at {_count(points, 'point')}, {low:.5g} to {high:.5g} Hz"
    if not model.modes:
        return [f"No mode was found in {measured}."]
    f = model.f_hz
    std = np.array([mode.f_std_hz for mode in model.modes])
    damping = np.array([100.0 * mode.damping_std for mode in model.modes])
    source = (
        ", from the scatter between points"
        if model.robust_covariance
        else "; scatter between points is not known, so take them as lower bounds"
    )
    said = [
        f"{_count(len(f), 'mode')} from {f[0]:.5g} to {f[-1]:.5g} Hz, found in {measured}."
        if len(f) > 1
        else f"One mode at {f[0]:.5g} Hz, found in {measured}.",
        (
            f"Together they explain all but {100.0 * model.synthesis_error:.2g} % of the FRFs "
            f"(RMS); the worst explained FRF agrees with them to {_floored(model.frac.min())} %."
        ),
        (
            f"Frequencies are known within {_range(std)} Hz, damping ratios within "
            f"{_range(damping)} % (one standard deviation{source})."
        ),
    ]
    moving = drift_told(model)
    if moving:
        said.append(
            f"{_count(len(moving), 'mode')} moved between measurements, by up to "
            f"{max(told.half_power_bandwidths for told in moving):.2g} half-power bandwidths; "
            "frequency and damping are means over the points."
        )
    elif points > 1:
        said.append("No mode moved from point to point by more than scatter explains.")
    else:
        said.append("With one point it cannot be said whether a mode moves from point to point.")
    return said


def open_questions(frf: FrequencyResponse, model: ModalModel) -> list[str]:
    """What is not explained, not known, or to be looked at."""
    said = list(model.notes)
    said += [
        f"{told.words}. Shifts along this line explain {100.0 * told.explained:.0f} % of the "
        "variance between points"
        if told.cause
        else told.words
        for told in drift_told(model)
    ]
    said += _misfits(frf, model)
    unknown = [m for m in model.modes if m.damping_ratio < TWO_SIDED_95 * m.damping_std]
    if unknown:
        said.append(f"the damping of {_listed(unknown)} may be 0")
    if not model.modes:
        return said
    n_places = len(shape_of(model, model.modes[0]))
    if n_places == 1:
        said.append(
            "one degree of freedom was measured: there are no shapes, and MPC has no meaning"
        )
    elif len(model.modes) > 1:
        shapes = np.stack([shape_of(model, mode) for mode in model.modes], axis=1)
        likeness = np.triu(mac_matrix(shapes, shapes), 1)
        a, b = np.unravel_index(int(np.argmax(likeness)), likeness.shape)
        said.append(
            f"the two most alike shapes are those of {model.modes[a].f_hz:.5g} and "
            f"{model.modes[b].f_hz:.5g} Hz (MAC {likeness[a, b]:.2f})"
            + (
                f"; {n_places} degrees of freedom cannot tell {len(model.modes)} shapes apart"
                if n_places < len(model.modes)
                else ""
            )
        )
    return said


def _misfits(frf: FrequencyResponse, model: ModalModel) -> list[str]:
    """Where the FRFs are not explained: beside a mode, or where one may be missing."""
    beside: dict[float, float] = {}
    said = []
    for hint in missing_mode_hints(frf, model)[:_MOST_HINTS]:
        if hint.beside_hz is not None:
            beside[hint.beside_hz] = max(hint.share, beside.get(hint.beside_hz, 0.0))
        else:
            said.append(
                f"a mode may be missing near {hint.f_hz:.5g} Hz: {100.0 * hint.share:.2g} % of "
                "the FRFs there are not explained"
            )
    if beside:
        share = _range(100.0 * np.array(list(beside.values())))
        said.append(
            f"close to {', '.join(f'{f:.5g}' for f in sorted(beside))} Hz the modes explain all "
            f"but {share} % of the FRFs, which is more than noise leaves elsewhere"
        )
    return said


def _floored(share: float) -> str:
    """A share in per cent, never rounded up to all of it."""
    return f"{np.floor(1e4 * share) / 1e2:g}"


def _count(n: int, what: str) -> str:
    return f"{n} {what}{'' if n == 1 else 's'}"


def _range(values: np.ndarray) -> str:
    low, high = f"{values.min():.2g}", f"{values.max():.2g}"
    return low if low == high else f"{low} to {high}"


def _listed(modes: list[Mode]) -> str:
    return ", ".join(f"{mode.f_hz:.5g} Hz" for mode in modes)
