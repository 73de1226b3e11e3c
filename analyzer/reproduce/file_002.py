"""File 002: the Viper s650, five joints, the workspace."""

from __future__ import annotations

from armodal.analyzer.calibration.calibrate import Calibration
from armodal.analyzer.reproduce.file_002_errors import errors_of_table_4, workspace_radius
from armodal.analyzer.reproduce.file_002_mass import couplings, figure_3, gravity
from armodal.analyzer.reproduce.file_002_tables import PAPER, VALIDATION, table_2, table_4
from armodal.analyzer.reproduce.file_002_workspace import figures_12_13, figures_14_16
from armodal.analyzer.reproduce.records import Figure, not_derivable
from armodal.protocols.arm.records import Arm

__all__ = ["figures_002"]


def figures_002(
    calibrated: Arm, predicting: Arm, calibration: Calibration, *, n_postures: int
) -> list[Figure]:
    """Every figure of file 002.

    Parameters
    ----------
    calibrated
        The Viper calibrated to Table 4 as well.
    predicting
        The Viper calibrated without it.
    calibration
        How it was made.
    n_postures
        Random postures for Figs. 3, 12 and 13.
    """
    return [
        *table_2(calibrated),
        *table_4(calibrated, predicting, calibration),
        *errors_of_table_4(VALIDATION),
        workspace_radius(calibrated),
        *couplings(predicting),
        *gravity(calibrated),
        *figure_3(calibrated, n_postures),
        *figures_12_13(calibrated, n_postures),
        *figures_14_16(calibrated),
        not_derivable(
            PAPER,
            "Table 4",
            "experimental frequencies and damping",
            "20 figures",
            "measured on the real arm; the measurement is not printed",
        ),
        not_derivable(
            PAPER,
            "Figs. 3, 5, 12-16",
            "heights of bars and contours",
            "pictures",
            "the pictures carry no numbers that can be read to a margin",
        ),
    ]
