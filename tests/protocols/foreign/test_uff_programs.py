"""Universal files in the conventions of other programs: cosmetic faults are notes."""

import numpy as np
import pytest
from support.foreign_samples import accelerance, frf_set, write_sets
from support.foreign_writers import NODES_2411, PERMAS_HEADER, TESTLAB_GEOMETRY, VKI_HEADER
from support.manifests import manifest, posture, run

from armodal.protocols.errors import ForeignFileError
from armodal.protocols.foreign.measured import Hints
from armodal.protocols.foreign.uff_measured import uff_content
from armodal.protocols.foreign.uff_read import uff_from_bytes

FREQ = 0.25 * np.arange(400)


def frf_bytes(folder, nodes=(1, 2, 3), **changes):
    sets = [frf_set(n, accelerance(FREQ, i, 0), FREQ, **changes) for i, n in enumerate(nodes)]
    return write_sets(folder / "frfs.uff", sets).read_bytes()


@pytest.mark.parametrize(
    "head",
    [TESTLAB_GEOMETRY, VKI_HEADER, PERMAS_HEADER, NODES_2411],
    ids=["lms", "vki", "permas", "2411"],
)
def test_a_file_of_another_program_is_imported(tmp_path, head):
    (tmp_path / "a.unv").write_bytes(head.encode("latin-1") + frf_bytes(tmp_path))
    session = run(manifest(tmp_path, posture('["a.unv"]')))
    assert [dof.point for dof in session.frfs[0].responses] == ["1", "2", "3"]


def test_trace_lines_filled_up_with_zeros_are_a_note():
    file = uff_from_bytes(TESTLAB_GEOMETRY.encode(), "a")
    assert file.trace_lines[0].nodes.tolist() == [1, 2, 3]
    assert any("filled up with zeros" in note for note in file.notes)
    assert file.header.program == "Test.Lab Rev 15A"


def test_nodes_that_fill_up_a_trace_line_are_refused():
    text = TESTLAB_GEOMETRY.replace(
        "         3         0         0         0", "         3         0         7         0", 1
    )
    with pytest.raises(ForeignFileError, match="wanted 3 nodes"):
        uff_from_bytes(text.encode(), "a")


def test_nodes_of_2411_and_elements_of_2412_are_the_geometry():
    file = uff_from_bytes(NODES_2411.encode(), "a")
    assert file.nodes.number.tolist() == [1, 2, 3]
    assert file.nodes.position[2].tolist() == [0.3, 0.0, 0.5]
    beam, triangle = file.trace_lines
    assert beam.nodes.tolist() == [1, 2]
    assert triangle.nodes.tolist() == [1, 2, 3, 1]
    assert any(
        "1858 (qualifiers of functions)" in text for text in uff_content(file, Hints(), "a").said
    )


def test_geometry_of_2411_places_the_points(tmp_path):
    (tmp_path / "a.unv").write_bytes(NODES_2411.encode() + frf_bytes(tmp_path))
    session = run(manifest(tmp_path, posture('["a.unv"]')))
    assert session.header.arm.point("3").position_m.tolist() == [0.3, 0.0, 0.5]


def test_another_coordinate_system_is_said():
    text = NODES_2411.replace(
        "    1.0000000000000000E+0    0.0", "    2.0000000000000000E+0    0.0", 1
    )
    (note,) = uff_from_bytes(text.encode(), "a").notes
    assert "1 coordinate systems are not the global one" in note


def test_a_header_without_dates_is_read(tmp_path):
    lines = ["    -1", "   151", *["NONE"] * 3, "", "", "pyuff", "", "    -1", ""]
    data = "\n".join(lines).encode() + frf_bytes(tmp_path)
    assert uff_from_bytes(data, "a").header.program == "pyuff"


def test_words_around_the_datasets_are_notes(tmp_path):
    data = b"exported from a program\n" + frf_bytes(tmp_path) + b"end of file\n"
    file = uff_from_bytes(data, "a")
    assert len(file.functions) == 3
    assert len(file.notes) == 2


def test_shifted_columns_of_record_6_are_read(tmp_path):
    text = frf_bytes(tmp_path, nodes=(7,), rsp_dir=-2).decode()
    at = text.index("    4         ")
    record = text[at:].splitlines()[0]
    shifted = record.replace(" NONE ", " de0 ", 1)
    data = text.replace(record, shifted).encode()
    (function,) = uff_from_bytes(data, "a").functions
    assert (function.response_node, function.response_direction) == (7, -2)
    assert (function.reference_node, function.reference_direction) == (1, 3)


@pytest.mark.parametrize("label", ["(1/N)*(m/s²)", "(m/s²)/N", "m/s^2/N", "(m/s2)(N)"])
def test_a_ratio_in_the_label_tells_the_form(tmp_path, label):
    text = frf_bytes(tmp_path, nodes=(1,), ordinate_spec_data_type=1, orddenom_spec_data_type=0)
    blank = b"         1    0    0    0 NONE                 " + label.encode("latin-1")
    lines = text.split(b"\n")
    at = next(
        i for i, line in enumerate(lines) if line.startswith(b"         1    0    0    0 NONE")
    )
    lines[at] = blank
    content = uff_content(uff_from_bytes(b"\n".join(lines), "a"), Hints(), "a")
    assert str(content.frfs[0].form) == "accelerance"
    assert not any("units" in said for said in content.said)


def test_the_coherence_may_lack_a_line(tmp_path):
    coherence = frf_set(1, np.linspace(0.5, 0.9, 399), FREQ[1:], func_type=6)
    path = write_sets(tmp_path / "a.uff", [frf_set(1, accelerance(FREQ, 0, 0), FREQ), coherence])
    content = uff_content(uff_from_bytes(path.read_bytes(), "a"), Hints(), "a")
    # six digits of an abscissa; the values have twelve
    assert np.allclose(content.frfs[0].coherence, np.linspace(0.5, 0.9, 399), atol=1e-10)


def test_channels_of_a_hit_a_sample_apart_are_cut_with_a_word(tmp_path):
    t = np.arange(256) / 1024.0
    common = {"func_type": 1, "abscissa_spec_data_type": 17, "orddenom_spec_data_type": 0}
    sets = [
        frf_set(1, np.exp(-(((t - 0.05) / 0.002) ** 2)), t, **common, ordinate_spec_data_type=13),
        frf_set(2, np.cos(90 * t[:-1]), t[:-1], **common, ordinate_spec_data_type=12),
    ]
    path = write_sets(tmp_path / "a.uff", sets)
    content = uff_content(uff_from_bytes(path.read_bytes(), "a"), Hints(), "a")
    assert len(content.hits[0].force_n) == 255
    assert any("the first 255 samples are used" in said for said in content.said)


def test_a_refusal_lists_what_is_in_the_file(tmp_path):
    data = frf_bytes(tmp_path, nodes=(1,), ordinate_spec_data_type=0, orddenom_spec_data_type=0)
    with pytest.raises(
        ForeignFileError, match=r"form unknown.*found FRF 1:\+z over 1:\+z \(400 complex\)"
    ):
        uff_content(uff_from_bytes(data, "a"), Hints(), "a")
