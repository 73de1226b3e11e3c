"""Probabilities in words."""

import pytest

from armodal.analyzer.report.effect_words import chance


@pytest.mark.parametrize(
    ("probability", "words"),
    [
        (None, "not known"),
        (1.0, "100 %"),
        (0.25, "25 %"),
        (0.034, "3.4 %"),
        (4e-4, "0.04 %"),
        (3e-9, "below 0.01 %"),
    ],
)
def test_chance_is_told_as_far_as_replicas_tell_it(probability, words):
    assert chance(probability) == words
