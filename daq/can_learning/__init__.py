"""Find the joint angles in a controller's frames, by frames heard at rest and angles typed."""

from armodal.daq.can_learning.fields import Field
from armodal.daq.can_learning.learn import Learned, LearnedJoint, Station, learn
from armodal.daq.can_learning.texts import can_section_text, database_text

__all__ = [
    "Field",
    "Learned",
    "LearnedJoint",
    "Station",
    "can_section_text",
    "database_text",
    "learn",
]
