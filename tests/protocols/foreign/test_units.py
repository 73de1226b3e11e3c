import numpy as np
import pytest

from armodal.protocols.errors import ForeignFileError
from armodal.protocols.foreign.frf_units import frf_form, frf_scale
from armodal.protocols.foreign.uff_records import DataKind, UffFunction, UffUnits
from armodal.protocols.foreign.units import signal_scale, unit
from armodal.protocols.frf_records import FrfForm

G = 9.80665  # CGPM 1901


def function(**changes):
    facts = {
        "kind": 4,
        "response_node": 1,
        "response_direction": 1,
        "reference_node": 1,
        "reference_direction": 1,
        "abscissa": np.arange(3.0),
        "values": np.ones(3, complex),
        "even": True,
        "numerator": 12,
        "denominator": 13,
    }
    return UffFunction(**(facts | changes))


@pytest.mark.parametrize(
    ("label", "factor"),
    [
        ("m/s^2", 1.0),
        ("m/s²", 1.0),
        ("(m/s**2)", 1.0),
        ("mm/s2", 1e-3),
        ("g", G),
        ("in/s^2", 0.0254),
        ("kN", 1e3),
        ("lbf", 4.4482216152605),
        ("m/sec^2", 1.0),
    ],
)
def test_a_unit_has_its_factor(label, factor):
    assert unit(label)[1] == pytest.approx(factor, rel=1e-12)


def test_millinewton_is_not_meganewton():
    assert unit("mN")[1] == 1e-3
    assert unit("MN")[1] == 1e6


@pytest.mark.parametrize(
    ("changes", "form"),
    [
        ({}, FrfForm.ACCELERANCE),
        ({"numerator": 11}, FrfForm.MOBILITY),
        ({"numerator": 8, "denominator": 9}, FrfForm.RECEPTANCE),
        ({"numerator": 0, "denominator": 0}, None),
        ({"numerator": 12, "denominator": 0}, None),
        ({"numerator": 12, "denominator": 12}, None),
        ({"numerator": 0, "denominator": 0, "numerator_unit": "m/N"}, FrfForm.RECEPTANCE),
        ({"numerator": 0, "denominator": 0, "numerator_unit": "g/N"}, FrfForm.ACCELERANCE),
        (
            {"numerator": 1, "denominator": 1, "numerator_unit": "m/s", "denominator_unit": "N"},
            FrfForm.MOBILITY,
        ),
    ],
)
def test_the_form_is_what_data_types_or_units_tell_else_unknown(changes, form):
    assert frf_form(function(**changes)) is form


def test_nothing_told_is_assumed_and_said():
    scale = frf_scale(function(), FrfForm.ACCELERANCE, None, "a")
    assert scale.assumed
    assert scale.factor == 1.0


def test_dataset_164_is_divided_by_as_the_format_says():
    inch = UffUnits(code=7, description="", length=1 / 0.0254, force=1 / 4.4482216152605)
    scale = frf_scale(function(), FrfForm.ACCELERANCE, inch, "a")
    assert not scale.assumed
    assert scale.factor == pytest.approx(0.0254 / 4.4482216152605, rel=1e-9)


def test_labels_tell_units_without_dataset_164():
    scale = frf_scale(function(numerator_unit="g/N"), FrfForm.ACCELERANCE, None, "a")
    assert not scale.assumed
    assert scale.factor == pytest.approx(G)


def test_a_units_code_its_factors_contradict_is_refused():
    # pyuff's own example: code 1 (SI) with the factors of feet and pounds.
    wrong = UffUnits(code=1, description="SI", length=3.2808399, force=0.224808943)
    with pytest.raises(ForeignFileError, match="units code 1"):
        frf_scale(function(), FrfForm.ACCELERANCE, wrong, "a")


def test_a_label_that_contradicts_dataset_164_is_refused():
    si = UffUnits(code=1, description="", length=1.0, force=1.0)
    with pytest.raises(ForeignFileError, match="dataset 164"):
        frf_scale(function(numerator_unit="g"), FrfForm.ACCELERANCE, si, "a")


def test_a_label_of_another_quantity_or_none_is_refused():
    with pytest.raises(ForeignFileError, match="tells force"):
        signal_scale(DataKind.ACCELERATION, "N", None, "a")
    with pytest.raises(ForeignFileError, match="'V' came"):
        signal_scale(DataKind.ACCELERATION, "V", None, "a")
