"""LBR iiwa 14 with a block on its flange."""

from math import pi

from armodal.hil_sim.makers.arm_table import ArmTable, Inertial, LinkRow, Shell, box

LIFT = (pi / 2.0, 0.0, pi)
LEAN = (pi / 2.0, 0.0, 0.0)
TURN = (-pi / 2.0, pi, 0.0)

TABLE = ArmTable(
    name="iiwa14",
    source=(
        "Chain, masses, centres and inertias: robot description of the iiwa 14 published in "
        "iiwa_stack and MuJoCo Menagerie. Stiffness: of strain wave gears of the drives' size."
    ),
    base=box(5.0, (-0.05, 0.0, 0.07), (0.24, 0.2, 0.14)),
    base_shell=Shell(path=((0.0, 0.0, 0.0), (0.0, 0.0, 0.1575)), diameter_m=0.2, wall_m=0.012),
    links=(
        LinkRow(
            joint="axis_1",
            link="link_1",
            xyz_m=(0.0, 0.0, 0.1575),
            rpy_rad=(0.0, 0.0, 0.0),
            range_deg=(-170.0, 170.0),
            stiffness_n_m_per_rad=27000.0,
            inertial=Inertial(
                mass_kg=5.76,
                center_m=(0.0, -0.03, 0.12),
                inertia_kg_m2=(0.0333, 0.033, 0.0123, 0.0, 0.0, 0.0),
            ),
            shell=Shell(path=((0.0, 0.0, 0.0), (0.0, 0.0, 0.2025)), diameter_m=0.15, wall_m=0.010),
        ),
        LinkRow(
            joint="axis_2",
            link="link_2",
            xyz_m=(0.0, 0.0, 0.2025),
            rpy_rad=LIFT,
            range_deg=(-120.0, 120.0),
            stiffness_n_m_per_rad=27000.0,
            inertial=Inertial(
                mass_kg=6.35,
                center_m=(0.0003, 0.059, 0.042),
                inertia_kg_m2=(0.0305, 0.0304, 0.011, 0.0, 0.0, 0.0),
            ),
            shell=Shell(path=((0.0, 0.0, 0.0), (0.0, 0.2045, 0.0)), diameter_m=0.14, wall_m=0.010),
        ),
        LinkRow(
            joint="axis_3",
            link="link_3",
            xyz_m=(0.0, 0.2045, 0.0),
            rpy_rad=LIFT,
            range_deg=(-170.0, 170.0),
            stiffness_n_m_per_rad=15500.0,
            inertial=Inertial(
                mass_kg=3.5,
                center_m=(0.0, 0.03, 0.13),
                inertia_kg_m2=(0.025, 0.0238, 0.0076, 0.0, 0.0, 0.0),
            ),
            shell=Shell(path=((0.0, 0.0, 0.0), (0.0, 0.0, 0.2155)), diameter_m=0.13, wall_m=0.009),
        ),
        LinkRow(
            joint="axis_4",
            link="link_4",
            xyz_m=(0.0, 0.0, 0.2155),
            rpy_rad=LEAN,
            range_deg=(-120.0, 120.0),
            stiffness_n_m_per_rad=15500.0,
            inertial=Inertial(
                mass_kg=3.5,
                center_m=(0.0, 0.067, 0.034),
                inertia_kg_m2=(0.017, 0.0164, 0.006, 0.0, 0.0, 0.0),
            ),
            shell=Shell(path=((0.0, 0.0, 0.0), (0.0, 0.1845, 0.0)), diameter_m=0.13, wall_m=0.009),
        ),
        LinkRow(
            joint="axis_5",
            link="link_5",
            xyz_m=(0.0, 0.1845, 0.0),
            rpy_rad=TURN,
            range_deg=(-170.0, 170.0),
            stiffness_n_m_per_rad=8800.0,
            inertial=Inertial(
                mass_kg=3.5,
                center_m=(0.0001, 0.021, 0.076),
                inertia_kg_m2=(0.01, 0.0087, 0.00449, 0.0, 0.0, 0.0),
            ),
            shell=Shell(path=((0.0, 0.0, 0.0), (0.0, 0.0, 0.2155)), diameter_m=0.12, wall_m=0.008),
        ),
        LinkRow(
            joint="axis_6",
            link="link_6",
            xyz_m=(0.0, 0.0, 0.2155),
            rpy_rad=LEAN,
            range_deg=(-120.0, 120.0),
            stiffness_n_m_per_rad=6200.0,
            inertial=Inertial(
                mass_kg=1.8,
                center_m=(0.0, 0.0006, 0.0004),
                inertia_kg_m2=(0.0049, 0.0047, 0.0036, 0.0, 0.0, 0.0),
            ),
            shell=Shell(path=((0.0, 0.0, 0.0), (0.0, 0.081, 0.0)), diameter_m=0.12, wall_m=0.008),
        ),
        LinkRow(
            joint="axis_7",
            link="flange",
            xyz_m=(0.0, 0.081, 0.0),
            rpy_rad=TURN,
            range_deg=(-175.0, 175.0),
            stiffness_n_m_per_rad=6200.0,
            inertial=Inertial(
                mass_kg=1.2,
                center_m=(0.0, 0.0, 0.02),
                inertia_kg_m2=(0.001, 0.001, 0.001, 0.0, 0.0, 0.0),
            ),
            shell=Shell(path=((0.0, 0.0, 0.0), (0.0, 0.0, 0.09)), diameter_m=0.1, wall_m=0.012),
        ),
    ),
    tool=box(2.0, (0.0, 0.02, 0.07), (0.1, 0.17, 0.05)),
    wrist=("axis_6", "axis_7"),
    postures_deg=(
        (20.0, 35.0, 15.0, -70.0, 30.0, 60.0, 0.0),
        (-45.0, 60.0, -30.0, -40.0, -50.0, 80.0, 45.0),
        (75.0, -25.0, 50.0, -100.0, 20.0, -55.0, -70.0),
        (0.0, 75.0, -20.0, 45.0, 65.0, 40.0, 100.0),
        (-100.0, 20.0, 70.0, 85.0, -35.0, -85.0, 25.0),
    ),
    youngs_modulus_pa=7.1e10,
    density_kg_m3=2700.0,
    peaks_n=(14.0, 36.0, 90.0),
)
