"""The FANUC R-2000iC of Liu et al. 2026: what their published parameters tell of their table.

D. Liu, B. Feng, Q. Gu, S. Liu, M. Li, S. Jin, "Stiffness-inertia dynamic synergy for breakthrough
surge suppression in high-speed robotic drilling", Shanghai Jiao Tong University, 2026: DH rows,
inertials, six identified joint stiffnesses and eight trials of drilling in four postures.

When the drill breaks through, the energy F²c/2 that its thrust has stored along the feed becomes
velocity of the mass m that the arm has there: v² = eta² (F² c/m + v_feed²).
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from armodal.analyzer.reproduce.records import Figure, Status, compared, not_derivable, statement
from armodal.analyzer.workspace.batch import ArmBatch
from armodal.protocols.arm.records import Arm

__all__ = ["axial", "figures_fanuc", "model_angles"]

Array = npt.NDArray[np.float64]

PAPER = "003"
TABLE = "validation trials"
K = (9.339417645e5, 4.129256136e6, 1.907534091e6, 2.332046026e5, 4.043588275e5, 7.961815940e4)
TIP_M = (0.0069, 0.2453, 0.3193)  # in the flange's frame
FEED_AXIS = (0.0, 1.0, 0.0)  # the flange's axis that the drill points along
ETA = 0.3845
SET_N = 500.0  # the thrust that their search of postures is set to
# Pendant angles, degrees; then of each trial v_feed, v_surge measured, "theory^2", v_surge by
# theory, mm/s and mm²/s².
TRIALS = (
    (
        (-91.294, 34.275, -23.321, 180.0, 66.693, -268.709),
        ((10.37, 18.31, 2770.813006, 20.62852321), (20.95, 52.2, 5477.947643, 29.57614925)),
    ),
    (
        (-102.968, 18.194, -29.414, 180.002, 60.594, 12.97),
        ((8.37, 57.38, 17160.07149, 50.47084791), (21.8, 85.32, 31857.00054, 69.13759125)),
    ),
    (
        (-100.2, 44.586, -17.223, 180.001, 72.782, 10.206),
        ((7.56, 49.61, 16455.79135, 49.40928971), (9.71, 55.22, 23818.20625, 59.45778798)),
    ),
    (
        (-97.91, 31.218, -24.525, 179.968, 65.487, -307.7),
        ((9.09, 32.72, 7034.647701, 32.43793819), (15.15, 53.18, 15146.27422, 47.67768483)),
    ),
)
MEAN_THEORY = 44.849477
ROUNDING = 2e-3  # mm/s: feeds of two decimals, eta of four


def figures_fanuc(arm: Arm) -> list[Figure]:
    """Every figure that the print lets derive, and what it does not.

    Parameters
    ----------
    arm
        With their DH rows and inertials.
    """
    theory, measured, thrusts, level = [], [], [], []
    figures = []
    for posture_deg, trials in TRIALS:
        compliance, mass, feed = axial(arm, posture_deg)
        level.append(abs(float(feed[2])))
        for v_feed, v_surge, squared, v_theory in trials:
            ours = ETA * float(np.sqrt(squared + v_feed**2))
            theory.append(ours)
            measured.append((v_surge, ours / ETA))
            thrusts.append(1e-3 * float(np.sqrt(squared * mass / compliance)))
            figures.append(
                compared(
                    PAPER,
                    TABLE,
                    f"surge velocity by theory, trial {len(theory)}",
                    "mm/s",
                    published=v_theory,
                    ours=ours,
                    margin=ROUNDING,
                    status=Status.RECOMPUTED,
                    why="rounding of the feed and of eta",
                )
            )
    v, root = np.array(measured).T
    fitted = float(v @ root / (root @ root))
    pairs = list(zip(thrusts[::2], thrusts[1::2], strict=True))
    span = f"{min(thrusts):.0f} to {max(thrusts):.0f} N"
    return [
        *figures,
        compared(
            PAPER,
            "damping sensitivity",
            "mean surge velocity by theory",
            "mm/s",
            published=MEAN_THEORY,
            ours=float(np.mean(theory)),
            margin=ROUNDING,
            status=Status.RECOMPUTED,
            why="rounding of the feed and of eta",
        ),
        statement(
            PAPER,
            TABLE,
            "the drill's axis is level in the four postures",
            holds=max(level) < 1e-2,
            status=Status.GEOMETRY,
            number=f"off by at most {np.degrees(np.arcsin(max(level))):.2f} degrees; not said in "
            "print: a check of its DH rows and angles",
        ),
        statement(
            PAPER,
            TABLE,
            "in each posture the faster feed has the greater thrust",
            holds=all(slow < fast for slow, fast in pairs),
            status=Status.RECOMPUTED,
            number=f"F² c/m of one posture, c and m alike: {span}",
        ),
        not_derivable(
            PAPER,
            TABLE,
            "thrust of every trial",
            "8 figures behind theory^2",
            f"not printed; with the printed masses and stiffnesses they are {span}, where the "
            f"search of postures is set to {SET_N:g} N",
        ),
        not_derivable(
            PAPER,
            "damping sensitivity",
            "eta of the velocities",
            ETA,
            f"fitted to other data: least squares of the eight printed trials gives {fitted:.3f}",
        ),
        not_derivable(
            PAPER,
            "joint stiffness",
            "k of the six joints",
            "6 figures",
            "the place on the tool that was pulled at is not printed; with the drill's tip in its "
            "place the 43 published deflections give joints 1, 3, 5 within 8 %, joint 2 by -31 %, "
            "joint 4 by +20 %, joint 6 3.5 times as stiff (bench/bench_published_statics.py)",
        ),
        not_derivable(
            PAPER,
            TABLE,
            "surge velocities measured",
            "8 figures",
            "measured on the real arm; the measurement is not printed",
        ),
    ]


def model_angles(pendant_rad: npt.ArrayLike) -> Array:
    """Joint angles of the DH rows from the pendant's, (..., 6) rad.

    The pendant's third angle is the forearm's to the horizontal, and joints 3 to 6 count the other
    way.
    """
    q = np.array(pendant_rad, dtype=np.float64)
    q[..., 2] += q[..., 1]
    q[..., 2:] *= -1.0
    return q


def axial(arm: Arm, pendant_deg: npt.ArrayLike) -> tuple[float, float, Array]:
    """Compliance and mass at the drill's tip along its feed, in one posture.

    Returns
    -------
    compliance_m_per_n, mass_kg : float
        The mass is that of the tip where it may move along the feed alone: of the inverse of
        J M⁻¹ Jᵀ, as theirs.
    feed : (3,) unit, base frame
    """
    q = model_angles(np.deg2rad(pendant_deg))[None]
    batch = ArmBatch(arm)
    J = batch.unit_motions(q, TIP_M)[0][:, :, 0]
    M = batch.mass(q)[:, :, 0]
    feed = _flange_axis(batch, q)
    compliance = J[:3] @ np.diag(1.0 / np.array(K)) @ J[:3].T
    mass = np.linalg.inv(J @ np.linalg.solve(M, J.T))[:3, :3]
    return float(feed @ compliance @ feed), float(feed @ mass @ feed), feed


def _flange_axis(batch: ArmBatch, q: Array) -> Array:
    last = len(batch.arm.joints) - 1
    ends = [batch.position(q, last, place)[:, 0] for place in (FEED_AXIS, (0.0, 0.0, 0.0))]
    return np.asarray(ends[0] - ends[1])
