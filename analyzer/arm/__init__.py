"""The arm as a dynamic model: rigid links by pinocchio, springs and axes put around them."""

from armodal.analyzer.arm.reduced import ReducedModel, reduce_model
from armodal.analyzer.arm.structure import Axis, Structure
from armodal.analyzer.arm.superset import PostureDynamics, Superset

__all__ = ["Axis", "PostureDynamics", "ReducedModel", "Structure", "Superset", "reduce_model"]
