"""Fanuc LR Mate 200iD with a block on its flange."""

from math import pi

from armodal.hil_sim.makers.arm_table import ArmTable, LinkRow, Shell, box

UP = (pi / 2.0, 0.0, 0.0)
DOWN = (-pi / 2.0, 0.0, 0.0)

TABLE = ArmTable(
    name="lrmate200id",
    source=(
        "Dimensions and mass of the whole: Fanuc, data sheet of the LR Mate 200iD. Masses of the "
        "links: estimates that add up to it; inertias: boxes of the links' size. Stiffness: of "
        "strain wave gears of the drives' size."
    ),
    base=box(8.0, (-0.04, 0.0, 0.1), (0.25, 0.19, 0.2)),
    base_shell=Shell(path=((0.0, 0.0, 0.0), (0.0, 0.0, 0.33)), diameter_m=0.19, wall_m=0.009),
    links=(
        LinkRow(
            joint="J1",
            link="turret",
            xyz_m=(0.0, 0.0, 0.33),
            rpy_rad=(0.0, 0.0, 0.0),
            range_deg=(-170.0, 170.0),
            stiffness_n_m_per_rad=21000.0,
            inertial=box(5.2, (0.03, 0.01, -0.03), (0.2, 0.19, 0.2)),
            shell=Shell(
                path=((0.0, 0.0, -0.08), (0.0, 0.0, 0.0), (0.05, 0.0, 0.0)),
                diameter_m=0.17,
                wall_m=0.009,
            ),
        ),
        LinkRow(
            joint="J2",
            link="upper_arm",
            xyz_m=(0.05, 0.0, 0.0),
            rpy_rad=DOWN,
            range_deg=(-190.0, 55.0),
            stiffness_n_m_per_rad=23000.0,
            inertial=box(4.3, (0.15, 0.0, 0.01), (0.42, 0.1, 0.13)),
            shell=Shell(path=((0.0, 0.0, 0.0), (0.33, 0.0, 0.0)), diameter_m=0.11, wall_m=0.006),
        ),
        LinkRow(
            joint="J3",
            link="elbow",
            xyz_m=(0.33, 0.0, 0.0),
            rpy_rad=(0.0, 0.0, 0.0),
            range_deg=(-160.0, 160.0),
            stiffness_n_m_per_rad=12500.0,
            inertial=box(3.7, (0.02, 0.02, 0.0), (0.16, 0.14, 0.13)),
            shell=Shell(
                path=((0.0, 0.0, 0.0), (0.035, 0.0, 0.0), (0.035, 0.09, 0.0)),
                diameter_m=0.12,
                wall_m=0.007,
            ),
        ),
        LinkRow(
            joint="J4",
            link="forearm",
            xyz_m=(0.035, 0.335, 0.0),
            rpy_rad=DOWN,
            range_deg=(-190.0, 190.0),
            stiffness_n_m_per_rad=4700.0,
            inertial=box(2.3, (0.0, 0.0, -0.14), (0.1, 0.1, 0.26)),
            shell=Shell(path=((0.0, 0.0, -0.245), (0.0, 0.0, 0.0)), diameter_m=0.09, wall_m=0.005),
        ),
        LinkRow(
            joint="J5",
            link="wrist",
            xyz_m=(0.0, 0.0, 0.0),
            rpy_rad=UP,
            range_deg=(-125.0, 125.0),
            stiffness_n_m_per_rad=3600.0,
            inertial=box(0.9, (0.0, 0.015, 0.0), (0.08, 0.09, 0.08)),
            shell=Shell(path=((0.0, 0.0, 0.0), (0.0, 0.08, 0.0)), diameter_m=0.07, wall_m=0.006),
        ),
        LinkRow(
            joint="J6",
            link="flange",
            xyz_m=(0.0, 0.08, 0.0),
            rpy_rad=DOWN,
            range_deg=(-360.0, 360.0),
            stiffness_n_m_per_rad=2300.0,
            inertial=box(0.25, (0.0, 0.0, 0.0), (0.06, 0.06, 0.03)),
            shell=Shell(path=((0.0, 0.0, 0.0), (0.0, 0.0, 0.055)), diameter_m=0.075, wall_m=0.01),
        ),
    ),
    tool=box(1.6, (0.0, 0.012, 0.03), (0.08, 0.15, 0.05)),
    wrist=("J5", "J6"),
    postures_deg=(
        (20.0, -60.0, -35.0, 25.0, 50.0, 0.0),
        (-55.0, -100.0, 20.0, -70.0, 80.0, 45.0),
        (75.0, -35.0, -75.0, 110.0, -65.0, -60.0),
        (-10.0, -85.0, -60.0, -30.0, -45.0, 100.0),
        (45.0, -120.0, 45.0, 60.0, 95.0, -20.0),
    ),
    youngs_modulus_pa=7.0e10,
    density_kg_m3=2700.0,
    peaks_n=(12.0, 30.0, 75.0),
)
