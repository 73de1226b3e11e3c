"""Checks of a measurement that need no model of the arm's stiffness."""

from armodal.analyzer.checks.driving_point import driving_point
from armodal.analyzer.checks.homogeneity import homogeneity
from armodal.analyzer.checks.links import check_links
from armodal.analyzer.checks.reciprocity import reciprocity
from armodal.analyzer.checks.records import Fault, Outcome
from armodal.analyzer.checks.sensor import sensor_verdict
from armodal.analyzer.checks.session import check_session

__all__ = [
    "Fault",
    "Outcome",
    "check_links",
    "check_session",
    "driving_point",
    "homogeneity",
    "reciprocity",
    "sensor_verdict",
]
