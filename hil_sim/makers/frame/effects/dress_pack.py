"""A cable over the outside of the arm, as soft beams with their mass."""

from itertools import pairwise

import numpy as np

from armodal.hil_sim.makers.frame.beams import Section
from armodal.hil_sim.makers.frame.everyday import Everyday
from armodal.hil_sim.makers.frame.kit import Hidden, Kit
from armodal.hil_sim.makers.frame.standing import Standing, middle_of

OUTSIDE = True  # a gap analysis has no name for it
RANGE = (0.001, 0.4)  # of the moving mass
SAG = (0.1, 0.35)  # of the span
THICK = 0.3  # diameter over that of the shell it begins on
SOFT_PA = (2e6, 6e7)  # modulus of a bundle of hoses
LOSS = 0.17
PIECES = 6


def where(drawn: Everyday) -> list[str]:
    """From the second link to one of the wrist."""
    rows = drawn.table.links
    return [f"{rows[1].link}|{row.link}" for row in rows[-3:]]


def hide(kit: Kit, place: str, size: float) -> Hidden:
    """Hang the cable in a bow between two clamps."""
    first, last = place.split("|")
    mass = size * kit.arm_kg()
    thick = THICK * kit.row(first).shell.diameter_m
    sag, soft = float(kit.rng.uniform(*SAG)), float(kit.rng.uniform(*SOFT_PA))
    ends = [
        middle_of(kit.row(name), float(kit.rng.uniform(0.3, 0.8)))
        + 0.5 * kit.row(name).shell.diameter_m * kit.anywhere()
        for name in (first, last)
    ]

    def span(standing: Standing) -> None:
        a, b = standing.place(first, ends[0]), standing.place(last, ends[1])
        along = np.linspace(0.0, 1.0, PIECES + 1)[:, None]
        drop = sag * np.linalg.norm(b - a) * 4.0 * along * (1.0 - along)
        bow = a + (b - a) * along + drop * np.array([0.0, 0.0, -1.0])
        steps = np.linalg.norm(np.diff(bow, axis=0), axis=1)
        area = np.pi * thick**2 / 4.0
        second = np.pi * thick**4 / 64.0
        section = Section(
            area_m2=area,
            second_moments_m4=(second, second),
            torsion_m4=2.0 * second,
            shear_area_m2=0.89 * area,
            youngs_pa=soft,
            density_kg_m3=mass / (area * float(np.sum(steps))),
        )
        structure = standing.structure
        nodes = [structure.node(bow[i]) for i in range(PIECES + 1)]
        for i, j in pairwise(nodes):
            structure.beam(section, i, j, LOSS)
        for node, link, at in ((nodes[0], first, ends[0]), (nodes[-1], last, ends[1])):
            held = standing.spot(link, at), structure.spot_at(node, structure.nodes[node])
            structure.spring(*held, np.diag([1e7] * 3 + [1e4] * 3))

    kit.parts.last.append(span)
    return {"mass_kg": mass, "diameter_m": thick, "sag": sag, "modulus_pa": soft}
