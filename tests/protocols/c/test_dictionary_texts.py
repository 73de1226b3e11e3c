"""Texts of a board's dictionary, in C and in Python."""

import unicodedata

import pytest
from support.c_device import accepts, dictionary_of

from armodal.protocols.board import decode_dictionary, encode_dictionary
from armodal.protocols.errors import FrameError


def test_both_sides_refuse_the_characters_of_control_and_no_others():
    for character in map(chr, range(0x800)):
        text = character.encode()
        room = b"x" * len(text)
        encoded = encode_dictionary(dictionary_of(board_id=room.decode())).replace(room, text)
        if unicodedata.category(character) == "Cc":
            assert not accepts(encoded)
            with pytest.raises(FrameError, match="control"):
                decode_dictionary(encoded)
        else:
            assert accepts(encoded)
            assert decode_dictionary(encoded).board_id == character
