"""Sealed cases for the study of gap naming: sessions, made in process, in which an effect hides.

`docs/simulated-plant.md` says what can hide and what every case has wrong besides.
"""

from armodal.hil_sim.study.any_arm import can_size, rehearsal_plan, study_of
from armodal.hil_sim.study.arms import STUDY_ARMS, StudyArm, study_arm
from armodal.hil_sim.study.cases import (
    CaseFiles,
    SealedCase,
    make_case,
    sealed,
    write_case,
)
from armodal.hil_sim.study.catalogue import LIBRARY, MAGNITUDES, OUTSIDE, VERSION, library
from armodal.hil_sim.study.draw import draw_study
from armodal.hil_sim.study.hiding import CaseSpec

__all__ = [
    "LIBRARY",
    "MAGNITUDES",
    "OUTSIDE",
    "STUDY_ARMS",
    "VERSION",
    "CaseFiles",
    "CaseSpec",
    "SealedCase",
    "StudyArm",
    "can_size",
    "draw_study",
    "library",
    "make_case",
    "rehearsal_plan",
    "sealed",
    "study_arm",
    "study_of",
    "write_case",
]
