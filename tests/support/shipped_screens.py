"""The screens by which tests count: what is added beside them moves nothing here."""

from armodal.tui.screens.review.pane import review_panes
from armodal.tui.screens.run.operator_screen import operator_screens

PANES = ("frf", "cmif", "poles", "modes", "mac", "shape", "identify", "gap")
STEPS = ("lab", "progress", "posture", "point", "hit")
SHIPPED_PANES = {name: review_panes()[name] for name in PANES}
SHIPPED_SCREENS = {name: operator_screens()[name] for name in STEPS}
