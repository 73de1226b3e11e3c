"""A gas spring beside the second joint: stiffness along its line, force across it."""

from collections.abc import Callable

import numpy as np

from armodal.hil_sim.makers.arm_table import Array, rotation
from armodal.hil_sim.makers.frame.everyday import Everyday
from armodal.hil_sim.makers.frame.kit import Hidden, Kit
from armodal.hil_sim.makers.frame.standing import Standing, middle_of

RANGE = (0.004, 1.5)  # stiffness about the joint over the drive's
EYE = (0.25, 0.65)  # of the link's line
FORCE = (0.02, 0.25)  # over stiffness times length


def where(drawn: Everyday) -> list[str]:
    """The second joint."""
    return [drawn.elastic[1]]


def hide(kit: Kit, place: str, size: float) -> Hidden:
    """Span a bar with a force in it from the link before to the link that the joint moves."""
    rows = kit.drawn.table.links
    row = kit.row(place)
    parent = rows[rows.index(row) - 1].link
    eye = middle_of(row, float(kit.rng.uniform(*EYE)))
    lever = float(np.linalg.norm(eye))
    anchor = np.array(row.xyz_m) + lever * kit.rng.uniform(0.65, 1.1) * kit.anywhere()
    levers = eye, rotation(row.rpy_rad).T @ (anchor - np.array(row.xyz_m))
    stiffness = size * kit.parts.drives[place].stiffness / lever**2
    strain = float(kit.rng.uniform(*FORCE))

    kit.parts.last.append(pulled((parent, anchor), (row.link, eye), stiffness, strain))
    return {
        "stiffness_n_per_m": stiffness,
        "anchor_m": anchor.tolist(),
        "eye_m": np.asarray(eye).tolist(),
        "shorter_lever_m": min(float(np.hypot(x, y)) for x, y, _ in levers),
        "pull_over_stiffness_times_length": strain,
    }


def pulled(
    first: tuple[str, Array], second: tuple[str, Array], stiffness: float, strain: float
) -> Callable[[Standing], None]:
    """Return what spans a spring, that pulls by a part of stiffness times length, between places.

    Each end is a link and a place in its frame.
    """

    def span(standing: Standing) -> None:
        ends = standing.place(*first), standing.place(*second)
        line = ends[1] - ends[0]
        length = float(np.linalg.norm(line))
        along = np.outer(line, line) / length**2
        # Along its line the spring; across, its force over its length (Przemieniecki, eq. 15.28),
        # which pulls steadily at what its ends sit on.
        block = stiffness * along + stiffness * strain * (np.eye(3) - along)
        six = np.zeros((6, 6))
        six[:3, :3] = block
        spots = standing.spot(*first), standing.spot(*second)
        standing.structure.spring(*spots, six)
        pull = stiffness * strain * line
        standing.structure.pulls += [(spots[0], pull), (spots[1], -pull)]

    return span
