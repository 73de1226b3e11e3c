"""Makers of test data that share no line and no number with the analyzer or one another.

`docs/makers.md` says what each is made of. They have only tables of arms and the layout of a
session in common.
"""

from armodal.hil_sim.makers.arms import ARMS, WRISTS
from armodal.hil_sim.makers.case import SIZES, Case, CaseFiles, CaseSpec, write_case
from armodal.hil_sim.makers.draw import draw_cases
from armodal.hil_sim.makers.making import MAKERS, case_of, effects_of, make_case, newest_version

__all__ = [
    "ARMS",
    "MAKERS",
    "SIZES",
    "WRISTS",
    "Case",
    "CaseFiles",
    "CaseSpec",
    "case_of",
    "draw_cases",
    "effects_of",
    "make_case",
    "newest_version",
    "write_case",
]
