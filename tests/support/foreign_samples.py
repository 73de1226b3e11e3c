"""Universal files for tests: made of closed forms, written by pyuff alone or by armodal."""

import numpy as np
import pyuff

from armodal.protocols.foreign.uff_records import (
    UffFile,
    UffFunction,
    UffHeader,
    UffNodes,
    UffShape,
    UffTraceLine,
)
from armodal.protocols.foreign.uff_write import SI_UNITS

POLES_HZ = (30.0, 75.0)
DAMPING = 0.02


def accelerance(freq_hz, i, j):
    """A free-floating chain's accelerance: two modes of known shape and unit modal mass."""
    shapes = np.array([[1.0, 0.8], [0.6, -0.9], [-0.5, 0.4]])
    s = 2j * np.pi * freq_hz
    total = np.zeros(len(freq_hz), dtype=complex)
    for r, f in enumerate(POLES_HZ):
        w = 2 * np.pi * f
        total += s**2 * shapes[i, r] * shapes[j, r] / (s**2 + 2 * DAMPING * w * s + w**2)
    return total


def frf_set(node, values, freq_hz, **changes):
    """Dataset 58 as people write it with pyuff, without anything optional."""
    return {
        "type": 58,
        "func_type": 4,
        "rsp_node": node,
        "rsp_dir": 3,
        "ref_node": 1,
        "ref_dir": 3,
        "data": np.array(values),
        "x": np.array(freq_hz),
        "abscissa_spacing": 1,
        "abscissa_spec_data_type": 18,
        "ordinate_spec_data_type": 12,
        "orddenom_spec_data_type": 13,
        "binary": 0,
        **changes,
    }


def si_set():
    return pyuff.prepare_164(
        units_code=1,
        units_description="SI",
        temp_mode=1,
        length=1.0,
        force=1.0,
        temp=1.0,
        temp_offset=273.15,
    )


def write_sets(path, sets):
    """Have pyuff write datasets one by one, for its "overwrite" loses headers of 58b."""
    path.unlink(missing_ok=True)
    file = pyuff.UFF(str(path))
    for content in sets:
        file.write_sets([content], mode="add")
    return path


def chain_file(path, *, nodes=(1, 2, 3), units=True, lines=400, **changes):
    """FRFs of three points over point 1, lines 0.25 Hz apart from 0 Hz."""
    freq = 0.25 * np.arange(lines)
    sets = [si_set()] if units else []
    sets += [
        frf_set(node, accelerance(freq, i, 0), freq, **changes) for i, node in enumerate(nodes)
    ]
    return write_sets(path, sets)


def whole_file(rng, *, n=33):
    """One dataset of every kind, with numbers that are exact in no decimal format."""

    def function(even, is_complex):
        x = np.arange(n) * (51200 / 31 / 2048) if even else np.sort(rng.uniform(1, 100, n))
        values = rng.standard_normal(n) + (1j * rng.standard_normal(n) if is_complex else 0.0)
        return UffFunction(
            kind=4 if is_complex else 6,
            response_node=3,
            response_direction=-2,
            reference_node=1,
            reference_direction=3,
            abscissa=x,
            values=values,
            even=even,
            numerator=12,
            denominator=13,
            numerator_unit="m/s^2",
            denominator_unit="N",
            abscissa_kind=18,
            identification=("one", "two", "three", "four", "five"),
        )

    position = rng.standard_normal((9, 3))
    node = np.arange(1, 10)
    return UffFile(
        header=UffHeader(model="model", description="words", program="program"),
        units=SI_UNITS,
        nodes=UffNodes(number=node, position=position),
        trace_lines=(UffTraceLine(number=1, name="line", nodes=node),),
        functions=tuple(function(even, c) for even in (False, True) for c in (False, True)),
        shapes=(
            UffShape(mode=1, node=node, shape=position, f_hz=3.4, damping_ratio=0.01),
            UffShape(
                mode=2,
                node=node,
                shape=position * (1 + 2j),
                f_hz=abs(-1 + 20j) / (2 * np.pi),
                damping_ratio=1 / abs(-1 + 20j),
                pole_rad_s=-1 + 20j,
                modal_a=0.5 - 2j,
            ),
        ),
    )
