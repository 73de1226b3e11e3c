"""Checks of a measurement that need no model of the arm's stiffness."""

from armodal.analyzer.checks.candidates import Candidate
from armodal.analyzer.checks.driving_point import driving_point
from armodal.analyzer.checks.homogeneity import homogeneity
from armodal.analyzer.checks.links import check_links, ordinary_errors
from armodal.analyzer.checks.reciprocity import reciprocity
from armodal.analyzer.checks.records import Fault, Finding, Outcome
from armodal.analyzer.checks.rigid_link import PointSight, RigidLinkResult
from armodal.analyzer.checks.rigid_statistics import OrdinaryErrors
from armodal.analyzer.checks.sensor import sensor_verdict
from armodal.analyzer.checks.session import check_session

__all__ = [
    "Candidate",
    "Fault",
    "Finding",
    "OrdinaryErrors",
    "Outcome",
    "PointSight",
    "RigidLinkResult",
    "check_links",
    "check_session",
    "driving_point",
    "homogeneity",
    "ordinary_errors",
    "reciprocity",
    "sensor_verdict",
]
