"""What is known of any arm before it is measured.

Ranges from physics and literature, not from a generator of test data. Each is as wide as its source
leaves it; a session's own data say the rest.
"""

from __future__ import annotations

__all__ = [
    "BEARING_LIMIT",
    "BEARING_MEAN",
    "BEARING_STD",
    "DELAY_STD_S",
    "FLOOR_LIMIT",
    "FLOOR_MEAN",
    "FLOOR_STD",
    "INTERFACE_LOSS_MEAN_S",
    "INTERFACE_LOSS_STD_S",
    "JOINT_LOSS_LIMIT",
    "JOINT_LOSS_MEAN",
    "JOINT_LOSS_STD",
    "LEVER_M",
    "PLACE_STD_M",
]

# Damping over stiffness of a seat, a bearing, a bolted flange. Loss factors of joined metal
# structures are 0.002 to 0.1 (Beards, Structural Vibration (1996), section 3.3; Nashif, Jones and
# Henderson, Vibration Damping (1985), chapter 2), which about 20 to 200 Hz are 2 to 400 us.
INTERFACE_LOSS_MEAN_S, INTERFACE_LOSS_STD_S = 4e-5, 8e-5

# Loss factor of a joint's drive beside its dashpot: grease, seals, strain wave or cycloid gears
# (Tuttle and Seering, IEEE Trans. Robot. Autom. 12 (1996) 368: up to some per cent unloaded).
JOINT_LOSS_MEAN, JOINT_LOSS_STD, JOINT_LOSS_LIMIT = 0.010, 0.015, 0.06

# Across a joint's axis, as parts of the arm's own compliance. Cross roller and main bearings of
# robot gears tilt by 1e-7 to 1e-6 rad/(N m) in catalogues of drives whose torsion is 1e-5 to 1e-4;
# a structure's own bending between two joints is of that size too. More is an effect.
BEARING_MEAN, BEARING_STD, BEARING_LIMIT = 0.006, 0.006, 0.025

# A base on its bolts, as part of the arm's own compliance; more is an effect. Shifting goes with
# rocking by a lever squared.
FLOOR_MEAN, FLOOR_STD, FLOOR_LIMIT = 0.001, 0.003, 0.01
LEVER_M = 0.3

DELAY_STD_S = 20e-6  # between the channels of one board

# A sensor's place on its point, put there by hand and measured by rule.
PLACE_STD_M = 0.002
