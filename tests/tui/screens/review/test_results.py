"""Identify and Gap: commands beside the app, and what their results look like."""

import asyncio
import json
import sys

import pytest
from rich.console import Console
from support.gap_results import made_result
from support.screen import screen_text
from support.shown_results import GAP

from armodal.analyzer.report import gap_to_json
from armodal.protocols.errors import EstimateError, SessionError
from armodal.tui.command_parts.gap_results import gap_json
from armodal.tui.screens.review.command_run import CommandRun
from armodal.tui.screens.review.gap_text import gap_view
from armodal.tui.screens.review.identify_text import identification_view
from armodal.tui.screens.review.panes.gap import read_gap
from armodal.tui.screens.review.picked_file import picked_path


def plain(renderable, width=100):
    console = Console(width=width, color_system=None, force_terminal=False)
    with console.capture() as capture:
        console.print(renderable)
    return capture.get()


def python(code):
    return (sys.executable, "-c", code)


def run(code, progress=None):
    heard = [] if progress is None else progress
    return asyncio.run(CommandRun(("gap", "x"), heard.append, python(code)).result())


def test_the_verdict_the_sizes_and_what_to_do_are_on_the_gap_screen():
    shown = plain(gap_view(GAP))
    for words in ("NAMED", "The base rocks.", "97 % sure", "Tighten the bolts.", "bearing"):
        assert words in shown
    assert "40.0" in shown
    assert "10.0" in shown
    assert "█ 9" in shown  # the worst axis of the point counts
    assert "10000 to 30000" in shown


def test_a_parameter_reads_alike_from_the_kept_file_and_from_the_command():
    """With its unit, its deviation and its interval."""
    result = made_result("named", ["payload"])
    kept = plain(gap_view(json.loads(gap_to_json(result))))
    (line,) = (row.strip() for row in kept.split("\n") if row.strip().startswith("size:"))
    assert line == "size: 1.00 ± 0.10 kg (95 %: 0.800 to 1.20 kg)"
    assert line in plain(gap_view(gap_json(result, {})))


def test_the_map_of_eighteen_points_fits_eighty_columns():
    where = [
        {"posture": "validation 1", "point": str(p), "band_hz": [20, 55], "ratio": 10.0 * p}
        for p in range(1, 19)
    ]
    row = next(
        line
        for line in plain(gap_view({**GAP, "where": where}), 78).split("\n")
        if "validation 1" in line
    )
    assert row.count("█") == 18
    assert row.rstrip().endswith("█99")


def test_a_gap_result_of_the_verdict_alone_can_be_shown():
    assert "NOTHING DETECTABLE" in plain(gap_view({"verdict": "nothing_detectable"}))


@pytest.mark.parametrize("key", [*GAP, "next_test"])
@pytest.mark.parametrize("value", [None, 3, "text", [1], {"a": 1}, []])
def test_no_odd_value_in_a_gap_result_breaks_the_screen(key, value):
    assert plain(gap_view({**GAP, key: value}))


@pytest.mark.parametrize("text", ["", "[]", '{"a": 1}', "\x00"])
def test_a_file_that_is_no_gap_result_is_refused(tmp_path, text):
    path = tmp_path / "g.json"
    path.write_text(text)
    with pytest.raises(SessionError):
        read_gap(path)


WRONG_TYPES = [
    '{"verdict": "named", "effects": [{"parameters": [1]}]}',
    '{"verdict": "named", "where": [{"ratio": 2, "band_hz": ["a", "b"]}]}',
    '{"verdict": "named", "gap_before": [{"posture": [1]}], "gap_after": []}',
    '{"verdict": "x", "gap_before": [{"frf_error": 1}], "gap_after": [{"frf_error": 1e999}]}',
]


@pytest.mark.parametrize("text", WRONG_TYPES)
def test_a_gap_result_of_wrong_types_is_refused(tmp_path, text):
    path = tmp_path / "g.json"
    path.write_text(text)
    with pytest.raises(SessionError, match=r"g\.json: wanted the values"):
        read_gap(path)


def test_brackets_in_a_gap_result_are_no_markup():
    rows = [{"name": "[/effect]", "posture": "[/test]", "frf_error": 0.1}]
    shown = plain(gap_view({"verdict": "named", "rivals": rows, "gap_before": rows}))
    assert "[/effect]" in shown
    assert "[/test]" in shown


def test_a_damaged_gap_result_kept_beside_the_session_is_one_message(drive, notices):
    async def steps(app, pilot):
        (told,) = notices
        assert "s.gap.json: wanted the values" in told
        assert app.state.gap is None
        await pilot.press("8")
        assert "enter: find where" in screen_text(app)

    drive(steps, prepare=lambda path: path.with_suffix(".gap.json").write_text(WRONG_TYPES[0]))


def test_a_command_tells_its_progress_and_its_result():
    heard = []
    code = "import sys; print('· step', file=sys.stderr); print('{\"a\": 1}')"
    assert run(code, heard) == {"a": 1}
    assert heard == ["step"]


@pytest.mark.parametrize("code", ["raise SystemExit(2)", "print('[]')", "print('no json')", "pass"])
def test_a_command_that_fails_or_says_something_else_is_an_error(code):
    with pytest.raises(EstimateError):
        run(code)


def test_a_command_can_be_stopped():
    async def main():
        started = asyncio.Event()
        code = "import sys, time; print('on', file=sys.stderr, flush=True); time.sleep(60)"
        command = CommandRun(("identify", "x"), lambda _: started.set(), python(code))
        task = asyncio.ensure_future(command.result())
        await started.wait()
        command.stop()
        with pytest.raises(EstimateError, match="stopped"):
            await task

    asyncio.run(main())


def test_stiffness_stands_with_its_range_and_its_method():
    found = {
        "joints": [
            {
                "joint": "joint_1",
                "k_n_m_per_rad": 20_000.0,
                "k_half_width_95": 15.0,
                "k_std_model": 600.0,
                "k_one_joint_n_m_per_rad": None,
                "c_n_m_s_per_rad": 15.0,
                "c_std": 0.1,
            }
        ],
        "structural": [],
        "validation": [],
        "notes": ["a note"],
    }
    shown = plain(identification_view(found), 76)  # what 80 columns leave beside the scroll bar
    for words in ("20000", "19985 to 20015", "all FRFs", "one mode", "none", "note: a note"):
        assert words in shown
    assert "…" not in shown


def test_identify_runs_beside_the_app_and_its_result_stays(drive):
    code = (
        "import json, sys; print('· modes', file=sys.stderr); "
        "print(json.dumps({'joints': [], 'structural': [], 'validation': [], 'notes': ['done']}))"
    )

    async def steps(app, pilot):
        await pilot.press("7", "enter")
        await app.workers.wait_for_complete()
        await pilot.pause()
        assert app.state.identification == {
            "joints": [],
            "structural": [],
            "validation": [],
            "notes": ["done"],
        }
        assert "note: done" in screen_text(app)

    drive(steps, command=python(code))


def test_identify_takes_the_poles_picked_by_hand_and_only_saved_ones(drive, notices):
    code = (
        "import json, sys; print(json.dumps({'joints': [], 'structural': [], 'validation': [], "
        "'notes': [' '.join(sys.argv[1:])]}))"
    )

    async def steps(app, pilot):
        pane = app.query_one("#identify-main")
        await pilot.press("7")
        assert "the automatic modes of all postures" in screen_text(app)
        assert "--picked" not in pane.arguments()
        await pilot.press("3", "x")
        await pilot.press("7", "enter")
        assert "refit the picks first" in notices[-1]
        await pilot.press("3", "r")
        await app.workers.wait_for_complete()
        await pilot.pause()
        await pilot.press("7", "enter")
        assert "save the picks first" in notices[-1]
        assert app.state.identification is None
        await pilot.press("s")
        await pilot.pause()
        assert "picked by hand in test 1" in screen_text(app)
        await pilot.press("enter")
        await app.workers.wait_for_complete()
        await pilot.pause()
        assert str(picked_path(app.path)) in app.state.identification["notes"][0]

    drive(steps, size=(160, 45), command=python(code))
