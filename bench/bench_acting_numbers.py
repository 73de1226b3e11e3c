"""What the numbers in acting on a corrected arm decide: each moved by 30 % either way.

    bench_acting_numbers.py demo/demo.arm.toml

Told of each number is the largest relative change of what it has a say in. `docs/acting.md` and
`docs/corrected-model.md` have the table.
"""

import argparse
from dataclasses import replace

import numpy as np

from armodal.analyzer.acting import chatter, robust, self_motion, semi_discretisation
from armodal.analyzer.acting.cutting import Cutter
from armodal.analyzer.corrected import prediction
from armodal.analyzer.corrected.batch import batched
from armodal.analyzer.corrected.correction import correction_of
from armodal.protocols.arm.files import load_arm

Q_DEG = [0.0, 30.0, 60.0, 0.0, 60.0, 0.0]
CUTTER = Cutter(teeth=4, tangential_n_per_m2=6e8, radial_n_per_m2=2e8, immersion=1.0, down=True)
SPEEDS = np.linspace(60.0, 600.0, 60)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("arm")
    arm = load_arm(parser.parse_args().arm)

    def predicted():
        (found,) = prediction.predict_arm(arm, [Q_DEG], below_hz=150.0)
        return np.concatenate([found.f_std_hz, found.damping_std])

    def shaped():
        boxes = robust.mode_boxes(prediction.predict_arm(arm, [Q_DEG], below_hz=150.0), 2)
        boxes = [replace(box, f_hz=(0.95 * box.f_hz[0], 1.05 * box.f_hz[1])) for box in boxes]
        return 1.0 + np.array([own.residual for own in robust.candidates(boxes)])

    def cut():
        found = chatter.lobe_diagram(
            correction_of(arm),
            np.deg2rad(Q_DEG),
            CUTTER,
            SPEEDS,
            directions=chatter.tool_frame((1.0, 0.0, 0.0), (0.0, 0.0, 1.0)),
            tool_m=(0.0, 0.0, 0.1),
        )
        return {
            "depths": found.depth_m,
            "band": np.array([found.low_m, found.high_m]),
            "delayed": found.checked_m,
        }

    def best():
        found = self_motion.stiffest_angle(
            batched(arm),
            np.deg2rad([Q_DEG]),
            (30.0, 0.0, -200.0),
            tool_m=(0.1, 0.0, 0.1),
            spin=(1.0, 0.0, 0.0),
        )
        return found.best.along_n_per_m

    def change(module, name, measure):
        own, before = getattr(module, name), measure()
        worst = {}
        for part in (0.7, 1.3):
            moved = type(own)(round(part * own)) if isinstance(own, int) else part * own
            setattr(module, name, moved)
            after = measure()
            setattr(module, name, own)
            rows = before.items() if isinstance(before, dict) else [("", before)]
            for what, here in rows:
                there = after[what] if isinstance(after, dict) else after
                both = np.isfinite(here) & np.isfinite(there) & (np.abs(here) > 0.0)
                ratio = np.abs(there[both] / here[both] - 1.0)
                worst[what] = max(worst.get(what, 0.0), float(ratio.max(initial=0.0)))
        told = ", ".join(f"{what} {100 * value:.2g} %" for what, value in worst.items())
        print(f"{module.__name__.rsplit('.', 1)[-1]}.{name} = {own}: {told}", flush=True)

    change(prediction, "_STEP", predicted)
    for name in ("_GRID", "_MOST_DAMPING", "_WIDEST"):
        change(robust, name, shaped)
    change(self_motion, "STEP_RAD", best)
    for name in ("_LINES", "_DRAWS", "BELOW_HZ", "_STEPS"):
        change(chatter, name, cut)
    change(semi_discretisation, "_HALVINGS", cut)


if __name__ == "__main__":
    main()
