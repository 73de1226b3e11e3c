"""Where a corrected arm chatters while it mills: lobes with a band, and a map over feeds."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from armodal.analyzer.acting.cutting import Cutter
from armodal.analyzer.acting.lobes import limit_of_depth, lobes
from armodal.analyzer.acting.semi_discretisation import ToolModes, depth_limit
from armodal.analyzer.arm.hysteresis import hysteresis
from armodal.analyzer.corrected.correction import Correction, stepped
from armodal.analyzer.corrected.modes import corrected_modes
from armodal.analyzer.corrected.posture import CorrectedPosture, corrected_posture, stand
from armodal.protocols.errors import ArmError

__all__ = ["LobeDiagram", "depth_map", "lobe_diagram", "tool_frame", "tool_frf"]

Array = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]

BELOW_HZ = 500.0  # modes of the arm that may chatter; a spindle's own are not in its model
_LINES = 2500
_STEPS = 80  # of a tooth's period, in the delayed equations
_DRAWS = 80  # of what the arm file leaves uncertain
_SEED = 0
_BAND = (0.025, 0.975)


@dataclass(frozen=True, slots=True, kw_only=True)
class LobeDiagram:
    """Deepest stable cuts in m at each speed; inf where no mode of the arm limits them."""

    speeds_rpm: Array  # (n,)
    depth_m: Array  # (n,) with the arm file's values
    low_m: Array  # (n,) and the ends of the 95 % band of its uncertainty
    high_m: Array  # (n,)
    always_m: float  # stable at any speed
    always_low_m: float
    checked_rpm: Array  # (k,) speeds at which the delayed equations were solved
    checked_m: Array  # (k,) deepest stable cuts by them


def tool_frame(feed: npt.ArrayLike, axis: npt.ArrayLike) -> Array:
    """Return (2, 3) directions of feed and normal, base frame, across the tool's axis.

    Raises
    ------
    ArmError
        If the feed lies along the axis, or one has no length.
    """
    along, spindle = (np.asarray(v, dtype=np.float64) for v in (feed, axis))
    if not np.linalg.norm(along) > 0.0 or not np.linalg.norm(spindle) > 0.0:
        raise ArmError("wanted a feed direction and a tool axis with a length, got zeros")
    spindle = spindle / np.linalg.norm(spindle)
    flat = along - spindle * (along @ spindle)
    if np.linalg.norm(flat) < 1e-3 * np.linalg.norm(along):
        raise ArmError(
            "wanted a feed across the tool's axis, got one along it; give --feed and --axis in base"
        )
    flat = flat / np.linalg.norm(flat)
    return np.stack([flat, np.cross(spindle, flat)])


def tool_frf(posture: CorrectedPosture, directions: Array, f_hz: Array) -> ComplexArray:
    """Return (n_lines, 2, 2) receptance of the tool in m/N, the work taken as rigid."""
    s = 2j * np.pi * f_hz
    Z = (
        (s**2)[:, None, None] * posture.mass
        + s[:, None, None] * posture.damping
        + posture.stiffness
        + hysteresis(s)[:, None, None] * posture.loss
    )
    J = directions @ posture.tool_jacobian[:3]
    return np.asarray(J @ np.linalg.solve(Z, np.broadcast_to(J.T, (len(s), *J.T.shape))))


def lobe_diagram(
    correction: Correction,
    joints_rad: Array,
    cutter: Cutter,
    speeds_rpm: Array,
    *,
    directions: Array,
    tool_m: npt.ArrayLike,
    n_checks: int = 3,
) -> LobeDiagram:
    """Stability lobes of a posture, with a band and a check by the delayed equations.

    Parameters
    ----------
    directions
        Of `tool_frame`.
    n_checks
        Speeds at which the delayed equations are solved too; modes with light damping are taken
        there, and no loss factor as such.
    """
    at = stand(correction, joints_rad)
    posture = corrected_posture(correction, at, tool_m=tool_m)
    modes = corrected_modes(posture, below_hz=BELOW_HZ)
    f_hz = np.linspace(0.3 * modes.f_hz[0], 1.4 * modes.f_hz[-1], _LINES)

    def limits(own: Correction) -> tuple[Array, float]:
        frf = tool_frf(corrected_posture(own, at, tool_m=tool_m), directions, f_hz)
        return lobes(cutter, frf, f_hz, speeds_rpm), limit_of_depth(cutter, frf)

    depth, always = limits(correction)
    drawn = [limits(own) for own in _draws(correction)]
    low, high = np.quantile(_finite([d for d, _ in drawn]), _BAND, axis=0)
    # At slow speeds many waves lie between two teeth, and single steps would not follow them.
    chosen = np.linspace(len(speeds_rpm) // 3, len(speeds_rpm) - 1, n_checks).astype(int)
    chosen = chosen[np.isfinite(depth[chosen])]
    shape = directions @ posture.tool_jacobian[:3] @ modes.shape.real
    tool = ToolModes(
        omega_rad_s=np.abs(modes.pole_rad_s), damping_ratio=modes.damping_ratio, shape=shape
    )
    return LobeDiagram(
        speeds_rpm=speeds_rpm,
        depth_m=depth,
        low_m=_open(low),
        high_m=_open(high),
        always_m=always,
        always_low_m=float(_open(np.quantile(_finite([[a] for _, a in drawn]), _BAND[0]))),
        checked_rpm=speeds_rpm[chosen],
        checked_m=np.array(
            [
                depth_limit(tool, cutter, speeds_rpm[i], 2.0 * depth[i], n_steps=_STEPS)
                for i in chosen
            ]
        ),
    )


def depth_map(
    correction: Correction,
    postures_rad: Array,
    cutter: Cutter,
    *,
    axis: npt.ArrayLike,
    tool_m: npt.ArrayLike,
    n_directions: int,
) -> tuple[Array, Array]:
    """Return feeds (n, 3) about the axis, and cuts (n_postures, n) stable at any speed."""
    spindle = np.asarray(axis, dtype=np.float64)
    across = np.eye(3)[int(np.argmin(np.abs(spindle)))]
    frame = tool_frame(across, spindle)
    angles = np.arange(n_directions) * 2.0 * np.pi / n_directions
    feeds = np.cos(angles)[:, None] * frame[0] + np.sin(angles)[:, None] * frame[1]
    found = np.empty((len(postures_rad), n_directions))
    for row, q in enumerate(postures_rad):
        posture = corrected_posture(correction, stand(correction, q), tool_m=tool_m)
        modes = corrected_modes(posture, below_hz=BELOW_HZ)
        f_hz = np.linspace(0.3 * modes.f_hz[0], 1.4 * modes.f_hz[-1], _LINES)
        whole = tool_frf(posture, np.eye(3), f_hz)
        for column, feed in enumerate(feeds):
            own = tool_frame(feed, spindle)
            found[row, column] = limit_of_depth(cutter, own @ whole @ own.T)
    return feeds, found


def _draws(correction: Correction) -> list[Correction]:
    """The arm as the file's deviations leave it; joints' springs and dampers as logarithms."""
    rng = np.random.default_rng(_SEED)
    names, stds = [], []
    for joint in correction.ordinary.arm.joints:
        for what, estimate in (("k", joint.stiffness), ("c", joint.damping)):
            if joint.stiffness is not None and estimate is not None and estimate.value > 0.0:
                names.append(f"ln {what} {joint.name}")
                # As wide as a Gaussian of that relative deviation, and never negative.
                stds.append(float(np.sqrt(np.log1p((estimate.std / estimate.value) ** 2))))
    logs = len(names)
    own = [(n, s) for n, _, s in correction.names if correction.values[n] > 0.0 and s > 0.0]
    found = []
    for _ in range(_DRAWS):
        steps = dict(zip(names, (rng.standard_normal(logs) * stds).tolist(), strict=True))
        for name, std in own:
            value = correction.values[name]
            wide = float(np.sqrt(np.log1p((std / value) ** 2)))
            steps[name] = value * float(np.expm1(wide * rng.standard_normal()))
        found.append(stepped(correction, steps))
    return found


_FAR_M = 1e3  # for inf, which has no quantiles


def _finite(values: list[Array] | list[list[float]]) -> Array:
    return np.minimum(np.array(values, dtype=np.float64), _FAR_M)


def _open(values: npt.ArrayLike) -> Array:
    array = np.asarray(values, dtype=np.float64)
    return np.where(array >= 0.5 * _FAR_M, np.inf, array)
