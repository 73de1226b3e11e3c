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

# Damping over stiffness of a seat, a bearing, a bolted flange, s. Damping ratios are below 0.01 in
# metals, 0.02 to 0.04 in continuous and 0.03 to 0.07 in jointed metal structures (Adams and
# Askenazi, Building Better Products with Finite Element Analysis (1999)): loss factors of twice
# that, 0.002 to 0.14, are 1.6 us at 200 Hz to 1 ms at 20 Hz.
INTERFACE_LOSS_MEAN_S, INTERFACE_LOSS_STD_S = 4e-5, 8e-5

# Loss factor of a joint's drive beside its dashpot. The same range, its lower half: what grows with
# frequency is the dashpot's.
JOINT_LOSS_MEAN, JOINT_LOSS_STD, JOINT_LOSS_LIMIT = 0.010, 0.015, 0.06

# Across a joint's axis, as parts of its drive's compliance; more is an effect. No source: assumed.
# A sound bearing of another gear may well give way more, and would then be named.
BEARING_MEAN, BEARING_STD, BEARING_LIMIT = 0.006, 0.006, 0.025

# A base on its bolts, as parts of the first drive's compliance; more is an effect. No source: a
# foundation is meant to be stiffer than what stands on it by two orders of magnitude and more.
FLOOR_MEAN, FLOOR_STD, FLOOR_LIMIT = 0.001, 0.003, 0.01
LEVER_M = 0.3  # about half of a base plate's width: shifting over rocking is its square

DELAY_STD_S = 20e-6  # between the channels of one board: half a sample at 25.6 kS/s

# A sensor's place on its point: what a rule and a pencil mark tell, 1 mm, and the sensor's own
# centre in its housing, as much.
PLACE_STD_M = 0.002
