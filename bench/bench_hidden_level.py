"""A micro-slip that a turned sensor axis hides: the whole workflow, its laws included.

One sensor axis turned leaves so much that no joint's change with the level stands out; it is looked
for again once the turn is named. Takes some ten minutes; the small version, without laws, is in the
tests of the workflow.
"""

import json
import time

from armodal.analyzer.gap.workflow import find_gap
from armodal.hil_sim.study import make_case
from armodal.study.score import mark

KINDS = ("microslip", "flipped_axis")
SEED = 3343554958663793303


def main():
    case = make_case(seed=SEED, arm="ur5", effect=KINDS, ladder=True)
    session = case.session()
    began = time.process_time()
    result = find_gap(session, gates=False, modes=False, advice=False).result
    spent = time.process_time() - began
    print(f"{mark(json.loads(case.open_truth()), result).outcome}, {spent:.0f} s")
    print(result.summary)
    for note in result.notes:
        print(f"  {note}")


if __name__ == "__main__":
    main()
