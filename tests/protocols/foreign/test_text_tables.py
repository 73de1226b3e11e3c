"""FRFs and hits in text, in the manner of several analysers."""

import numpy as np
import pytest
from support.foreign_samples import accelerance
from support.foreign_writers import kyowa, lms_text, pulse, signalcalc, table
from support.manifests import RATE, hit_signals

from armodal.protocols.errors import ForeignFileError
from armodal.protocols.foreign.content import read_content
from armodal.protocols.foreign.measured import Hints, NotToldError, parse_dof
from armodal.protocols.foreign.text_table import text_variables
from armodal.protocols.frf_records import FrfForm

FREQ = 0.25 * np.arange(1, 401)
FRF = accelerance(FREQ, 0, 0)
DEGREES = np.degrees(np.angle(FRF))
TEXT = 2e-8  # relative: nine decimals


def read(folder, data, hints=None, name="a.txt"):
    (folder / name).write_bytes(data if isinstance(data, bytes) else data.encode())
    return read_content(folder / name, hints or Hints())


def same(content, frf=FRF, scale=1.0, freq=FREQ, tolerance=TEXT):
    (found,) = content.frfs
    assert np.allclose(found.freq_hz, freq, rtol=1e-7)
    size = np.abs(frf).max()
    assert np.max(np.abs(found.values - scale * frf)) < tolerance * size * scale
    return found


# Programs ----------------------------------------------------------------------------------------


def test_signalcalc_is_read_with_its_unit(tmp_path):
    content = read(tmp_path, signalcalc(FREQ, FRF))
    found = same(content, tolerance=1e-6)  # seven digits
    assert found.form is FrfForm.ACCELERANCE
    assert not any("units" in text for text in content.said)


def test_units_in_a_line_of_their_own_are_the_columns_own(tmp_path):
    """A spectrum as an analyser writes it: facts, names, units, decimal commas, `'` in a corner."""
    rows = [
        "CSVFormatType;Spectrum2DComplex",
        "AxisUnit;Hz",
        "Name;Signal 2",
        "Unit;(m/s^2)/N",
        "",
        "';Signal 2 (Real);Signal 2 (Imag.)",
        "';(m/s^2)/N;(m/s^2)/N",
        *(f"{f:.4f};{v.real:.9E};{v.imag:.9E}" for f, v in zip(FREQ, FRF, strict=True)),
    ]
    content = read(tmp_path, "\n".join(rows).replace(".", ",").replace("(Imag,)", "(Imag.)"))
    found = same(content, tolerance=1e-8)
    assert found.form is FrfForm.ACCELERANCE
    assert not any("units" in text for text in content.said)


def test_real_and_complex_are_the_parts(tmp_path):
    rows = [f"{f}\t{v.real:.9e}\t{v.imag:.9e}" for f, v in zip(FREQ, FRF, strict=True)]
    told = Hints(form=FrfForm.ACCELERANCE)
    same(read(tmp_path, "\n".join(["freq (Hz)\treal\tcomplex", *rows]), told))


def test_a_column_may_be_named_with_its_unit(tmp_path):
    rows = [f"{f}\t{v.real:.9e}\t{v.imag:.9e}" for f, v in zip(FREQ, FRF, strict=True)]
    names = {"frequency": ("a (Hz)",), "real": ("b",), "imaginary": ("c",)}
    told = Hints(form=FrfForm.ACCELERANCE, variables=names)
    same(read(tmp_path, "\n".join(["a (Hz)\tb\tc", *rows]), told))


def test_signalcalc_in_g_is_scaled(tmp_path):
    same(
        read(tmp_path, signalcalc(FREQ, FRF, unit="(g)(lbf)")),
        scale=9.80665 / 4.4482216152605,
        tolerance=1e-6,
    )


def test_pulse_files_hold_several_functions(tmp_path):
    frfs = [accelerance(FREQ, i, 0) for i in range(3)]
    with pytest.raises(NotToldError, match="names for 3 responses") as caught:
        read(tmp_path, pulse(FREQ, frfs))
    assert caught.value.key == "responses 3"
    told = tuple(parse_dof(name, "a") for name in ("7:z", "8:z", "9:z"))
    content = read(tmp_path, pulse(FREQ, frfs), Hints(responses=told))
    assert [frf.response.node for frf in content.frfs] == ["7", "8", "9"]
    for found, frf in zip(content.frfs, frfs, strict=True):
        assert found.form is FrfForm.ACCELERANCE
        assert np.allclose(found.values, frf, atol=1e-8 * np.abs(frf).max())


def test_a_coherence_behind_its_frf_belongs_to_it(tmp_path):
    coherence = np.linspace(0.5, 1.25, len(FREQ))
    content = read(tmp_path, pulse(FREQ, [FRF], coherence=coherence))
    (found,) = content.frfs
    assert np.allclose(found.coherence, coherence, atol=1e-8)
    assert any("reaches 1.25: clipped to 1" in text for text in content.said)


def test_a_section_that_is_no_measurement_is_left_out_with_a_word(tmp_path):
    spectrum = f"\nAutospectrum\nFrequency [Hz]\tPSD\n{table([FREQ, np.abs(FRF)])}".encode()
    content = read(tmp_path, pulse(FREQ, [FRF]) + spectrum)
    same(content)
    assert any("left out" in text for text in content.said)


def test_testlab_facts_are_no_names_but_tell_points_and_averages(tmp_path):
    content = read(tmp_path, lms_text(FREQ, FRF))
    found = same(content, scale=9.80665, tolerance=1e-8)
    assert (found.response.node, found.response.direction.tolist()) == ("3", [0, 0, -1])
    assert (found.reference.node, found.reference.direction.tolist()) == ("10", [0, 0, -1])
    assert content.averages == 3


def test_columns_stay_in_their_order_where_two_are_named_after_the_axis(tmp_path):
    """`1 Hz` and `2 Hz` hold a real and an imaginary part, though both are called after hertz."""
    rows = table([FREQ, FRF.real, FRF.imag])
    told = Hints(form=FrfForm.ACCELERANCE)
    same(read(tmp_path, f"Frequency [Hz]\tat 1 Hz\tsecond\n{rows}", told), tolerance=1e-8)


def test_kyowa_records_have_names_and_units_in_rows(tmp_path):
    _, force, responses = hit_signals(channels=2)
    content = read(tmp_path, kyowa(RATE, [force, *responses], ["N", "m/s2", "m/s2"]), name="a.csv")
    (hit,) = content.hits
    assert hit.rate_hz == RATE
    assert np.allclose(hit.force_n, force, rtol=1e-8, atol=1e-9)
    assert np.allclose(hit.acceleration_m_s2, responses, rtol=1e-8, atol=1e-9)
    assert not content.said


def test_the_only_signal_in_volts_beside_accelerations_is_the_force(tmp_path):
    _, force, responses = hit_signals(channels=2)
    signals = [100.0 * responses[0], 100.0 * responses[1], force / 0.02]
    data = kyowa(RATE, signals, ["cm/s2", "cm/s2", "V"])
    with pytest.raises(NotToldError) as caught:
        read(tmp_path, data, name="a.csv")
    assert caught.value.key == "scale"  # newtons a volt, nobody tells
    content = read(tmp_path, data, Hints(force_scale=0.02, response_scale=0.01), name="a.csv")
    (hit,) = content.hits
    assert np.allclose(hit.force_n, force, rtol=1e-8, atol=1e-9)
    assert np.allclose(hit.acceleration_m_s2, responses, rtol=1e-8, atol=1e-9)
    assert any("CH-3, in V, is the only signal" in text for text in content.said)


def test_two_signals_in_volts_are_asked_about(tmp_path):
    _, force, responses = hit_signals(channels=2)
    data = kyowa(RATE, [force, *responses], ["V", "V", "m/s2"])
    with pytest.raises(NotToldError) as caught:
        read(tmp_path, data, name="a.csv")
    assert caught.value.key == "variables"


# Dialects ----------------------------------------------------------------------------------------

HEADER = ("Frequency [Hz]", "Real [(m/s²)/N]", "Imag [(m/s²)/N]")


@pytest.mark.parametrize(
    ("delimiter", "decimal"),
    [(d, s) for d in ("\t", ";", ",", "  ") for s in ".," if (d, s) != (",", ",")],
)
@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "latin-1", "utf-16", "utf-16-le"])
def test_any_delimiter_decimal_sign_and_encoding(tmp_path, delimiter, decimal, encoding):
    text = delimiter.join(HEADER) + "\n"
    text += table([FREQ, FRF.real, FRF.imag], delimiter, decimal)
    found = same(read(tmp_path, text.encode(encoding)))
    assert found.form is FrfForm.ACCELERANCE


@pytest.mark.parametrize("ends", ["\n", "\r\n"])
@pytest.mark.parametrize("comment", ["# ", "% ", "! ", "// "])
def test_a_header_may_be_a_comment(tmp_path, comment, ends):
    lines = [f"{comment}test of a beam", comment + "\t".join(HEADER)]
    text = "\n".join(lines) + "\n" + table([FREQ, FRF.real, FRF.imag])
    same(read(tmp_path, text.replace("\n", ends)))


@pytest.mark.parametrize(
    ("names", "columns"),
    [
        (("f [Hz]", "Re(H) [g/N]", "Im(H) [g/N]"), (FRF.real, FRF.imag)),
        (("Frequenz [Hz]", "Realteil [g/N]", "Imaginärteil [g/N]"), (FRF.real, FRF.imag)),
        (("Frequency (Hz)", "Magnitude (g/N)", "Phase (deg)"), (np.abs(FRF), DEGREES)),
        (("Frequency (Hz)", "Mag (g/N)", "Phase (rad)"), (np.abs(FRF), np.angle(FRF))),
        (("Freq Hz", "Betrag [g/N]", "Phase [°]"), (np.abs(FRF), DEGREES)),
        (("f_Hz", "|H| (g/N)", "phase (rad)"), (np.abs(FRF), np.angle(FRF))),
    ],
    ids=["re im", "german", "degrees", "radians", "degree sign", "bars"],
)  # fmt: skip
def test_parts_are_found_by_name(tmp_path, names, columns):
    text = ";".join(names) + "\n" + table([FREQ, *columns], ";")
    same(read(tmp_path, text), scale=9.80665)


def test_decibels_are_twenty_logarithms(tmp_path):
    names = "Frequency [Hz];Magnitude [dB];Phase [deg]"
    columns = [FREQ, 20 * np.log10(np.abs(FRF)), np.degrees(np.angle(FRF))]
    content = read(tmp_path, f"{names}\n{table(columns, ';')}", Hints(form=FrfForm.ACCELERANCE))
    same(content)
    assert any("dB" in text for text in content.read_as)


def test_a_magnitude_below_zero_is_taken_as_decibels_with_a_word(tmp_path):
    names = "Frequency [Hz];Magnitude;Phase"
    columns = [FREQ, 20 * np.log10(np.abs(FRF)), np.degrees(np.angle(FRF))]
    content = read(tmp_path, f"{names}\n{table(columns, ';')}", Hints(form=FrfForm.ACCELERANCE))
    same(content)
    assert any("taken as dB" in text for text in content.said)
    assert any("taken as degrees" in text for text in content.said)


def test_kilohertz_are_a_thousand_hertz(tmp_path):
    names = "Frequency [kHz]\tReal [g/N]\tImag [g/N]"
    text = f"{names}\n{table([FREQ / 1e3, FRF.real, FRF.imag])}"
    same(read(tmp_path, text), scale=9.80665)


def test_the_coherence_is_found_by_name_and_its_excess_said(tmp_path):
    names = "Frequency [Hz]\tReal [g/N]\tImag [g/N]\tCoherence"
    coherence = np.linspace(0.4, 1.05, len(FREQ))
    content = read(tmp_path, f"{names}\n{table([FREQ, FRF.real, FRF.imag, coherence])}")
    found = same(content, scale=9.80665)
    assert np.allclose(found.coherence, coherence, atol=1e-8)
    assert any("reaches 1.05: clipped to 1" in text for text in content.said)


def test_several_frfs_of_a_table_need_names_or_have_them(tmp_path):
    frfs = [accelerance(FREQ, i, 0) for i in range(3)]
    columns = [part for frf in frfs for part in (frf.real, frf.imag)]

    def text(title):
        names = [f"{what} {title.format(i + 1)} [g/N]" for i in range(3) for what in ("Re", "Im")]
        return "\t".join(["Frequency [Hz]", *names]) + "\n" + table([FREQ, *columns])

    content = read(tmp_path, text("H({}Z,1Z)"))
    assert [frf.response.node for frf in content.frfs] == ["1", "2", "3"]
    assert [frf.response.label for frf in content.frfs] == ["z", "z", "z"]
    content = read(tmp_path, text("Tool:{}:-Z/Tool:7:+X"))  # as Testlab writes them
    assert [frf.response.node for frf in content.frfs] == ["1", "2", "3"]
    assert {tuple(frf.response.direction) for frf in content.frfs} == {(0.0, 0.0, -1.0)}
    assert {(frf.reference.node, frf.reference.label) for frf in content.frfs} == {("7", "x")}
    with pytest.raises(NotToldError, match="names for 3 responses") as caught:
        read(tmp_path, text("H{}"))
    assert caught.value.key == "responses 3"
    told = Hints(responses=tuple(parse_dof(name, "a") for name in ("7:x", "8:x", "9:x")))
    content = read(tmp_path, text("H{}"), told)
    assert [frf.response.node for frf in content.frfs] == ["7", "8", "9"]
    for found, frf in zip(content.frfs, frfs, strict=True):
        assert np.allclose(found.values, 9.80665 * frf, atol=1e-7 * np.abs(frf).max())


def test_the_line_at_zero_hertz_is_dropped_with_a_word(tmp_path):
    freq = np.concatenate([[0.0], FREQ])
    frf = np.concatenate([[0.0], FRF])
    content = read(tmp_path, signalcalc(freq, frf))
    assert content.frfs[0].freq_hz[0] == FREQ[0]
    assert any("0 Hz" in text for text in content.said)


# Without names -----------------------------------------------------------------------------------


def test_three_columns_that_step_too_slowly_for_a_time_are_an_frf(tmp_path):
    data = table([FREQ, FRF.real, FRF.imag])
    with pytest.raises(NotToldError, match="form unknown"):
        read(tmp_path, data)
    content = read(tmp_path, data, Hints(form=FrfForm.ACCELERANCE))
    same(content)
    content = read(tmp_path, data, Hints(kind="frf", form=FrfForm.MOBILITY))
    assert same(content).form is FrfForm.MOBILITY


def test_three_columns_of_a_hit_are_a_hit(tmp_path):
    t, force, responses = hit_signals()
    (hit,) = read(tmp_path, table([t, force, *responses])).hits
    assert hit.rate_hz == RATE


@pytest.mark.parametrize("step", [0.003, 0.5])
def test_a_table_that_might_be_either_is_asked_about(tmp_path, step):
    _, force, responses = hit_signals()  # a pulse, over times of a frequency axis
    x = step * np.arange(len(force))
    data = table([x, np.abs(force), *responses])
    with pytest.raises(NotToldError, match='`kind = "hit"` or `kind = "frf"`') as caught:
        read(tmp_path, data)
    assert caught.value.key == "kind"
    assert "found column 1 (2048 real)" in str(caught.value)
    assert read(tmp_path, data, Hints(kind="hit")).hits
    assert read(tmp_path, data, Hints(kind="frf", form=FrfForm.ACCELERANCE)).frfs


def test_magnitude_and_phase_are_told_by_their_signs(tmp_path):
    data = table([FREQ, np.abs(FRF), np.degrees(np.angle(FRF))])
    content = read(tmp_path, data, Hints(form=FrfForm.ACCELERANCE))
    same(content)
    assert any("taken as magnitude and phase" in text for text in content.said)


def test_complex_numbers_stand_beside_their_frequency(tmp_path):
    for form in ("({0.real:.9e}{0.imag:+.9e}j)", "{0.real:.9e} {0.imag:+.9e}i"):
        rows = [f"{f:.6f};{form.format(h)}" for f, h in zip(FREQ, FRF, strict=True)]
        same(read(tmp_path, "\n".join(rows), Hints(form=FrfForm.ACCELERANCE)))


def test_a_time_printed_with_few_digits_is_no_force(tmp_path):
    """As a spreadsheet prints it: four samples are called 0.998 s."""
    t, force, responses = hit_signals()
    coarse = np.array([float(f"{x:.2e}") for x in t])
    (tmp_path / "h.txt").write_text(table([coarse, force, responses[0]]))
    with pytest.raises(ForeignFileError, match=r"not in equal steps.* say `rate_hz`"):
        read_content(tmp_path / "h.txt", Hints())
    rate = 1.0 / (t[1] - t[0])
    content = read_content(tmp_path / "h.txt", Hints(rate_hz=rate))
    (hit,) = content.hits
    assert len(hit.responses) == 1
    assert any("too few digits" in text for text in content.said)


def test_a_column_of_complex_numbers_needs_its_lines(tmp_path):
    rows = "\n".join(f"({h.real:.9e}{h.imag:+.9e}j)" for h in FRF)
    with pytest.raises(NotToldError) as caught:
        read(tmp_path, rows)
    assert caught.value.key == "line_spacing_hz"
    hints = Hints(form=FrfForm.ACCELERANCE, line_spacing_hz=0.25, first_line_hz=0.25)
    same(read(tmp_path, rows, hints))


def test_columns_may_be_mapped(tmp_path):
    data = table([FRF.imag, FREQ, FRF.real])
    variables = {"frequency": ("column 2",), "real": ("column 3",), "imaginary": ("column 1",)}
    same(read(tmp_path, data, Hints(form=FrfForm.ACCELERANCE, variables=variables)))
    with pytest.raises(ForeignFileError, match=r"variables.real: wanted the name.*got 'Re'.*found"):
        read(tmp_path, data, Hints(variables={**variables, "real": ("Re",)}))


# Refused -----------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "wanted"),
    [
        ("", "got 0 lines"),
        ("hello\nworld\n", "the first is 'hello'"),
        ("1 2 3\n4 5\n6 7 8\n9 1 2\n3 4 5\n", "rows alike"),
        ("Frequency [Hz]\tPSD\n" + table([FREQ, np.abs(FRF)]), "found Frequency"),
        ("Frequency [Hz]\tReal [g/N]\n" + table([FREQ, FRF.real]), "found Frequency"),
        ("1 2 3\n" * 50, "neither"),
        ("x" * 2_000_000, "a million characters"),
    ],
    ids=["empty", "words", "ragged", "spectrum", "half", "flat", "one line"],
)
def test_what_is_no_measurement_is_one_sentence(tmp_path, text, wanted):
    with pytest.raises(ForeignFileError, match=wanted) as caught:
        read(tmp_path, text)
    assert "\n" not in str(caught.value)


def test_a_cell_that_is_no_number_is_refused_with_its_row(tmp_path):
    rows = table([FREQ, FRF.real, FRF.imag]).splitlines()
    rows[200] = rows[200].replace("e", "x", 1)
    with pytest.raises(ForeignFileError, match="row 200"):
        read(tmp_path, "\n".join(rows))


def test_binary_under_the_name_of_a_text_is_refused(tmp_path):
    with pytest.raises(ForeignFileError, match="control characters"):
        read(tmp_path, b"abc\x00\x01\x02" * 40)


def test_a_table_cut_within_a_row_is_refused_with_that_row_and_no_library_s_advice(tmp_path):
    whole = table([FREQ, FRF.real, FRF.imag])
    cut = "".join(whole.splitlines(keepends=True)[:50]) + "12.75\t0.1\n"
    with pytest.raises(ForeignFileError, match=r"changed from 3 to 2 at row 51\); trunc") as caught:
        read(tmp_path, cut)
    assert "usecols" not in str(caught.value)


@pytest.mark.parametrize("end", [b"\n", b"\r"])
def test_more_numbers_than_are_read_in_time_are_refused(monkeypatch, end):
    monkeypatch.setattr("armodal.protocols.foreign.text_table.MOST_TEXT_NUMBERS", 41)
    wide = b"1,2,3,4,5,6\n" * 6  # a section of its own counts for what it holds
    rows = [b"0.1,1.5", b"0.2,1.5"]
    assert len(text_variables(wide + b"time,force\n" + end.join(rows), "a.csv")) == 2
    many = wide + b"time,force\n" + end.join([*rows, b"0.3,1.5"])
    with pytest.raises(ForeignFileError, match=r"^a.csv: 2: wanted at most 41 numbers in a text"):
        text_variables(many, "a.csv")
