"""Checks of a measurement that need no model of the arm's stiffness."""

from analyzer.checks.candidates import Candidate
from analyzer.checks.driving_point import driving_point
from analyzer.checks.homogeneity import homogeneity
from analyzer.checks.links import check_links, ordinary_errors
from analyzer.checks.reciprocity import reciprocity
from analyzer.checks.records import Fault, Finding, Outcome
from analyzer.checks.rigid_link import PointSight, RigidLinkResult
from analyzer.checks.rigid_statistics import OrdinaryErrors
from analyzer.checks.sensor import sensor_verdict
from analyzer.checks.session import check_session

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
