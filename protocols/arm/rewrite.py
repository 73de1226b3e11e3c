"""Write other values into an arm file and leave everything else as it stands."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import tomlkit
from tomlkit import TOMLDocument
from tomlkit.exceptions import TOMLKitError
from tomlkit.items import InlineTable, Table

from armodal.protocols.arm.files import arm_from_texts
from armodal.protocols.arm.records import (
    AddedEffect,
    Arm,
    Estimate,
    InertialLink,
    PastSession,
    Point,
)
from armodal.protocols.errors import ArmError

__all__ = ["text_with_effects", "text_with_inertials", "text_with_point"]

_DIGITS = 6


def text_with_inertials(text: str, links: Sequence[InertialLink], *, name: str, source: str) -> str:
    """Return an arm file's text with the inertials of its links replaced.

    Parameters
    ----------
    text
        An arm file that has been read without error.
    links
        One per joint, base outwards.
    name, source
        Of the new arm; the source says where the inertials come from.
    """
    document = tomlkit.parse(text)
    document["name"] = name
    document["source"] = source
    document.pop("masses", None)  # every link gets its own mass
    joints = document["joints"]
    for joint, link in zip(joints, links, strict=True):
        inertia = link.inertia_kg_m2
        table = tomlkit.inline_table()
        table["name"] = link.name
        table["mass_kg"] = _short(link.mass_kg)
        table["center_m"] = [_short(value) for value in link.center_m]
        table["inertia_kg_m2"] = [
            _short(inertia[i, j]) for i, j in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))
        ]
        joint["link"] = table
    return tomlkit.dumps(document)


def text_with_effects(
    arm: Arm,
    effects: Sequence[AddedEffect],
    *,
    stiffness: Mapping[str, Estimate] | None = None,
    damping: Mapping[str, Estimate] | None = None,
    name: str | None = None,
    past: Sequence[PastSession] = (),
) -> str:
    """Return an arm's text with its effects, and values of its joints, replaced.

    Parameters
    ----------
    arm
        Its text is read with comments and order, and keeps both where nothing changes.
    effects
        All effects of the new arm. One that the arm has already, with the same values, keeps its
        lines; one that is not among them is taken out.
    stiffness, damping
        N m/rad and N m s/rad by joint; joints not named keep theirs.
    name
        Of the new arm; None keeps it.

    past
        The sessions the values come from, for the file's history.

    Raises
    ------
    ArmError
        If a joint is not the arm's, or a value is one that an arm file cannot hold.
    """
    try:
        document = tomlkit.parse(arm.text)
        if name is not None:
            document["name"] = name
        joints = {str(joint["name"]): joint for joint in document["joints"]}
        for key, values in (
            ("stiffness_n_m_per_rad", stiffness or {}),
            ("damping_n_m_s_per_rad", damping or {}),
        ):
            for joint, estimate in values.items():
                if joint not in joints:
                    raise ArmError(
                        f"arm {arm.name!r}: wanted one of the joints {', '.join(joints)}, "
                        f"got {joint!r}"
                    )
                _put(joints[joint], key, _estimate(estimate))
        if tuple(effects) != arm.effects:
            # One that stays as it is keeps its lines.
            kept = list(zip(arm.effects, document.get("effects", []), strict=True))
            document.pop("effects", None)
            tables = tomlkit.aot()
            for effect in effects:
                tables.append(
                    next(
                        (t for e, t in kept if e == effect and isinstance(t, Table)),
                        _effect(effect),
                    )
                )
            if effects:
                document["effects"] = tables
        if past:
            _remember(document, past)
        text = tomlkit.dumps(document)
    except TOMLKitError as problem:
        raise ArmError(f"arm {arm.name!r}: its text cannot be rewritten: {problem}") from problem
    database = None if arm.can is None else arm.can.database_text
    changed = arm_from_texts(
        text, urdf_text=arm.urdf_text, database_text=database, origin=f"arm {name or arm.name}"
    )
    if changed.effects != tuple(effects):
        raise ArmError(f"arm {arm.name!r}: wanted effects as an array of tables, [[effects]]")
    return text


def text_with_point(arm: Arm, point: Point) -> str:
    """Return an arm's text with one of its points moved; the rest keeps its lines.

    Raises
    ------
    ArmError
        If the text cannot be rewritten, or would not be an arm file.
    """
    try:
        document = tomlkit.parse(arm.text)
        for table in document["points"]:
            if table["id"] == point.id:
                table["position_m"] = [round(float(value), 5) for value in point.position_m]
                table["normal"] = [round(float(value), 6) for value in point.R_link_sensor[:, 2]]
                table["x_axis"] = [round(float(value), 6) for value in point.R_link_sensor[:, 0]]
        text = tomlkit.dumps(document)
    except TOMLKitError as problem:
        raise ArmError(f"arm {arm.name!r}: its text cannot be rewritten: {problem}") from problem
    database = None if arm.can is None else arm.can.database_text
    arm_from_texts(text, urdf_text=arm.urdf_text, database_text=database, origin=f"arm {arm.name}")
    return text


def _remember(document: TOMLDocument, past: Sequence[PastSession]) -> None:
    """Put sessions at the end of the file's history."""
    every = tomlkit.aot()
    for old in document.pop("history", []):
        table = tomlkit.table()
        table.update(old)
        every.append(table)
    for new in past:
        table = tomlkit.table()
        table["session_sha256"] = new.session_sha256
        table["by"] = new.by
        table["created"] = new.created
        every.append(table)
    document["history"] = every


def _put(joint: Table, key: str, value: InlineTable) -> None:
    """Replace a value and keep the comment at the end of its line."""
    old = joint.get(key)
    if old is not None and not isinstance(old, Table):
        value.trivia.comment_ws, value.trivia.comment = old.trivia.comment_ws, old.trivia.comment
    joint[key] = value


def _estimate(estimate: Estimate) -> InlineTable:
    table = tomlkit.inline_table()
    table["value"] = float(estimate.value)
    table["std"] = float(estimate.std)
    table["source"] = estimate.source
    return table


def _effect(effect: AddedEffect) -> Table:
    table = tomlkit.table()
    table["name"] = effect.name
    table["place"] = effect.place
    parameters = tomlkit.table()
    for p in effect.parameters:
        inline = tomlkit.inline_table()
        if p.unit:
            inline["unit"] = p.unit
        for key, value in (("value", p.value), ("std", p.std), ("low", p.low), ("high", p.high)):
            inline[key] = float(value)
        parameters[p.name] = inline
    table["parameters"] = parameters
    if effect.description:
        description = tomlkit.inline_table()
        for key, said in effect.description.items():
            description[key] = list(said) if isinstance(said, tuple) else said
        table["description"] = description
    e = effect.evidence
    evidence = tomlkit.table()
    weighed = {
        "gain_nats": e.gain_nats,
        "held_out_gain_nats": e.held_out_gain_nats,
        "confidence": e.confidence,
    }
    for key, told in weighed.items():
        if told is not None:
            evidence[key] = float(told)
    evidence["session_sha256"] = e.session_sha256
    evidence["created"] = e.created
    table["evidence"] = evidence
    return table


def _short(value: float) -> float:
    # What is below a nanometre or a nano kg m² is rounding of a zero.
    return 0.0 if abs(value) < 1e-9 else float(f"{value:.{_DIGITS}g}")
