"""Colours of the report; every text of them on white has a contrast of 4.5 : 1 or more."""

__all__ = ["DRIVEN", "FAINT", "FOUND", "GRID", "INK", "MODEL", "OTHER", "REST"]

INK = "#1d2733"
GRID = "#dfe4ea"
FAINT = "#8b98a5"  # curves beside the ones that are meant
REST = "#b9c3cd"  # what stands still
DRIVEN = "#0b5cad"  # measured, at the driving point; what moves
OTHER = "#1a7f5a"  # measured, a second choice
MODEL = "#c2410c"  # computed
FOUND = "#b91c1c"  # where the model departs
