"""Mass matrices and modes of many postures beside the loops a user would write, one core.

Prints times a posture and their ratios, and the memory at two sizes.
"""

import resource
import time

import numpy as np
import pinocchio as pin
import scipy.linalg

from armodal.analyzer.workspace.batch import ArmBatch
from armodal.analyzer.workspace.moments import moments_of
from armodal.analyzer.workspace.postures import CHUNK, random_postures
from armodal.analyzer.workspace.spectrum import elastic_joints, spectrum
from armodal.analyzer.workspace.study import study_workspace
from armodal.protocols.arm.files import load_arm
from armodal.protocols.arm.records import Arm

N = 1_000_000
N_LOOP = 50_000


def pinocchio_model(arm: Arm) -> pin.Model:
    model, parent = pin.Model(), 0
    for joint in arm.joints:
        T = joint.T_parent_joint
        parent = model.addJoint(
            parent,
            pin.JointModelRevoluteUnaligned(joint.axis),
            pin.SE3(T[:3, :3], T[:3, 3]),
            joint.name,
        )
        inertia = pin.Inertia(joint.link.mass_kg, joint.link.center_m, joint.link.inertia_kg_m2)
        model.appendBodyToJoint(parent, inertia, pin.SE3.Identity())
    return model


def main() -> None:
    arm = load_arm("viper_s650")
    elastic = elastic_joints(arm)
    chosen = np.ix_(elastic.joints, elastic.joints)
    K = np.diag(elastic.stiffness_n_m_per_rad)
    Q = random_postures(arm, N, np.random.default_rng(0))
    batch, model = ArmBatch(arm), pinocchio_model(arm)
    data = model.createData()

    began = time.perf_counter()
    for i in range(N):
        pin.crba(model, data, Q[i])
    loop_mass = (time.perf_counter() - began) / N

    began = time.perf_counter()
    total = None
    for first in range(0, N, CHUNK):
        part = moments_of(np.abs(batch.mass(Q[first : first + CHUNK])), axis=2)
        total = part if total is None else total.joined(part)
    ours_mass = (time.perf_counter() - began) / N
    print(
        f"mass matrices with statistics {1e6 * ours_mass:.2f} us a posture, crba loop without "
        f"{1e6 * loop_mass:.2f} us: ratio {ours_mass / loop_mass:.2f}, at most 1.5 wanted"
    )

    began = time.perf_counter()
    for i in range(N_LOOP):
        M = pin.crba(model, data, Q[i])[chosen]
        scipy.linalg.eigh(K, np.triu(M) + np.triu(M, 1).T)
    loop_modes = (time.perf_counter() - began) / N_LOOP

    began = time.perf_counter()
    for first in range(0, N, CHUNK):
        spectrum(batch, Q[first : first + CHUNK], elastic)
    ours_modes = (time.perf_counter() - began) / N
    print(
        f"frequencies, damping, shapes of {len(elastic.joints)} joints {1e6 * ours_modes:.2f} us "
        f"a posture, 10 wanted; crba + eigh loop {1e6 * loop_modes:.2f} us: "
        f"{loop_modes / ours_modes:.1f} times faster, 4 wanted"
    )

    for n in (N // 10, N, 4 * N):
        began = time.perf_counter()
        study_workspace(arm, elastic, n)
        peak_mb = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
        print(f"{n:>9,} postures: {time.perf_counter() - began:6.1f} s, peak {peak_mb:.0f} MB")


if __name__ == "__main__":
    main()
