"""MuJoCo's frequencies of exported arms beside the arm files' own: three arms, 20 postures.

Wanted: within 0.2 %. With `--urdf FOLDER` every URDF found there too: a serial arm of somebody
else's, springs guessed, MuJoCo's own reading of it patched.
"""

import argparse
import tempfile
from pathlib import Path

import mujoco
from support.added import any_of, axis, with_effects
from support.any_arm import arm_text_of_urdf

from armodal.analyzer.export.by_mujoco import compare_frequencies
from armodal.analyzer.export.exported import BELOW_HZ, ready_for_export
from armodal.analyzer.export.mjcf import mjcf_text
from armodal.analyzer.export.mjcf_patch import patched_mjcf
from armodal.protocols.arm.files import load_arm
from armodal.protocols.arm.urdf import read_urdf
from armodal.protocols.errors import ArmodalError

KINDS = (
    "base",
    "bearing",
    "coupling",
    "link_bending",
    "link_torsion",
    "payload",
    "released_joint",
    "rotor",
    "servo",
)


def largest(ready, model) -> float:
    return compare_frequencies(
        ready.correction, ready.tree, mujoco, model, n_postures=20, below_hz=BELOW_HZ
    ).largest


def of_shipped() -> None:
    for name in ("rv4frl", "ur5", "viper_s650"):
        arm = load_arm(name)
        found = {}
        every = [any_of(arm, kind) for kind in KINDS]
        cases = dict(zip(KINDS, ([effect] for effect in every), strict=True))
        cases |= {"axis": [axis(arm.joints[1].link.name)], "all": every}
        for kind, effects in cases.items():
            ready = ready_for_export(with_effects(arm, *effects))
            model = mujoco.MjModel.from_xml_string(mjcf_text(arm, ready.tree))
            found[kind] = largest(ready, model)
        words = ", ".join(f"{kind} {100 * value:.4f}" for kind, value in found.items())
        print(f"{name}: largest difference in % by effect: {words}")


def of_others(folder: Path) -> None:
    for path in sorted(folder.rglob("*.urdf")):
        text = path.read_text(encoding="utf-8")
        with tempfile.TemporaryDirectory() as place:
            try:
                chain = read_urdf(text)
                own = Path(place) / "own.urdf"
                own.write_text(text, encoding="utf-8")
                file = Path(place) / "arm.toml"
                file.write_text(arm_text_of_urdf(path.stem, "own.urdf", chain), encoding="utf-8")
                plain = load_arm(str(file))
                arm = with_effects(plain, axis(plain.joints[1].link.name), any_of(plain, "bearing"))
                ready = ready_for_export(arm)
                spec = mujoco.MjSpec.from_file(str(path))
                theirs = Path(place) / "theirs.xml"
                spec.compile()
                theirs.write_text(spec.to_xml(), encoding="utf-8")
                patched, notes = patched_mjcf(arm, ready.tree, theirs, theirs, mujoco)
                model = mujoco.MjModel.from_xml_string(patched)
            except (ArmodalError, ValueError) as problem:
                print(f"{path.name}: not compared: {str(problem).splitlines()[0][:120]}")
                continue
            print(f"{path.name}: {100 * largest(ready, model):.4f} %; {'; '.join(notes)}")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--urdf", type=Path, default=None)
    given = parser.parse_args()
    of_shipped()
    if given.urdf is not None:
        of_others(given.urdf)


if __name__ == "__main__":
    main()
