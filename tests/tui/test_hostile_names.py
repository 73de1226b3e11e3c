"""Names in files of every kind, and of files themselves, steer no terminal and forge no line."""

from __future__ import annotations

import re
from dataclasses import replace

import h5py
import numpy as np
import pytest
from support.command import armodal
from support.plain_structure import plate_session
from support.quick import every_but

from armodal import save_session
from armodal.protocols.arm.files import ARMS_DIRECTORY
from armodal.protocols.plan import PLANS_DIRECTORY
from armodal.protocols.printable import UNSEEN

NAME = "a\x1b[2J\x9b2J\x07\u202eZ\u2066\u2028Q"
LINES = f"{NAME}\nnext: armodal forged"
ESCAPED = r"a\u001b[2J\u009b2J\u0007\u202eZ\u2066\u2028Q\nnext: armodal forged"  # as TOML has it
STEERS = re.compile(rf"(?![\n\t])[{UNSEEN}\ud800-\udfff]|^next: armodal forged", re.MULTILINE)
ARM = (ARMS_DIRECTORY / "bench57.toml").read_text(encoding="utf-8")
PLAN = (PLANS_DIRECTORY / "bench57-five-postures.toml").read_text(encoding="utf-8")
ROWS = "".join(f"{i / 1024:.6f};{np.exp(-i / 99):.6f};{np.sin(i):.6f}\n" for i in range(2048))
URDF = (
    '<robot name="r"><link name="base"/><link name="{0}"/><joint name="{0}" type="revolute">'
    '<parent link="base"/><child link="{0}"/><limit lower="-1" upper="1"/></joint></robot>'
)


def arm_with(old):
    def write(path):
        assert old in ARM
        path.write_text(ARM.replace(old, ESCAPED), encoding="utf-8")

    return write


def text(words, encoding="utf-8"):
    return lambda path: path.write_bytes(words.encode(encoding, "replace"))


def hdf5(path):
    with h5py.File(path, "w") as file:
        for name in ("force", LINES):
            file[name] = np.sin(np.arange(2048.0))
            file[name].attrs["unit"] = LINES


def numpy_names(path):
    np.savez(path, **{"force": np.arange(2048.0), LINES: np.arange(2048.0)})


def in_a_folder(path):
    path.mkdir()
    (path / f"{LINES}.csv").write_text(ROWS, encoding="utf-8")
    (path / "other.csv").write_text(ROWS, encoding="utf-8")


SHOW, CHECK = ("arm", "show"), ("arm", "check")
ON_ARM = (SHOW, CHECK, ("model", "diff", "bench57"), ("mozzi", "--wrench", "1,0,0,0,0,0"))
ON_FILE = (("inspect",), ("inspect", "--json"), ("import", "--out", "made.h5"))
MANIFEST = (
    f'format = "armodal-import-1"\narm = "{ESCAPED}"\nname = "x"\n[[postures]]\n'
    f'name = "p"\nfiles = ["{ESCAPED}"]\n'
)
HEAD = f"time;{LINES};{NAME} [{NAME}]\n"
FILES = {
    "source of an arm": ("a.toml", arm_with("Invented: reach 0.96 m"), ON_ARM),
    "source of a stiffness": ("a.toml", arm_with("guess from the drive's size"), ON_ARM),
    "name of a joint": ("a.toml", arm_with("axis_2"), ON_ARM),
    "name of a link": ("a.toml", arm_with("knuckle"), ON_ARM),
    "name of a point": ("a.toml", arm_with('"t1"'), ON_ARM),
    "raw in an arm file": ("a.toml", text(ARM.replace("axis_2", NAME)), ON_ARM),
    "posture of a plan": (
        "p.toml",
        text(PLAN.replace('name = "', f'name = "{ESCAPED}')),
        (("sim", "--arm", "bench57", "--plan"),),
    ),
    "plant": ("p.toml", text(f'[[effects]]\nkind = "{ESCAPED}"\n'), (("sim", "--plant"),)),
    "header of a table": ("x.csv", text(HEAD + ROWS), ON_FILE),
    "header of a table, Latin 1": ("x.csv", text(HEAD + ROWS, "latin-1"), ON_FILE),
    "HDF5": ("x.h5", hdf5, ON_FILE),
    "MATLAB 7.3": ("x.mat", hdf5, ON_FILE),
    "numpy": ("x.npz", numpy_names, ON_FILE),
    "manifest": ("m.toml", text(MANIFEST), (("import", "--out", "made.h5"),)),
    "URDF": ("r.urdf", text(URDF.format("a\x9b\u202e&#10;next: armodal forged")), (CHECK,)),
    "data base of a bus": ("x.dbc", text(f'VERSION "{LINES}"\nBO_ 1 {NAME}: 8 A\n'), ON_FILE),
    "in a folder": ("folder", in_a_folder, ON_FILE),
    "name of the file": (f"{NAME}.csv", text(ROWS), ON_FILE),
    "name of the file, with a line end": (f"{LINES}.csv", text(ROWS), ON_FILE),
    "name of the file, no UTF-8": ("x\udc9b\udcff.h5", hdf5, (*ON_FILE, ("fit",), ("report",))),
}


@pytest.mark.parametrize("kind", every_but(FILES, "plant"))  # its laboratory is a process
def test_names_in_files_of_every_kind_are_written_out(kind, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    name, write, commands = FILES[kind]
    path = tmp_path / name
    write(path)
    for command in commands:
        words = 2 if command[0] in {"arm", "model"} else 1
        at_end = command[-1] in {"--plan", "--plant"}
        said = (
            armodal(*command, path) if at_end else armodal(*command[:words], path, *command[words:])
        )
        told = said.stdout + said.stderr
        assert told
        assert STEERS.search(told) is None, told
        assert "Traceback" not in told


def few_postures(session):
    """Two postures, one of them for validation: what is said of more is said the same way."""
    few = (session.header.plan.postures[0].name, session.header.plan.postures[-1].name)
    return replace(session, hits=tuple(hit for hit in session.hits if hit.posture in few))


@pytest.mark.parametrize("of", ["plate", pytest.param("arm", marks=pytest.mark.long)])
def test_words_in_a_session_are_written_out(of, request, tmp_path):
    path, page = tmp_path / "s.h5", tmp_path / "s.html"
    if of == "plate":
        session = plate_session(tmp_path)
    else:
        session = few_postures(request.getfixturevalue("session"))
    header = replace(session.header, measured_by=LINES)
    save_session(replace(session, header=header, warnings=(LINES,)), path)
    for command in (("fit", path), ("check", "session", path), ("report", path, "--out", page)):
        said = armodal(*command)
        assert STEERS.search(said.stdout + said.stderr) is None
    words = page.read_text(encoding="utf-8").partition("</head>")[2]
    assert r"a\x1b[2J\x9b2J" in words
    own = words[: words.index("<script")] if "<script" in words else words
    assert not set(NAME) - set("a[2JZQ") & set(own)
