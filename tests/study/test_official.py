"""The seed of an official study is its commit's; cases of other makers are drawn from it."""

import importlib
import subprocess
from hashlib import sha256
from types import SimpleNamespace

import pytest

from armodal.hil_sim.makers import ARMS, MAKERS, WRISTS, draw_cases, effects_of
from armodal.protocols.errors import SessionError
from armodal.study.cases import case_of
from armodal.study.official import official_seed


def git(folder, *words):
    names = ["-c", "user.name=n", "-c", "user.email=n@n"]
    told = subprocess.run(
        ["git", "-C", str(folder), *names, *words], check=True, capture_output=True, text=True
    )
    return told.stdout.strip()


@pytest.fixture
def tree(tmp_path):
    git(tmp_path, "init", "-q")
    (tmp_path / "code.py").write_text("1")
    git(tmp_path, "add", ".")
    git(tmp_path, "commit", "-qm", "One")
    return tmp_path


def test_another_commit_has_another_seed(tree):
    seed, commit = official_seed(tree)
    assert commit == git(tree, "rev-parse", "HEAD")
    assert commit.startswith(f"{seed:013x}")
    git(tree, "commit", "-qm", "Two", "--allow-empty")
    assert official_seed(tree)[0] != seed


def test_changes_are_refused(tree):
    (tree / "code.py").write_text("2")
    with pytest.raises(SessionError, match="has changes"):
        official_seed(tree)


def test_code_of_no_commit_is_refused(tmp_path):
    with pytest.raises(SessionError, match="no git work tree"):
        official_seed(tmp_path)


def test_cases_go_round_arms_wrists_and_effects():
    specs = draw_cases("frame", 3, nulls=10, effects=2 * len(effects_of("frame")))
    nulls = [spec for spec in specs if not spec.kinds]
    assert {(spec.arm, spec.wrist) for spec in nulls} == {(a, w) for a in ARMS for w in WRISTS}
    kinds = [spec.kinds[0] for spec in specs if spec.kinds]
    assert sorted(kinds) == sorted([*effects_of("frame"), *effects_of("frame")])
    assert {spec.wrist for spec in specs if spec.kinds == ("released_joint",)} == {"rigid"}
    assert [spec.number for spec in specs] == list(range(1, len(specs) + 1))


def test_more_cases_leave_the_others_as_they_are():
    few = draw_cases("frame", 3, nulls=4, effects=6)
    more = draw_cases("frame", 3, nulls=8, effects=9)
    told = {(s.kinds, s.size_class, s.arm, s.wrist, s.seed) for s in more}
    assert {(s.kinds, s.size_class, s.arm, s.wrist, s.seed) for s in few} <= told


def test_an_effect_that_came_later_leaves_the_seeds_of_a_library_as_they_were(monkeypatch):
    def drawn(maker, version=None):
        specs = draw_cases(maker, 3, nulls=20, effects=60, version=version)
        told = [(s.number, s.arm, s.wrist, s.seed, s.kinds, s.size_class) for s in specs]
        return sha256(repr(told).encode()).hexdigest()[:16]

    of_first = {maker: drawn(maker, 1) for maker in MAKERS}
    # As drawn when there was one library.
    assert of_first == {"frame": "07d1c5129a3e1ac2", "mujoco": "c97d2a6269655982"}
    for maker in MAKERS:
        modules = importlib.import_module(f"armodal.hil_sim.makers.{maker}.maker").EFFECTS
        later = {**modules, "later": SimpleNamespace(SINCE=2)}
        monkeypatch.setattr(f"armodal.hil_sim.makers.{maker}.maker.EFFECTS", later)
        assert drawn(maker, 1) == of_first[maker]
        assert drawn(maker) != of_first[maker]


def test_a_case_of_another_maker_is_closed_by_its_specification():
    spec = draw_cases("frame", 3, nulls=1, effects=0)[0]
    case = case_of(spec)
    assert case.arm.name
    assert len(case.truth_sha256) == 64
