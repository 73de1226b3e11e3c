"""What effects gain on replicas, beside fits of each replica."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from support.made_gap_fits import made_fit

from armodal.analyzer.gap.inference.error_modes import Sensitivities, curvature_of
from armodal.analyzer.gap.model.effect import Instance
from armodal.analyzer.gap.model.hypothesis import Hypothesis
from armodal.analyzer.gap.model.space import Parameter
from armodal.analyzer.gap.search import replicas
from armodal.analyzer.gap.search.replicas import replica_gains

CHANNELS, LINES, POSTURES, DRAWS = 6, 4, 3, 4000
ORDINARY = tuple(Parameter(name=f"o{i}", unit="", mean=0.0, std=1.0) for i in range(4))
SIZE = Parameter(name="size", unit="", mean=0.0, std=1.0)
GROWS = Instance(
    effect=SimpleNamespace(name="grows"),
    place="",
    parameters=(Parameter(name="size", unit="", mean=0.0, std=1.0, low=0.0),),
    size="size",
)
EITHER_WAY = Instance(
    effect=SimpleNamespace(name="either"), place="", parameters=(SIZE,), size="size"
)
OTHER = Instance(
    effect=SimpleNamespace(name="other"),
    place="",
    parameters=(Parameter(name="other", unit="", mean=0.0, std=1.0),),
    size="other",
)
LOOSE = Instance(
    effect=SimpleNamespace(name="loose"),
    place="",
    relaxes={"o1": Parameter(name="o1", unit="", mean=0.0, std=10.0)},
    size="o1",
)
BOTH = replace(LOOSE, effect=SimpleNamespace(name="both"), parameters=(SIZE,), size="size")


@pytest.fixture
def linear(monkeypatch):
    """A linear model of three postures and what it leaves, four ordinary parameters and a size."""
    rng = np.random.default_rng(7)
    scale = np.array([3.0, 0.3, 1.0, 2.0, 0.7, 1.0])[:, None, None]
    parts = []
    for _ in range(POSTURES):
        J = scale * rng.standard_normal((6, CHANNELS, 2 * LINES))
        left = rng.standard_normal((CHANNELS, 2 * LINES))
        parts.append(Sensitivities(raw=J, clean=J, left=left))

    def seen(_stage, _hypothesis, space, _values):
        n = len(space)
        return [Sensitivities(raw=p.raw[:n], clean=p.clean[:n], left=p.left) for p in parts]

    monkeypatch.setattr(replicas, "sensitivities", seen)
    # What is left is as it was drawn, no fit's end: its modes are those of the errors.
    monkeypatch.setattr(replicas, "settled", lambda parts, *_: parts)
    monkeypatch.setattr(replicas, "released", lambda parts, _: [p.left for p in parts])
    return parts


def null(first=ORDINARY[0]):
    hypothesis = Hypothesis(ordinary=SimpleNamespace(parameters=lambda: (first, *ORDINARY[1:])))
    space = hypothesis.space()
    return made_fit(hypothesis, cost=1.0, space=space, u=np.zeros(len(space)))


def evidence(J, r, mean, std):
    """Of a linear model with a Gaussian prior, up to a constant: minus the log, least cost."""
    A = J @ J.T + np.diag(1.0 / std**2)
    b = J @ r + mean / std**2
    u = np.linalg.solve(A, b)
    cost = 0.5 * (r @ r + np.sum((mean / std) ** 2) - b @ u)
    return cost + 0.5 * np.linalg.slogdet(A * np.outer(std, std))[1], u


def fitted_gains(parts, instance):
    """Each replica fitted, without the effect and with it."""
    rng = np.random.default_rng(8)
    flat = np.concatenate([p.raw[:5].reshape(5, -1) for p in parts], axis=1)
    found = []
    for _ in range(DRAWS):
        errors = []
        for part in parts:
            u, s, vh = np.linalg.svd(part.left.view(complex), full_matrices=False)
            a = (rng.standard_normal(s.size) + 1j * rng.standard_normal(s.size)) / np.sqrt(2.0)
            errors.append(np.sqrt(POSTURES) * ((u * s * a) @ vh).view(float).reshape(-1))
        r = np.concatenate(errors)
        mean, std = rng.standard_t(4.0, 4), np.ones(4)  # tolerances may be wrong
        without, _ = evidence(flat[:4], r, mean, std)
        if instance.relaxes:
            mean, std = mean * [1, 0, 1, 1], std * [1, 10, 1, 1]
            n = 4 + len(instance.parameters)
            wide, _ = evidence(flat[:n], r, np.append(mean, 0.0)[:n], np.append(std, 1.0)[:n])
            found.append(without - wide)
            continue
        with_it, u = evidence(flat, r, np.append(mean, 0.0), np.ones(5))
        grown = u[4] > 0.0 or instance is EITHER_WAY
        found.append(without - with_it if grown else 0.0)
    return np.array(found)


@pytest.mark.long
@pytest.mark.parametrize("instance", [GROWS, LOOSE, EITHER_WAY, BOTH])
def test_gains_scatter_as_those_of_fitted_replicas(instance, linear):
    found = replica_gains(None, null(), (), [instance, OTHER])
    fitted = fitted_gains(linear, instance)
    # Quantiles of 2000 and 4000 draws: their rate has a deviation of sqrt(p (1 - p) / n).
    for q in (0.92, 0.97):
        limit = np.quantile(found.replicas[0], q)
        tolerance = 4.0 * np.sqrt(q * (1.0 - q) * (1.0 / 2000 + 1.0 / DRAWS))
        assert np.mean(fitted > limit) == pytest.approx(1.0 - q, abs=tolerance)


@pytest.mark.usefixtures("linear")
def test_no_replica_has_an_ordinary_error_that_nature_or_its_name_forbids():
    """A compliance below none, or as large as an effect's; where a fit ends forbids nothing."""
    wide = replace(LOOSE, relaxes={"o0": replace(SIZE, name="o0", std=10.0)})

    def largest(first):
        return np.quantile(replica_gains(None, null(first), (), [wide]).replicas[0], 0.999)

    ends = largest(replace(ORDINARY[0], farthest=5.0))
    assert ends == largest(ORDINARY[0])
    # Half the square of a deviation, and t of four degrees of freedom has 8.6 in one of a thousand.
    assert largest(replace(ORDINARY[0], low=-1.0, high=2.0)) < 0.5 * 3.0**2 < 0.5 * 6.0**2 < ends


def test_dispersion_counts_errors_of_all_postures_alike(linear):
    found = replica_gains(None, null(), (), [EITHER_WAY])
    H = curvature_of(linear)
    assert H.shape == (6, 6)
    # Residuals of unit variance, as many modes as channels and lines allow: a slope's variance is
    # that of independent ones times the postures, within what a few modes of one draw make of it.
    assert found.dispersion == pytest.approx(POSTURES, rel=0.5)


@pytest.mark.usefixtures("linear")
def test_a_library_that_only_widens_priors_tells_of_no_errors():
    assert replica_gains(None, null(), (), [LOOSE]).dispersion == 0.0


@pytest.mark.usefixtures("linear")
def test_what_has_no_column_has_no_gains_and_disturbs_none():
    exchanged = Instance(effect=SimpleNamespace(name="exchanged"), place="test 1")
    found = replica_gains(None, null(), [exchanged], [EITHER_WAY, exchanged])
    alone = replica_gains(None, null(), (), [EITHER_WAY])
    assert found.instances == (EITHER_WAY,)
    np.testing.assert_array_equal(found.replicas, alone.replicas)


@pytest.mark.parametrize(
    "rival",
    [
        Instance(effect=SimpleNamespace(name="exchanged"), place="test 1"),
        replace(LOOSE, builder=lambda assembly, values: None),
    ],
)
def test_a_rival_without_parameters_is_part_of_what_its_replicas_are_drawn_of(
    monkeypatch, linear, rival
):
    """Points that were exchanged are no error of the model that knows it, nor how losses grow."""
    of_null = null()
    hypothesis = replace(of_null.hypothesis, instances=(rival,))
    best = made_fit(hypothesis, cost=1.0, space=of_null.space, u=np.zeros(len(of_null.space)))
    looked = []

    def seen(_stage, wide, space, _values):
        looked.append(wide.instances)
        return [replace(p, raw=p.raw[: len(space)], clean=p.clean[: len(space)]) for p in linear]

    monkeypatch.setattr(replicas, "sensitivities", seen)
    replica_gains(None, best, [rival], [EITHER_WAY])
    kept = next(instance for instance in looked[0] if instance.key == rival.key)
    assert kept.builder is rival.builder
    assert not kept.relaxes  # its own prior is what a replica has not
