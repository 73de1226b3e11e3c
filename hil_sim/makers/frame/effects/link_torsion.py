"""A shell that twists more than its section should."""

from dataclasses import replace

from armodal.hil_sim.makers.arms import arms_with
from armodal.hil_sim.makers.frame.everyday import Everyday
from armodal.hil_sim.makers.frame.kit import Hidden, Kit, stiffer_at_told

RANGE = (1.5, 2000.0)  # times as soft as the section
ARMS = arms_with(lambda table: table.twisting_links)


def where(drawn: Everyday) -> list[str]:
    """One of the long links that turn at neither end about their own line."""
    return list(drawn.table.twisting_links)


def hide(kit: Kit, place: str, size: float) -> Hidden:
    """Thin the section against torsion."""
    section = kit.parts.sections[place]
    thinned = replace(section, torsion_m4=section.torsion_m4 / size)
    kit.parts.sections[place] = thinned
    felt = stiffer_at_told(kit.parts.beam_loss)
    return {"torsional_stiffness_n_m2": felt * thinned.shear_pa * thinned.torsion_m4}
