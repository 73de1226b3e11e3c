"""Triangles of a mesh file of several parts, each put back on its own vertices.

Coal's loader puts the vertices of all parts of a file one behind the other, and numbers the
corners of some parts as if these stood alone: of those of one node, such as an OBJ's materials, and
of nodes deep in a tree. Vertices are then used by no triangle, and others by strangers. A part is
found again by what a part is: its first triangle (a, a + 1, a + 2), and every number from `a` on
used; together the parts use every vertex.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

__all__ = ["separated_parts"]

Triangles = npt.NDArray[np.int64]


def separated_parts(n_vertices: int, triangles: Triangles) -> Triangles | None:
    """The triangles with their corners numbered through the whole file.

    Parameters
    ----------
    n_vertices
        Of the file.
    triangles
        (n, 3) as read.

    Returns
    -------
    (n, 3) int64 or None
        Unchanged where every vertex is used; None where parts that use every vertex are not found.
    """
    if len(np.unique(triangles)) == n_vertices:
        return triangles
    first, second, third = triangles.T
    starts = np.flatnonzero((second == first + 1) & (third == first + 2)).tolist()
    if not starts or starts[0] != 0:
        return None
    bounds = [*starts, len(triangles)]
    # By the bound that a part may end at: vertices used so far, and the bound and count before.
    ways: list[dict[int, tuple[int, int]]] = [{} for _ in bounds]
    ways[0][0] = (0, 0)
    for i, start in enumerate(starts):
        if not ways[i]:
            continue
        base = int(triangles[start, 0])
        seen = np.zeros(n_vertices + 1, dtype=bool)
        top = base
        for j in range(i + 1, len(bounds)):
            part = triangles[bounds[j - 1] : bounds[j]]
            if part.min() < base:
                break
            seen[part.ravel()] = True
            top = max(top, int(part.max()))
            n_used = top + 1 - base
            if seen[base : top + 1].all():
                for before in ways[i]:
                    if before + n_used <= n_vertices:
                        ways[j].setdefault(before + n_used, (i, before))
    if n_vertices not in ways[-1]:
        return None
    untangled = triangles.copy()
    end, used = len(bounds) - 1, n_vertices
    while end:
        begin, before = ways[end][used]
        untangled[bounds[begin] : bounds[end]] += before - triangles[bounds[begin], 0]
        end, used = begin, before
    return untangled
