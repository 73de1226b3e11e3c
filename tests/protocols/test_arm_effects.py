"""Effects in an arm file: read strictly, written back without touching the rest."""

from __future__ import annotations

from dataclasses import replace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from armodal.protocols.arm.files import arm_from_texts, load_arm
from armodal.protocols.arm.records import AddedEffect, EffectEvidence, EffectParameter, Estimate
from armodal.protocols.arm.rewrite import text_with_effects
from armodal.protocols.errors import ArmError

ARM = load_arm("rv4frl")
EVIDENCE = EffectEvidence(
    gain_nats=812.5,
    held_out_gain_nats=-3.0,
    confidence=0.998,
    session_sha256="ab" * 32,
    created="2026-01-31T12:00:00+00:00",
)
AXIS = AddedEffect(
    name="link_axis",
    place="link_3",
    parameters=(
        EffectParameter(
            name="axis compliance link_3",
            unit="rad/(N m)",
            value=2.1e-5,
            std=1e-6,
            low=1.9e-5,
            high=2.3e-5,
        ),
    ),
    description={"link": ARM.joints[2].link.name, "direction": (0.0, 0.6, 0.8), "count": 2.0},
    evidence=EVIDENCE,
)
ROTOR = replace(AXIS, name="rotor", place="joint_2", description={})


def read(text: str):
    assert ARM.can is not None
    return arm_from_texts(text, urdf_text=ARM.urdf_text, database_text=ARM.can.database_text)


NUMBER = st.floats(min_value=-1e14, max_value=1e14)
TEXT = st.text(
    st.characters(min_codepoint=32, exclude_categories=["Cs", "Cc"]), min_size=1, max_size=20
)


@st.composite
def an_effect(draw):
    names = draw(st.lists(TEXT, max_size=3, unique=True))
    parameters = []
    for name in names:
        low, value, high = sorted(draw(st.tuples(NUMBER, NUMBER, NUMBER)))
        std = abs(draw(NUMBER))
        parameters.append(
            EffectParameter(
                name=name, unit=draw(st.just("") | TEXT), value=value, std=std, low=low, high=high
            )
        )
    keys = st.from_regex(r"[a-z][a-z0-9_]{0,8}", fullmatch=True).filter(
        lambda key: key not in {"link", "direction", "point_m"}
    )
    values = TEXT | NUMBER | st.lists(NUMBER, min_size=1, max_size=4).map(tuple)
    return AddedEffect(
        name=draw(TEXT),
        place=draw(TEXT),
        parameters=tuple(parameters),
        description=draw(st.dictionaries(keys, values, max_size=3)),
        evidence=replace(EVIDENCE, gain_nats=draw(NUMBER), held_out_gain_nats=draw(NUMBER)),
    )


@settings(max_examples=25)
@given(effects=st.lists(an_effect(), max_size=3))
def test_effects_come_back_as_they_were_written(effects) -> None:
    assert read(text_with_effects(ARM, effects)).effects == tuple(effects)


def test_without_a_change_the_text_is_the_same_to_the_byte() -> None:
    assert text_with_effects(ARM, ()) == ARM.text
    more = read(text_with_effects(ARM, [AXIS]))
    assert text_with_effects(more, [AXIS]) == more.text


def test_an_effect_taken_out_again_leaves_the_arm_as_it_was() -> None:
    more = read(text_with_effects(ARM, [AXIS, ROTOR]))
    assert text_with_effects(more, ()).rstrip() == ARM.text.rstrip()
    assert read(text_with_effects(more, [ROTOR])).effects == (ROTOR,)


def test_all_lines_that_do_not_change_are_kept_with_their_comments() -> None:
    text = text_with_effects(
        ARM, [AXIS], stiffness={"joint_2": Estimate(value=2.5e4, std=1e2, source="gap")}
    )
    lost = set(ARM.text.splitlines()) - set(text.splitlines())
    assert len(lost) == 1
    assert lost.pop().startswith("stiffness_n_m_per_rad = { value = 33000.0")


def test_comments_in_an_effect_that_stays_are_kept() -> None:
    text = text_with_effects(ARM, [AXIS]).replace("[[effects]]", "# seen twice\n[[effects]]")
    again = text_with_effects(read(text), [AXIS, ROTOR])
    assert "# seen twice" in again
    assert read(again).effects == (AXIS, ROTOR)


def test_joint_values_and_name_are_put_in() -> None:
    k, c = Estimate(value=1.5, std=0.1, source='a "b"\\'), Estimate(value=2.0, std=1.0, source="s")
    arm = read(
        text_with_effects(ARM, [], stiffness={"joint_5": k}, damping={"joint_5": c}, name="another")
    )
    assert arm.name == "another"
    assert (arm.joints[4].stiffness, arm.joints[4].damping) == (k, c)
    assert arm.joints[0].stiffness == ARM.joints[0].stiffness


def test_a_comment_behind_a_replaced_value_is_kept() -> None:
    line = next(line for line in ARM.text.splitlines() if line.startswith("stiffness"))
    arm = read(ARM.text.replace(line, line + "  # by hand", 1))
    text = text_with_effects(
        arm, [], stiffness={"joint_1": Estimate(value=2.0, std=1.0, source="s")}
    )
    assert 'value = 2.0, std = 1.0, source = "s"}  # by hand' in text


def test_an_arm_that_a_file_cannot_hold_is_refused() -> None:
    bad = replace(AXIS.parameters[0], low=1.0)
    with pytest.raises(ArmError, match=r"effects\[0\]\.parameters.*low <= value <= high"):
        text_with_effects(ARM, [replace(AXIS, parameters=(bad,))])
    with pytest.raises(ArmError, match="wanted one of the joints joint_1"):
        text_with_effects(ARM, [], stiffness={"j9": Estimate(value=1.0, std=1.0, source="s")})
    with pytest.raises(ArmError, match="damping_n_m_s_per_rad together"):
        text_with_effects(ARM, [], stiffness={"joint_6": Estimate(value=1.0, std=1.0, source="s")})


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("confidence = 0.998", "confidence = 1.5", "effects[0].evidence.confidence: wanted less"),
        ("confidence", "trust", "effects[0].evidence.trust: wanted one of the keys"),
        ("gain_nats = 812.5", "gain_nats = nan", "effects[0].evidence.gain_nats: wanted a finite"),
        ("gain_nats = 812.5", "gain_nats = inf", "effects[0].evidence.gain_nats: wanted"),
        ("abab", "ABab", "effects[0].evidence.session_sha256: wanted"),
        ("2026-01-31T12:00:00+00:00", "yesterday", "effects[0].evidence.created: wanted an ISO"),
        ("2026-01-31T12:00:00+00:00", "2026-01-31", "effects[0].evidence.created: wanted an ISO"),
        ("std = 1e-06", "std = -1.0", "effects[0].parameters.'axis compliance link_3'.std: wanted"),
        ("[0.0, 0.6, 0.8]", "[0.0, 0.6, 0.9]", "effects[0].description: wanted direction of len"),
        ("[0.0, 0.6, 0.8]", "[0.0, 1.0]", "effects[0].description: wanted direction of three"),
        ("count = 2.0", "count = true", "effects[0].description.count"),
        ('place = "link_3"', "", "effects[0].place: wanted a value, got nothing"),
        ('place = "link_3"', 'place = "a\\u0000b"', "effects[0].place: wanted text without"),
        ('place = "link_3"', 'place = "l"\nsize = 1', "effects[0].size: wanted one of the keys"),
    ],
)
def test_an_impossible_effect_is_refused_with_its_path(old, new, said) -> None:
    text = text_with_effects(ARM, [AXIS])
    head, tail = text[: text.index("[[effects]]")], text[text.index("[[effects]]") :]
    assert old in tail
    with pytest.raises(ArmError) as caught:
        read(head + tail.replace(old, new, 1))
    assert said in str(caught.value)


def test_a_link_of_another_arm_is_refused() -> None:
    with pytest.raises(ArmError, match=r"effects\[0\]\.description\.link: wanted one of the links"):
        text_with_effects(ARM, [replace(AXIS, description={"link": "elsewhere"})])


def test_an_inline_array_of_effects_is_rewritten_as_tables() -> None:
    text = (
        'name = "rv4frl"\neffects = [{ name = "rotor", place = "joint_1", parameters = {}, '
        "evidence = { gain_nats = 1.0, held_out_gain_nats = 1.0, confidence = 0.5, "
        f'session_sha256 = "{"0" * 64}", created = "2026-01-31T12:00:00Z" }} }}]'
    )
    arm = read(ARM.text.replace('name = "rv4frl"', text, 1))
    assert read(text_with_effects(arm, [*arm.effects, AXIS])).effects == (*arm.effects, AXIS)
