"""Measured modes beside the model's, wherever the sensor and the hammer were."""

from dataclasses import replace

import numpy as np
import pytest
from support.offline_lab import simulate_session

from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.gap.begin import ordinary_of
from armodal.analyzer.gap.inference.annealing import annealing_stages
from armodal.analyzer.gap.inference.compare import match_modes
from armodal.analyzer.gap.model.hypothesis import Hypothesis
from armodal.analyzer.identification.estimate import estimate_frfs
from armodal.analyzer.modal import fit_modes
from armodal.hil_sim.plant import load_plant


@pytest.mark.parametrize("plan", ["rv4frl-three-postures", "rv4frl-roving-hammer"])
def test_modes_are_paired_by_what_was_moved_from_point_to_point(plan):
    session = simulate_session(2, plan=plan)
    superset = Superset(session.header.arm)
    frfs = estimate_frfs(session, superset)
    (sharp,) = annealing_stages(superset, session, frfs, only=[3])
    present = Hypothesis(ordinary=ordinary_of((session,), superset, sharp.lines))
    space = present.space()
    values = space.values(space.start())
    joints = zip(superset.arm.joints, load_plant("rv4frl").truth.links, strict=True)
    values |= {
        f"ln k {joint.name}": np.log(link.stiffness_n_m_per_rad)
        for joint, link in joints
        if link.stiffness_n_m_per_rad
    }
    lines = sharp.lines[0]
    system = sharp.models[0].system(present, lines, values)
    points = [point.id for point in superset.arm.points]
    found = match_modes(fit_modes(frfs[0]), system, lines, points)
    # The arm has a hidden axis besides, which moves the joints' own modes little.
    assert len(found) == 3
    assert min(match.mac for match in found) > 0.9
    assert [m.model_hz for m in found] == pytest.approx([m.measured_hz for m in found], rel=0.02)
    # Records that fall by 2/s beside have modes with as much more decay.
    faded = match_modes(fit_modes(frfs[0]), replace(system, decay_rad_s=2.0), lines, points)
    for before, after in zip(found, faded, strict=True):
        decays = [2.0 * np.pi * m.model_hz * m.model_damping_ratio for m in (before, after)]
        assert decays[1] - decays[0] == pytest.approx(2.0)
