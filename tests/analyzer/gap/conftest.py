import numpy as np
import pytest
from support.bench_effects import JOINTS

from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.gap.model.lines import PostureLines
from armodal.analyzer.gap.model.ordinary import Ordinary
from armodal.analyzer.gap.model.posed import PosedModel
from armodal.protocols.arm.files import load_arm


@pytest.fixture(scope="session")
def superset():
    """Of bench57."""
    return Superset(load_arm("bench57"))


@pytest.fixture(scope="session")
def ordinary(superset):
    return Ordinary(superset=superset, postures=("p",))


@pytest.fixture(scope="session")
def lines(superset):
    n_points = len(superset.arm.points)
    s = 2 * np.pi * (2.0 + 1j * np.array([8.0, 13.0, 31.0, 64.0, 110.0]))
    return PostureLines(
        name="p",
        joints_rad=JOINTS,
        s_rad_s=s,
        sensor_point=np.arange(n_points),
        hit=np.zeros(n_points, dtype=int),
        hit_point=np.array([0]),
        hit_direction=np.array([[-0.45, -0.62, -0.6427]]),
        values=np.ones((n_points, 3, s.size), dtype=complex),
        variance=np.ones((n_points, 3, s.size)),
        sensor_mass_kg=0.0093,
    )


@pytest.fixture(scope="module")
def posed(superset):
    return PosedModel(superset, JOINTS)
