"""TDMS files of LabVIEW and DIAdem, read by npTDMS where it is installed.

A group of channels is a section. npTDMS is asked for what is in the file before any sample is
read, so that nothing larger than the file is ever made.
"""

from __future__ import annotations

import io
import logging
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from typing import Any

import numpy as np

from armodal.protocols.errors import ForeignFileError
from armodal.protocols.foreign.variables import Axis, Listed, Variable, Variables

__all__ = ["tdms_variables"]

_UNIT_KEYS = ("unit_string", "NI_UnitDescription", "Unit")
_MOST_CHANNELS = 1000
_CUT = ("Last segment", "Data size")  # how npTDMS begins to tell of a file that is cut off


def tdms_variables(data: bytes, origin: str) -> tuple[Variables, ...]:
    """Return the groups of a TDMS file.

    Raises
    ------
    ForeignFileError
        If npTDMS is not installed, or cannot read the file.
    """
    try:
        from nptdms import TdmsFile  # noqa: PLC0415 - an extra of armodal
    except ImportError as error:
        raise ForeignFileError(
            f"{origin}: wanted npTDMS to read a TDMS file, it is not installed; install it with "
            "`pip install 'armodal[files]'`"
        ) from error
    try:
        with _heard() as words, TdmsFile.open(io.BytesIO(data)) as file:
            groups = [_group(group, len(data), origin) for group in file.groups()]
    except ForeignFileError:
        raise
    except Exception as error:  # npTDMS raises whatever its parser meets
        raise ForeignFileError(
            f"{origin}: wanted a TDMS file, it cannot be read "
            f"({(str(error).splitlines() or [type(error).__name__])[0][:160]}): truncated or "
            "damaged? Save it again"
        ) from error
    filled = tuple(group for group in groups if group.variables)
    if not filled:
        raise ForeignFileError(f"{origin}: wanted channels with samples, got none; save it again")
    if any(word.startswith(_CUT) for word in words):
        said = (f"{origin}: the file ends within its samples: what is there is read",)
        filled = (replace(filled[0], said=said), *filled[1:])
    return filled


class _Heard(logging.Filter):
    """What npTDMS logs, kept instead of shown."""

    def __init__(self) -> None:
        super().__init__()
        self.words: list[str] = []

    def filter(self, record: logging.LogRecord) -> bool:
        self.words.append(str(record.msg))
        return False


@contextmanager
def _heard() -> Iterator[list[str]]:
    heard = _Heard()
    known = list(logging.Logger.manager.loggerDict)
    loggers = [logging.getLogger(name) for name in known if name.startswith("nptdms")]
    for logger in loggers:
        logger.addFilter(heard)
    try:
        yield heard.words
    finally:
        for logger in loggers:
            logger.removeFilter(heard)


def _group(group: Any, limit: int, origin: str) -> Variables:
    channels = group.channels()
    if len(channels) > _MOST_CHANNELS:
        raise ForeignFileError(
            f"{origin}: wanted at most {_MOST_CHANNELS} channels, got {len(channels)}"
        )
    variables = []
    others = []
    axis = None
    for channel in channels:
        dtype = np.dtype(channel.dtype)
        if dtype.kind not in "fiuc" or len(channel) == 0:
            others.append(Listed(name=str(channel.name), shape=(len(channel),), type=str(dtype)))
            continue
        if len(channel) * min(dtype.itemsize, 1) > limit:
            raise ForeignFileError(
                f"{origin}: wanted at most the file's {limit} bytes, channel "
                f"{str(channel.name)[:40]} announces {len(channel)} samples: damaged"
            )
        wanted = np.complex128 if dtype.kind == "c" else np.float64
        properties = channel.properties
        unit = next((str(properties[key]) for key in _UNIT_KEYS if properties.get(key)), "")
        variables.append(
            Variable(name=str(channel.name), values=np.asarray(channel[:], dtype=wanted), unit=unit)
        )
        axis = axis or _axis(properties)
    return Variables(
        origin=f"{origin}: {str(group.name)[:40]}" if group.name else origin,
        format="TDMS",
        variables=tuple(variables),
        axis=axis,
        others=tuple(others),
    )


def _axis(properties: Any) -> Axis | None:
    """Return the even axis that a waveform's properties tell."""
    step = properties.get("wf_increment")
    if not isinstance(step, (int, float)) or not np.isfinite(step) or step <= 0.0:
        return None
    first = properties.get("wf_start_offset", 0.0)
    unit = str(properties.get("wf_xunit_string", "") or properties.get("wf_xname", "")).lower()
    return Axis(
        unit="Hz" if unit.startswith(("hz", "freq")) else "s",
        first=float(first) if isinstance(first, (int, float)) else 0.0,
        step=float(step),
    )
