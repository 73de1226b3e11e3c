"""SDF of corrected arms, read by libsdformat, the library that Gazebo reads models with.

Wanted: no error, masses and springs as written. Needs g++ and libsdformat-dev (Debian); says so and
ends where they are not installed.
"""

import argparse
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

from support.added import any_of, axis, with_effects

from armodal.analyzer.export.exported import ready_for_export
from armodal.analyzer.export.sdf import sdf_text
from armodal.protocols.arm.files import load_arm

KINDS = ("base", "bearing", "link_bending", "link_torsion", "payload", "released_joint")
READER = Path(__file__).parent / "sdf_reader.cc"


def main() -> int:
    argparse.ArgumentParser(description=__doc__).parse_args()
    tool, compiler = shutil.which("pkg-config"), shutil.which("g++")
    listed = _said(tool, "--list-all").splitlines() if tool else []
    library = next((line.split()[0] for line in listed if "sdformat" in line), None)
    if tool is None or library is None or compiler is None:
        print("not read: libsdformat-dev, pkg-config and g++ are not all installed")
        return 0
    flags = _said(tool, "--cflags", "--libs", library).split()
    with tempfile.TemporaryDirectory() as folder:
        reader = Path(folder) / "reader"
        subprocess.run([compiler, "-std=c++17", READER, "-o", reader, *flags], check=True)
        files = []
        for name in ("rv4frl", "ur5", "viper_s650"):
            arm = load_arm(name)
            cases = {kind: [any_of(arm, kind)] for kind in KINDS} | {"none": []}
            cases |= {"axis": [axis(arm.joints[1].link.name)]}
            for kind, effects in cases.items():
                corrected = with_effects(arm, *effects)
                text, _ = sdf_text(corrected, ready_for_export(corrected).tree)
                files.append(Path(folder) / f"{name}-{kind}.sdf")
                files[-1].write_text(text, encoding="utf-8")
        return subprocess.run([reader, *files], check=False).returncode


def _said(*command: str) -> str:
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout


if __name__ == "__main__":
    sys.exit(main())
