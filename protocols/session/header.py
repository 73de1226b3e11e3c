"""The session header as it is stored: texts from which arm, plan and dictionary are read again."""

from __future__ import annotations

from armodal.protocols.arm.files import arm_from_texts
from armodal.protocols.board.messages import decode_dictionary
from armodal.protocols.errors import ArmodalError, JournalError
from armodal.protocols.plan import plan_from_text
from armodal.protocols.session.journal_models import HeaderModel, check
from armodal.protocols.session.records import SessionHeader

__all__ = ["header_model", "header_of"]


def header_model(header: SessionHeader) -> HeaderModel:
    """Return what is stored of `header` beside the dictionary's bytes.

    Raises
    ------
    JournalError
        If a value is impossible, or arm, plan and dictionary are not what their texts and
        bytes say: such a header could be written and never read.
    """
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
            "told_tolerance_rad": header.told_tolerance_rad,
            "measured_by": header.measured_by,
        },
        "session header",
    )
    if header_of(model, header.dictionary_bytes).dictionary != header.dictionary:
        raise JournalError("session header: the dictionary is not the one its bytes describe")
    return model


def header_of(model: HeaderModel, dictionary_bytes: bytes) -> SessionHeader:
    """Return the header that `model` and the board's dictionary describe.

    Raises
    ------
    JournalError
        If a text or the dictionary cannot be read, or is not the one the model names.
    """
    try:
        arm = arm_from_texts(
            model.arm_text, urdf_text=model.urdf_text, database_text=model.database_text
        )
        plan = plan_from_text(model.plan_text, arm)
        dictionary = decode_dictionary(dictionary_bytes)
    except ArmodalError as error:
        raise JournalError(f"the arm, plan or dictionary stored in the session: {error}") from error
    for name, found, told in (
        ("arm", arm.sha256, model.arm_sha256),
        ("plan", plan.sha256, model.plan_sha256),
    ):
        if found != told:
            raise JournalError(
                f"the {name} stored in the session has SHA-256 {found}, its header says {told}: "
                "the text is not the one the session began with"
            )
    if model.channel_mask >> len(dictionary.channels):
        raise JournalError(
            f"the channel mask {model.channel_mask:#x} names a channel that the board has not "
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
        told_tolerance_rad=model.told_tolerance_rad,
        measured_by=model.measured_by,
    )
