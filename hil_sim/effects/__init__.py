"""What a plant file can hide in the arm or its measurement; `docs/simulated-plant.md` lists it."""

from typing import Annotated

from pydantic import Field

from hil_sim.effects.base import Base, BaseSpring
from hil_sim.effects.bearing import Bearing
from hil_sim.effects.bending import Bending
from hil_sim.effects.coupling import Coupling
from hil_sim.effects.delay import Delay
from hil_sim.effects.dress_pack import DressPack
from hil_sim.effects.effect import BaseEffect
from hil_sim.effects.encoder_offset import EncoderOffset
from hil_sim.effects.gains import ChannelGain, HammerGain
from hil_sim.effects.hysteretic import Hysteretic
from hil_sim.effects.link_axis import LinkAxis
from hil_sim.effects.one_sided import OneSidedCrack
from hil_sim.effects.payload import Payload
from hil_sim.effects.released_joint import ReleasedJoint
from hil_sim.effects.rotor import Rotor
from hil_sim.effects.sensor_axes import FlippedAxis, SwappedAxes

__all__ = [
    "Base",
    "BaseEffect",
    "BaseSpring",
    "Bearing",
    "Bending",
    "ChannelGain",
    "Coupling",
    "Delay",
    "DressPack",
    "Effect",
    "EncoderOffset",
    "FlippedAxis",
    "HammerGain",
    "Hysteretic",
    "LinkAxis",
    "OneSidedCrack",
    "Payload",
    "ReleasedJoint",
    "Rotor",
    "SwappedAxes",
]

Effect = Annotated[
    Base
    | Bearing
    | Bending
    | ChannelGain
    | Coupling
    | Delay
    | DressPack
    | EncoderOffset
    | FlippedAxis
    | HammerGain
    | Hysteretic
    | LinkAxis
    | OneSidedCrack
    | Payload
    | ReleasedJoint
    | Rotor
    | SwappedAxes,
    Field(discriminator="kind"),
]
