"""A footing that gives way in all six ways."""

import numpy as np

from armodal.hil_sim.makers.frame.everyday import Everyday
from armodal.hil_sim.makers.frame.kit import Hidden, Kit, law_at_told, stiffer_at_told
from armodal.hil_sim.makers.frame.parts import Parts
from armodal.hil_sim.makers.frame.standing import stand

RANGE = (0.004, 3.0)  # rocking compliance over the softest drive's
ASKEW = (0.45, 1.0)  # stiffness of the other rocking
YAW = (1.2, 5.0)
FEET = (0.35, 1.0)  # root of rocking over shift stiffness, over the base's diameter
LOSS = (0.018, 0.14)


def where(drawn: Everyday) -> list[str]:
    """There is one."""
    del drawn
    return ["base"]


def hide(kit: Kit, place: str, size: float) -> Hidden:
    """Put the plate on softer springs, turned about the vertical.

    Told is how all below the first joint turns, its casting too: no measurement tells those apart.
    """
    del place
    rock = 1.0 / (size * kit.softest())
    other, yaw = rock * kit.rng.uniform(*ASKEW), rock * kit.rng.uniform(*YAW)
    shift = rock / (kit.drawn.table.base_shell.diameter_m * kit.rng.uniform(*FEET)) ** 2
    turn, loss = kit.rng.uniform(0.0, np.pi), float(kit.rng.uniform(*LOSS))
    R = np.eye(3)
    R[:2, :2] = [[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]]
    plate = np.zeros((6, 6))
    plate[:3, :3] = np.diag([shift, shift, 1.5 * shift])
    plate[3:, 3:] = R @ np.diag([rock, other, yaw]) @ R.T
    kit.parts.plate, kit.parts.plate_loss = plate, loss
    upright = stand(kit.parts, np.zeros(len(kit.parts.bodies)))
    felt = np.linalg.inv(upright.turns_before(next(iter(kit.parts.drives)), law_at_told()))
    return {
        "rock_x_n_m_per_rad": float(felt[0, 0]),
        "rock_y_n_m_per_rad": float(felt[1, 1]),
        "rock_xy_n_m_per_rad": float(felt[0, 1]),
        "turn_n_m_per_rad": float(felt[2, 2]),
        "shift_n_per_m": float(plate[0, 0]) * stiffer_at_told(loss),
        "base_mass_kg": kit.drawn.table.base.mass_kg + _shell_kg(kit.parts),
        "loss_factor": loss,
    }


def _shell_kg(parts: Parts) -> float:
    """Mass of the base's shell."""
    section, path = parts.sections["base"], np.array(parts.table.base_shell.path)
    length = float(np.sum(np.linalg.norm(np.diff(path, axis=0), axis=1)))
    return section.density_kg_m3 * section.area_m2 * length
