"""Effects of an arm file in the simulated arm, beside what the analysis makes of the same file."""

import inspect
from dataclasses import replace

import numpy as np
import pytest
import scipy.optimize
from support.added import added, any_of, axis, with_effects

from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.corrected.prediction import predict_arm
from armodal.analyzer.gap.add import file_key
from armodal.analyzer.gap.library import all_instances, described, names_of_laws
from armodal.analyzer.gap.model.ordinary import Ordinary
from armodal.hil_sim.effects import modules_with
from armodal.hil_sim.rehearsal import Rehearsal
from armodal.hil_sim.rehearsed_plant import draw_plant
from armodal.hil_sim.small_motion import linearise
from armodal.hil_sim.study.model_error import plant_of_tables
from armodal.hil_sim.study.of_file import OF_THE_TEST, with_file_effects
from armodal.hil_sim.study.plant_of_arm import plant_file_of_arm
from armodal.protocols.arm.files import load_arm
from armodal.protocols.errors import PlantError

ARM = load_arm("rv4frl")
POSTURES = np.array([[0.2, 0.4, 1.1, -0.5, 0.6, 0.3], [-0.4, -0.3, 0.8, 0.2, 1.0, 0.0]])
BELOW_HZ = 120.0
# By how much both may differ in frequency and damping ratio, relative, and why.
SAME = (1e-5, 1e-4)  # the same equations, by other recursions
# Of what a bearing loses a file tells a factor, Maxwell elements here. What grows with frequency no
# file tells: that moves |pole| by its damping ratio squared.
LOSS_TOLD_IN_PART = (5e-3, None)
AGREES = {
    "link_axis": SAME,
    "absorber": SAME,
    "bearing": LOSS_TOLD_IN_PART,
    "payload": SAME,
    "released_joint": LOSS_TOLD_IN_PART,
    "servo": (5e-3, 2e-2),  # the rotor is carried by the link before, one part in its ratio
    "rotor": (5e-3, 2e-2),
    "coupling": SAME,
    "wrist_coupling": LOSS_TOLD_IN_PART,
    "load_damping": SAME,
    "nonproportional": SAME,
    "encoder_offset": SAME,
    "hysteretic": (5e-3, 5e-2),  # five Maxwell elements for a constant loss factor
    "gravity_compensator": SAME,
    "link_bending": (5e-2, 0.3),  # the link's mass is cut in other pieces
    "link_torsion": (1e-2, 0.1),
}
ABOUT = (5e-2, None)  # of an effect that is not listed
KNOWN = {name for module in modules_with("OF_FILE").values() for name in module.OF_FILE}
# On soft ground the inertia is its own; laws of joints are set beside each other over a swing.
COMPARED = sorted(KNOWN - OF_THE_TEST - {"base", *names_of_laws()})


def swinging(place):
    """A mass of which a part moves across with its link, beside its line's nearest point."""
    told = {"mass": 4.0, "ln_frequency": 2.9, "loss": 3e-3, "part_across": 0.6, "place_along": 0.07}
    where = {"link": place, "direction": (0.6, 0.0, 0.8), "point_m": (0.1, 0.05, 0.02)}
    values = {f"absorber_{key}": value for key, value in told.items()}
    return added("absorber", place, where, std=0.0, **values)


def exactly(name, place=None):
    made = {"link_axis": lambda: axis("shoulder", std=0.0), "absorber": lambda: swinging("forearm")}
    return made[name]() if name in made else any_of(ARM, name, place)


def at_one_place(name):
    """A link that gives way over a tenth of its length, a third along it."""
    found = any_of(ARM, name)
    told = {"place": 0.31, "stretch": 0.1, "taper": 0.8, "middle": -0.6}
    told = {f"{name.removeprefix('link_')}_{key}": value for key, value in told.items()}
    parameters = [replace(p, value=told.get(p.name, p.value)) for p in found.parameters]
    assert told.keys() <= {p.name for p in parameters}
    return replace(found, parameters=tuple(parameters))


def pulling(name):
    """A compensator that stands aside, and whose pull grows by a part of its stiffness."""
    told = {"aside": 0.4, "stretch": 0.12, "growth": 0.7}
    found = any_of(ARM, name)
    told = {f"compensator_{key}": value for key, value in told.items()}
    parameters = [replace(p, value=told.get(p.name, p.value)) for p in found.parameters]
    assert told.keys() <= {p.name for p in parameters}
    return replace(found, parameters=tuple(parameters))


def without_errors(effects):
    """The arm's own springs and masses, and the effects as large as the file has them."""
    k = [joint.stiffness and joint.stiffness.value for joint in ARM.joints]
    c = [joint.damping and joint.damping.value for joint in ARM.joints]
    tables = plant_file_of_arm(ARM, k, c, peak_n=(16.0, 24.0)).model_dump()
    return plant_of_tables(with_file_effects(tables, with_effects(ARM, *effects), 1))


@pytest.mark.parametrize(
    ("name", "made"),
    [
        *((name, exactly) for name in COMPARED),
        ("gravity_compensator", pulling),
        ("link_torsion", at_one_place),
        ("link_bending", at_one_place),
    ],
)
def test_the_simulated_arm_has_the_modes_of_the_file(name, made):
    effect = made(name)
    still = replace(effect, parameters=tuple(replace(p, std=0.0) for p in effect.parameters))
    plant, corrected = without_errors([still]), with_effects(ARM, still)
    allowed = AGREES.get(name, ABOUT)
    offset = plant.sensing.encoder_rad
    for q in POSTURES:
        (wanted,) = predict_arm(corrected, [np.rad2deg(q).tolist()], below_hz=BELOW_HZ)
        true = q - np.array([offset.get(joint.name, 0.0) for joint in ARM.joints])
        poles = linearise(plant, true, None).poles
        poles = poles[poles.imag > 0.0]
        f_hz, damping = np.abs(poles) / (2.0 * np.pi), -poles.real / np.abs(poles)
        apart = np.abs(np.log(wanted.modes.f_hz[:, None] / f_hz[None]))
        own, other = scipy.optimize.linear_sum_assignment(apart)
        assert f_hz[other] == pytest.approx(wanted.modes.f_hz[own], rel=allowed[0])
        if allowed[1] is not None:
            assert damping[other] == pytest.approx(
                wanted.modes.damping_ratio[own], rel=allowed[1], abs=1e-7
            )


def test_every_effect_of_the_library_is_in_the_simulated_arm_or_refused_by_name():
    ordinary = Ordinary(superset=Superset(ARM), postures=())
    every = {instance.effect for instance in all_instances(ordinary)}
    of_the_test = {effect.name for effect in every if effect.of_the_test}
    assert of_the_test <= OF_THE_TEST
    of_the_arm = {effect.name for effect in every if not effect.of_the_test}
    of_the_arm |= {"link_axis", "absorber"}  # where a look proposes them
    assert {*AGREES, "base"} <= of_the_arm
    without = sorted((of_the_arm | set(names_of_laws())) - KNOWN)
    unread = added("no_such_effect", "joint_1")
    corrected = with_effects(ARM, *(any_of(ARM, name) for name in without), unread)
    with pytest.raises(PlantError) as refused:
        with_file_effects({"links": [], "effects": []}, corrected, 1)
    for name in (*without, "no_such_effect"):
        assert f"{name} (" in str(refused.value)


def test_a_drawn_arm_has_the_file_s_effects_beside_its_ordinary_errors():
    corrected = with_effects(ARM, axis("shoulder"), any_of(ARM, "base"), any_of(ARM, "bearing"))
    plain, _ = draw_plant(Rehearsal(arm=ARM, hidden=(("delay", 0.5),)), seed=3)
    plant, hidden = draw_plant(Rehearsal(arm=corrected), seed=3)
    assert hidden == []
    assert "axis of the file in shoulder" in plant.coordinates
    assert "bearing 1 of joint_1" in plain.coordinates
    assert "bearing 1 of joint_1" not in plant.coordinates
    # Beside them the arms are one: masses and springs are drawn alike.
    assert [link.mass_kg for link in plant.truth.links] == [
        link.mass_kg for link in plain.truth.links
    ]
    another, _ = draw_plant(Rehearsal(arm=corrected), seed=4)
    sizes = [
        next(e for e in p.truth.effects if e.kind == "link_axis").stiffness_n_m_per_rad
        for p in (plant, another)
    ]
    assert sizes[0] != sizes[1]
    # The file's deviation is a tenth of the size; none beyond two.
    assert np.abs(np.log(np.array(sizes) * 1e-5)).max() <= 0.2


def test_an_effect_that_no_module_reads_is_refused_by_its_name():
    unread = with_effects(ARM, added("no_such_effect", "joint_1"))
    with pytest.raises(PlantError, match=r"no_such_effect \(joint_1\), of which it has none"):
        with_file_effects({"links": [], "effects": []}, unread, 1)


def test_an_effect_at_a_joint_that_the_arm_has_not_is_told():
    elsewhere = with_effects(ARM, replace(any_of(ARM, "bearing"), place="joint_99"))
    with pytest.raises(PlantError, match=r"bearing \(joint_99\): it has no joint of that name"):
        with_file_effects({"links": [], "effects": []}, elsewhere, 1)


def test_an_effect_that_lacks_a_size_is_told():
    corrected = with_effects(ARM, any_of(ARM, "servo"))
    (servo,) = corrected.effects
    bare = with_effects(ARM, replace(servo, parameters=()))
    with pytest.raises(PlantError, match=r"servo \(joint_1\), which lacks servo_compliance"):
        with_file_effects({"links": [], "effects": []}, bare, 1)


SWING = 3e-5
LAWS = {
    "friction": {"limit": 0.2, "ln_presliding": 1.2, "creep": 0.0},
    "microslip": {"ln_stiffer_while_held": 0.47, "ln_seat_slips": 0.6, "ln_seat_spread": 0.5},
    "softening": {"softer": 0.2, "ln_bend": 0.3},
    "backlash": {"play": 0.7, "ln_half_play": -0.8},
}


def law(name, **values):
    told = {"joint": "joint_1", "swing_rad": SWING, "rate_rad_s": 100.0}
    return added(name, "joint_1", told, std=0.0, **(LAWS[name] | values))


def cycle(torque):
    """Torque over turns that swing as far as a hit of the middle level, to and fro."""
    turns = np.concatenate([[0.0], SWING * np.sin(np.linspace(0.0, 4.0 * np.pi, 400))])
    return np.array([torque(turn) for turn in turns])


def of_element(element):
    """Torque at a turn of an element of either side, with its memory."""
    memory = np.zeros((1, element.n_memory))

    def torque(turn):
        nonlocal memory
        held = float(element.resist(np.array([turn]), memory)[0][0])
        several = "step_s" in inspect.signature(element.remember).parameters
        more = (1e-4,) if several else ()
        memory = element.remember(np.array([turn]), memory, *more)
        return held

    return torque


@pytest.mark.parametrize("name", LAWS)
def test_a_joint_s_own_law_has_the_torque_of_the_file(name):
    """Over a swing; softening's form is the laboratory's own, alike to a tenth of what it loses.

    A seat's smooth law is another staircase on either side: 16 and 48 sliders differ by 0.7 %.
    """
    corrected = with_effects(ARM, law(name))
    effect = corrected.effects[0]
    ordinary = Ordinary(superset=Superset(ARM), postures=())
    known = {f"ln k {j.name}": np.log(j.stiffness.value) for j in ARM.joints if j.stiffness}
    instance = described(ordinary, name, effect.description)
    own = known | {
        p.name: next(v.value for v in effect.parameters if v.name == file_key(p.name, "joint_1"))
        for p in instance.parameters
    }
    plant = without_errors([law(name)])
    motion = linearise(plant, POSTURES[0], None)
    (element,) = motion.elements
    ours = cycle(of_element(instance.law.element(own, 0.0)))
    # Where the weight lays the play to a side the laboratory's does so too; joint 1 carries none.
    theirs = cycle(of_element(element))
    # A spring's part that the file has beside the joint's, the laboratory may have in the joint's.
    rest = ours - theirs
    turns = cycle(lambda turn: turn)
    rest -= turns * float(rest @ turns / (turns @ turns))
    allowed = {"softening": 0.1, "microslip": 0.015}.get(name, 1e-9)
    assert np.abs(rest).max() <= allowed * np.ptp(ours)


def test_what_of_a_law_the_laboratory_has_not_is_told():
    for effect, words in (
        (law("friction", creep=50.0), "it has no friction that creeps"),
        (law("softening", softer=-1.0), "it has no joint that hardens"),
        (added("softening", "joint_1", **LAWS["softening"]), "law without its swing"),
    ):
        with pytest.raises(PlantError, match=words):
            with_file_effects({"links": [], "effects": []}, with_effects(ARM, effect), 1)


@pytest.mark.parametrize("name", ["link_axis", "hysteretic"])
def test_a_loss_factor_beyond_what_the_laboratory_has_is_refused(name):
    key = {"link_axis": "axis_loss_factor", "hysteretic": "loss_joint_1"}[name]
    told = added("", "", **{key: 0.5}).parameters
    effect = exactly(name)
    kept = tuple(p for p in effect.parameters if p.name != key)
    large = with_effects(ARM, replace(effect, parameters=(*kept, *told)))
    with pytest.raises(PlantError, match=r"loss factor beyond 0\.3"):
        with_file_effects({"links": [], "effects": []}, large, 1)
