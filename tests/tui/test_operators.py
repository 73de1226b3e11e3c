"""The scripted operator knows whether its laboratory is there."""

import socket

from support.chain_arm import chain_arm

from armodal.hil_sim.study import rehearsal_plan
from armodal.tui.operators import ScriptedOperator


def test_a_scripted_operator_hears_that_its_laboratory_has_gone(tmp_path):
    arm = chain_arm(1)
    with socket.socket(socket.AF_UNIX) as server:
        server.bind(str(tmp_path / "s"))
        server.listen()
        operator = ScriptedOperator(tmp_path / "s", arm, rehearsal_plan(arm), time_scale=1.0)
        theirs, _ = server.accept()
        assert operator.listens
        theirs.close()
        assert not operator.listens
        operator.close()
