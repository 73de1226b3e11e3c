"""A session from foreign files: read all, build arm and plan, place what was measured."""

from __future__ import annotations

import hashlib
from fractions import Fraction

import numpy as np

from armodal.protocols.arm.records import Arm
from armodal.protocols.board.messages import encode_dictionary
from armodal.protocols.errors import ForeignFileError
from armodal.protocols.foreign.content import read_content
from armodal.protocols.foreign.even_records import trimmed, with_even_axes
from armodal.protocols.foreign.frf_matrix import frf_matrix
from armodal.protocols.foreign.hit_records import (
    PlacedHit,
    foreign_dictionary,
    hit_records,
    place_hits,
    pretrigger,
)
from armodal.protocols.foreign.import_arm import MeasuredPosture, imported_arm, placement_of
from armodal.protocols.foreign.manifest import Manifest, PostureTable
from armodal.protocols.foreign.session_texts import (
    PlanFacts,
    plan_text,
)
from armodal.protocols.foreign.variables import listing
from armodal.protocols.frf_records import FrequencyResponse
from armodal.protocols.plan import plan_from_text
from armodal.protocols.session.records import Session, SessionHeader

__all__ = ["import_session"]


def import_session(manifest: Manifest, *, created: str, software: str) -> Session:
    """Build the session a manifest describes.

    Parameters
    ----------
    manifest
        From `load_manifest`.
    created
        ISO 8601 time of the import, UTC.
    software
        What imports.

    Returns
    -------
    Session
        Every file's open questions are among its warnings. FRFs have variance 0.

    Raises
    ------
    ForeignFileError, ArmError, PlanError
        If a file, the arm or a posture cannot be used.
    """
    said: list[str] = []
    postures = [_read(manifest, table, said) for table in manifest.file.postures]
    arm = imported_arm(manifest, postures, said)
    frfs: list[FrequencyResponse] = []
    hits: list[PlacedHit] = []
    points: list[list[str]] = []
    fixed: list[str] = []
    roving_hammer = manifest.file.mode == "roving-hammer"
    for posture in postures:
        placement = placement_of(manifest, arm, posture.table)
        found = [hit for content in posture.contents for hit in content.hits]
        if found:
            placed = place_hits(found, posture.table, placement, said)
            hits += placed
            sensors = [hit.sensor_point for hit in placed]
            struck = [hit.hit_point for hit in placed]
        else:
            frf = frf_matrix(posture.contents, posture.table, placement, said)
            frfs.append(frf)
            sensors = [dof.point for dof in frf.responses]
            struck = [dof.point for dof in frf.references]
        moving, still = (struck, sensors) if roving_hammer else (sensors, struck)
        if found and len(set(still)) > 1 and len(set(moving)) > 1:
            said.append(
                f"posture {posture.table.name!r}: {len(set(struck))} points are struck and "
                f"{len(set(sensors))} have sensors: every sensor is to be hit from every one"
            )
        elif len(set(still)) != 1 and found:
            raise ForeignFileError(
                f"{manifest.origin}: posture {posture.table.name!r}: mode {manifest.file.mode} "
                f"wants one fixed point, got {', '.join(sorted(set(still)))}; change `mode`"
            )
        points.append(list(dict.fromkeys(moving)))
        fixed.append(still[0])
    hits = with_even_axes(trimmed(hits, said), said)
    dictionary = foreign_dictionary(hits)
    facts = _facts(arm, fixed[0], points, hits, frfs)
    plan = plan_from_text(plan_text(manifest.file, facts), arm, origin=manifest.origin)
    header = SessionHeader(
        session_id=_session_id(manifest),
        created=created,
        software=software,
        arm=arm,
        plan=plan,
        dictionary=dictionary,
        dictionary_bytes=encode_dictionary(dictionary),
        channel_mask=(1 << len(dictionary.channels)) - 1,
        time_scale=1.0,
    )
    return Session(
        header=header,
        hits=hit_records(hits, dictionary),
        losses=(),
        complete=True,
        warnings=(*arm.tolerances.remarks, *_gathered(said)),
        frfs=tuple(frfs),
    )


def _read(manifest: Manifest, table: PostureTable, said: list[str]) -> MeasuredPosture:
    contents = tuple(read_content(path, hints) for path, hints in manifest.files(table))
    for content in contents:
        said.extend(content.said)
    n_frfs = sum(len(content.frfs) for content in contents)
    n_hits = sum(len(content.hits) for content in contents)
    if (n_frfs > 0) == (n_hits > 0):
        came = "neither" if n_frfs == 0 else f"{n_frfs} FRFs and {n_hits} hits"
        found = listing([one for content in contents for one in content.found])
        raise ForeignFileError(
            f"{manifest.origin}: posture {table.name!r}: wanted files of FRFs or of single hits, "
            f"got {came}; list files of one kind; {found}"
        )
    return MeasuredPosture(table=table, contents=contents)


def _facts(
    arm: Arm,
    fixed_point: str,
    points: list[list[str]],
    hits: list[PlacedHit],
    frfs: list[FrequencyResponse],
) -> PlanFacts:
    if hits:
        signals = [hit.signals for hit in hits]
        peaks = [float(np.abs(one[0] - np.median(one[0])).max()) for one in signals]
        per_point = len(hits) // max(sum(len(names) for names in points), 1)
        return PlanFacts(
            arm=arm.name,
            fixed_point=fixed_point,
            hits_per_point=min(max(per_point, 1), 100),
            rate_hz=hits[0].rate_hz,
            samples=max(one.shape[1] for one in signals),
            pretrigger=min(pretrigger(one) for one in signals),
            level_n=max(0.05 * min(peaks), 1e-6),
            points=points,
        )
    # Of averaged FRFs no sampling is told: the slowest that gives these lines.
    freq = frfs[0].freq_hz
    rate = float(np.ceil(2.0 * freq[-1]))
    samples = round(rate / float(np.min(np.diff(freq))))
    return PlanFacts(
        arm=arm.name,
        fixed_point=fixed_point,
        hits_per_point=min(max(int(frfs[0].n_hits.min()), 1), 100),
        rate_hz=Fraction(min(max(rate, 1.0), 1e6)).limit_denominator(1),
        samples=min(max(samples, 64), 2**20),
        pretrigger=0,
        level_n=1.0,
        points=points,
    )


def _gathered(said: list[str]) -> tuple[str, ...]:
    """Return each sentence once, with the files it is about counted."""
    about: dict[str, list[str]] = {}
    for sentence in said:
        file, colon, text = sentence.partition(": ")
        key, name = (text, file) if colon else (sentence, "")
        names = about.setdefault(key, [])
        if name not in names:
            names.append(name)
    result = []
    for text, names in about.items():
        more = f" and {len(names) - 1} more" if len(names) > 1 else ""
        result.append(f"{names[0]}{more}: {text}" if names[0] else text)
    return tuple(result)


def _session_id(manifest: Manifest) -> str:
    digest = hashlib.sha256(manifest.text.encode())
    for posture in manifest.file.postures:
        for path, hints in manifest.files(posture):
            for one in (path, hints.force_file):
                if one is not None:
                    digest.update(hashlib.sha256(one.read_bytes()).digest())
    return digest.hexdigest()[:32]
