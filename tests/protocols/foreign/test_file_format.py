"""File formats are found by themselves: a module of `formats` is all that one takes."""

from __future__ import annotations

import sys

import numpy as np
import pytest

from armodal.protocols.foreign import file_format, formats
from armodal.protocols.foreign.content import read_content
from armodal.protocols.foreign.file_format import every_format
from armodal.protocols.foreign.measured import Hints

# A made-up format: two columns of doubles behind a sign.
ANOTHER = """
import numpy as np
from armodal.protocols.foreign.file_format import FileFormat, of_bytes
from armodal.protocols.foreign.text_table import text_variables

def _read(data, origin):
    f, real, imaginary = np.frombuffer(data[4:]).reshape(3, -1)
    head = "Frequency [Hz]\\tReal [(m/s^2)/N]\\tImaginary [(m/s^2)/N]\\n"
    rows = "".join(f"{a}\\t{b}\\t{c}\\n" for a, b, c in zip(f, real, imaginary))
    return text_variables((head + rows).encode(), origin)

FORMAT = FileFormat(
    name="another", holds="a table", endings=(".ano",), is_it=lambda head: head.startswith(b"ANO1"),
    variables=of_bytes(_read),
)
"""


@pytest.fixture
def another(tmp_path, monkeypatch):
    """A module that lies among the formats."""
    (tmp_path / "another.py").write_text(ANOTHER, encoding="utf-8")
    monkeypatch.setattr(formats, "__path__", [*formats.__path__, str(tmp_path)])
    every_format.cache_clear()
    yield
    sys.modules.pop(f"{formats.__name__}.another", None)
    every_format.cache_clear()


@pytest.mark.usefixtures("another")
def test_a_format_of_a_module_of_its_own_is_read(tmp_path):
    table = np.array([[1.0, 2.0, 3.0, 4.0], [0.1, 0.2, 0.3, 0.4], [0.0, 0.5, 0.6, 0.7]])
    path = tmp_path / "plate.ano"
    path.write_bytes(b"ANO1" + table.tobytes())
    content = read_content(path, Hints())
    (frf,) = content.frfs
    assert np.allclose(frf.values, table[1] + 1j * table[2])


def test_no_two_formats_claim_a_name_or_an_ending():
    names = [own.name for own in every_format()]
    endings = [ending for own in every_format() for ending in own.endings]
    assert len(set(names)) == len(names)
    assert len(set(endings)) == len(endings)
    assert file_format.HEAD_BYTES >= 520  # MATLAB 7.3 is known by the bytes at 512
