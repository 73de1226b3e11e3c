import json
from dataclasses import replace

from armodal.tui.command_parts.check_session import session_checks


def test_checks_are_plain_values_and_a_table(session):
    """Of two postures, one of them for validation."""
    few = (session.header.plan.postures[0].name, session.header.plan.postures[-1].name)
    session = replace(session, hits=tuple(hit for hit in session.hits if hit.posture in few))
    value, table = session_checks(session)
    assert json.loads(json.dumps(value)) == value
    rows = value["checks"]
    assert {row["check"] for row in rows} == {
        "rigid link",
        "driving point",
        "homogeneity",
        "reciprocity",
        "drift",
        "sensor",
    }
    assert not [row for row in rows if row["outcome"] == "fault"]
    assert table.row_count == len(rows)
