"""A shell that bends more than its section should."""

from dataclasses import replace

from armodal.hil_sim.makers.frame.everyday import Everyday
from armodal.hil_sim.makers.frame.kit import Hidden, Kit, stiffer_at_told

RANGE = (1.6, 2000.0)  # times as soft as the section


def where(drawn: Everyday) -> list[str]:
    """One of the long links."""
    return list(drawn.table.long_links)


def hide(kit: Kit, place: str, size: float) -> Hidden:
    """Thin the section's stiffness, not its mass."""
    section = kit.parts.sections[place]
    bending = section.youngs_pa * section.mean_moment_m4 / size
    twisting = section.shear_pa * section.torsion_m4
    first, second = section.second_moments_m4
    kit.parts.sections[place] = replace(section, second_moments_m4=(first / size, second / size))
    felt = stiffer_at_told(kit.parts.beam_loss)
    return {"bending_stiffness_n_m2": felt * bending, "torsional_stiffness_n_m2": felt * twisting}
