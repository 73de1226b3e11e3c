"""What is written from the table of messages (`records.py`): C, tables of the document, vectors."""

from armodal.protocols.board.generate.c_header import c_header
from armodal.protocols.board.generate.c_source import c_board_source, c_host_source
from armodal.protocols.board.generate.document import document_with_tables
from armodal.protocols.board.generate.table import TABLE, Table
from armodal.protocols.board.generate.vectors import field_vectors

__all__ = [
    "TABLE",
    "Table",
    "c_board_source",
    "c_header",
    "c_host_source",
    "document_with_tables",
    "field_vectors",
]
