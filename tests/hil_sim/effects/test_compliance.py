import numpy as np
import pytest
from support.plain_plants import (
    LENGTH,
    MASS,
    OWN,
    K,
    chain,
    flexibility,
    frequencies,
    hertz,
    motion_of,
)

from armodal.protocols.errors import PlantError

INERTIA = OWN + MASS * LENGTH**2
EXACT = 1e-9  # both sides are rounded only


def test_a_released_joint_is_a_joint_with_that_spring():
    spring = {"stiffness_n_m_per_rad": 700.0, "damping_n_m_s_per_rad": 0.05}
    freed = {"kind": "released_joint", "joint": "joint_2", **spring}
    released = motion_of(chain("zz", k=(K, None), effects=[freed]))
    plain = motion_of(chain("zz", k=(K, 700.0)))
    assert frequencies(released) == pytest.approx(frequencies(plain), rel=EXACT)


def test_a_bearing_lets_the_link_swing_and_roll_across_the_axis():
    bearing = {
        "kind": "bearing",
        "joint": "joint_1",
        "stiffness_n_m_per_rad": (800.0, 500.0),
        "damping_n_m_s_per_rad": (0.01, 0.01),
    }
    motion = motion_of(chain("z", effects=[bearing]))
    # axis x e with e = x, the axis' farthest: y, swing; then z x y, back along -x: roll.
    wanted = np.sqrt([K / INERTIA, 800.0 / INERTIA, 500.0 / OWN]) / (2.0 * np.pi)
    assert frequencies(motion) == pytest.approx(np.sort(wanted), rel=EXACT)


def test_an_axis_in_a_link_swings_what_lies_beyond_it():
    weak = {
        "kind": "link_axis",
        "link": "link_1",
        "point_m": (0.2, 0.0, 0.0),
        "direction": (0.0, 0.0, 1.0),
        "stiffness_n_m_per_rad": 900.0,
        "damping_n_m_s_per_rad": 0.01,
    }
    motion = motion_of(chain("z", effects=[weak]))
    lever = LENGTH - 0.2
    across = OWN + MASS * LENGTH * lever
    M = np.array([[INERTIA, across], [across, OWN + MASS * lever**2]])
    assert frequencies(motion) == pytest.approx(hertz(M, np.diag([K, 900.0])), rel=EXACT)


def test_a_base_that_rocks_and_shifts_carries_the_arm():
    base = {
        "kind": "base",
        "pivot_m": (0.0, 0.0, 0.0),
        "mass_kg": 12.0,
        "center_m": (0.0, 0.0, 0.0),
        "inertia_kg_m2": (0.3, 0.0, 0.0, 0.3, 0.0, 0.4),
        "springs": (
            {"way": "rock_z", "stiffness": 5e4, "damping": 1.0},
            {"way": "shift_y", "stiffness": 4e6, "damping": 10.0},
        ),
    }
    motion = motion_of(chain("z", effects=[base]))
    pull = MASS * LENGTH
    M = np.array(  # shift, rock, joint
        [[12.0 + MASS, pull, pull], [pull, 0.4 + INERTIA, INERTIA], [pull, INERTIA, INERTIA]]
    )
    assert frequencies(motion) == pytest.approx(hertz(M, np.diag([4e6, 5e4, K])), rel=EXACT)


@pytest.mark.parametrize("cuts", [1, 3, 8])
def test_a_bending_link_gives_at_its_tip_like_a_cantilever(cuts):
    bent = {
        "kind": "bending",
        "link": "link_1",
        "from_m": (0.0, 0.0, 0.0),
        "to_m": (LENGTH, 0.0, 0.0),
        "cuts": cuts,
        "bending_stiffness_n_m2": 40.0,
        "loss": 1e-5,
    }
    plant = chain("z", effects=[bent])
    gives = flexibility(plant, motion_of(plant), "link_1", (LENGTH, 0.0, 0.0))
    beam = LENGTH**3 / (3.0 * 40.0) * (1.0 - 0.25 / cuts**2)
    assert gives[2, 2] == pytest.approx(beam, rel=EXACT)
    assert gives[1, 1] == pytest.approx(beam + LENGTH**2 / K, rel=EXACT)


def test_a_twisting_link_turns_by_length_over_stiffness():
    twisted = {
        "kind": "torsion",
        "link": "link_1",
        "from_m": (0.0, 0.0, 0.0),
        "to_m": (LENGTH, 0.0, 0.0),
        "torsional_stiffness_n_m2": 40.0,
        "loss": 1e-5,
    }
    plant = chain("z", effects=[twisted])
    gives = flexibility(plant, motion_of(plant), "link_1", (LENGTH, 0.0, 0.0))
    assert gives[3, 3] == pytest.approx(LENGTH / 40.0, rel=EXACT)
    assert gives[2, 2] == pytest.approx(0.0, abs=1e-15)


@pytest.mark.parametrize("kind", ["bending", "torsion"])
def test_a_link_that_bows_gives_way_across_and_along_its_tangent(kind):
    """A parabola in the level plane: hinges about its tangent, or across it, lift the tip."""
    stiffness = {"bending": "bending_stiffness_n_m2", "torsion": "torsional_stiffness_n_m2"}
    bow_m, cuts = 0.05, 8
    bowed = {
        "kind": kind,
        "link": "link_1",
        "from_m": (0.0, 0.0, 0.0),
        "to_m": (LENGTH, 0.0, 0.0),
        "bow_m": (0.02, bow_m, 0.0),  # what lies along the line is no bow
        "cuts": cuts,
        stiffness[kind]: 40.0,
        "loss": 1e-5,
    }
    plant = chain("z", effects=[bowed])
    gives = flexibility(plant, motion_of(plant), "link_1", (LENGTH, 0.0, 0.0))
    part = (np.arange(cuts) + 0.5) / cuts
    place = np.stack([LENGTH * part, 4.0 * part * (1.0 - part) * bow_m])
    tangent = np.stack([np.ones(cuts), 4.0 * (1.0 - 2.0 * part) * bow_m / LENGTH])
    tangent /= np.linalg.norm(tangent, axis=0)
    about = tangent if kind == "torsion" else np.stack([-tangent[1], tangent[0]])
    arm = np.array([[LENGTH], [0.0]]) - place
    lifts = about[0] * arm[1] - about[1] * arm[0]
    assert gives[2, 2] == pytest.approx(LENGTH / cuts / 40.0 * np.sum(lifts**2), rel=EXACT)


@pytest.mark.parametrize("kind", ["bending", "torsion"])
def test_pieces_of_a_link_have_its_mass_centre_and_inertia_together(kind):
    stiffness = {"bending": "bending_stiffness_n_m2", "torsion": "torsional_stiffness_n_m2"}
    cut = {
        "kind": kind,
        "link": "link_1",
        "from_m": (0.0, 0.0, 0.0),
        "to_m": (LENGTH, 0.1, 0.0),
        stiffness[kind]: 1e12,  # so that nothing but the joint gives
        "loss": 1e-5,
    }
    motion = motion_of(chain("z", effects=[cut]))
    # Between 1e12 and 3e3 a part of 1e-8 is left.
    assert frequencies(motion)[0] == pytest.approx(np.sqrt(K / INERTIA) / 2.0 / np.pi, rel=1e-6)


def test_a_crack_is_closed_at_rest_and_loses_stiffness_beyond_its_opening():
    crack = {
        "kind": "one_sided",
        "link": "link_1",
        "point_m": (0.2, 0.0, 0.0),
        "direction": (0.0, 0.0, 1.0),
        "stiffness_closed_n_m_per_rad": 900.0,
        "stiffness_open_n_m_per_rad": 300.0,
        "damping_n_m_s_per_rad": 0.01,
        "opening_rad": 1e-4,
    }
    motion = motion_of(chain("z", effects=[crack]))
    assert motion.stiffness == pytest.approx(np.diag([K, 900.0]), abs=1e-6)
    (element,) = motion.elements
    torque, slope = element.resist(np.array([0.5e-4, 3e-4]), np.zeros((2, 0)))
    assert torque == pytest.approx([0.0, -600.0 * 2e-4])
    assert slope == pytest.approx([0.0, -600.0])


def test_a_parallelogram_s_bar_resists_both_joints_turning_together():
    bar = {
        "kind": "parallelogram",
        "joint": "joint_1",
        "joint_after": "joint_2",
        "tail_m": (0.0, 0.1, 0.0),
        "stiffness_n_per_m": 1e5,
        "damping_n_s_per_m": 1.0,
        "mass_kg": 0.6,
    }
    plant, plain = chain("zz", effects=[bar]), motion_of(chain("zz"))
    square = motion_of(plant)
    lever = 1e5 * 0.1**2 * np.ones((2, 2))
    assert square.stiffness - plain.stiffness == pytest.approx(lever, rel=EXACT)
    # Half of the bar rides at (LENGTH, 0.1), the same place as from joint 2 at (0, 0.1).
    M = 0.3 * np.array([[LENGTH**2 + 0.01, 0.01], [0.01, 0.01]])
    assert square.mass - plain.mass == pytest.approx(M, rel=1e-6)
    turned = motion_of(plant, [0.0, 30.0]).stiffness - motion_of(chain("zz"), [0.0, 30.0]).stiffness
    assert turned == pytest.approx(lever * np.cos(np.deg2rad(30.0)) ** 2, rel=1e-6)


def test_a_bar_between_joints_in_the_wrong_order_is_refused():
    bar = {
        "kind": "parallelogram",
        "joint": "joint_2",
        "joint_after": "joint_1",
        "tail_m": (0.0, 0.1, 0.0),
        "stiffness_n_per_m": 1e5,
        "damping_n_s_per_m": 1.0,
    }
    with pytest.raises(PlantError, match="exchange them"):
        motion_of(chain("zz", effects=[bar]))
