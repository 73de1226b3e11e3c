"""A joint of a wrist believed rigid is not locked: its drive gives way."""

from armodal.hil_sim.makers.frame.drive_loss import DriveLoss
from armodal.hil_sim.makers.frame.everyday import Everyday
from armodal.hil_sim.makers.frame.kit import Hidden, Kit

WRIST = "rigid"  # the only one with such a joint
RANGE = (0.015, 80.0)  # compliance over the softest drive's
LOSS = (0.018, 0.13)


def where(drawn: Everyday) -> list[str]:
    """The joints of a rigid wrist; none where all are elastic."""
    return [row.joint for row in drawn.table.links if row.joint not in drawn.elastic]


def hide(kit: Kit, place: str, size: float) -> Hidden:
    """Give the drive a stiffness that nobody believes in."""
    drive, loss = kit.parts.drives[place], float(kit.rng.uniform(*LOSS))
    drive.stiffness = 1.0 / (size * kit.softest())
    drive.law = DriveLoss(factor=loss).law(drive.stiffness)
    return {"stiffness_n_m_per_rad": drive.stiffness, "loss_factor": loss}
