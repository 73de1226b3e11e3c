"""The ordinary errors of a case are as large as docs/gap-cases.md says."""

import math
from functools import cache

import numpy as np
import pytest
from scipy.stats import norm

from armodal.hil_sim.plant import load_plant
from armodal.hil_sim.study import plant_of_arm, study_arm
from armodal.hil_sim.study.model_error import erring_plant_tables
from armodal.hil_sim.study.plant_of_arm import plant_file_of_arm

SEEDS = 200
VISCOUS = 0.8  # of the arm file's damping; the rest is hysteretic
SHEAR = 0.02  # of each element by which an inertia's axes are turned and stretched


def left_by_cut(bound):
    """Standard deviation of a standard normal number moved to +-bound where it is beyond.

    The integral of x^2 within the bound by parts, and bound^2 times the two tails.
    """
    tails = 2.0 * norm.sf(bound)
    return math.sqrt(1.0 - tails - 2.0 * bound * norm.pdf(bound) + bound**2 * tails)


def spread_of(link):
    """Second moments of a link's body about its centre, (3, 3)."""
    inertia = np.zeros((3, 3))
    inertia[np.triu_indices(3)] = link["inertia_kg_m2"]
    inertia = inertia + np.triu(inertia, 1).T
    return 0.5 * np.trace(inertia) * np.eye(3) - inertia


def effects_of(tables, kind):
    return [effect for effect in tables["effects"] if effect["kind"] == kind]


@pytest.fixture(scope="module")
def monkeypatch_module():
    with pytest.MonkeyPatch.context() as patch:
        yield patch


@pytest.fixture(scope="module", params=[SEEDS // 4, pytest.param(SEEDS, marks=pytest.mark.long)])
def errors(monkeypatch_module, request):
    """Every deviation from the arm file, over its own standard deviation where that is a link's."""
    # The pattern of every plant is one file: read once, not once a seed.
    monkeypatch_module.setattr(plant_of_arm, "load_plant", cache(load_plant))
    study = study_arm("bench57")
    joints = study.arm.joints
    k = [j.stiffness.value if j.stiffness else None for j in joints]
    c = [j.damping.value if j.damping else None for j in joints]
    believed = plant_file_of_arm(study.arm, k, c, peak_n=study.peak_n).model_dump()
    found = {name: [] for name in FIGURES}
    for seed in range(request.param):
        tables = erring_plant_tables(study, seed)
        for true, file in zip(tables["links"], believed["links"], strict=True):
            if file["stiffness_n_m_per_rad"] is not None:
                ratio = true["stiffness_n_m_per_rad"] / file["stiffness_n_m_per_rad"]
                found["stiffness"].append(np.log(ratio))
                ratio = true["damping_n_m_s_per_rad"] / file["damping_n_m_s_per_rad"]
                found["damping"].append(np.log(ratio / VISCOUS))
            found["mass"].append(true["mass_kg"] / file["mass_kg"] - 1.0)
            found["centre_m"].extend(np.subtract(true["center_m"], file["center_m"]))
            S = spread_of(file)
            # To first order tr((1 + e)(1 + B) S (1 + B)^T) / tr S = 1 + e + 2 tr(B S) / tr S.
            shear = 2.0 * SHEAR * np.linalg.norm(S) / np.trace(S)
            own = math.hypot(FIGURES["inertia"][0], shear) / FIGURES["inertia"][0]
            found["inertia"].append((np.trace(spread_of(true)) / np.trace(S) - 1.0) / own)
        gains = np.array(tables["accelerometer"]["response"]) - np.eye(3)
        found["gain"].extend(np.diag(gains))
        found["cross_talk"].extend(gains[~np.eye(3, dtype=bool)])
        found["hammer"].append(tables["hammer"]["gain_error"])
        found["encoder_deg"].extend(e["offset_deg"] for e in effects_of(tables, "encoder_offset"))
        (late,) = effects_of(tables, "delay")
        found["skew_s"].append(late["delay_s"] * (1 if late["channels"] == ("hammer",) else -1))
    return found


# Figure of the document, and the deviations at which it is cut.
FIGURES = {
    "stiffness": (0.15, 2.0),
    "damping": (0.25, 2.0),
    "mass": (0.05, 2.0),
    "centre_m": (0.003, 2.5),
    "inertia": (0.05, 2.5),
    # A direct gain has the cross talk's error as well.
    "gain": (math.hypot(0.01, 0.003), 2.5),
    "cross_talk": (0.003, 2.5),
    "hammer": (0.01, 2.5),
    "encoder_deg": (0.15, 2.5),
    "skew_s": (10e-6, 2.5),
}


@pytest.mark.parametrize("name", FIGURES)
def test_an_error_scatters_as_the_document_says(errors, name):
    figure, bound = FIGURES[name]
    scatter = math.sqrt(np.mean(np.square(errors[name])))
    # Four standard deviations of the root mean square of n normal numbers; cut ones scatter less.
    tolerance = 4.0 / math.sqrt(2.0 * len(errors[name]))
    assert scatter == pytest.approx(figure * left_by_cut(bound), rel=tolerance)


def test_the_cut_of_a_normal_number_takes_what_drawing_says():
    drawn = np.clip(np.random.default_rng(1).standard_normal(100_000), -2.0, 2.0)
    # Four standard deviations, 4 / sqrt(2 n).
    assert drawn.std() == pytest.approx(left_by_cut(2.0), rel=4.0 / math.sqrt(2e5))
