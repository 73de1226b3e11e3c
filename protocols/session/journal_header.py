"""The HEADER record: what is fixed when a session begins, with the texts it rests on."""

from __future__ import annotations

from armodal.protocols.session.header import header_model, header_of
from armodal.protocols.session.journal_framing import MAGIC, RecordKind, encode_record
from armodal.protocols.session.journal_models import HeaderModel, from_json, to_json
from armodal.protocols.session.journal_payloads import join_payload, split_payload
from armodal.protocols.session.records import SessionHeader

__all__ = ["begin_journal", "decode_header"]

_JSON_LIMIT = 32 * 2**20


def begin_journal(header: SessionHeader) -> bytes:
    """Return the first bytes of a journal: magic and HEADER record.

    Raises
    ------
    JournalError
        If the header could not be read back.
    """
    payload = join_payload(to_json(header_model(header)), header.dictionary_bytes)
    return MAGIC + encode_record(RecordKind.HEADER, payload)


def decode_header(payload: bytes | memoryview) -> SessionHeader:
    """Return the session header; arm, plan and dictionary are read from the texts inside."""
    text, dictionary_bytes = split_payload(payload, "HEADER", _JSON_LIMIT)
    return header_of(from_json(HeaderModel, text, "HEADER", _JSON_LIMIT), dictionary_bytes)
