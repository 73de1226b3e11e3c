"""`armodal import` and `armodal export` as a user runs them."""

import json
from dataclasses import replace

import numpy as np
import pytest
import pyuff
from support import foreign_samples as chain
from support.command import armodal
from support.manifests import plain
from typer.testing import CliRunner

from armodal.analyzer.corrected.prediction import predict_arm
from armodal.analyzer.identification.identify import identify
from armodal.analyzer.identification.predicted_posture import predict_posture
from armodal.protocols.arm.files import load_arm
from armodal.protocols.foreign.uff_read import read_uff
from armodal.protocols.session.hdf5 import read_session, write_session
from armodal.tui.cli import app
from armodal.tui.commands.export import export_model

FREQ = 0.25 * np.arange(1, 500)
POLES_HZ, DAMPING = (30.0, 75.0), (0.02, 0.01)
SHAPES = np.array([[1.0, 0.8], [0.6, -0.9], [-0.5, 0.4]])


def accelerance(i, j, noise=0.0, rng=None):
    s = 2j * np.pi * FREQ
    total = np.zeros(len(FREQ), dtype=complex)
    for r, (f, z) in enumerate(zip(POLES_HZ, DAMPING, strict=True)):
        w = 2 * np.pi * f
        total += s**2 * SHAPES[i, r] * SHAPES[j, r] / (s**2 + 2 * z * w * s + w**2)
    if noise:
        size = noise * np.sqrt(np.mean(np.abs(total) ** 2) / 2)
        total = total + size * (
            rng.standard_normal(len(FREQ)) + 1j * rng.standard_normal(len(FREQ))
        )
    return total


def uff(path, *, drive=0, noise=0.01):
    rng = np.random.default_rng(3)
    path.unlink(missing_ok=True)
    file = pyuff.UFF(str(path))
    for i in range(3):
        content = pyuff.prepare_58(
            binary=0,
            func_type=4,
            rsp_node=i + 1,
            rsp_dir=3,
            ref_node=drive + 1,
            ref_dir=3,
            data=accelerance(i, drive, noise, rng),
            x=FREQ,
            id1="free chain",
            rsp_ent_name="NONE",
            ref_ent_name="NONE",
            abscissa_spacing=1,
            abscissa_spec_data_type=18,
            ordinate_spec_data_type=12,
            orddenom_spec_data_type=13,
        )
        file.write_sets([content], mode="add")
    return path


def flat(text):
    """Printed text without the line breaks of a narrow terminal."""
    return " ".join(text.split())


def test_a_plain_structure_is_imported_fitted_and_exported(tmp_path):
    uff(tmp_path / "a.uff")
    session = tmp_path / "s.h5"
    code, out, _ = armodal("import", plain(tmp_path, '["a.uff"]'), "--out", session, "--json")
    assert code == 0
    said = json.loads(out)
    assert said["postures"][0]["frfs"] == 3
    assert any("units are not told" in text for text in said["warnings"])
    code, out, _ = armodal("fit", session, "--json")
    assert code == 0
    found = json.loads(out)
    modes = found["modes"]
    # 1 % noise on 3 FRFs of 499 lines: four standard deviations as told.
    for mode, f, z in zip(modes, POLES_HZ, DAMPING, strict=True):
        assert abs(mode["f_hz"] - f) < 4 * mode["f_std_hz"] + 1e-4 * f
        assert abs(mode["damping_ratio"] - z) < 4 * mode["damping_std"] + 1e-4
        assert mode["joint_share"] is None
    assert any("units are not told" in text for text in found["warnings"])
    code, _, _ = armodal("export", session, "--out", tmp_path / "b.uff")
    assert code == 0
    back = read_uff(tmp_path / "b.uff")
    assert [shape.pole_rad_s is not None for shape in back.shapes] == [True, True]
    for shape, f in zip(back.shapes, POLES_HZ, strict=True):
        assert abs(shape.f_hz - f) < 0.02
    # accelerance residues psi_i psi_1 with psi the shape: the second point over the first
    ratio = back.shapes[0].shape[1, 2] / back.shapes[0].shape[0, 2]
    assert abs(ratio - 0.6) < 0.01


def test_export_says_the_band_of_its_modes_in_one_line(tmp_path):
    uff(tmp_path / "a.uff")
    armodal("import", plain(tmp_path, '["a.uff"]'), "--out", tmp_path / "s.h5")
    session = read_session(tmp_path / "s.h5")
    (frf,) = session.frfs
    rng = np.random.default_rng(4)
    # `uff` adds a hundredth of the RMS everywhere; a soft tip leaves noise alone above 90 Hz.
    size = np.sqrt(np.mean(np.abs(frf.values) ** 2)) * np.where(frf.freq_hz > 90.0, 2.0, 0.01)
    noise = size * rng.standard_normal((2, *frf.values.shape))
    faded = replace(
        frf,
        values=np.where(frf.freq_hz > 90.0, noise[0] + 1j * noise[1], frf.values),
        variance=np.broadcast_to(2.0 * size**2, frf.values.shape),
    )
    write_session(replace(session, frfs=(faded,)), tmp_path / "t.h5")
    export = ("export", tmp_path / "t.h5", "--out", tmp_path / "b.uff")
    (file,) = json.loads(armodal(*export, "--json")[1])["files"]
    low, high = file["modes_fitted_hz"]
    assert low < 30.0
    # Both modes, and of the noise no more than the 16 lines kept as a last mode's flank.
    assert 75.0 < high < 100.0
    _, out, _ = armodal(*export)
    assert f"chain: {file['file']}, modes fitted from {low:.4g} to {high:.5g} Hz" in flat(out)
    assert f"above {high:.5g} Hz are noise" in flat(out)
    asked = json.loads(armodal(*export, "--json", "--band", "20", "60")[1])
    assert asked["files"][0]["modes_fitted_hz"][0] >= 20.0
    assert asked["files"][0]["modes_fitted_hz"][1] <= 60.0
    assert not any("are noise" in text for text in asked["warnings"])
    without = json.loads(armodal(*export, "--json", "--no-modes")[1])
    assert without["files"][0]["modes_fitted_hz"] is None


def test_modal_a_scales_the_exported_shapes(tmp_path):
    uff(tmp_path / "a.uff", noise=0.0)
    session = tmp_path / "s.h5"
    armodal("import", plain(tmp_path, '["a.uff"]'), "--out", session)
    armodal("export", session, "--out", tmp_path / "b.uff")
    for shape, r in zip(read_uff(tmp_path / "b.uff").shapes, (0, 1), strict=True):
        # Receptance residues of unit modal mass: psi psi^T / (2 j w_d); text keeps 6 digits.
        w_d = 2 * np.pi * POLES_HZ[r] * np.sqrt(1 - DAMPING[r] ** 2)
        wanted = SHAPES[:, r] * SHAPES[0, r] / (2j * w_d)
        found = shape.shape[:, 2] * shape.shape[0, 2] / shape.modal_a
        assert np.allclose(found, wanted, rtol=2e-3)


def test_reading_writing_and_reading_again_gives_the_same_frfs(tmp_path):
    uff(tmp_path / "a.uff")
    armodal("import", plain(tmp_path, '["a.uff"]'), "--out", tmp_path / "s.h5")
    armodal("export", tmp_path / "s.h5", "--out", tmp_path / "b.uff", "--no-modes", "--binary")
    armodal("import", plain(tmp_path, '["b.uff"]'), "--out", tmp_path / "t.h5")
    one, two = (read_session(tmp_path / name).frfs[0] for name in ("s.h5", "t.h5"))
    assert np.array_equal(one.values, two.values)
    assert np.allclose(one.freq_hz, two.freq_hz, rtol=1e-9)  # ten digits of the step
    assert [dof.point for dof in one.responses] == [dof.point for dof in two.responses]
    assert np.array_equal(one.references[0].direction, two.references[0].direction)


def test_matlab_files_come_back(tmp_path):
    uff(tmp_path / "a.uff")
    armodal("import", plain(tmp_path, '["a.uff"]'), "--out", tmp_path / "s.h5")
    code, _, _ = armodal("export", tmp_path / "s.h5", "--out", tmp_path / "b.mat")
    assert code == 0
    armodal("import", plain(tmp_path, '["b.mat"]'), "--out", tmp_path / "t.h5")
    one, two = (read_session(tmp_path / name).frfs[0] for name in ("s.h5", "t.h5"))
    assert np.array_equal(one.values, two.values)
    assert np.array_equal(one.freq_hz, two.freq_hz)


@pytest.mark.parametrize("ending", ["uff", pytest.param("mat", marks=pytest.mark.long)])
def test_frfs_not_measured_stay_so_through_fit_export_and_import(tmp_path, ending):
    freq = 0.25 * np.arange(1, 400)
    chain.write_sets(
        tmp_path / "a.uff",
        [
            chain.si_set(),
            *(
                chain.frf_set(i + 1, chain.accelerance(freq, i, j), freq, ref_node=j + 1)
                for i in range(3)
                for j in range(3)
                if i != j
            ),
        ],
    )
    _, out, _ = armodal(
        "import", plain(tmp_path, '["a.uff"]'), "--out", tmp_path / "s.h5", "--json"
    )
    assert any("3 of 9 FRFs were not measured" in text for text in json.loads(out)["warnings"])
    code, out, _ = armodal("fit", tmp_path / "s.h5", "--json")
    assert code == 0
    f_hz = [mode["f_hz"] for mode in json.loads(out)["modes"]]
    assert np.allclose(f_hz, chain.POLES_HZ, rtol=1e-4)  # text holds six digits
    code, _, _ = armodal("export", tmp_path / "s.h5", "--out", tmp_path / f"b.{ending}")
    assert code == 0
    code, _, said = armodal(
        "import", plain(tmp_path, f'["b.{ending}"]'), "--out", tmp_path / "t.h5"
    )
    assert code == 0, said
    one, two = (
        {
            (frf.responses[i].point, frf.references[j].point): frf.values[i, j]
            for i, j in np.argwhere(frf.measured)
        }
        for frf in (read_session(tmp_path / name).frfs[0] for name in ("s.h5", "t.h5"))
    )
    assert one.keys() == two.keys()
    assert len(one) == 6
    for path, values in one.items():
        assert np.allclose(values, two[path], rtol=1e-4)


@pytest.mark.parametrize("command", ["import", "export"])
def test_help_has_an_example(command):
    said = CliRunner().invoke(app, [command, "--help"])
    assert said.exit_code == 0
    assert "Example" in said.stdout


@pytest.mark.parametrize("end", [0, 1, 40, 500, 3000, -1])
def test_a_truncated_file_is_one_message_and_exit_code_2(tmp_path, end):
    data = uff(tmp_path / "a.uff").read_bytes().rstrip()
    (tmp_path / "a.uff").write_bytes(data[:end])
    code, out, err = armodal("import", plain(tmp_path, '["a.uff"]'), "--out", tmp_path / "s.h5")
    assert code == 2
    assert not out
    assert err.count("armodal:") == 1
    assert "Traceback" not in err
    assert not (tmp_path / "s.h5").exists()


def test_identify_of_a_plain_structure_is_one_message(tmp_path):
    uff(tmp_path / "a.uff")
    armodal("import", plain(tmp_path, '["a.uff"]'), "--out", tmp_path / "s.h5")
    code, _, err = armodal("identify", tmp_path / "s.h5")
    assert code == 2
    assert "without an arm" in err


RATE = 4096
TIMES = np.arange(4096) / RATE


def half_sine(at_s, peak_n):
    phase = (TIMES - at_s) / 3e-3
    return np.where((phase > 0) & (phase < 1), peak_n * np.sin(np.pi * phase), 0.0)


def save_hit(path, force, *, at_s=0.1):
    """A table of time, the force given, and a mode that rings from `at_s`."""
    since = np.maximum(TIMES - at_s, 0.0)
    ring = np.exp(-8 * since) * np.sin(2 * np.pi * 60 * since)
    noise = 0.01 * np.random.default_rng(1).standard_normal((2, len(TIMES)))
    np.save(path, np.vstack([TIMES, force + noise[0], ring + noise[1]]))


def imported(folder, files):
    code, out, err = armodal("import", plain(folder, files), "--out", folder / "s.h5", "--json")
    assert code == 0, err
    return json.loads(out)


def test_imported_hits_are_judged_like_our_own(tmp_path):
    save_hit(tmp_path / "good.npy", half_sine(0.1, 50))
    save_hit(tmp_path / "double.npy", half_sine(0.1, 50) + half_sine(0.12, 20))
    said = imported(tmp_path, '["good.npy", "double.npy"]')
    assert said["postures"][0]["accepted"] == 1
    assert any("double.npy: rejected: double" in text for text in said["warnings"])


def test_hits_that_triggered_elsewhere_in_their_records_are_all_accepted(tmp_path):
    at_s = [0.05, 0.1, 0.1 + 5 / RATE, 0.2]
    for i, at in enumerate(at_s):
        save_hit(tmp_path / f"h{i}.npy", half_sine(at, 50), at_s=at)
    said = imported(tmp_path, [f"h{i}.npy" for i in range(len(at_s))])
    assert not any("rejected" in text for text in said["warnings"])
    assert said["postures"][0]["accepted"] == len(at_s)
    hits = read_session(tmp_path / "s.h5").hits
    begins = [(hit.trigger_sample - hit.first_sample) / RATE for hit in hits]
    # A half-sine of 3 ms reaches a twentieth of its peak within a sample.
    assert np.allclose(begins, at_s, atol=1.5 / RATE)


def test_a_peak_long_after_the_trigger_is_late_wherever_the_record_begins(tmp_path):
    save_hit(tmp_path / "good.npy", half_sine(0.05, 50), at_s=0.05)
    save_hit(tmp_path / "late.npy", half_sine(0.1, 6) + half_sine(0.15, 50))
    said = imported(tmp_path, '["good.npy", "late.npy"]')
    (text,) = [text for text in said["warnings"] if "rejected" in text]
    assert "late.npy: rejected" in text
    assert "late" in text.partition("rejected: ")[2]


def test_a_file_that_cannot_be_meant_is_one_message_and_exit_code_2(tmp_path):
    np.save(tmp_path / "many.npy", np.vstack([TIMES, half_sine(0.1, 50), *np.eye(5, len(TIMES))]))
    code, out, err = armodal("import", plain(tmp_path, '["many.npy"]'), "--out", tmp_path / "s.h5")
    assert code == 2
    assert not out
    assert err.count("armodal:") == 1
    assert "Traceback" not in err
    assert not (tmp_path / "s.h5").exists()


def test_exported_files_are_named_by_number_not_by_posture(tmp_path):
    uff(tmp_path / "a.uff")
    text = plain(tmp_path, '["a.uff"]').read_text()
    body = '\n[[postures]]\nname = "../../evil"\nfiles = ["a.uff"]\n'
    (tmp_path / "m.toml").write_text(text + body)
    armodal("import", tmp_path / "m.toml", "--out", tmp_path / "s.h5")
    (tmp_path / "out").mkdir()
    code, _, _ = armodal(
        "export", tmp_path / "s.h5", "--out", tmp_path / "out" / "x.uff", "--no-modes"
    )
    assert code == 0
    assert sorted(p.name for p in (tmp_path / "out").iterdir()) == ["x-1.uff", "x-2.uff"]


# An arm through UFF ------------------------------------------------------------------------------


@pytest.mark.long
def test_joint_stiffness_survives_the_way_through_a_universal_file(tmp_path, session, identified):
    """Responses turned into the base frame, oblique hits, an exponential window: all come back."""
    write_session(session, tmp_path / "own.h5")
    code, _, err = armodal("export", tmp_path / "own.h5", "--out", tmp_path / "x.uff", "--no-modes")
    assert code == 0, err
    lines = ['arm = "rv4frl"', 'mode = "roving-response"', "sensor_mass_kg = 0.0093"]
    for i, posture in enumerate(session.header.plan.postures[:3]):
        lines += [
            "[[postures]]",
            f'name = "{posture.name}"',
            f"joints_deg = {np.degrees(posture.joints_rad).tolist()}",
            f'files = ["x-{i + 1}.uff"]',
        ]
    (tmp_path / "m.toml").write_text("\n".join(lines))
    code, _, err = armodal("import", tmp_path / "m.toml", "--out", tmp_path / "back.h5")
    assert code == 0, err
    through = identify(read_session(tmp_path / "back.h5"))
    for one, other in zip(identified.joints, through.joints, strict=True):
        # The same data weighted a little differently: within 3 of the larger deviation told.
        std = max(one.k_std, other.k_std)
        assert abs(one.k_n_m_per_rad - other.k_n_m_per_rad) < 3 * std
    assert len(through.axes) == len(identified.axes) == 1


def test_the_identified_model_is_an_arm_file_with_the_values_found(tmp_path, session, identified):
    told = {"software": "armodal test", "session_sha256": "c" * 64}
    export_model(session, identified, tmp_path / "model.toml", **told)
    arm = load_arm(tmp_path / "model.toml")
    for joint, found in zip(arm.joints[:3], identified.joints, strict=True):
        assert joint.stiffness.value == found.k_n_m_per_rad
        assert joint.damping.value == found.c_n_m_s_per_rad
        assert "identified" in joint.stiffness.source
    # The structural axis is the effect that the gap workflow would name, and gives its modes.
    (effect,), (axis,) = arm.effects, identified.axes
    assert (effect.name, effect.place) == ("link_axis", axis.link)
    assert effect.evidence.confidence is None
    assert [own.by for own in arm.history] == ["armodal identify"]
    posture = session.header.plan.postures[0]
    own = predict_posture(session.header.arm, identified, np.rad2deg(posture.joints_rad))
    (filed,) = predict_arm(arm, [np.rad2deg(posture.joints_rad)])
    assert filed.modes.f_hz == pytest.approx(own.predicted.modes.f_hz, rel=1e-6)
    assert filed.modes.damping_ratio == pytest.approx(own.predicted.modes.damping_ratio, rel=1e-6)
    export_model(session, identified, tmp_path / "model.json", **told)
    model = json.loads((tmp_path / "model.json").read_text())
    assert len(model["joints"]) == 3
    assert len(model["structural"]) == 1
