"""10^5 postures of a corrected arm with three effects, beside the plain arm.

Wanted: at most three times as long.
"""

import argparse
import time

import numpy as np
from support.added import any_of, axis, with_effects

from armodal.analyzer.corrected.batch import batched
from armodal.analyzer.workspace.study import study_workspace
from armodal.protocols.arm.files import load_arm

EFFECTS = ("bearing", "rotor")


def seconds(arm, n_postures: int, repeats: int) -> float:
    ready = batched(arm)
    found = []
    for _ in range(repeats):
        began = time.process_time()
        study_workspace(arm, ready.elastic, n_postures, still=(0,), batch=ready.batch)
        found.append(time.process_time() - began)
    return float(np.median(found))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--postures", type=int, default=100_000)
    parser.add_argument("--repeats", type=int, default=3)
    given = parser.parse_args()
    for name in ("rv4frl", "ur5", "viper_s650"):
        plain = load_arm(name)
        effects = [axis(plain.joints[1].link.name), *(any_of(plain, kind) for kind in EFFECTS)]
        before = seconds(plain, given.postures, given.repeats)
        after = seconds(with_effects(plain, *effects), given.postures, given.repeats)
        print(
            f"{name}: plain {before:.2f} s, three effects {after:.2f} s, {after / before:.2f} times"
        )


if __name__ == "__main__":
    main()
