"""Compliance beside the joints' own, hidden at its clear size times a magnitude."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from armodal.hil_sim.effects.hidden import Hidden, about, hidden, loss_s, plain, unit
from armodal.hil_sim.study.places import ArmPlaces
from armodal.protocols.errors import PlantError

__all__ = [
    "base",
    "bearing",
    "link_axis",
    "link_bending",
    "link_torsion",
    "released_joint",
]

# Compliances at magnitude 1, as parts of the arm's own joint compliance.
RELEASED = 7.5
BEARING = 0.1  # both ways across
AXIS = 0.38
ROCKING = 0.08
SHIFT_M2 = 2.5e-3  # m / N per rad / N m
BENDING = 0.15  # of the whole link
TORSION = 0.8
CUTS = 8  # of a link: none where one of two to four points stands, and its tip is right to 0.4 %
FLATTEST = 4.0  # at most, about one direction over the other: a thin box 0.4 as wide as high

Rng = np.random.Generator


def released_joint(places: ArmPlaces, rng: Rng, magnitude: float) -> Hidden:
    """A joint the arm file calls rigid."""
    if not places.rigid:
        raise PlantError("released_joint: wanted a joint believed rigid, got none")
    joint = places.rigid[0] if len(places.rigid) > 1 else places.rigid[-1]
    k = 1.0 / (RELEASED * places.compliance * magnitude * about(rng))
    table = {
        "kind": "released_joint",
        "joint": joint,
        "stiffness_n_m_per_rad": k,
        "damping_n_m_s_per_rad": 0.06 * k / (2.0 * np.pi * 100.0),
    }
    return hidden("released_joint", joint, table, stiffness_n_m_per_rad=k)


def bearing(places: ArmPlaces, rng: Rng, magnitude: float) -> Hidden:
    """A joint's bearing, alike both ways across."""
    joint = places.main_joint(rng)
    k = 1.0 / (BEARING * places.compliance * magnitude * about(rng))
    lost = loss_s(rng)
    table = {
        "kind": "bearing",
        "joint": joint,
        "stiffness_n_m_per_rad": (k, k),
        "damping_n_m_s_per_rad": (lost * k, lost * k),
    }
    return hidden("bearing", joint, table, compliance_rad_per_n_m=1.0 / k)


def link_axis(places: ArmPlaces, rng: Rng, magnitude: float) -> Hidden:
    """An axis in any direction, sometimes with a part of the link before it."""
    link = str(rng.choice(places.structural()))
    point, direction = places.somewhere(rng, link), unit(rng)
    k = 1.0 / (AXIS * places.compliance * magnitude * about(rng))
    near: tuple[str, ...] = ()
    table = {
        "kind": "link_axis",
        "link": link,
        "point_m": plain(point),
        "direction": plain(direction),
        "stiffness_n_m_per_rad": k,
        "damping_n_m_s_per_rad": loss_s(rng) * k,
    }
    if rng.random() < 0.3 and len(places.points[link]) > 2:
        nearest = min(places.points[link], key=lambda p: float(np.linalg.norm(p["position_m"])))
        near = (nearest["id"],)
        table |= {"mass_before": 0.25, "points_before": near}
    return hidden(
        "link_axis",
        link,
        table,
        compliance_rad_per_n_m=1.0 / k,
        point_m=places.in_file(link, point),
        direction=places.in_file(link, direction),
        points_before=list(near),
        mass_before=0.25 if near else 0.0,
    )


def base(places: ArmPlaces, rng: Rng, magnitude: float) -> Hidden:
    """The base rocks, and shifts in half of the cases."""
    rock = ROCKING * places.compliance * magnitude * np.array([about(rng), about(rng)])
    shift = SHIFT_M2 * rock * np.array([about(rng), about(rng)])
    ways = {f"rock_{axis}": 1.0 / c for axis, c in zip("xy", rock, strict=True)}
    if rng.random() < 0.5:
        ways |= {f"shift_{axis}": 1.0 / c for axis, c in zip("xy", shift, strict=True)}
    mass = float(rng.uniform(8.0, 25.0))
    lost = loss_s(rng)
    table = {
        "kind": "base",
        "pivot_m": (0.0, 0.0, float(rng.uniform(-0.05, 0.02))),
        "mass_kg": mass,
        "center_m": (0.0, 0.0, 0.08),
        "inertia_kg_m2": (0.015 * mass, 0.0, 0.0, 0.015 * mass, 0.0, 0.02 * mass),
        "springs": tuple(
            {"way": way, "stiffness": float(k), "damping": float(lost * k)}
            for way, k in ways.items()
        ),
    }
    units = {way: "n_m_per_rad" if way.startswith("rock") else "n_per_m" for way in ways}
    parameters = {f"{way}_{units[way]}": float(k) for way, k in ways.items()}
    return hidden("base", "base", table, base_mass_kg=mass, **parameters)


def link_bending(places: ArmPlaces, rng: Rng, magnitude: float) -> Hidden:
    """A long link that bends all along, more easily about one direction than about the other."""
    made = _all_along("bending", "bending_stiffness_n_m2", BENDING * magnitude, places, rng)
    table = {
        **made.tables[0],
        "softest_about": plain(unit(rng)),
        "softest_over_stiffest": float(np.exp(rng.uniform(0.0, np.log(FLATTEST)))),
    }
    return replace(made, tables=[table])


def link_torsion(places: ArmPlaces, rng: Rng, magnitude: float) -> Hidden:
    """A long link that twists all along."""
    return _all_along("torsion", "torsional_stiffness_n_m2", TORSION * magnitude, places, rng)


def _all_along(kind: str, key: str, part: float, places: ArmPlaces, rng: Rng) -> Hidden:
    """A long link whose whole compliance is a part of the arm's own."""
    link = _long_link(places, rng)
    start, end = places.tube(link)
    stiffness = float(np.linalg.norm(end - start) / (part * places.compliance * about(rng)))
    table = {
        "kind": kind,
        "link": link,
        "from_m": plain(start),
        "to_m": plain(end),
        "cuts": CUTS,
        key: stiffness,
        "loss": loss_s(rng),
    }
    return hidden(f"link_{kind}", link, table, **{key: stiffness})


def _long_link(places: ArmPlaces, rng: Rng) -> str:
    """One of the two links that are most longer than wide."""
    return str(rng.choice(sorted(places.structural(), key=places.longer_than_wide)[-2:]))
