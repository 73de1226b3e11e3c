"""Six elastic joints in the band: what `identify` and `gap` say of each, beside the truth.

A UR10e with wrist drives so soft that all six modes lie below 60 Hz, masses as the arm file has
them, measured by the simulator's hand and sensors; once as it is, once with an axis in its shoulder
that the arm file does not know. Takes some minutes; `quick` leaves the axis out.
"""

import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

from support.soft_ur10e import AXIS, soft_ur10e_session

from armodal.analyzer.gap.workflow import find_gap
from armodal.analyzer.identification.identify import identify


def main():
    cases = [("as it is", None)] + ([] if "quick" in sys.argv[1:] else [("with an axis", AXIS)])
    for words, axis in cases:
        session, true = soft_ur10e_session(axis, seed=1)
        began = time.perf_counter()
        found = identify(session)
        between = time.perf_counter()
        gap = find_gap(session, gates=False, modes=False, advice=False).result
        spent = between - began, time.perf_counter() - between
        print(f"{words}: identify {spent[0]:.0f} s, gap {spent[1]:.0f} s, {gap.summary}")
        print("  joint            identify/true   gap/true  ± its std   off in std")
        for row, k, by_gap in zip(found.joints, true, gap.joint_stiffness_ranges, strict=True):
            off = (by_gap.k_n_m_per_rad - k) / by_gap.k_std
            print(
                f"  {row.joint:<16} {row.k_n_m_per_rad / k:13.4f} {by_gap.k_n_m_per_rad / k:10.4f}"
                f" {by_gap.k_std / k:11.4f} {off:12.1f}"
            )


if __name__ == "__main__":
    main()
