"""Files of the Rattlesnake vibration controller: netCDF of time data and, of a modal test, FRFs.

The root has the attribute `sample_rate` and `time_data` (channels, samples); the group `channels`
a table of strings (`node_number`, `node_direction`, `unit`, …); the group of a modal test
`frf_data_real` and `frf_data_imag` (lines, responses, references), `coherence` (lines, responses),
`response_channel_indices`, `reference_channel_indices`, and the attributes `samples_per_frame` and
`num_averages`.

References
----------
Sandia National Laboratories, Rattlesnake User's Manual, output files.
"""

from __future__ import annotations

import re
from collections.abc import Mapping

import numpy as np
import numpy.typing as npt

from armodal.protocols.errors import ForeignFileError
from armodal.protocols.foreign.variables import Axis, Variable, Variables

__all__ = ["is_rattlesnake", "rattlesnake_variables"]

_DIRECTION = re.compile(r"([+-]?)([XYZ])([+-]?)", re.IGNORECASE)


def is_rattlesnake(part: Variables, settings: Mapping[str, float]) -> bool:
    """Return whether an HDF5 file is one of Rattlesnake."""
    return settings.get("sample_rate", 0.0) > 0.0 and "channels.unit" in part.texts


def rattlesnake_variables(part: Variables, settings: Mapping[str, float]) -> tuple[Variables, ...]:
    """Return the FRFs of a modal test, else the time data, with units and degrees of freedom."""
    by_name = {variable.name: variable.values for variable in part.variables}
    channels = {
        name.removeprefix("channels."): words
        for name, words in part.texts.items()
        if name.startswith("channels.")
    }
    rate = settings["sample_rate"]
    real = next((name for name in by_name if name.endswith(".frf_data_real")), None)
    if real is None:
        return (_time_data(part, by_name, channels, rate),)
    group = real.removesuffix(".frf_data_real")
    frame = settings.get(f"{group}.samples_per_frame", 0.0)
    imaginary = by_name.get(f"{group}.frf_data_imag")
    responses = _places(by_name.get(f"{group}.response_channel_indices"), channels)
    references = _places(by_name.get(f"{group}.reference_channel_indices"), channels)
    if imaginary is None or imaginary.shape != by_name[real].shape or frame <= 0.0:
        raise ForeignFileError(
            f"{part.origin}: wanted frf_data_real and frf_data_imag of one shape and "
            f"samples_per_frame in {group!r}, got others: the file is damaged"
        )
    H = np.moveaxis(by_name[real] + 1j * imaginary, 0, -1)
    units = {(channels["unit"][i], channels["unit"][j]) for i in responses for j in references}
    unit = "({})/{}".format(*units.pop()) if len(units) == 1 else ""
    variables = [Variable(name="frf", values=H, unit=unit)]
    coherence = by_name.get(f"{group}.coherence")
    if coherence is not None:
        variables.append(Variable(name="coherence", values=np.moveaxis(coherence, 0, -1)))
    averages = settings.get(f"{group}.num_averages")
    if averages is not None:
        variables.append(Variable(name="averages", values=np.array(averages)))
    texts = {"responses": _dofs(responses, channels), "references": _dofs(references, channels)}
    return (
        Variables(
            origin=part.origin,
            format="Rattlesnake modal test",
            variables=tuple(variables),
            axis=Axis(unit="Hz", first=0.0, step=rate / frame),
            texts={key: words for key, words in texts.items() if words},
        ),
    )


def _time_data(
    part: Variables,
    by_name: Mapping[str, npt.NDArray[np.float64]],
    channels: Mapping[str, tuple[str, ...]],
    rate: float,
) -> Variables:
    table = by_name.get("time_data")
    units = channels["unit"]
    if table is None or table.ndim != 2 or len(table) != len(units):
        raise ForeignFileError(
            f"{part.origin}: wanted time_data of {len(units)} channels, got others: damaged"
        )
    return Variables(
        origin=part.origin,
        format="Rattlesnake time data",
        variables=tuple(
            Variable(name=f"channel {i + 1}", values=row, unit=unit)
            for i, (row, unit) in enumerate(zip(table, units, strict=True))
        ),
        axis=Axis(unit="s", first=0.0, step=1.0 / rate),
    )


def _places(
    indices: npt.NDArray[np.float64] | None, channels: Mapping[str, tuple[str, ...]]
) -> list[int]:
    if indices is None:
        return []
    places = [int(index) for index in np.real(indices).reshape(-1)]
    return [place for place in places if 0 <= place < len(channels["unit"])]


def _dofs(places: list[int], channels: Mapping[str, tuple[str, ...]]) -> tuple[str, ...]:
    """Return names such as `101:-z`; none where the table lacks one."""
    nodes, directions = channels.get("node_number", ()), channels.get("node_direction", ())
    named = []
    for place in places:
        if place >= min(len(nodes), len(directions)) or not nodes[place]:
            return ()
        match = _DIRECTION.fullmatch(directions[place])
        sign = "-" if match and "-" in match.groups() else ""
        named.append(
            f"{nodes[place][:16]}:{sign}{match[2].lower()}" if match else nodes[place][:16]
        )
    return tuple(named)
