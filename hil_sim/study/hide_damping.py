"""Losses and amplitude-dependent stiffness, hidden at their clear size times a magnitude."""

from __future__ import annotations

import numpy as np

from hil_sim.study.places import ArmPlaces, Hidden, about, hidden

__all__ = ["hysteretic"]

HYSTERETIC_LOSS = 0.12

Rng = np.random.Generator


def hysteretic(places: ArmPlaces, rng: Rng, magnitude: float) -> Hidden:
    """Losses of the joints' drives that do not grow with frequency."""
    loss = float(HYSTERETIC_LOSS * magnitude * about(rng))
    table = {
        "kind": "hysteretic",
        "joints": tuple(places.elastic),
        "loss_factor": loss,
        "replaces_viscous": magnitude > 0.7,
    }
    return hidden("hysteretic", places.elastic, table, loss_factor=loss)
