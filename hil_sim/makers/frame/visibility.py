"""How visible an effect is: its change of the FRFs over what tolerances scatter them.

This maker's measure of size. FRFs on broad lines are compared with those of the everyday arm; what
other stiffnesses and losses of the drives explain best is taken off first, since nobody knows
these; what is left is counted in standard deviations of everyday arms drawn within the tolerances.
Sizes are drawn by what drives explain to first order; told is what they leave when they are fitted.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass, replace
from functools import cached_property, partial

import numpy as np

from armodal.hil_sim.makers.arm_table import Array
from armodal.hil_sim.makers.frame.everyday import (
    PLATE,
    TILT,
    Everyday,
    Gear,
    redrawn,
    within,
)
from armodal.hil_sim.makers.frame.frfs import felt_per_wrench
from armodal.hil_sim.makers.frame.modal import Modal, modal
from armodal.hil_sim.makers.frame.parts import Parts
from armodal.hil_sim.makers.frame.standing import Standing, stand
from armodal.hil_sim.makers.frame.structure import Complex, Law
from armodal.hil_sim.streams import stream
from armodal.protocols.plan_records import Plan

__all__ = ["VISIBLE", "Witness"]

# Root mean square of standard deviations that each class is visible by, met to a seventh.
VISIBLE = {"faint": 0.8, "medium": 1.8, "clear": 4.0}

SEEN = (0, 2)  # postures
EVERY = 2  # every other point is looked at, and those that are exchanged
LINES = np.geomspace(5.0, 140.0, 48)
WIDTH = 0.05  # of a line, of its frequency
DRAWS = 10
OWN_SCATTER = 0.011  # of an FRF's magnitude: gains and repeats
OTHER_SCATTER = 0.006  # of the root mean square of all FRFs
STEP = 0.02  # of ln of a drive's stiffness and loss
HIGHEST_HZ = 400.0  # of the modes that are kept
WIDER = (0.4, 0.15)  # than a line is, where a fit of drives begins: it finds its way from far
# Of Gauss and Newton, which end where one leaves hardly less; parts of a step that are tried, and
# its most, of a logarithm.
STEPS, HARDLY, PARTS, FARTHEST = 8, 0.97, (1.0, 0.5, 0.25, 0.1), 1.0


@dataclass(frozen=True)
class Witness:
    """Somebody who has seen many everyday arms like this one."""

    drawn: Everyday
    plan: Plan
    seed: int
    also: frozenset[str] = frozenset()  # points that are looked at besides every other

    def looking_at(self, points: Collection[str]) -> Witness:
        """Itself, or somebody who looks at some points too."""
        return replace(self, also=frozenset(points)) if points else self

    def sees(self, parts: Parts, gear: Gear) -> float:
        """Visibility of what differs from the everyday arm."""
        change = _parted((self._frfs(parts, gear) - self._plain) / self._scatter)
        explained, *_ = np.linalg.lstsq(self._drives, change, rcond=None)
        left = change - self._drives @ explained
        return float(np.sqrt(2.0 * np.mean(left**2)))

    def left_by_drives(self, parts: Parts, gear: Gear) -> float:
        """Visibility of what no other drives imitate, however far off.

        Slopes do not imitate what moves a resonance by more than its width, such as a servo that is
        faster than every mode and so a spring.
        """
        changed = self._modes(parts)
        drives = np.zeros(2 * len(self.drawn.elastic))
        for width in WIDER:
            _, drives = self._fitted(self._felt(changed, gear, width), drives, width)
        frfs = self._felt(changed, gear, WIDTH)
        return min(self._fitted(frfs, begin, WIDTH)[0] for begin in (drives, 0.0 * drives))

    def _fitted(self, frfs: Complex, drives: Array, width: float) -> tuple[float, Array]:
        """What everyday drives leave of FRFs at best, and those drives, begun at some.

        `drives` are logarithms of stiffness and loss over the everyday ones, drive by drive.
        """

        def left(at: Array) -> Array:
            return _parted((frfs - self._imitated(at, width)) / self._scatter)

        ways = STEP * np.eye(len(drives))
        here = left(drives)
        for _ in range(STEPS if here.any() else 0):
            slopes = np.column_stack([(here - left(drives + way)) / STEP for way in ways])
            step, *_ = np.linalg.lstsq(slopes, here, rcond=None)
            step *= min(1.0, FARTHEST / float(np.abs(step).max()))
            trials = [(left(drives + part * step), drives + part * step) for part in PARTS]
            there, found = min(trials, key=lambda trial: float(np.linalg.norm(trial[0])))
            gained = float(np.linalg.norm(there) / np.linalg.norm(here))
            if gained < 1.0:
                here, drives = there, found
            if gained > HARDLY:
                break
        return float(np.sqrt(2.0 * np.mean(here**2))), drives

    @cached_property
    def _plain(self) -> Complex:
        return self._frfs(self.drawn.parts, self.drawn.gear)

    @cached_property
    def _scatter(self) -> Array:
        """Standard deviation of every FRF and line over everyday arms."""
        drawn, plain = self.drawn, self._plain
        total = (OWN_SCATTER * np.abs(plain)) ** 2
        total += np.mean(np.abs(OTHER_SCATTER * plain) ** 2)
        for k in range(DRAWS):
            streams = partial(stream, self.seed, "frame", "witness", k)
            parts = redrawn(drawn, streams)
            for joint in drawn.elastic[:3]:
                other = drawn.parts.drives[joint].stiffness / within(streams("tilt", joint), TILT)
                parts.drives[joint].tilt = (other, other)
            rock = drawn.parts.drives[drawn.elastic[0]].stiffness / within(streams("plate"), PLATE)
            parts.plate = drawn.parts.plate * (rock / drawn.parts.plate[3, 3])
            total += np.abs(self._less_drives(self._frfs(parts, drawn.gear) - plain)) ** 2 / DRAWS
        return np.sqrt(total)

    @cached_property
    def _slopes(self) -> list[Complex]:
        """Change of the FRFs with ln of each drive's stiffness and loss."""
        slopes = []
        for joint in self.drawn.elastic:
            drive, loss = self.drawn.parts.drives[joint], self.drawn.loss[joint]
            for stiffer, looser in ((np.exp(STEP), 1.0), (1.0, np.exp(STEP))):
                parts = self.drawn.parts.copy()
                parts.drives[joint].stiffness = drive.stiffness * stiffer
                parts.drives[joint].law = loss.law(drive.stiffness, looser)
                slopes.append((self._frfs(parts, self.drawn.gear) - self._plain) / STEP)
        return slopes

    @cached_property
    def _drives(self) -> Array:
        return np.column_stack([_parted(slope / self._scatter) for slope in self._slopes])

    def _less_drives(self, change: Complex) -> Complex:
        """Take off what other drives explain, weighed by the FRFs' own magnitudes."""
        weight = OWN_SCATTER * np.abs(self._plain) + OTHER_SCATTER * np.abs(self._plain).mean()
        columns = np.column_stack([_parted(slope / weight) for slope in self._slopes])
        explained, *_ = np.linalg.lstsq(columns, _parted(change / weight), rcond=None)
        for slope, share in zip(self._slopes, explained, strict=True):
            change = change - share * slope
        return change

    def _frfs(self, parts: Parts, gear: Gear) -> Complex:
        """FRFs, (postures, points, lines, 3)."""
        return self._felt(self._modes(parts), gear, WIDTH)

    def _modes(self, parts: Parts) -> list[tuple[Standing, Modal]]:
        """An arm in every posture that is looked at, and its modes."""
        standings = [stand(parts, self.plan.postures[i].joints_rad) for i in SEEN]
        return [(standing, modal(standing, HIGHEST_HZ)) for standing in standings]

    @cached_property
    def _everyday(self) -> list[tuple[Standing, Modal, list[Array]]]:
        """The everyday arm, with every drive's turn on its modes."""
        return [
            (standing, modes, [modes.shapes.T @ standing.turn(j) for j in self.drawn.elastic])
            for standing, modes in self._modes(self.drawn.parts)
        ]

    def _imitated(self, drives: Array, width: float) -> Complex:
        """FRFs of the everyday arm with other drives: on its own modes, as further laws."""
        more = [
            self._more(joint, float(ln_k), float(ln_loss))
            for joint, (ln_k, ln_loss) in zip(
                self.drawn.elastic, drives.reshape(-1, 2), strict=True
            )
        ]
        both = [
            (standing, replace(modes, laws=(*modes.laws, *zip(turns, more, strict=True))))
            for standing, modes, turns in self._everyday
        ]
        return self._felt(both, self.drawn.gear, width)

    def _more(self, joint: str, ln_k: float, ln_loss: float) -> Law:
        """What a drive has more than the everyday one, stiffness and loss off by factors."""
        stiffness = self.drawn.parts.drives[joint].stiffness
        loss = self.drawn.loss[joint]
        was, now = loss.law(stiffness), loss.law(stiffness, float(np.exp(ln_loss)))
        return lambda s: stiffness * np.expm1(ln_k) + now(s) - was(s)

    def _felt(self, both: list[tuple[Standing, Modal]], gear: Gear, width: float) -> Complex:
        s = np.asarray((width + 1j) * 2.0 * np.pi * LINES, dtype=np.complex128)
        kg = self.plan.sensor.mass_kg + gear.added_kg
        factor = (np.exp(-s * gear.lag_s) / gear.force_gain)[:, None]
        seen = []
        for i, (standing, modes) in zip(SEEN, both, strict=True):
            posture = self.plan.postures[i]
            points = enumerate(posture.points)
            names = [name for k, name in points if k % EVERY == 0 or name in self.also]
            at = [standing.point(gear.exchanged.get(name, name)) for name in names]
            fixed = standing.point(gear.exchanged.get(self.plan.fixed_point, self.plan.fixed_point))
            felt = felt_per_wrench(standing, modes, s, [spot for spot, _ in at], [fixed[0]], kg)
            told = posture.hit_direction if posture.hit_direction is not None else -fixed[1][:, 2]
            seen.append(
                [
                    (f[:, :, 0, :3] @ told) @ axes @ gear.response.T * factor
                    for f, (_, axes) in zip(felt, at, strict=True)
                ]
            )
        return np.array(seen)


def _parted(values: Complex) -> Array:
    return np.concatenate([values.real.ravel(), values.imag.ravel()])
