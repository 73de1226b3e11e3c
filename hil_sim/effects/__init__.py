"""What a plant file can hide in the arm or its measurement; `docs/simulated-plant.md` lists it."""

from typing import Annotated

from pydantic import Field

from armodal.hil_sim.effects.backlash import Backlash
from armodal.hil_sim.effects.base import Base
from armodal.hil_sim.effects.bearing import Bearing
from armodal.hil_sim.effects.bending import Bending
from armodal.hil_sim.effects.coupling import Coupling
from armodal.hil_sim.effects.dashpot import Dashpot
from armodal.hil_sim.effects.delay import Delay
from armodal.hil_sim.effects.dress_pack import DressPack
from armodal.hil_sim.effects.effect import BaseEffect
from armodal.hil_sim.effects.encoder_offset import EncoderOffset
from armodal.hil_sim.effects.exponential_window import ExponentialWindow
from armodal.hil_sim.effects.friction import Friction
from armodal.hil_sim.effects.gains import ChannelGain, HammerGain
from armodal.hil_sim.effects.gravity_compensator import GravityCompensator
from armodal.hil_sim.effects.hit_direction import HitDirection
from armodal.hil_sim.effects.hysteretic import Hysteretic
from armodal.hil_sim.effects.link_axis import LinkAxis
from armodal.hil_sim.effects.load_damping import LoadDamping
from armodal.hil_sim.effects.one_sided import OneSidedCrack
from armodal.hil_sim.effects.parallelogram import Parallelogram
from armodal.hil_sim.effects.payload import Payload
from armodal.hil_sim.effects.released_joint import ReleasedJoint
from armodal.hil_sim.effects.rotor import Rotor
from armodal.hil_sim.effects.sensor_axes import FlippedAxis, SwappedAxes
from armodal.hil_sim.effects.sensor_mass import SensorMass
from armodal.hil_sim.effects.softening import Softening
from armodal.hil_sim.effects.torsion import Torsion
from armodal.hil_sim.effects.wrist_coupling import WristCoupling
from armodal.hil_sim.effects.wrong_point import ExchangedPoints, MovedPoint

__all__ = ["BaseEffect", "Effect"]

Effect = Annotated[
    Backlash
    | Base
    | Bearing
    | Bending
    | ChannelGain
    | Coupling
    | Dashpot
    | Delay
    | DressPack
    | EncoderOffset
    | ExchangedPoints
    | ExponentialWindow
    | FlippedAxis
    | Friction
    | GravityCompensator
    | HammerGain
    | HitDirection
    | Hysteretic
    | LinkAxis
    | LoadDamping
    | MovedPoint
    | OneSidedCrack
    | Parallelogram
    | Payload
    | ReleasedJoint
    | Rotor
    | SensorMass
    | Softening
    | SwappedAxes
    | Torsion
    | WristCoupling,
    Field(discriminator="kind"),
]
