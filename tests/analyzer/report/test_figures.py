"""What the report's figures show: units, and the motion of a mode where it was measured."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from support.small_fit import measured, state_of, true_structure, unmeasured

from armodal.analyzer.arm import Superset, reduce_model
from armodal.analyzer.arm.reduced import model_modes
from armodal.analyzer.modal import convert_form, fit_modes
from armodal.analyzer.report.figures import arm_figure, frf_figure, indicator_figure
from armodal.protocols.frf_records import Dof, FrequencyResponse, FrfForm

FREQ_HZ = np.arange(5.0, 60.0, 0.5)
POINTS = ("1", "4", "6", "8", "11", "13")


@pytest.fixture(scope="module")
def roving_response(superset):
    """A triaxial sensor goes over six points; one hit."""
    blank = unmeasured(superset, 1, POINTS, FREQ_HZ, mass_kg=0.0)
    rng = np.random.default_rng(1)
    data = measured(superset, blank, state_of(true_structure(), 1), 0, rng, noise=1e-3)
    values = np.moveaxis(data.values, 2, 1).reshape(-1, 1, FREQ_HZ.size)
    rotation = data.dynamics.point_rotation[data.sensor_point]
    return FrequencyResponse(
        posture="p",
        form=FrfForm.ACCELERANCE,
        freq_hz=FREQ_HZ,
        decay_rad_s=2.0,
        values=values,
        coherence=np.ones(values.shape),
        variance=np.full(values.shape, data.variance.flat[0]),
        n_hits=np.full(values.shape[:2], 3),
        responses=tuple(
            Dof(point=point, label=label, direction=rotation[i, :, axis])
            for i, point in enumerate(POINTS)
            for axis, label in enumerate("xyz")
        ),
        references=(Dof(point="1", label="hit", direction=data.hit_direction[0]),),
        joints_rad=data.dynamics.joints_rad,
    )


@pytest.fixture(scope="module")
def roving_hammer(roving_response):
    """The hammer goes along z of the six points, the sensor stays where the hit was."""
    rows = [i for i, dof in enumerate(roving_response.responses) if dof.label == "z"]

    def turned(values):
        return values[rows].swapaxes(0, 1)

    return replace(
        roving_response,
        values=turned(roving_response.values),
        variance=turned(roving_response.variance),
        coherence=turned(roving_response.coherence),
        n_hits=turned(roving_response.n_hits),
        responses=(replace(roving_response.references[0], label="z"),),
        references=tuple(replace(roving_response.responses[i], label="hit") for i in rows),
    )


def drawn_motion(superset, frf):
    """Motion (n_points, 3) that the figure draws of the lowest mode."""
    figure = arm_figure(superset, frf, fit_modes(frf), ())
    traces = {trace.name: np.stack([trace.x, trace.y, trace.z], axis=1) for trace in figure.data}
    order = np.argsort(superset.point_link, kind="stable")
    motion = np.empty_like(traces["points"])
    motion[order] = traces["mode shape"] - traces["points"][order]
    return motion


@pytest.mark.parametrize("of", ["roving_response", "roving_hammer"])
def test_a_mode_is_drawn_where_it_was_measured_with_its_own_shape(superset, of, request):
    frf = request.getfixturevalue(of)
    motion = drawn_motion(superset, frf)
    dynamics = superset.posture(frf.joints_rad)
    model = reduce_model(superset, dynamics, true_structure())
    lowest = model.point_jacobian[:, :3] @ model_modes(model).shape[:, 0]
    index = [superset.point_index[point] for point in POINTS]
    assert set(np.flatnonzero(np.linalg.norm(motion, axis=1) > 0.0)) == set(index)
    z = dynamics.point_rotation[index][:, :, 2]
    drawn, truth = np.sum(motion[index] * z, axis=1), np.sum(lowest[index] * z, axis=1)
    if of == "roving_hammer":
        np.testing.assert_allclose(np.cross(motion[index], z), 0.0, atol=1e-12)
    factor = np.vdot(drawn, truth) / np.vdot(drawn, drawn)
    # Noise is a thousandth of the FRFs' rms, a weak mode's shape known to a few per cent; damping
    # leaves complex parts of that size.
    np.testing.assert_allclose(factor * drawn, truth, atol=0.05 * np.abs(truth).max())


@pytest.mark.parametrize(
    ("form", "unit"),
    [
        (FrfForm.RECEPTANCE, "m/N"),
        (FrfForm.MOBILITY, "m/(s N)"),
        (FrfForm.ACCELERANCE, "m/(s² N)"),
    ],
)
def test_magnitudes_carry_the_unit_of_their_form(roving_response, form, unit):
    frf = convert_form(roving_response, form)
    assert frf_figure(frf, 60.0).layout.yaxis.title.text == unit
    shown = indicator_figure(frf, fit_modes(frf), {"all": POINTS}, 60.0)
    assert shown.layout.yaxis.title.text == unit


EVIL = "<b>&"
SHOWN = "&lt;b&gt;&amp;"


def test_plotly_is_given_postures_groups_and_points_without_tags(roving_response):
    """It takes a tag in a text for its own."""
    hit, *_ = roving_response.references
    first, *others = roving_response.responses
    frf = replace(
        roving_response,
        posture=EVIL,
        references=(replace(hit, point=EVIL),),
        responses=(replace(first, point=EVIL), *others),
    )
    curves = frf_figure(frf, 60.0)
    assert curves.layout.title.text == f"{SHOWN}: FRFs"
    assert curves.data[0].name == f"point {SHOWN} x"
    sums = indicator_figure(frf, fit_modes(roving_response), {EVIL: POINTS}, 60.0)
    assert sums.layout.title.text.startswith(f"{SHOWN}: ")
    assert {f"sum of {SHOWN}", f"MIF, hit at {SHOWN}"} <= {trace.name for trace in sums.data}


def test_the_arm_is_drawn_with_labels_without_tags(superset, roving_response):
    arm, unused = superset.arm, superset.point_index["2"]
    *below, last = arm.joints
    renamed = replace(last, link=replace(last.link, name=EVIL))
    points = [
        replace(point, link=EVIL) if point.link == last.link.name else point for point in arm.points
    ]
    points[unused] = replace(points[unused], id=EVIL)
    told = SimpleNamespace(
        link=EVIL, point_link_m=np.zeros(3), direction_link=np.array([0.0, 0.0, 1.0]), mozzi=()
    )
    figure = arm_figure(
        Superset(replace(arm, points=tuple(points), joints=(*below, renamed))),
        replace(roving_response, posture=EVIL),
        fit_modes(roving_response),
        (told,),
    )
    assert figure.layout.title.text.startswith(f"{SHOWN}: ")
    traces = {trace.name: trace for trace in figure.data}
    assert traces["points"].text[unused] == SHOWN
    assert f"axis in {SHOWN}" in traces
