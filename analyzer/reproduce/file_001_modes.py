"""File 001: the frequencies of Table 3, and the small peaks of its figures."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from armodal.analyzer.calibration.calibrate import Calibration
from armodal.analyzer.reproduce.records import (
    Figure,
    Status,
    compared,
    not_derivable,
    statement,
)
from armodal.analyzer.workspace.batch import ArmBatch
from armodal.analyzer.workspace.spectrum import (
    ElasticJoints,
    elastic_joints,
    spectrum,
    spectrum_of_mass,
)
from armodal.protocols.arm.records import Arm

__all__ = ["small_peaks", "table_3"]

PAPER = "001"
PRINT_HZ = 0.25  # frequencies are multiples of 0.5 Hz
ABOUT = 0.15  # of a peak that is "at about" a frequency, in a range where structure gives way too
# Test, frequency, number of the model's mode.
PEAKS = ((1, 40.0, 3), (1, 57.0, 4), (2, 32.0, 3), (3, 14.0, 1))


def table_3(
    own: Calibration,
    posture_deg: Sequence[float],
    k: Sequence[float],
    numerical_hz: Sequence[float],
    experimental_hz: Sequence[Sequence[float]],
) -> list[Figure]:
    """The authors' numerical frequencies from the paper's own three inertias, and their errors."""
    elastic = ElasticJoints(
        joints=(0, 1, 2), stiffness_n_m_per_rad=np.array(k), damping_n_m_s_per_rad=np.zeros(3)
    )

    def modes(mass: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
        return np.asarray(spectrum_of_mass(mass, elastic).f_hz[0])

    f_hz, std = own.spread_of(np.deg2rad([posture_deg]), modes)
    figures = [
        compared(
            PAPER,
            "Table 3",
            f"numerical frequency of mode {i + 1}",
            "Hz",
            published=published,
            ours=float(f_hz[i]),
            margin=2.0 * float(std[i]) + PRINT_HZ,
            status=Status.PREDICTED,
            why="two standard deviations of what three inertias, the total mass and shares of the "
            "volume leave open, and half of the print's step of 0.5 Hz",
            ours_std=float(std[i]),
        )
        for i, published in enumerate(numerical_hz)
    ]
    errors = [
        max(abs(one - numerical) for one in measured)
        for numerical, measured in zip(numerical_hz, experimental_hz, strict=True)
    ]
    figures.append(
        compared(
            PAPER,
            "section 2.3",
            "largest error of a numerical frequency, about",
            "Hz",
            published=3.0,
            ours=max(errors),
            margin=2.0 * PRINT_HZ,
            status=Status.RECOMPUTED,
            why="the print's step of both frequencies",
        )
    )
    figures.append(
        statement(
            PAPER,
            "section 2.3",
            "it is that of the third mode",
            holds=int(np.argmax(errors)) == 2,
            status=Status.RECOMPUTED,
            number=f"largest errors {', '.join(f'{error:.1f}' for error in errors)} Hz",
        )
    )
    return figures


def small_peaks(arm: Arm, tests_deg: Sequence[Sequence[float]]) -> list[Figure]:
    """Peaks beside the identified ones, by the five joints of file 002."""
    batch, elastic = ArmBatch(arm), elastic_joints(arm)
    modes = spectrum(batch, np.deg2rad(tests_deg), elastic)
    figures = [
        compared(
            PAPER,
            "section 2.2",
            f"small peak of test {test}, at about",
            "Hz",
            published=peak_hz,
            ours=float(modes.f_hz[test - 1, mode - 1]),
            margin=ABOUT * peak_hz,
            status=Status.SISTER,
            why="'about', read off a figure; inertias and five stiffnesses are file 002's, which "
            "finds that structure gives way too in this range",
        )
        for test, peak_hz, mode in PEAKS
    ]
    figures.append(
        not_derivable(
            PAPER,
            "section 2.2",
            "small peak of test 2, at about 40 Hz",
            40.0,
            f"five joints have no mode there between {modes.f_hz[1, 2]:.1f} and "
            f"{modes.f_hz[1, 3]:.1f} Hz: it takes structure that gives way",
        )
    )
    strain = elastic.stiffness_n_m_per_rad[:, None] * modes.shape[2] ** 2
    share = strain / strain.sum(axis=0)
    figures.append(
        statement(
            PAPER,
            "section 2.2",
            "the small peak of test 3 is a mode of joint 2",
            holds=int(np.argmax(share[:, 0])) == 1,
            status=Status.SISTER,
            number=f"joint 2 has {100 * share[1, 0]:.0f} % of its strain energy",
        )
    )
    return figures
