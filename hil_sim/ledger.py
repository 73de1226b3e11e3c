"""The ledger: what truly happened in the simulated laboratory, one JSON object a line.

Only the laboratory writes it. Only tests, the last table of the demo and `armodal sim --open` read
it. The lines of a sealed ledger are packed, so that nobody reads them by accident.
"""

from __future__ import annotations

import base64
import binascii
import hashlib
import json
import os
import zlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from armodal.hil_sim.plant import Plant
from armodal.protocols.arrays import frozen_array
from armodal.protocols.errors import PlantError

__all__ = ["AxisTruth", "JointTruth", "LedgerRecord", "LedgerTruth", "LedgerWriter", "read_ledger"]


@dataclass(frozen=True, slots=True, kw_only=True)
class JointTruth:
    """True stiffness and damping of a joint."""

    name: str
    k_n_m_per_rad: float
    c_n_m_s_per_rad: float


@dataclass(frozen=True, slots=True, kw_only=True)
class AxisTruth:
    """The hidden axis, in the base frame while all joint angles are zero, and in its link's.

    In the link's frame it stays where it is in every posture.
    """

    link: str
    point_base_m: npt.NDArray[np.float64]  # (3,) base frame, all joint angles zero
    direction_base: npt.NDArray[np.float64]  # (3,) unit, base frame, all joint angles zero
    point_link_m: npt.NDArray[np.float64]  # (3,) link frame
    direction_link: npt.NDArray[np.float64]  # (3,) unit, link frame
    k_n_m_per_rad: float
    c_n_m_s_per_rad: float


@dataclass(frozen=True, slots=True, kw_only=True)
class LedgerTruth:
    """What the laboratory keeps to itself."""

    plant: str
    seed: int
    time_scale: float
    joints: tuple[JointTruth, ...]  # those that give way, base outwards
    axis: AxisTruth | None
    effects: tuple[Mapping[str, Any], ...] = ()  # name, place and parameters of what is hidden

    def joint(self, name: str) -> JointTruth:
        """Return the truth of a joint, or raise KeyError."""
        for joint in self.joints:
            if joint.name == name:
                return joint
        raise KeyError(name)


@dataclass(frozen=True, slots=True, kw_only=True)
class LedgerRecord:
    """A ledger as read: the truth, and the events in order with their lab times."""

    truth: LedgerTruth
    events: tuple[dict[str, Any], ...]

    def of(self, kind: str) -> tuple[dict[str, Any], ...]:
        """Return the events of a kind: posture, mount, hit, sampling, fault, end."""
        return tuple(event for event in self.events if event["event"] == kind)


class LedgerWriter:
    """Appends to a ledger; the first line is the truth.

    Attributes
    ----------
    truth_sha256
        Of the truth's line before it is packed, to be told before anybody measures.
    """

    def __init__(
        self,
        path: Path,
        plant: Plant,
        *,
        seed: int,
        time_scale: float,
        effects: Sequence[Mapping[str, object]] = (),
        sealed: bool = False,
    ) -> None:
        fd = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_APPEND, 0o600)
        self._file = os.fdopen(fd, "a", encoding="utf-8")
        self._sealed = sealed
        truth = _truth_of(plant) | {"seed": seed, "time_scale": time_scale}
        told = self._write({"truth": truth | {"effects": list(effects)}})
        self.truth_sha256 = hashlib.sha256(told.encode()).hexdigest()

    def note(self, event: str, lab_s: float, **facts: object) -> None:
        """Append what happened at lab time `lab_s`; arrays become lists."""
        self._write({"event": event, "lab_s": lab_s} | facts)

    def close(self) -> None:
        """Close the file."""
        self._file.close()

    def _write(self, entry: dict[str, Any]) -> str:
        told = json.dumps(entry, default=_plain)
        line = base64.b64encode(zlib.compress(told.encode())).decode() if self._sealed else told
        self._file.write(line + "\n")
        self._file.flush()
        return told


def _plain(value: object) -> object:
    if isinstance(value, np.ndarray | np.generic):
        return value.tolist()
    raise TypeError(f"a ledger holds numbers, text and arrays, got {type(value).__name__}")


def _truth_of(plant: Plant) -> dict[str, Any]:
    truth = plant.truth
    joints = [
        {
            "name": link.joint,
            "k_n_m_per_rad": link.stiffness_n_m_per_rad,
            "c_n_m_s_per_rad": link.damping_n_m_s_per_rad,
        }
        for link in truth.links
        if link.stiffness_n_m_per_rad is not None
    ]
    weak = truth.hidden_axis
    axis: dict[str, Any] | None = None
    if weak is not None:
        # Link frames are parallel to the base while all joint angles are zero.
        names = [link.name for link in truth.links]
        carriers = truth.links[: names.index(weak.link) + 1]
        origin = np.sum([link.origin_m for link in carriers], axis=0)
        direction = np.array(weak.direction) / np.linalg.norm(weak.direction)
        axis = {
            "link": weak.link,
            "point_base_m": origin + weak.point_m,
            "direction_base": direction,
            "point_link_m": weak.point_m,
            "direction_link": direction,
            "k_n_m_per_rad": weak.stiffness_n_m_per_rad,
            "c_n_m_s_per_rad": weak.damping_n_m_s_per_rad,
        }
    return {"plant": truth.name, "joints": joints, "axis": axis}


def read_ledger(path: str | Path) -> LedgerRecord:
    """Read a ledger; a last line that is not complete is left out.

    Raises
    ------
    PlantError
        If the file is missing or is no ledger.
    """
    try:
        lines = Path(path).read_text(encoding="utf-8").split("\n")[:-1]
        entries = [_opened(line) for line in lines]
        # A laboratory started again in the same folder goes on below.
        last = max(i for i, entry in enumerate(entries) if "truth" in entry)
        truth = _read_truth(entries[last]["truth"])
    except (OSError, ValueError, LookupError, TypeError, zlib.error) as error:
        raise PlantError(
            f"ledger {path}: wanted the ledger of a simulated laboratory, got {error!r}; "
            "give the path that the laboratory printed"
        ) from error
    return LedgerRecord(truth=truth, events=tuple(entries[last + 1 :]))


def _opened(line: str) -> dict[str, Any]:
    """Read a line of a ledger, sealed or not."""
    if not line.startswith("{"):
        try:
            line = zlib.decompress(base64.b64decode(line, validate=True)).decode()
        except binascii.Error as error:
            raise ValueError(line[:40]) from error
    entry: dict[str, Any] = json.loads(line)
    return entry


def _read_truth(entry: dict[str, Any]) -> LedgerTruth:
    axis = entry["axis"]
    if axis is not None:
        vectors = ("point_base_m", "direction_base", "point_link_m", "direction_link")
        axis = axis | {name: frozen_array(axis[name], np.float64) for name in vectors}
    return LedgerTruth(
        plant=entry["plant"],
        seed=entry["seed"],
        time_scale=entry["time_scale"],
        joints=tuple(JointTruth(**joint) for joint in entry["joints"]),
        axis=AxisTruth(**axis) if axis is not None else None,
        effects=tuple(entry.get("effects", ())),
    )
