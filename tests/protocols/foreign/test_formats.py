"""LabVIEW, TDMS, sound, MATLAB 7.3, Rattlesnake, NumPy and MATLAB files under their own names."""

import builtins
import io

import numpy as np
import pytest
import scipy.io
from support.foreign_samples import accelerance
from support.foreign_writers import lvm, mat73, rattlesnake, wav
from support.manifests import RATE, hit_signals, manifest, posture, run

from armodal.protocols.bounds import most_decoded_bytes
from armodal.protocols.errors import ForeignFileError
from armodal.protocols.foreign.content import read_content
from armodal.protocols.foreign.measured import Hints, NotToldError, parse_dof
from armodal.protocols.frf_records import FrfForm

FREQ = 0.25 * np.arange(1, 401)
FRF = np.array([accelerance(FREQ, i, 0) for i in range(3)])
THREE = tuple(parse_dof(f"{i}:z", "a") for i in (1, 2, 3))
ACCELERANCE = Hints(form=FrfForm.ACCELERANCE, responses=THREE)


def read(folder, name, data=None, hints=None):
    if data is not None:
        (folder / name).write_bytes(data)
    return read_content(folder / name, hints or Hints())


def same_hit(content, force, responses, tolerance):
    (hit,) = content.hits
    assert hit.rate_hz == RATE
    assert np.allclose(hit.force_n, force, rtol=0, atol=tolerance)
    assert np.allclose(hit.acceleration_m_s2, responses, rtol=0, atol=tolerance)
    return hit


# LabVIEW -----------------------------------------------------------------------------------------


@pytest.mark.parametrize("columns", ["No", "One", "Multi"])
@pytest.mark.parametrize("decimal", [".", ","])
def test_a_labview_hit_in_every_layout(tmp_path, columns, decimal):
    _, force, (response,) = hit_signals()
    data = lvm(1 / RATE, [{"Force": force, "Acc": response}], columns=columns, decimal=decimal)
    content = read(tmp_path, "a.lvm", data)
    same_hit(content, force, [response], 1e-9)  # nine decimals
    assert not content.said


def test_sections_of_a_labview_file_are_hits(tmp_path):
    _, force, (response,) = hit_signals()
    sections = [{"Force": k * force, "Acc": k * response} for k in (1, 2, 3)]
    content = read(tmp_path, "a.lvm", lvm(1 / RATE, sections))
    assert [round(float(hit.force_n.max())) for hit in content.hits] == [50, 100, 150]


def test_a_labview_channel_in_volts_needs_its_scale(tmp_path):
    _, force, (response,) = hit_signals()
    data = lvm(1 / RATE, [{"Hammer": force / 22.4, "Acc": response}], units=("Volts", "m/s^2"))
    with pytest.raises(NotToldError, match="`scale`") as caught:
        read(tmp_path, "a.lvm", data)
    assert caught.value.key == "scale"
    content = read(tmp_path, "a.lvm", hints=Hints(force_scale=22.4, response_scale=1.0))
    same_hit(content, force, [response], 22.4e-9)


def test_a_labview_channel_without_a_name_is_asked_about(tmp_path):
    _, force, (response,) = hit_signals()
    data = lvm(1 / RATE, [{"Untitled": force, "Untitled 1": response}], units=("", ""))
    with pytest.raises(NotToldError, match=r"variables.*found Untitled \(2048 real\)") as caught:
        read(tmp_path, "a.lvm", data)
    assert caught.value.key == "variables"
    told = {"force": ("Untitled",), "response": ("Untitled 1",)}
    same_hit(read(tmp_path, "a.lvm", hints=Hints(variables=told)), force, [response], 1e-9)


def test_a_labview_frf_of_real_and_imaginary_part(tmp_path):
    data = lvm(
        0.25,
        [{"Real": FRF[0].real, "Imag": FRF[0].imag}],
        units=("(m/s^2)/N", ""),
        dimension="Frequency",
    )
    (found,) = read(tmp_path, "a.lvm", data).frfs
    # the file starts at X0 = 0: its line at 0 Hz is dropped
    assert np.allclose(found.values, FRF[0][1:], atol=1e-9)
    assert found.form is FrfForm.ACCELERANCE


def test_a_cut_labview_file_is_refused(tmp_path):
    _, force, (response,) = hit_signals()
    data = lvm(1 / RATE, [{"Force": force, "Acc": response}])
    with pytest.raises(ForeignFileError, match="wanted 2048 samples"):
        read(tmp_path, "a.lvm", data[: len(data) // 2].rpartition(b"\r\n")[0])


def test_a_step_printed_with_few_digits_is_the_simplest_rate(tmp_path):
    _, force, (response,) = hit_signals()
    data = lvm(1 / 1024, [{"Force": force, "Acc": response}]).replace(b"9.765625E-04", b"0.000977")
    content = read(tmp_path, "a.lvm", data)
    assert content.hits[0].rate_hz == 1024
    assert any("the rate is taken as 1024 Hz" in text for text in content.said)


# TDMS --------------------------------------------------------------------------------------------


def tdms(groups, *, rate=RATE):
    nptdms = pytest.importorskip("nptdms")
    stream = io.BytesIO()
    with nptdms.TdmsWriter(stream) as writer:
        for group, channels in groups.items():
            writer.write_segment(
                [
                    nptdms.ChannelObject(
                        group,
                        name,
                        values,
                        properties={"wf_increment": 1 / rate, "unit_string": unit},
                    )
                    for name, (values, unit) in channels.items()
                ]
            )
    return stream.getvalue()


def test_groups_of_a_tdms_file_are_hits(tmp_path):
    _, force, (response,) = hit_signals()
    groups = {
        f"hit {k}": {"hammer": (k * force, "N"), "ai1": (k * response, "m/s^2")} for k in (1, 2)
    }
    content = read(tmp_path, "a.tdms", tdms(groups))
    one, other = content.hits
    assert np.array_equal(one.force_n, force)
    assert np.array_equal(other.acceleration_m_s2, [2 * response])
    assert one.rate_hz == RATE


def test_without_nptdms_there_is_one_clear_message(tmp_path, monkeypatch):
    real = builtins.__import__

    def missing(name, *arguments, **more):
        if name.startswith("nptdms"):
            raise ImportError(name)
        return real(name, *arguments, **more)

    monkeypatch.setattr(builtins, "__import__", missing)
    with pytest.raises(ForeignFileError, match=r"install it with `pip install 'armodal\[files\]'`"):
        read(tmp_path, "a.tdms", b"TDSm" + bytes(40))


# Sound -------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("kind", "bits"), [("pcm16", 15), ("pcm24", 23), ("pcm32", 31), ("float32", 23)]
)
def test_a_sound_file_needs_a_scale_and_has_it(tmp_path, kind, bits):
    _, force, (response,) = hit_signals()
    data = wav(RATE, [force / 200, response / 4], kind=kind)
    with pytest.raises(NotToldError) as caught:
        read(tmp_path, "a.wav", data)
    assert caught.value.key == "scale"
    content = read(tmp_path, "a.wav", hints=Hints(force_scale=200.0, response_scale=4.0))
    same_hit(content, force, [response], 200.0 * 2.0**-bits)


def test_a_sound_file_may_have_its_channels_mapped(tmp_path):
    _, force, (response,) = hit_signals()
    data = wav(RATE, [response / 4, force / 200], kind="float32")
    told = {"force": ("column 2",), "response": ("column 1",)}
    hints = Hints(force_scale=200.0, response_scale=4.0, variables=told)
    same_hit(read(tmp_path, "a.wav", data, hints), force, [response], 200.0 * 2.0**-23)


# MATLAB 5 and 7.3, NPZ: names of their own --------------------------------------------------------


def write(path, variables):
    if path.suffix == ".npz":
        np.savez(path, **variables)
    elif path.name.startswith("v73"):
        mat73(path, variables)
    else:
        scipy.io.savemat(path, variables)


CONTAINERS = pytest.mark.parametrize("name", ["a.mat", "v73.mat", "a.npz"])


@CONTAINERS
@pytest.mark.parametrize("turned", [False, True])
def test_a_complex_matrix_beside_its_frequencies_is_frfs(tmp_path, name, turned):
    write(tmp_path / name, {"Freq_domain": FREQ, "Hf_chan_2": FRF.T if turned else FRF})
    with pytest.raises(NotToldError, match="3 responses") as caught:
        read(tmp_path, name, hints=Hints(form=FrfForm.ACCELERANCE))
    assert "Hf_chan_2 (" in str(caught.value)
    content = read(tmp_path, name, hints=ACCELERANCE)
    assert np.array_equal([frf.values for frf in content.frfs], FRF)


@CONTAINERS
@pytest.mark.parametrize("axis", ["f", "x", "abscissa"])
def test_frequencies_are_told_by_their_number(tmp_path, name, axis):
    write(tmp_path / name, {axis: FREQ, "result": FRF.T})
    content = read(tmp_path, name, hints=ACCELERANCE)
    assert np.array_equal(content.frfs[0].freq_hz, FREQ)
    assert any("taken as the frequencies in Hz" in text for text in content.said)


@CONTAINERS
def test_a_coherence_is_found_by_name(tmp_path, name):
    coherence = np.linspace(0.5, 1.1, FREQ.size)
    variables = {
        "Freq_domain": FREQ,
        "Hf_chan_2": FRF[0],
        "Hf_coh_chan_2": coherence,
        "PSD_chan_2": np.abs(FRF[0]) ** 2,
        "Cross_Spec": 2 * FRF[0],
        "Time_chan_1": np.sin(np.arange(1024.0)),
    }
    write(tmp_path / name, variables)
    content = read(tmp_path, name, hints=Hints(form=FrfForm.ACCELERANCE))
    (found,) = content.frfs
    assert np.array_equal(found.values, FRF[0])
    assert np.array_equal(found.coherence, coherence)
    assert any("reaches 1.1: clipped" in text for text in content.said)


@CONTAINERS
def test_arrays_under_any_name_are_mapped(tmp_path, name):
    write(tmp_path / name, {"a": FREQ, "b": FRF[0].real, "c": FRF[0].imag, "d": FRF[1]})
    told = {"frequency": ("a",), "real": ("b",), "imaginary": ("c",)}
    hints = Hints(form=FrfForm.ACCELERANCE, variables=told)
    (found,) = read(tmp_path, name, hints=hints).frfs
    assert np.array_equal(found.values, FRF[0])


@CONTAINERS
def test_three_dimensions_are_responses_references_lines(tmp_path, name):
    H = np.stack([FRF, 2 * FRF], axis=1)  # (3, 2, lines)
    write(tmp_path / name, {"freq": FREQ, "H": H})
    references = tuple(parse_dof(f"{i}:z", "a") for i in (1, 2))
    hints = Hints(form=FrfForm.ACCELERANCE, responses=THREE, references=references)
    content = read(tmp_path, name, hints=hints)
    assert len(content.frfs) == 6
    assert np.array_equal(content.frfs[3].values, 2 * FRF[1])
    assert content.frfs[3].reference.node == "2"


@CONTAINERS
def test_a_matrix_that_fits_no_lines_is_refused_with_what_was_found(tmp_path, name):
    write(tmp_path / name, {"freq": FREQ[:-3], "H": FRF})
    with pytest.raises(NotToldError, match=r"line_spacing_hz.*found .*H \(3 x 400 complex\)"):
        read(tmp_path, name, hints=ACCELERANCE)


@CONTAINERS
def test_a_hit_in_a_container_with_its_rate(tmp_path, name):
    _, force, responses = hit_signals()
    write(tmp_path / name, {"force": force, "acc": responses[0]})
    with pytest.raises(NotToldError) as caught:
        read(tmp_path, name)
    assert caught.value.key == "rate_hz"
    same_hit(read(tmp_path, name, hints=Hints(rate_hz=RATE)), force, responses, 0.0)


def test_fields_of_a_struct_are_named_after_it(tmp_path):
    signal = {"x_values": {"increment": 0.25}, "y_values": {"values": FRF[0]}, "unit": "(m/s^2)/N"}
    scipy.io.savemat(tmp_path / "a.mat", {"Signal_0": signal, "Note": "a test"})
    told = {"frf": ("Signal_0.y_values.values",)}
    with pytest.raises(NotToldError, match=r"Signal_0\.y_values\.values"):
        read(tmp_path, "a.mat", hints=Hints(form=FrfForm.ACCELERANCE, variables=told))
    hints = Hints(
        form=FrfForm.ACCELERANCE, variables=told, line_spacing_hz=0.25, first_line_hz=0.25
    )
    (found,) = read(tmp_path, "a.mat", hints=hints).frfs
    assert np.array_equal(found.values, FRF[0])


def test_h1_is_used_of_several_estimators(tmp_path):
    np.savez(tmp_path / "a.npz", freq=FREQ, H1=FRF[0], H2=1.1 * FRF[0])
    content = read(tmp_path, "a.npz", hints=Hints(form=FrfForm.ACCELERANCE))
    assert np.array_equal(content.frfs[0].values, FRF[0])
    assert any("h1 is used of h1, h2" in text for text in content.said)


def test_channels_a_sample_apart_are_cut_with_a_word(tmp_path):
    t, force, responses = hit_signals()
    np.savez(tmp_path / "a.npz", time=t, force=force[:-1], acc=responses[0])
    content = read(tmp_path, "a.npz")
    assert len(content.hits[0].force_n) == len(t) - 1
    assert any("the first 2047 samples are used" in text for text in content.said)


def test_channels_many_samples_apart_are_refused(tmp_path):
    t, force, responses = hit_signals()
    np.savez(tmp_path / "a.npz", time=t, force=force[:-100], acc=responses[0])
    with pytest.raises(ForeignFileError, match="signals of one length, got 1948 samples"):
        read(tmp_path, "a.npz")


# Rattlesnake -------------------------------------------------------------------------------------


def test_a_modal_test_of_rattlesnake_tells_everything(tmp_path):
    freq = 0.5 * np.arange(201)
    H = np.moveaxis([[accelerance(freq, i, 0)] for i in range(3)], -1, 0)
    rattlesnake(tmp_path / "a.nc4", 0.5, H, np.full((201, 3), 0.9))
    session = run(manifest(tmp_path, posture('["a.nc4"]')))
    (frf,) = session.frfs
    assert frf.form is FrfForm.ACCELERANCE
    assert [dof.point for dof in frf.responses] == ["101", "102", "103"]
    assert frf.references[0].direction.tolist() == [0.0, 0.0, -1.0]
    scale = 9.80665 / 4.4482216152605
    assert np.allclose(frf.values, scale * np.moveaxis(H, 0, -1)[..., 1:], rtol=1e-12)
    assert frf.n_hits.min() == 5
    assert np.allclose(frf.coherence, 0.9)


# Wrong endings -----------------------------------------------------------------------------------


@pytest.mark.parametrize("ending", [".txt", ".uff", ".mat", ".wav", ".exe", ""])
def test_the_content_tells_the_format_not_the_ending(tmp_path, ending):
    t, force, responses = hit_signals()
    np.save(tmp_path / "h.npy", np.vstack([t, force, responses]))
    data = (tmp_path / "h.npy").read_bytes()
    same_hit(read(tmp_path, f"h{ending}", data), force, responses, 0.0)


def test_small_types_are_counted_as_the_numbers_they_become(tmp_path):
    """Two arrays of zeros: few kB packed, as bytes not too many, as float64 eight times that."""
    zeros = np.zeros(most_decoded_bytes(0) // 8, dtype=np.uint8)
    np.savez_compressed(tmp_path / "a.npz", time=zeros, force=zeros)
    with pytest.raises(ForeignFileError, match=r"wanted at most \d+ numbers, got more"):
        read(tmp_path, "a.npz")


def test_the_force_of_a_sound_file_is_the_channel_that_is_one_push(tmp_path):
    _, force, responses = hit_signals(n=2048, channels=1)
    scale = 2.0 * max(np.abs(force).max(), np.abs(responses).max())
    told = Hints(response_scale=scale, force_scale=scale)
    for name, columns in (("a.wav", [force, responses[0]]), ("b.wav", [responses[0], force])):
        content = read(
            tmp_path, name, wav(RATE, [c / scale for c in columns], kind="float32"), told
        )
        same_hit(content, force, responses, 1e-6 * scale)
        assert any("taken as the force" in text for text in content.read_as) is (name == "b.wav")


@pytest.mark.parametrize(
    "head",
    [b"PK\x03\x04" + bytes(26) + b"[Content_Types].xml", b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1"],
    ids=["xlsx", "xls"],
)
def test_a_workbook_is_refused_with_what_to_do(tmp_path, head):
    with pytest.raises(ForeignFileError, match=r"save the sheet .* as CSV"):
        read(tmp_path, "a.xlsx", head + bytes(64))
