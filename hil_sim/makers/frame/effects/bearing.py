"""A main bearing that tilts: softer than everyday about both axes across a joint's."""

from armodal.hil_sim.makers.frame.everyday import Everyday
from armodal.hil_sim.makers.frame.kit import Hidden, Kit, stiffer_at_told

RANGE = (0.015, 5.0)  # tilt compliance over the drive's
LOSS = (0.018, 0.13)  # loss factor


def where(drawn: Everyday) -> list[str]:
    """One of the first three joints."""
    return list(drawn.elastic[:3])


def hide(kit: Kit, place: str, size: float) -> Hidden:
    """Soften the tilt, alike both ways."""
    drive, loss = kit.parts.drives[place], float(kit.rng.uniform(*LOSS))
    tilt = drive.stiffness / size
    drive.tilt, drive.tilt_loss = (tilt, tilt), loss
    drive.shift_n_per_m = max(drive.shift_n_per_m, tilt / 0.01)
    felt = tilt * stiffer_at_told(loss)
    return {"compliance_rad_per_n_m": 1.0 / felt, "loss_factor": loss}
