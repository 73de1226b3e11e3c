"""Points and directions of the FRFs in named arrays: told by the manifest, the file, or names."""

from __future__ import annotations

import re
from collections.abc import Sequence

import numpy as np

from armodal.protocols.errors import ForeignFileError
from armodal.protocols.foreign.measured import Hints, NotToldError, ToldDof, parse_dof
from armodal.protocols.foreign.variables import Variables

__all__ = ["reference_dofs", "response_dofs", "told_dof"]

# "3Z:1Z", "H(3z,1z)", "+3X/-1Y", "Tool:3:+Z/Tool:1:-Z" (Testlab): response, then reference.
_ONE = r"(?:[^\W\d]\w*:)?([+-]?)(\d{1,8})[\s:]?([+-]?)([XYZ])"
_NAMED = re.compile(rf"(?<![\w.]){_ONE}\s*[:,/;]\s*{_ONE}(?![\w.])", re.IGNORECASE)
_SINGLE = re.compile(_ONE, re.IGNORECASE)
_UNIT_LENGTH = 1e-3


def told_dof(text: str) -> str:
    """Return a file's one degree of freedom as a manifest names it; empty for none.

    >>> told_dof("Tool:10:-Z")
    '10:-z'
    """
    match = _SINGLE.fullmatch(text.strip())
    return "" if match is None else _written(*match.groups())


def response_dofs(
    part: Variables, names: Sequence[str], hints: Hints, read_as: list[str]
) -> list[ToldDof]:
    """Return one degree of freedom for each row of the FRF matrix.

    Raises
    ------
    NotToldError
        If there are several rows and nobody names them.
    ForeignFileError
        If the names are more or fewer than the rows.
    """
    told = list(hints.responses) or _of_texts(part, "response") or _of_names(names, 0)
    if not told and len(names) == 1:
        return [ToldDof(None, None)]
    if not told:
        raise NotToldError(
            f"{part.origin}: wanted names for {len(names)} responses, the file has none; say "
            '`responses` in the manifest, such as ["1:z", "2:z"]',
            key=f"responses {len(names)}",
        )
    if len(told) != len(names):
        raise ForeignFileError(
            f"{part.origin}: wanted names for {len(names)} responses, got {len(told)}; say "
            "`responses` in the manifest"
        )
    if not hints.responses:
        read_as.append("the file names the points and directions")
    return told


def reference_dofs(
    part: Variables, names: Sequence[str], count: int, hints: Hints
) -> list[ToldDof]:
    """Return one degree of freedom for each column of the FRF matrix.

    Raises
    ------
    NotToldError, ForeignFileError
        As for the responses.
    """
    told = list(hints.references) or _of_texts(part, "reference") or _of_names(names, 1)[:1]
    if not told and count == 1:
        return [ToldDof(None, None)]
    if not told:
        raise NotToldError(
            f"{part.origin}: wanted names for {count} references, the file has none; say "
            '`references` in the manifest, such as ["1:-z", "2:-z"]',
            key=f"references {count}",
        )
    if len(told) != count:
        raise ForeignFileError(
            f"{part.origin}: wanted names for {count} references, got {len(told)}; say "
            "`references` in the manifest"
        )
    return told


def _of_texts(part: Variables, what: str) -> list[ToldDof]:
    """Return what the variables `responses` and `response_directions` tell."""
    dofs = [parse_dof(name, part.origin) for name in part.texts.get(f"{what}s", ())]
    name = f"{what}_directions"
    D = next((v.values for v in part.variables if v.name == name), None)
    if name in {listed.name for listed in part.listed}:
        if D is not None and D.size == 3 and len(dofs) == 1:
            D = D.reshape(1, 3)
        real = D is not None and not np.iscomplexobj(D) and D.shape == (len(dofs), 3)
        length = np.linalg.norm(D, axis=-1) if real and D is not None else np.zeros(1)
        if D is None or not real or not np.allclose(length, 1.0, atol=_UNIT_LENGTH):
            raise ForeignFileError(
                f"{part.origin}: wanted {what}_directions of unit length, got others"
            )
        dofs = [ToldDof(dof.node, d / n) for dof, d, n in zip(dofs, D, length, strict=True)]
    return dofs


def _of_names(names: Sequence[str], which: int) -> list[ToldDof]:
    """Return degrees of freedom out of names such as `H 3Z:1Z`; none if one has none."""
    dofs = []
    for name in names:
        match = _NAMED.search(name)
        if match is None:
            return []
        told = match.groups()[4 * which : 4 * which + 4]
        dofs.append(parse_dof(_written(*told), name))
    return dofs


def _written(before: str, node: str, after: str, axis: str) -> str:
    sign = "-" if "-" in {before, after} else ""
    return f"{node}:{sign}{axis.lower()}"
