"""Rows and notes of an identification where more than joints gives way."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from armodal.analyzer.gap.outcome import notes_on_its_end
from armodal.analyzer.identification.beside_ordinary import AxisBeside, BesideOrdinary
from armodal.analyzer.identification.records import AxisResult, Explained, JointResult
from armodal.analyzer.screws import line_sense

__all__ = ["axes_beside", "joints_beside", "notes_beside"]


def joints_beside(
    rows: tuple[JointResult, ...], beside: BesideOrdinary | None
) -> tuple[JointResult, ...]:
    """Return the joints with k as it is beside what else gives way; as they are without that.

    Their scatter stays as large a part of k, damping is that of joints alone.
    """
    if beside is None:
        return rows
    found = beside.joint_stiffness()
    return tuple(
        replace(
            row,
            k_n_m_per_rad=found[row.joint][0],
            k_std=row.k_std * found[row.joint][0] / row.k_alone_n_m_per_rad,
            k_std_model=found[row.joint][1],
        )
        for row in rows
    )


def axes_beside(
    rows: tuple[AxisResult, ...], beside: BesideOrdinary | None
) -> tuple[AxisResult, ...]:
    """Return axes as they are beside what else gives way, those of the arm file too.

    Their modes' Mozzi axes stay beside the axes of joints alone, whose modes they are set beside.
    """
    found = {} if beside is None else {axis.link: axis for axis in beside.axes()}
    return tuple(_axis_beside(row, found[row.link]) if row.link in found else row for row in rows)


def _axis_beside(row: AxisResult, axis: AxisBeside) -> AxisResult:
    return replace(
        row,
        direction_link=line_sense(axis.direction_link),
        point_link_m=axis.point_link_m,
        direction_std_deg=float(np.rad2deg(axis.turned_rad)),
        point_std_m=axis.shifted_m,
        k_n_m_per_rad=axis.k_n_m_per_rad,
        k_std=row.k_std * axis.k_n_m_per_rad / row.k_alone_n_m_per_rad,
        k_std_model=axis.k_std,
    )


def notes_beside(explained: Explained, beside: BesideOrdinary | None) -> tuple[str, ...]:
    """What has to be said where joints and axes alone leave much; nothing where it is not known."""
    lacks = (
        "the model lacks an effect beside these, and its stiffnesses may be off by more than their "
        "deviations; `armodal gap` tells which"
    )
    if beside is None:
        within = (
            "joints alone leave so much because masses, places, gains and the hits' aim are off, "
            "within their tolerances; bearings, links and base explain none of it"
        )
        return (within,) if explained is Explained.JOINTS else ()
    first = (
        "joints alone do not explain the motion, since bearings, links and base give way a little "
        "in any sound arm: k is that beside them, as in `armodal gap`, and so validation postures "
        "are predicted; `k alone` is what a model of joints alone needs for the measured modes, "
        "and what `armodal predict` and exports have"
    )
    locked = tuple(
        f"the arm file's axis in {link} gives way by nothing beside these: its k is that beside "
        "joints alone"
        for link in beside.locked_axes()
    )
    if explained is Explained.NOTHING:
        return first, *locked, lacks
    averaged = (
        "soft and hard hits are averaged: a joint that slips, softens or has play has no one k; "
        "`armodal gap` asks whether any does"
    )
    levels = [averaged] if beside.fit.hypothesis.ordinary.levels_hit else []
    return (first, *locked, *levels, *notes_on_its_end(beside.fit))
