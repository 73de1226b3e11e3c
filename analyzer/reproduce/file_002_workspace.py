"""File 002, section 6, Figs. 12 to 16: frequencies and damping over the workspace."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from armodal.analyzer.reproduce.records import Figure, Status, statement
from armodal.analyzer.workspace.batch import ArmBatch
from armodal.analyzer.workspace.maps import FrequencyMap, map_frequencies
from armodal.analyzer.workspace.meridian import meridian_plane
from armodal.analyzer.workspace.spectrum import ElasticJoints, elastic_joints, spectrum
from armodal.analyzer.workspace.study import WorkspaceStudy, study_workspace
from armodal.protocols.arm.records import Arm

__all__ = ["figures_12_13", "figures_14_16"]

Array = npt.NDArray[np.float64]

PAPER = "002"
LIKE = 0.25  # relative, of standard deviations called similar
BAND_HZ = 1.0  # of the ends of a band read from a figure
UPPER = 0.5  # of a frequency's range over the plane: the start of what is large
STRONG = 0.7  # rank correlation of what "rises" or "falls" over the plane


def figures_12_13(arm: Arm, n_postures: int) -> list[Figure]:
    """Statements on frequencies and damping over random postures (Figs. 12 and 13)."""
    elastic = elastic_joints(arm)
    all_four = study_workspace(arm, elastic, n_postures, still=(0, 5))
    two = study_workspace(arm, elastic, n_postures, still=(0, 3, 4, 5))
    f, damping = all_four.f_hz, all_four.damping_ratio
    relative, damping_relative = f.std / f.mean, damping.std / damping.mean
    table = "section 6, Figs. 12, 13"

    def said(item: str, holds: bool, number: str, if_not: str = "") -> Figure:
        return statement(
            PAPER,
            table,
            item,
            holds=holds,
            status=Status.PREDICTED,
            number=f"{number} ({n_postures:,} postures)",
            if_not=if_not,
        )

    low, high = f.mean - f.std, f.mean + f.std
    wrist = two.f_hz.std[3:5] / f.std[3:5]

    return [
        said(
            "frequencies of modes 2 and 3 vary most",
            bool(f.std[1:3].min() > np.delete(f.std, [1, 2]).max()),
            "standard deviations " + _list(f.std) + " Hz",
        ),
        said(
            "the first frequency varies mildly",
            bool(f.std[0] < f.std[1:3].min() and f.std[0] > f.std[3]),
            f"{f.mean[0]:.1f} ± {f.std[0]:.1f} Hz",
        ),
        said(
            "frequencies of modes 4 and 5 vary very little",
            bool(relative[3:5].max() < 0.05),
            "relative " + _list(100 * relative) + " %",
        ),
        said(
            "damping of modes 1-3 varies with the posture, with standard deviations comparable "
            "with the means; of modes 4 and 5 hardly",
            bool(damping_relative[:3].min() > 0.2 and damping_relative[3:5].max() < 0.1),
            "relative " + _list(100 * damping_relative) + " %",
        ),
        said(
            "joints 2 and 3 alone give similar standard deviations of modes 1 to 3",
            _similar(all_four, two),
            "frequencies "
            + _list(two.f_hz.std[:3])
            + " Hz with two joints, "
            + _list(f.std[:3])
            + " Hz with four",
        ),
        said(
            "joints 2 and 3 alone give similar standard deviations of modes 4 and 5",
            bool(np.abs(wrist - 1).max() < LIKE),
            "frequencies "
            + _list(two.f_hz.std[3:5])
            + " Hz with two joints, "
            + _list(f.std[3:5])
            + " Hz with four",
            "joints 4 and 5 make their own modes' small variation; at the height of the figure's "
            "bars both look like nothing",
        ),
        said(
            "wrist modes always lie above arm modes",
            bool(f.lowest[3] > f.highest[2]),
            f"mode 3 at most {f.highest[2]:.1f} Hz, mode 4 at least {f.lowest[3]:.1f} Hz",
        ),
        said(
            "the first two modes share a band that hardly overlaps the others'",
            bool(high[0] > low[1] and high[:2].max() < low[2:].min()),
            f"mean ± standard deviation {low[0]:.1f} to {high[0]:.1f} and {low[1]:.1f} to "
            f"{high[1]:.1f} Hz, the others from {low[2:].min():.1f} Hz",
        ),
        said(
            "that band is 15 to 30 Hz",
            bool(abs(low[:2].min() - 15) < BAND_HZ and abs(high[:2].max() - 30) < BAND_HZ),
            f"{low[:2].min():.1f} to {high[:2].max():.1f} Hz",
            "the paper's own Table 4 has a first mode of 12.9 Hz in validation 2, and 12.8 Hz is "
            "measured in test 1",
        ),
    ]


def _similar(a: WorkspaceStudy, b: WorkspaceStudy) -> bool:
    """Standard deviations of the first three modes, whose posture matters, within a quarter."""
    f = b.f_hz.std[:3] / a.f_hz.std[:3]
    damping = b.damping_ratio.std[:3] / a.damping_ratio.std[:3]
    return bool(np.abs(np.concatenate([f, damping]) - 1).max() < LIKE)


def figures_14_16(arm: Arm) -> list[Figure]:
    """Statements on the maps over the wrist's position (Figs. 14 to 16)."""
    found = map_frequencies(arm, elastic_joints(arm))
    plane = meridian_plane(arm)
    h, v = np.meshgrid(found.horizontal_m, found.vertical_m)
    from_base = np.hypot(h, v - plane.shoulder_m.imag)
    figures = [_opposite_effects(arm)]
    for elbow, name in enumerate(("up", "down")):
        reached = np.isfinite(found.f_hz[elbow, ..., 0])
        f = found.f_hz[elbow][reached]
        away = from_base[reached]
        rank = _rank_correlation(away, f[:, 0])
        figures.append(
            statement(
                PAPER,
                "section 6, Fig. 14",
                f"frequency 1 falls with the wrist's distance from the base, elbow {name}",
                holds=rank < -STRONG,
                status=Status.PREDICTED,
                number=f"rank correlation {rank:+.2f} with the distance from joint 1's axis "
                "at the shoulder's height",
            )
        )
        figures += _second_and_third(found, elbow, name, h, v, reached, plane.reach_m)
    return figures


def _opposite_effects(arm: Arm) -> Figure:
    """The planar modes of joints 2 and 3 alone, over joint 3's range."""
    whole = elastic_joints(arm)
    planar = ElasticJoints(
        joints=(1, 2),
        stiffness_n_m_per_rad=whole.stiffness_n_m_per_rad[1:3],
        damping_n_m_s_per_rad=whole.damping_n_m_s_per_rad[1:3],
    )
    q = np.zeros((721, len(arm.joints)))
    q[:, 2] = np.linspace(*arm.joints[2].range_rad, 721)
    f = spectrum(ArmBatch(arm), q, planar).f_hz
    bent = _bent_deg(np.rad2deg(q[:, 2]))
    lower, upper = (_rank_correlation(bent, f[:, i]) for i in range(2))
    each_other = _rank_correlation(f[:, 0], f[:, 1])
    return statement(
        PAPER,
        "section 6",
        "q3 has opposite effects on the two modes in the meridian plane, of joints 2 and 3",
        holds=each_other < -STRONG and lower > 0.0 > upper,
        status=Status.PREDICTED,
        number=f"with joints 2 and 3 alone, rank correlation {each_other:+.2f} of the two "
        f"frequencies over q3; {lower:+.2f} and {upper:+.2f} with the angle away from 90°",
    )


def _bent_deg(q3_deg: Array) -> Array:
    """How far joint 3 is from the stretched arm, which has it at 90 degrees."""
    return np.asarray(np.abs(np.mod(q3_deg - 90 + 180, 360) - 180))


def _second_and_third(
    found: FrequencyMap, elbow: int, name: str, h: Array, v: Array, reached: Array, reach_m: float
) -> list[Figure]:
    f = found.f_hz[elbow]
    low = _place(int(np.nanargmin(f[..., 1])), h)
    high = _place(int(np.nanargmax(f[..., 1])), h)
    q3 = np.rad2deg(found.joints_rad[elbow][..., 2])
    bent = _bent_deg(q3[reached])
    stretched = _rank_correlation(bent, f[..., 2][reached])
    large = np.ones(reached.shape, dtype=bool)
    for mode in (1, 2):
        with np.errstate(invalid="ignore"):
            large &= f[..., mode] > np.nanmin(f[..., mode]) + UPPER * np.ptp(f[..., mode][reached])
    part = float(large.sum() / reached.sum())
    above = float(np.mean(v[large] > found.vertical_m.mean())) if large.any() else 1.0
    return [
        statement(
            PAPER,
            "section 6, Fig. 15",
            f"frequency 2 is lowest stretched to the front or back, elbow {name}",
            holds=bool(np.hypot(h[low], v[low] - found.vertical_m.mean()) > 0.8 * reach_m),
            status=Status.PREDICTED,
            number=f"{f[..., 1][low]:.1f} Hz with the wrist at ({h[low]:.2f}, {v[low]:.2f}) m, "
            f"q3 = {q3[low]:.0f}°",
        ),
        statement(
            PAPER,
            "section 6, Fig. 15",
            f"frequency 2 is highest with the wrist above the base, elbow {name}",
            holds=bool(v[high] > found.vertical_m.mean() and abs(h[high]) < 0.4 * reach_m),
            status=Status.PREDICTED,
            number=f"{f[..., 1][high]:.1f} Hz with the wrist at ({h[high]:.2f}, {v[high]:.2f}) m",
        ),
        statement(
            PAPER,
            "section 6, Fig. 16",
            f"frequency 3 rises as links 2 and 3 align (q3 near 90°), elbow {name}",
            holds=stretched < -STRONG,
            status=Status.PREDICTED,
            number=f"rank correlation {stretched:+.2f} with the angle away from 90°; above the "
            "base joint 1's mode passes the others and breaks the order",
        ),
        statement(
            PAPER,
            "section 6",
            f"frequencies 2 and 3 are both large only in a limited region above, elbow {name}",
            holds=part < 0.2 and above > 0.8,
            status=Status.PREDICTED,
            number=f"both in the upper half of their ranges over {100 * part:.1f} % of the plane's "
            f"reach, {100 * above:.0f} % of it above the shoulder",
        ),
    ]


def _place(flat: int, grid: Array) -> tuple[int, int]:
    return flat // grid.shape[1], flat % grid.shape[1]


def _rank_correlation(a: Array, b: Array) -> float:
    ranks = np.stack([np.argsort(np.argsort(values)) for values in (a, b)])
    return float(np.asarray(np.corrcoef(ranks))[0, 1])


def _list(values: Array) -> str:
    return ", ".join(f"{value:.1f}" for value in values)
