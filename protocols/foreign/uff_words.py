"""What is in a universal file, in words."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from armodal.protocols.foreign.uff_records import UffFile, UffFunction
from armodal.protocols.foreign.variables import Listed

__all__ = ["DATASETS", "FUNCTIONS", "listed_uff", "skipped_words"]

# SDRC I-DEAS universal files, as kept by the University of Cincinnati.
DATASETS = {
    15: "nodes", 18: "coordinate systems", 55: "data at nodes", 56: "data on elements",
    57: "data at nodes of elements", 58: "functions", 82: "trace lines", 151: "header",
    164: "units", 781: "nodes", 1858: "qualifiers of functions", 2400: "model header",
    2411: "nodes", 2412: "elements", 2414: "analysis data", 2420: "coordinate systems",
    2429: "groups", 2467: "groups", 2477: "groups",
}  # fmt: skip
FUNCTIONS = {
    0: "general", 1: "time record", 2: "auto spectrum", 3: "cross spectrum", 4: "FRF",
    5: "transmissibility", 6: "coherence", 7: "auto correlation", 8: "cross correlation",
    9: "power spectral density", 10: "energy spectral density", 12: "spectrum",
    13: "cumulative frequency distribution", 16: "impulse response", 17: "multiple coherence",
}  # fmt: skip
_AXES = ("", "x", "y", "z", "rx", "ry", "rz")


def skipped_words(skipped: Sequence[int]) -> list[str]:
    """Return a sentence about the datasets that are not read."""
    if not skipped:
        return []
    kinds = [f"{kind} ({DATASETS.get(kind, 'unknown')})" for kind in sorted(set(skipped))]
    return [f"datasets of type {', '.join(kinds)} are not read"]


def listed_uff(file: UffFile) -> tuple[Listed, ...]:
    """Return everything in a universal file: functions one by one, other datasets together."""
    listed = [_function(function) for function in file.functions]
    if file.units is not None:
        listed.insert(0, Listed(name=f"units {file.units.description}", shape=(), type=""))
    if file.nodes is not None:
        listed.append(Listed(name="nodes", shape=(len(file.nodes.number),), type=""))
    if file.trace_lines:
        listed.append(Listed(name="lines", shape=(len(file.trace_lines),), type=""))
    if file.shapes:
        listed.append(Listed(name="mode shapes", shape=(len(file.shapes),), type=""))
    for kind, count in sorted(Counter(file.skipped).items()):
        name = f"dataset {kind}, {DATASETS.get(kind, 'unknown')}"
        listed.append(Listed(name=name, shape=(count,), type="not read"))
    return tuple(listed)


def _function(function: UffFunction) -> Listed:
    name = FUNCTIONS.get(function.kind, f"function {function.kind}")
    response = _dof(function.response_node, function.response_direction)
    reference = _dof(function.reference_node, function.reference_direction)
    over = f" over {reference}" if function.kind != 1 else ""
    units = [unit for unit in (function.numerator_unit, function.denominator_unit) if unit]
    return Listed(
        name=f"{name} {response}{over}",
        shape=function.values.shape,
        type="complex" if function.values.dtype.kind == "c" else "real",
        unit=" over ".join(units),
        role={1: "hit", 4: "frf", 6: "coherence"}.get(function.kind, ""),
    )


def _dof(node: int, direction: int) -> str:
    sign = "-" if direction < 0 else "+"
    return f"{node}:{sign}{_AXES[abs(direction)]}" if direction else f"{node}"
