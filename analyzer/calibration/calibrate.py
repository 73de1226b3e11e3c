"""Inertias nearest to a belief that meet the targets, and what stays undetermined.

The most probable u of the belief (standard normal) and the targets (normal within their margins)
minimises |u|² + |pulls(u)|²; about it the distribution is normal with covariance
(JᵀJ + I)⁻¹, J the slope of the pulls. A number whose standard deviation stays near the belief's
one was not determined by any target.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import scipy

from armodal.analyzer.calibration.bodies import N_NUMBERS, BelievedBody, moved_body
from armodal.analyzer.calibration.targets import Target
from armodal.analyzer.workspace.batch import ArmBatch
from armodal.protocols.arm.records import Arm, InertialLink
from armodal.protocols.errors import EstimateError

__all__ = ["Calibration", "calibrate_inertia"]

Array = npt.NDArray[np.float64]

HOPELESS = 10.0  # margins: the figure and the belief about the links exclude each other
IMPLAUSIBLE = 4.0  # standard deviations of the belief
STEP = 1e-4  # in standard deviations of the belief, for slopes
DETERMINED = 0.7  # std against the belief's below which a number counts as determined
# Belief's standard deviations. From the belief itself rounding would choose between two that meet
# all figures alike.
_BESIDE_BELIEF = 0.01
_TWIN_APART, _TWIN_ALIKE = 0.1, 1.0  # belief's standard deviations; of |u|² + |pulls|²


@dataclass(frozen=True, slots=True, kw_only=True)
class Calibration:
    """Calibrated inertias with their uncertainty."""

    arm: Arm
    base_mass_kg: float
    bodies: tuple[BelievedBody, ...]  # of the moving links, base outwards
    u: Array  # (n,) ten numbers a link, then the base's mass
    covariance: Array  # (n, n) of u; about this solution, not its twin
    pulls: tuple[tuple[Target, Array], ...]  # deviation over margin, at the solution
    twin: tuple[InertialLink, ...] | None  # other links that are as probable, if any were found

    def spread_of(
        self, joints_rad: npt.ArrayLike, quantity: Callable[[Array], Array]
    ) -> tuple[Array, Array]:
        """A quantity of the calibrated arm and its standard deviation, by its slope in u.

        Parameters
        ----------
        joints_rad
            (k, n_joints) postures whose mass matrices the quantity needs.
        quantity
            Maps mass matrices (n_joints, n_joints, k) to an array (m,).
        """
        linear = _LinearArm(ArmBatch(self.arm), self.bodies, np.asarray(joints_rad))

        def at(u: Array) -> Array:
            return quantity(linear.mass(linear.links(u)))

        slope = np.stack(
            [
                (at(self.u + step) - at(self.u - step)) / (2 * STEP)
                for step in STEP * np.eye(self.u.size)
            ],
            axis=-1,
        )
        variance = np.einsum("...i,ij,...j->...", slope, self.covariance, slope)
        return at(self.u), np.asarray(np.sqrt(variance))

    def undetermined(self) -> dict[str, tuple[str, ...]]:
        """Of each link, the numbers that no target determined."""
        names = ("mass", "center x", "center y", "center z", *_SPREAD_NAMES)
        std = np.sqrt(np.diag(self.covariance))[:-1].reshape(-1, N_NUMBERS)
        return {
            body.name: tuple(n for n, s in zip(names, row, strict=True) if s > DETERMINED)
            for body, row in zip(self.bodies, std, strict=True)
        }


_SPREAD_NAMES = tuple(f"spread {pair}" for pair in ("xx", "yy", "zz", "xy", "xz", "yz"))


def calibrate_inertia(
    arm: Arm,
    bodies: Sequence[BelievedBody],
    targets: Sequence[Target],
    *,
    base_mass_kg: float,
    base_mass_std: float,
) -> Calibration:
    """Find the most probable inertias.

    Parameters
    ----------
    arm
        The arm; its links' inertias are replaced, everything else stays.
    bodies
        The belief, one per moving link, base outwards.
    base_mass_kg, base_mass_std
        Believed mass of the base and its relative std; it moves nothing but the total mass.

    Two arms may be equally probable, one on each side of the belief (the Viper's are, up to 7 % of
    its largest inertia apart): the one found from a little above the belief is given, the other
    is its `twin`.

    Raises
    ------
    EstimateError
        If a target stays more than `HOPELESS` margins off, or only a link more than
        `IMPLAUSIBLE` standard deviations from the belief would meet it.
    """
    bodies = tuple(bodies)
    if [body.name for body in bodies] != [joint.link.name for joint in arm.joints]:
        raise EstimateError(
            f"wanted a belief for each moving link, {[j.link.name for j in arm.joints]}, "
            f"got {[body.name for body in bodies]}"
        )
    n = N_NUMBERS * len(bodies) + 1

    def base_at(u: Array) -> float:
        return base_mass_kg * float(np.exp(base_mass_std * u[-1]))

    batch = ArmBatch(arm)
    linear = _LinearArm(batch, bodies, np.concatenate([target.postures for target in targets]))
    ends = np.cumsum([len(target.postures) for target in targets])
    spans = [slice(end - len(t.postures), end) for t, end in zip(targets, ends, strict=True)]

    def pulls_at(u: Array) -> list[Array]:
        links = linear.links(u)
        mass = linear.mass(links)
        total = base_at(u) + sum(link.mass_kg for link in links)
        return [
            target.pulls(mass[..., span], total)
            for target, span in zip(targets, spans, strict=True)
        ]

    def residual(u: Array) -> Array:
        return np.concatenate([u, *pulls_at(u)])

    found, other = (
        scipy.optimize.least_squares(residual, np.full(n, beside), method="lm", x_scale=1.0)
        for beside in (_BESIDE_BELIEF, -_BESIDE_BELIEF)
    )
    apart = bool(np.abs(other.x - found.x).max() > _TWIN_APART)
    alike = bool(abs(other.cost - found.cost) < 0.5 * _TWIN_ALIKE)
    u: Array = np.asarray(found.x)
    jacobian: Array = np.asarray(found.jac)
    pulls = tuple(zip(targets, pulls_at(u), strict=True))
    result = Calibration(
        arm=batch.with_links(linear.links(u)).arm,
        base_mass_kg=base_at(u),
        bodies=bodies,
        u=u,
        covariance=np.asarray(np.linalg.inv(jacobian.T @ jacobian), dtype=np.float64),
        pulls=pulls,
        twin=tuple(linear.links(np.asarray(other.x))) if apart and alike else None,
    )
    worst = max(float(np.abs(pull).max()) for _, pull in pulls)
    missed = {target.source for target, pull in pulls if np.abs(pull).max() > HOPELESS}
    if missed or np.abs(u).max() > IMPLAUSIBLE:
        raise EstimateError(
            f"no plausible inertias meet the figures: the furthest is {worst:.1f} margins "
            f"off ({', '.join(sorted(missed)) or 'none hopeless'}), and a link would be "
            f"{np.abs(u).max():.1f} standard deviations from what is believed; check the figures, "
            "or widen the belief about the links",
            partial=result,
        )
    return result


class _LinearArm:
    """Mass matrices in fixed postures, by their slope in the links' inertial parameters.

    A number moves one body: the others are as they were when last asked for.
    """

    def __init__(self, batch: ArmBatch, bodies: Sequence[BelievedBody], joints_rad: Array) -> None:
        self._batch = batch
        self._bodies = bodies
        self._last: dict[int, tuple[bytes, InertialLink]] = {}
        self._parameters: dict[int, tuple[InertialLink, Array]] = {}
        slope = batch.mass_slope(joints_rad)
        self._shape = slope.shape[:3]
        self._slope = slope.reshape(-1, slope.shape[3] * slope.shape[4])

    def links(self, u: Array) -> list[InertialLink]:
        return [self._moved(i, u[N_NUMBERS * i :][:N_NUMBERS]) for i in range(len(self._bodies))]

    def mass(self, links: Sequence[InertialLink]) -> Array:
        own = np.concatenate([self._parameters_of(i, link) for i, link in enumerate(links)])
        return np.asarray((self._slope @ own).reshape(self._shape))

    def _moved(self, i: int, u: Array) -> InertialLink:
        key, link = self._last.get(i, (b"", None))
        if link is None or key != u.tobytes():
            link = moved_body(self._bodies[i], u)
            self._last[i] = u.tobytes(), link
        return link

    def _parameters_of(self, i: int, link: InertialLink) -> Array:
        of, found = self._parameters.get(i, (None, None))
        if found is None or of is not link:
            found = self._batch.parameters_of(i, link)
            self._parameters[i] = link, found
        return found
