"""What `armodal gap` prints for people."""

from dataclasses import replace

from rich.console import Console
from support.gap_results import made_result

from armodal.analyzer.gap.records import Hidden
from armodal.tui.command_parts.gap_results import gap_tables


def printed(result):
    console = Console(width=100)
    with console.capture() as capture:
        for table in gap_tables(result):
            console.print(table)
    return capture.get()


def test_what_could_hide_is_told_where_most_of_it_could():
    rows = [
        Hidden(
            name="delay", title="Delay", place="", parameter="delay", unit="s", largest=8.87e-06
        ),
        *(
            Hidden(
                name="payload",
                title="Unmodelled mass on a link",
                place=place,
                parameter=f"payload {place}",
                words="mass",
                unit="kg",
                largest=largest,
            )
            for place, largest in (("l2", 0.2), ("l3", 0.5), ("l4", 0.1))
        ),
    ]
    found = printed(replace(made_result("nothing_detectable", ()), hidden=tuple(rows)))
    assert "Delay: delay no more than 8.87e-06 s" in found
    assert "Unmodelled mass on a link (l3): mass no more than 0.500 kg" in found
    assert "l2" not in found
    # Beside a name it is in the report.
    assert "hide" not in printed(replace(made_result("named", ("rotor",)), hidden=tuple(rows)))


def test_where_nothing_could_hide_there_is_no_heading():
    assert "could hide" not in printed(made_result("nothing_detectable", ()))
