"""The wheel installs `armodal` and nothing else, and works from there."""

import json
import os
import shutil
import subprocess
import sys
import venv
import zipfile
from pathlib import Path

import pytest

import armodal

ROOT = Path(__file__).parents[1]
PROGRAM = """
import json, pydoc, sys
import armodal
loaded_at_once = sorted(name for name in sys.modules if name.startswith("armodal."))
from armodal.analyzer.planning import search, selective
search.N_RANDOM, search.ROUNDS, selective.N_OTHERS = 1000, 2, 10  # a small plan is one, too
arm = armodal.load_arm("rv4frl")
plan = armodal.plan(arm, n_tests=1)
figure = armodal.figure(plan)
page = pydoc.plain(pydoc.render_doc(armodal))
print(json.dumps({
    "file": armodal.__file__,
    "at_once": loaded_at_once,
    "missing": [name for name in armodal.__all__ if name not in page and name != "__version__"],
    "tests": len(plan.plan.tests),
    "traces": len(figure.data),
    "elsewhere": sorted(name for name in sys.modules if name in
        {"analyzer", "daq", "hil_sim", "protocols", "tui"}),
}))
"""


def ran(command, **settings):
    done = subprocess.run(command, capture_output=True, text=True, check=False, **settings)
    assert done.returncode == 0, done.stderr
    return done.stdout


def tracked():
    names = ran(["git", "ls-files"], cwd=ROOT).splitlines()
    return [name for name in names if os.path.lexists(ROOT / name)]


@pytest.fixture(scope="module")
def wheel(tmp_path_factory):
    folder, checkout = tmp_path_factory.mktemp("wheel"), tmp_path_factory.mktemp("checkout")
    for name in tracked():
        target = checkout / name
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(ROOT / name, target, follow_symlinks=False)
    # The wheel that pip builds, without pip.
    build = "import sys; from setuptools.build_meta import build_wheel; build_wheel(sys.argv[1])"
    ran([sys.executable, "-c", build, str(folder)], cwd=checkout)
    (made,) = folder.glob("armodal-*.whl")
    return made


@pytest.fixture(scope="module")
def installed(wheel, tmp_path_factory):
    """A clean environment whose packages cannot be written, and its interpreter."""
    folder = tmp_path_factory.mktemp("environment")
    venv.create(folder, with_pip=False)
    (packages,) = folder.glob("lib/python*/site-packages")
    with zipfile.ZipFile(wheel) as archive:
        archive.extractall(packages)
    # What armodal depends on comes from the environment of the tests.
    others = [path for path in sys.path if "site-packages" in path]
    (packages / "others.pth").write_text("\n".join(others), encoding="utf-8")
    for path in packages.rglob("*"):
        path.chmod(0o555 if path.is_dir() else 0o444)
    yield folder / "bin" / "python", packages / "armodal"
    for path in packages.rglob("*"):
        path.chmod(0o755)


def test_only_armodal_lands_in_site_packages(wheel):
    with zipfile.ZipFile(wheel) as archive:
        names = archive.namelist()
    tops = {name.split("/")[0] for name in names}
    assert tops == {"armodal", f"armodal-{armodal.__version__}.dist-info"}
    assert "armodal/py.typed" in names


def test_every_file_a_package_reads_is_in_the_wheel(wheel):
    kept = {".c", ".css", ".dbc", ".h", ".html", ".js", ".ld", ".rules", ".tcss", ".toml", ".urdf"}
    packages = ("analyzer/", "daq/", "hil_sim/", "protocols/", "tui/")
    wanted = {
        f"armodal/{name}"
        for name in tracked()
        if name.startswith(packages) and Path(name).suffix in kept
    }
    with zipfile.ZipFile(wheel) as archive:
        assert wanted - set(archive.namelist()) == set()


@pytest.mark.long
def test_it_runs_from_another_folder_and_writes_nothing_where_it_is_installed(installed, tmp_path):
    python, package = installed
    before = sorted(package.rglob("*"))
    clean = {k: v for k, v in os.environ.items() if k != "PYTHONPATH"}
    clean |= {"PYTHONDONTWRITEBYTECODE": "1", "HOME": str(tmp_path)}
    found = json.loads(ran([python, "-c", PROGRAM], cwd=tmp_path, env=clean))
    assert Path(found["file"]).parent == package
    assert found["at_once"] == []
    assert found["missing"] == []
    assert found["elsewhere"] == []
    assert found["tests"] >= 1
    assert found["traces"] == 1
    said = ran([python, "-m", "armodal.tui.cli", "--version"], cwd=tmp_path, env=clean)
    assert said.strip() == f"armodal {armodal.__version__}"
    assert sorted(package.rglob("*")) == before


def test_a_checkout_without_links_says_so(tmp_path):
    (tmp_path / "armodal").mkdir()
    for name in ("setup.py", "pyproject.toml", "README.md", "LICENSE"):
        (tmp_path / name).write_bytes((ROOT / name).read_bytes())
    source = (ROOT / "armodal" / "__init__.py").read_bytes()
    (tmp_path / "armodal" / "__init__.py").write_bytes(source)
    (tmp_path / "armodal" / "daq").write_text("../daq", encoding="utf-8")
    for command in (["setup.py", "--name"], ["-c", "import armodal"]):
        done = subprocess.run(
            [sys.executable, *command],
            cwd=tmp_path,
            capture_output=True,
            text=True,
            check=False,
            env={k: v for k, v in os.environ.items() if k != "PYTHONPATH"},
        )
        assert done.returncode != 0
        assert "core.symlinks" in done.stderr
        assert "daq" in done.stderr
