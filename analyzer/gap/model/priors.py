"""What is known of any arm before it is measured.

Ranges from physics and literature, not from a generator of test data. Each is as wide as its source
leaves it; a session's own data say the rest.
"""

from __future__ import annotations

import math

__all__ = [
    "BASE_ASIDE_STD",
    "BASE_DISC",
    "BASE_FARTHEST_M",
    "BASE_GAIN_STD",
    "BASE_HEIGHT_M",
    "BASE_HEIGHT_STD_M",
    "BASE_LEVER",
    "BASE_MASS",
    "BASE_MASS_MOST",
    "BASE_MASS_STD",
    "BASE_RADIUS",
    "BASE_RADIUS_MOST",
    "BASE_RADIUS_STD",
    "BEARING_LEVER",
    "BEARING_LIMIT",
    "BEARING_MEAN",
    "BEARING_STD",
    "BEND_LIMIT",
    "BEND_MEAN",
    "BEND_PLACE",
    "BEND_PLACE_LEAST",
    "BEND_PLACE_MOST",
    "BEND_PLACE_STD",
    "BEND_STD",
    "DELAY_STD_S",
    "FLOOR_LIMIT",
    "FLOOR_MEAN",
    "FLOOR_STD",
    "INTERFACE_LOSS_MEAN_S",
    "INTERFACE_LOSS_STD_S",
    "JOINT_LOSS_LIMIT",
    "JOINT_LOSS_MEAN",
    "JOINT_LOSS_STD",
    "LEAN_STD",
    "LOSS_POWER_MEAN",
    "LOSS_POWER_STD",
    "MASS_SPREAD",
    "PLACE_STD_M",
    "RELAXING_MOST_LN_RATE",
    "RELAXING_STD_LN_RATE",
    "TURN_MOST",
    "TURN_STD",
]

# Damping over stiffness of a seat, a bearing, a bolted flange, s. Damping ratios are below 0.01 in
# metals, 0.02 to 0.04 in continuous and 0.03 to 0.07 in jointed metal structures (Adams and
# Askenazi, Building Better Products with Finite Element Analysis (1999)): loss factors of twice
# that, 0.002 to 0.14, are 1.6 us at 200 Hz to 1.1 ms at 20 Hz. Mean and deviation of an even draw
# of the logarithm between these.
INTERFACE_LOSS_MEAN_S, INTERFACE_LOSS_STD_S = 1.7e-4, 2.6e-4

# And their loss factor, where the loss does not grow with frequency: the same range.
INTERFACE_FACTOR_MEAN, INTERFACE_FACTOR_STD = 0.032, 0.035

# Loss factor of a joint's drive beside its dashpot. The same range, its lower half: what grows with
# frequency is the dashpot's.
JOINT_LOSS_MEAN, JOINT_LOSS_STD, JOINT_LOSS_LIMIT = 0.010, 0.015, 0.07

# By which power of frequency that loss grows: an even draw between none, as of rubber, and the
# first, a dashpot's. No sum of a dashpot and a loss that does not grow both loses and stiffens as
# one does that grows.
LOSS_POWER_MEAN, LOSS_POWER_STD = 0.5, 1.0 / math.sqrt(12.0)

# Where a drive's part that relaxes loses most, as a logarithm about the reference: an even draw
# over a decade either way. Beyond, it is a spring or a dashpot in any band that is measured.
RELAXING_MOST_LN_RATE = math.log(10.0)
RELAXING_STD_LN_RATE = RELAXING_MOST_LN_RATE / math.sqrt(3.0)

# Across a joint's axis, as parts of its drive's compliance; more is an effect. No source: assumed.
# A sound bearing of another gear may well give way more, and would then be named.
BEARING_MEAN, BEARING_STD, BEARING_LIMIT = 0.006, 0.006, 0.025

# How many times softer than by the weight it carries a drive may be that no file tells. No source:
# sizes of a series of gears are a factor of about two apart, and nobody tells for what tool a wrist
# is built.
UNTOLD = 3.0

# A base on its bolts, as parts of the arm's compliance; more is an effect. No source: a
# foundation is meant to be stiffer than what stands on it by two orders of magnitude and more.
FLOOR_MEAN, FLOOR_STD, FLOOR_LIMIT = 0.001, 0.003, 0.01

# A casting over its whole length, about each direction, as parts of its own drive's compliance;
# more is an effect. No source: a link is meant to be as much stiffer than its drive.
BEND_MEAN, BEND_STD, BEND_LIMIT = 0.001, 0.003, 0.012

# About which part of its length a casting gives way: any, a draw even between its first and its
# last slice (`long_links.SLICES`), beyond which it is the bearing there.
BEND_PLACE, BEND_PLACE_LEAST, BEND_PLACE_MOST = 0.5, 0.1, 0.9
BEND_PLACE_STD = (BEND_PLACE_MOST - BEND_PLACE_LEAST) / math.sqrt(12.0)

# Part of its length, about its centre, that a link's mass is spread over. No source: assumed,
# between the frames at its ends.
MASS_SPREAD = 0.6

# By what one direction about which a link bends leans towards the other: with yields that differ by
# e^0.7, as of a thin box 0.63 as wide as high, half of that turns it by half a right angle.
LEAN_STD = 0.35

# About which level line a base is softest: any, pi / 2 either way, with an even draw's deviation.
TURN_MOST = math.pi / 2.0
TURN_STD = TURN_MOST / math.sqrt(3.0)

# Roots of shift over tilt under unit loads, as parts of the arm's chain: radius over root 2, of a
# ring of rollers and of a plate on its bolts. No source: a joint's bearing is taken to be an eighth
# of the chain wide, a base plate half of it.
BEARING_LEVER, BASE_LEVER = 0.05, 0.2
SHIFT_STDS = 2.0  # a bearing's shifts over its tilts: the lever by half as much again

# Where along its axis a bearing stands: near the joint's frame, or anywhere between the frames
# beside it.
NEAR_M = 0.05

# How much more or less a point of the base moves than a rigid base does: a casting on its bolts
# deforms between them by as much as it moves on them. No source: assumed.
BASE_GAIN_STD = 0.5

DELAY_STD_S = 20e-6  # between the channels of one board: half a sample at 25.6 kS/s

# A sensor's place on its point: what a rule and a pencil mark tell, 1 mm, and the sensor's own
# centre in its housing, as much.
PLACE_STD_M = 0.002

# Least deviations of ln k and ln c of a joint, however sure the arm file is of them; how many of
# its deviations an ordinary error may be off by.
LEAST_LN_K_STD, LEAST_LN_C_STD, FARTHEST = 0.3, 0.5, 5.0

# What a wrist without a tool is built for, of what the most loaded joint carries.
LEAST_CARRIED = 0.1

# How far a line in a link may turn (tangent) and move from where its fit began, for its prior.
LINE_TILT_STD, LINE_SHIFT_STD_M = 1.0, 0.15

# Gains of one mounting, of the tolerance that a sensor's gain has, and at least.
MOUNTING_GAIN, MOUNTING_GAIN_LEAST = 0.4, 1e-3

# The base's body. A pedestal up to the height of two hands. No source: assumed.
BASE_HEIGHT_M, BASE_HEIGHT_STD_M, BASE_FARTHEST_M = 0.1, 0.1, 0.3
# Of the moving mass. Pedestals weigh from a tenth of the arm to as much. No source: assumed.
BASE_MASS, BASE_MASS_STD, BASE_MASS_MOST = 0.3, 0.3, 2.0
# Radii of gyration of a disc over its radius, squared.
BASE_DISC = (0.25, 0.25, 0.5)
# Of that disc, over the plate's on its bolts: a foot as wide as the first link to the plate itself.
BASE_RADIUS, BASE_RADIUS_STD, BASE_RADIUS_MOST = 0.5, 0.45, 2.0
BASE_ASIDE_STD = 0.1  # its centre from the first joint's axis, over the plate's radius
