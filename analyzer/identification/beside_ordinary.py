"""Joints' stiffness where joints are not all that gives way.

Bearings, links and the base of a sound arm give way a little too. A fit of joints alone makes
joints softer by that, by some per cent, and an axis in a link stiffer than any may take its place.
So where joints alone leave much, the model that a gap analysis begins with is fitted beside them:
masses, places, gains, bearings, links and base free within what is ordinary, and an axis counts
only if it explains what these do not (docs/theory-identification.md, section 5).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import numpy.typing as npt

from armodal.analyzer.arm.structure import Axis
from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.gap.add import instances_of_file
from armodal.analyzer.gap.begin import ordinary_of, with_places
from armodal.analyzer.gap.decision.calibration import FALSE_NAME, Calibration, calibrate
from armodal.analyzer.gap.decision.data_requirements import check_data_requirements
from armodal.analyzer.gap.effects import link_axis
from armodal.analyzer.gap.inference.annealing import annealing_stages
from armodal.analyzer.gap.inference.dispersion import dispersion
from armodal.analyzer.gap.inference.fit import Fit, Stage, fit_hypothesis
from armodal.analyzer.gap.inference.intervals import intervals
from armodal.analyzer.gap.model.effect import EffectWords, Instance
from armodal.analyzer.gap.model.hypothesis import Hypothesis
from armodal.analyzer.gap.search.candidates import other_candidates
from armodal.analyzer.gap.search.interfaces import lines_of_interfaces
from armodal.analyzer.gap.search.rivals import annealed
from armodal.analyzer.gap.search.scan import Candidate
from armodal.analyzer.gap.stiffness_ranges import left_open
from armodal.protocols.frf_records import FrequencyResponse
from armodal.protocols.session.records import Session

__all__ = ["AxisBeside", "BesideOrdinary", "fit_beside_ordinary"]

Array = npt.NDArray[np.float64]

_COMPLIANCES = ("rad/(N m)", "m/N")
_RIGID = 1e-6  # of a compliance's prior: moves nothing


@dataclass(frozen=True, slots=True, kw_only=True)
class AxisBeside:
    """An axis in a link, in the link's frame, with one standard deviation of each."""

    link: str
    k_n_m_per_rad: float
    k_std: float
    direction_link: Array  # (3,) unit
    point_link_m: Array  # (3,), nearest the frame's origin
    turned_rad: float
    shifted_m: float


@dataclass(frozen=True, kw_only=True)
class BesideOrdinary:
    """Joints, and axes in links, fitted beside all that gives way in a sound arm.

    Attributes
    ----------
    stages
        Lines of the fitted postures, from the widest to sharp.
    start
        Where the effects of the arm file begin.
    fit
        On the sharp lines.
    """

    stages: tuple[Stage, ...]
    start: Mapping[str, float]
    fit: Fit

    @cached_property
    def calibration(self) -> Calibration:
        """Return what chance may gain, from replicas of the session."""
        return calibrate(self.stages[-1], self.fit, self.fit, FALSE_NAME)

    def axis_limit_nats(self, richer: BesideOrdinary) -> float:
        """Return the evidence that an axis in a link needs, by replicas of the fit with one."""
        limits = calibrate(self.stages[-1], self.fit, richer.fit, FALSE_NAME)
        return limits.limit(link_axis.WORDS.name)

    @property
    def lacks_an_effect(self) -> bool:
        """Return whether more is left than a right model may be off."""
        return self.calibration.is_model_wrong

    def is_needed(self) -> bool:
        """Return whether the evidence is for what gives way beside joints and axes."""
        stiff = replace(
            self.fit.hypothesis,
            instances=(*self.fit.hypothesis.instances, _stiff(self.fit)),
        )
        alone = fit_hypothesis(self.stages[-1], stiff, start=self.fit.values)
        return self.fit.evidence < alone.evidence

    def may_have_axis(self) -> bool:
        """Return whether a look at every line of every link promises what an axis needs.

        Where an effect is missing it hides itself: replicas of what is left hold it.
        """
        if self.lacks_an_effect:
            return True
        lines = lines_of_interfaces(self.stages[-1], self.fit)
        return bool(lines) and lines[0].gain > self.calibration.limit(link_axis.WORDS.name)

    def with_axis(self, axis: Axis) -> BesideOrdinary:
        """Return the fit with an axis too, begun where joints alone have it."""
        present = self.fit.hypothesis
        instance = link_axis.at_axis(present.ordinary, axis.link, axis.direction, axis.point_m)
        k = axis.stiffness_n_m_per_rad
        begin = {
            p.name: axis.damping_n_m_s_per_rad / k for p in instance.parameters if p.unit == "s"
        }
        begin |= {**self.start, instance.size: 1.0 / k}
        richer = replace(present, instances=(*present.instances, instance))
        fit = annealed(self.stages, richer, begin)[-1]
        return BesideOrdinary(stages=self.stages, start=begin, fit=fit)

    def settled(self) -> BesideOrdinary:
        """Return it with what mountings have of their own as this fit foretells it."""
        present = self.fit.hypothesis
        stages = tuple(stage.with_places(present, self.fit.values) for stage in self.stages)
        fit = annealed(stages[-1:], present, self.fit.values)[-1]
        return replace(self, stages=stages, fit=fit)

    def joint_stiffness(self) -> dict[str, tuple[float, float]]:
        """Return k and its standard deviation, N m/rad, of every elastic joint."""
        ordinary = self.fit.hypothesis.ordinary
        names = [ordinary.arm.joints[i].name for i in ordinary.elastic]
        found = intervals(self.fit, [f"ln k {name}" for name in names], self.inflation)
        result = {}
        for name in names:
            row = found[f"ln k {name}"]
            std = np.hypot(
                row.std, left_open(self._hiding, self.fit, f"ln k {name}", self.inflation)
            )
            k = np.exp(row.value)
            result[name] = float(k), float(k * std)
        return result

    def axes(self) -> tuple[AxisBeside, ...]:
        """Return the axes in links that give way: of the arm file, and one that was added."""
        return tuple(self._axis(i) for i in self._lines() if self.fit.values[i.size] > 0.0)

    def locked_axes(self) -> tuple[str, ...]:
        """Return the links whose axis, one of the arm file, gives way by nothing here."""
        return tuple(i.place for i in self._lines() if self.fit.values[i.size] <= 0.0)

    def _lines(self) -> list[Instance]:
        return [i for i in self.fit.hypothesis.instances if i.effect == link_axis.WORDS]

    def _axis(self, instance: Instance) -> AxisBeside:
        told = intervals(self.fit, (instance.size, *instance.begins_at), self.inflation)
        size = told[instance.size]
        moved = [told[name] for name in instance.begins_at]
        line = {} if instance.describe is None else instance.describe(self.fit.values)
        return AxisBeside(
            link=instance.place,
            k_n_m_per_rad=1.0 / size.value,
            k_std=size.std / size.value**2,
            direction_link=np.array(line["direction"]),
            point_link_m=np.array(line["point_m"]),
            turned_rad=float(np.linalg.norm([m.std for m in moved if m.unit == ""])),
            shifted_m=float(np.linalg.norm([m.std for m in moved if m.unit == "m"])),
        )

    @cached_property
    def _hiding(self) -> list[Candidate]:
        """What nobody would see, and what a look makes of it."""
        looked = other_candidates(self.stages[-1], self.fit)
        return [c for c in looked if c.instance.size and np.isfinite(c.size_std)]

    @cached_property
    def inflation(self) -> float:
        """Return the factor of the data's variance, for intervals."""
        return max(self.calibration.inflation, dispersion(self.stages[-1], self.fit))


def fit_beside_ordinary(session: Session, frfs: tuple[FrequencyResponse, ...]) -> BesideOrdinary:
    """Fit the model that a gap analysis begins with to the postures that are identified.

    Parameters
    ----------
    frfs
        Of those postures; they give the band.

    Raises
    ------
    EstimateError
        If the session cannot carry it: fewer than two postures with known angles, too few points.
    """
    names = {frf.posture for frf in frfs}
    fitted = replace(
        session,
        hits=tuple(hit for hit in session.hits if hit.posture in names),
        frfs=tuple(frf for frf in session.frfs if frf.posture in names),
    )
    check_data_requirements(fitted)
    superset = Superset(session.header.arm)
    lines_of = frfs if fitted.hits else fitted.frfs
    stages = annealing_stages(superset, fitted, lines_of, band_of=frfs)
    ordinary = ordinary_of((fitted,), superset, stages[-1].lines)
    instances, start = instances_of_file(ordinary)
    stages, near = with_places(stages, Hypothesis(ordinary=ordinary, instances=instances), start)
    ordinary = ordinary.beside_drives(near)
    instances, start = instances_of_file(ordinary)
    present = Hypothesis(ordinary=ordinary, instances=instances)
    return BesideOrdinary(stages=stages, start=start, fit=annealed(stages, present, start)[-1])


def _stiff(fit: Fit) -> Instance:
    """Nothing gives way beside joints and axes."""
    of_file = {name for instance in fit.hypothesis.instances for name in instance.owned}
    rigid = {
        p.name: replace(p, mean=0.0, std=_RIGID * p.std, high=_RIGID * p.std)
        for p in fit.hypothesis.ordinary.parameters()
        if p.unit in _COMPLIANCES and p.name not in of_file
    }
    words = EffectWords(
        name="stiff",
        title="Nothing gives way beside the joints",
        changes="locks bearings, links and base",
        signature="",
        confused_with=(),
        told_by="",
        remedy="",
    )
    return Instance(effect=words, place="", relaxes=rigid)
