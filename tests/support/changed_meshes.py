"""COLLADA and PLY files made wrong: their loader is another's, and runs in a process of its own."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from support.bombs_of_others import collada
from support.mutate import mutated, mutated_text

PLY = (
    b"ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
    b"property float z\nelement face 4\nproperty list uchar int vertex_indices\nend_header\n"
    b"0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n"
)
WHOLE = {".dae": collada(nodes=1), ".ply": PLY}


def changed_meshes(count: int, rng: np.random.Generator) -> Iterator[tuple[str, bytes]]:
    """Yield the ending and the bytes of so many files of either kind."""
    for number in range(count):
        for ending, whole in WHOLE.items():
            change = mutated_text if number % 2 else mutated
            yield ending, change(whole, rng)
