"""The HEADER record: what is fixed when a session begins, with the texts it rests on."""

from __future__ import annotations

from protocols.board.messages import decode_dictionary
from protocols.errors import ArmodalError, JournalError
from protocols.session.journal_framing import MAGIC, RecordKind, encode_record
from protocols.session.journal_models import HeaderModel, check, from_json, to_json
from protocols.session.journal_payloads import join_payload, split_payload
from protocols.session.records import SessionHeader

__all__ = ["begin_journal", "decode_header"]

_JSON_LIMIT = 32 * 2**20


def begin_journal(header: SessionHeader) -> bytes:
    """Return the first bytes of a journal: magic and HEADER record."""
    arm, plan = header.arm, header.plan
    model = check(
        HeaderModel,
        {
            "session_id": header.session_id,
            "created": header.created,
            "software": header.software,
            "arm_text": arm.text,
            "urdf_text": arm.urdf_text,
            "database_text": None if arm.can is None else arm.can.database_text,
            "arm_sha256": arm.sha256,
            "plan_text": plan.text,
            "plan_sha256": plan.sha256,
            "channel_mask": header.channel_mask,
            "time_scale": header.time_scale,
        },
        "session header",
    )
    payload = join_payload(to_json(model), header.dictionary_bytes)
    return MAGIC + encode_record(RecordKind.HEADER, payload)


def decode_header(payload: bytes | memoryview) -> SessionHeader:
    """Return the session header; arm, plan and dictionary are read from the texts inside."""
    text, dictionary_bytes = split_payload(payload, "HEADER", _JSON_LIMIT)
    model = from_json(HeaderModel, text, "HEADER", _JSON_LIMIT)
    from protocols.arm.files import parse_arm
    from protocols.plan import parse_plan

    try:
        arm = parse_arm(model.arm_text, model.urdf_text, model.database_text)
        plan = parse_plan(model.plan_text, arm)
        dictionary = decode_dictionary(dictionary_bytes)
    except ArmodalError as error:
        raise JournalError(f"what the journal's HEADER holds cannot be used: {error}") from error
    for name, found, told in (
        ("arm", arm.sha256, model.arm_sha256),
        ("plan", plan.sha256, model.plan_sha256),
    ):
        if found != told:
            raise JournalError(
                f"the {name} text in the journal's HEADER has SHA-256 {found}, the HEADER says "
                f"{told}: the text was changed after the session began"
            )
    if model.channel_mask >> len(dictionary.channels):
        raise JournalError(
            f"the channel mask {model.channel_mask:#x} names a channel the board has not "
            f"({len(dictionary.channels)} channels)"
        )
    return SessionHeader(
        session_id=model.session_id,
        created=model.created,
        software=model.software,
        arm=arm,
        plan=plan,
        dictionary=dictionary,
        dictionary_bytes=dictionary_bytes,
        channel_mask=model.channel_mask,
        time_scale=model.time_scale,
    )
