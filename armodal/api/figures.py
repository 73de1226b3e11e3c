"""One figure for every record a script holds."""

from __future__ import annotations

from functools import singledispatch
from typing import Any

from armodal.analyzer.gap.records import GapResult
from armodal.analyzer.identification.predicted_posture import Prediction
from armodal.analyzer.identification.records import Identification
from armodal.analyzer.modal import ModalModel
from armodal.analyzer.planning.made import MadePlan
from armodal.analyzer.report.figures import frf_figure
from armodal.analyzer.report.gap_figures import gap_figure
from armodal.analyzer.report.result_figures import (
    joints_figure,
    modes_figure,
    plan_figure,
    prediction_figure,
)
from armodal.protocols.errors import EstimateError
from armodal.protocols.frf_records import FrequencyResponse

__all__ = ["figure"]


def figure(record: object, *, frf: FrequencyResponse | None = None) -> Any:
    """Plotly figure of FRFs, modes, an identification, a prediction, a gap or a plan.

    Parameters
    ----------
    record
        FrequencyResponse, ModalModel, Identification, Prediction, GapResult or MadePlan.
    frf
        With a ModalModel: the FRFs it was fitted to, drawn beside its synthesis.

    Returns
    -------
    plotly.graph_objects.Figure

    Raises
    ------
    EstimateError
        If there is no figure of such a record, or nothing in it to draw.
    """
    if isinstance(record, ModalModel):
        return modes_figure(record, frf)
    return _figure(record)


@singledispatch
def _figure(record: object) -> Any:
    raise EstimateError(
        "wanted a FrequencyResponse, ModalModel, Identification, Prediction, GapResult or "
        f"MadePlan to draw, got {type(record).__name__}"
    )


@_figure.register
def _(record: FrequencyResponse) -> Any:
    return frf_figure(record, float(record.freq_hz[-1]))


@_figure.register
def _(record: Identification) -> Any:
    return joints_figure(record)


@_figure.register
def _(record: Prediction) -> Any:
    return prediction_figure(record)


@_figure.register
def _(record: GapResult) -> Any:
    found = gap_figure(record)
    if found is None:
        raise EstimateError("the gap cannot be drawn: no posture was compared before and after")
    return found


@_figure.register
def _(record: MadePlan) -> Any:
    return plan_figure(record.plan)
