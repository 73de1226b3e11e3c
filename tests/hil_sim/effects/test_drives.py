import numpy as np
import pytest
from support.plain_plants import (
    LENGTH,
    MASS,
    OWN,
    C,
    K,
    chain,
    frequencies,
    hertz,
    motion_of,
    straight,
)

from armodal.hil_sim.effects.gravity_compensator import lever_arms
from armodal.hil_sim.small_motion import linearise
from armodal.protocols.errors import PlantError

INERTIA = OWN + MASS * LENGTH**2
EXACT = 1e-9  # both sides are rounded only


def test_coupled_joints_have_the_cross_stiffness_beside_the_diagonal():
    cross = {"kind": "coupling", "joints": ("joint_1", "joint_2")}
    motion = motion_of(chain("zz", effects=[cross | {"cross_stiffness_n_m_per_rad": -400.0}]))
    assert motion.stiffness == pytest.approx(np.array([[K, -400.0], [-400.0, K]]), abs=1e-6)
    with pytest.raises(PlantError, match="geometric mean"):
        motion_of(chain("zz", effects=[cross | {"cross_stiffness_n_m_per_rad": 1.1 * K}]))


def test_a_payload_adds_its_mass_at_its_place():
    body = {
        "kind": "payload",
        "link": "link_1",
        "mass_kg": 1.5,
        "center_m": (0.3, 0.4, 0.1),
        "inertia_kg_m2": (0.01, 0.0, 0.0, 0.02, 0.0, 0.03),
    }
    motion = motion_of(chain("z", effects=[body]))
    assert motion.mass[0, 0] == pytest.approx(INERTIA + 0.03 + 1.5 * 0.25, rel=EXACT)


def test_a_rotor_adds_its_reflected_inertia_and_rides_on_the_link_before():
    rotor = {"kind": "rotor", "joint": "joint_2", "inertia_kg_m2": 0.4, "ratio": 50.0}
    added = motion_of(chain("zz", effects=[rotor])).mass - motion_of(chain("zz")).mass
    # Kinetic energy 0.4 (q2' + q1' / 50)^2 / 2, without the rotor's own J q1'^2.
    assert added == pytest.approx(0.4 * np.array([[0.0, 0.02], [0.02, 1.0]]), abs=1e-7)


def test_a_servo_stands_in_a_row_with_the_transmission():
    servo = {
        "kind": "rotor",
        "joint": "joint_1",
        "inertia_kg_m2": 0.4,
        "servo_stiffness_n_m_per_rad": 2000.0,
        "servo_damping_n_m_s_per_rad": 0.1,
    }
    motion = motion_of(chain("z", effects=[servo]))
    gives = np.linalg.inv(motion.stiffness)[0, 0]
    assert gives == pytest.approx(1.0 / K + 1.0 / 2000.0, rel=EXACT)
    stiffness = np.array([[K, -K], [-K, K + 2000.0]])
    assert frequencies(motion) == pytest.approx(hertz(np.diag([INERTIA, 0.4]), stiffness), rel=1e-7)


def test_wrist_gears_turn_the_driven_link_back():
    gears = {"kind": "wrist_coupling", "driver": "joint_1", "driven": "joint_2", "ratio": 0.7}
    gives = np.linalg.inv(motion_of(chain("zz", effects=[gears])).stiffness)
    # A torque on the driver winds its own spring alone; the driven link follows by its ratio.
    assert gives[0, 0] == pytest.approx(1.0 / K, rel=1e-7)
    assert gives[0, 1] == pytest.approx(-0.7 / K, rel=1e-7)
    assert gives[1, 1] == pytest.approx((1.0 + 0.7**2) / K, rel=1e-7)


@pytest.mark.parametrize("q_deg", [-40.0, 0.0, 65.0])
def test_a_compensator_stiffens_by_the_curvature_of_its_energy(q_deg):
    anchor, eye = np.array([-0.1, 0.02, 0.3]), np.array([0.25, -0.03, 0.0])
    cylinder = {
        "kind": "gravity_compensator",
        "joint": "joint_1",
        "anchor_m": tuple(anchor),
        "eye_m": tuple(eye),
        "tension_n": 800.0,
        "length_m": 0.35,
        "stiffness_n_per_m": 2e4,
        "damping_n_s_per_m": 30.0,
    }
    plain = motion_of(chain("y"), [q_deg])
    motion = motion_of(chain("y", effects=[cylinder]), [q_deg])

    def length(q):
        R = np.array([[np.cos(q), 0, np.sin(q)], [0, 1, 0], [-np.sin(q), 0, np.cos(q)]])
        return np.linalg.norm(R @ eye - anchor)

    def energy(q):
        return 800.0 * length(q) + 1e4 * (length(q) - 0.35) ** 2

    q, h = np.deg2rad(q_deg), 1e-3
    curvature = (energy(q + h) - 2.0 * energy(q) + energy(q - h)) / h**2
    # Central differences of step 1e-3 leave 1e-6 of the curvature.
    assert (motion.stiffness - plain.stiffness)[0, 0] == pytest.approx(curvature, rel=1e-5)
    slope = (length(q + h) - length(q - h)) / (2.0 * h)
    assert (motion.damping - plain.damping)[0, 0] == pytest.approx(30.0 * slope**2, rel=1e-5)


def test_a_cylinder_square_to_its_lever_has_the_lever_as_arm():
    length, first, second = lever_arms(
        np.array([0.0, 0.0, 1.0]), np.array([0.3, 0.4, 0.2]), np.array([0.3, 0.0, 0.2])
    )
    assert (length, abs(first)) == pytest.approx((0.4, 0.3))
    assert second == pytest.approx((0.09 - 0.09) / 0.4)


def test_a_heavier_sensor_loads_the_point_it_stands_on():
    extra = {"kind": "sensor_mass", "extra_kg": 0.2}
    plain, heavy = chain("z"), chain("z", effects=[extra])
    for point, lever in (("p1", LENGTH), ("m1", 0.5 * LENGTH)):
        masses = [linearise(p, [0.0], straight(p, point)).mass[0, 0] for p in (plain, heavy)]
        assert masses[1] - masses[0] == pytest.approx(0.2 * lever**2, rel=1e-7)


def test_a_mass_on_springs_is_felt_as_an_absorber():
    pack = {
        "kind": "dress_pack",
        "link": "link_1",
        "position_m": (0.4, 0.0, 0.0),
        "mass_kg": 0.8,
        "frequency_hz": 9.0,
        "damping_ratio": 0.05,
    }
    motion = motion_of(chain("z", effects=[pack]))
    k = 0.8 * (2.0 * np.pi * 9.0) ** 2
    two = hertz(np.diag([INERTIA, 0.8]), np.array([[K + k * 0.16, -k * 0.4], [-k * 0.4, k]]))
    # Along x and z the link stands still.
    assert frequencies(motion) == pytest.approx(np.sort([*two, 9.0, 9.0]), rel=1e-7)


def test_a_dashpot_resists_along_its_line_and_may_stand_on_the_floor():
    damper = {
        "kind": "dashpot",
        "from_link": "floor",
        "from_m": (0.4, 1.0, 0.0),
        "to_link": "link_1",
        "to_m": (0.4, 0.0, 0.0),
        "damping_n_s_per_m": 25.0,
    }
    motion = motion_of(chain("z", effects=[damper]))
    assert motion.damping[0, 0] == pytest.approx(C + 25.0 * 0.4**2, rel=EXACT)
    assert motion.stiffness[0, 0] == pytest.approx(K, rel=1e-7)


def test_damping_grows_with_the_weight_a_joint_carries():
    losses = {"kind": "load_damping", "joint": "joint_1", "load_n_m": 10.0}
    plant = chain("y", gravity=9.8, effects=[losses])
    for q_deg in (0.0, 60.0):
        load = 9.8 * MASS * LENGTH * np.cos(np.deg2rad(q_deg))
        damping = motion_of(plant, [q_deg]).damping[0, 0]
        assert damping == pytest.approx(C * (1.0 + load / 10.0), rel=1e-9)


def test_hysteretic_losses_hardly_depend_on_frequency():
    lossy = {"kind": "hysteretic", "joints": ("joint_1",), "loss_factor": 0.1}
    motion = motion_of(chain("z", c=0.0, effects=[lossy | {"replaces_viscous": True}]))
    n = len(motion.mass)
    drive = np.zeros(len(motion.state_matrix))
    drive[n] = 1.0 / motion.mass[0, 0]
    for f_hz in (8.0, np.sqrt(5.0 * 200.0), 120.0):
        s = 2j * np.pi * f_hz
        answer = np.linalg.solve(s * np.eye(len(drive)) - motion.state_matrix, drive)[0]
        stiffness = 1.0 / answer - s**2 * motion.mass[0, 0]
        # Five elements hold the loss to some per cent inside the band.
        assert stiffness.imag == pytest.approx(0.1 * K, rel=0.1)
        if 30.0 < f_hz < 33.0:
            assert stiffness.real == pytest.approx(K, rel=1e-6)
