"""An arm of the class of the KR 210 R2700, with a block on its flange."""

from math import pi

from armodal.hil_sim.makers.arm_table import ArmTable, LinkRow, Shell, box

UP = (pi / 2.0, 0.0, 0.0)
DOWN = (-pi / 2.0, 0.0, 0.0)

TABLE = ArmTable(
    name="kr210",
    source=(
        "Dimensions and mass of the whole: KUKA, data sheet of the KR 210 R2700. Masses of the "
        "links: estimates that add up to it with the base; inertias: boxes of the links' size. "
        "Stiffness: of cycloidal gears of the drives' size."
    ),
    base=box(260.0, (-0.1, 0.0, 0.17), (0.9, 0.7, 0.35)),
    base_shell=Shell(path=((0.0, 0.0, 0.0), (0.0, 0.0, 0.45)), diameter_m=0.7, wall_m=0.028),
    links=(
        LinkRow(
            joint="A1",
            link="carousel",
            xyz_m=(0.0, 0.0, 0.45),
            rpy_rad=(0.0, 0.0, 0.0),
            range_deg=(-185.0, 185.0),
            stiffness_n_m_per_rad=2.9e6,
            inertial=box(265.0, (0.12, 0.02, 0.18), (0.75, 0.6, 0.5)),
            shell=Shell(
                path=((0.0, 0.0, 0.0), (0.1, 0.0, 0.2), (0.35, 0.0, 0.225)),
                diameter_m=0.55,
                wall_m=0.022,
            ),
        ),
        LinkRow(
            joint="A2",
            link="link_arm",
            xyz_m=(0.35, 0.0, 0.225),
            rpy_rad=DOWN,
            range_deg=(-140.0, -5.0),
            stiffness_n_m_per_rad=3.3e6,
            inertial=box(185.0, (0.52, 0.0, 0.04), (1.45, 0.32, 0.3)),
            shell=Shell(path=((0.0, 0.0, 0.0), (1.15, 0.0, 0.0)), diameter_m=0.34, wall_m=0.018),
        ),
        LinkRow(
            joint="A3",
            link="arm",
            xyz_m=(1.15, 0.0, 0.0),
            rpy_rad=(0.0, 0.0, 0.0),
            range_deg=(-120.0, 168.0),
            stiffness_n_m_per_rad=1.75e6,
            inertial=box(190.0, (0.03, -0.11, 0.0), (0.42, 0.75, 0.42)),
            shell=Shell(
                path=((0.0, 0.0, 0.0), (0.041, 0.0, 0.0), (0.041, 0.5, 0.0)),
                diameter_m=0.33,
                wall_m=0.016,
            ),
        ),
        LinkRow(
            joint="A4",
            link="arm_front",
            xyz_m=(0.041, 1.2, 0.0),
            rpy_rad=DOWN,
            range_deg=(-350.0, 350.0),
            stiffness_n_m_per_rad=2.6e5,
            inertial=box(62.0, (0.0, 0.0, -0.42), (0.24, 0.24, 0.65)),
            shell=Shell(path=((0.0, 0.0, -0.7), (0.0, 0.0, 0.0)), diameter_m=0.24, wall_m=0.014),
        ),
        LinkRow(
            joint="A5",
            link="hand",
            xyz_m=(0.0, 0.0, 0.0),
            rpy_rad=UP,
            range_deg=(-122.5, 122.5),
            stiffness_n_m_per_rad=2.2e5,
            inertial=box(31.0, (0.0, 0.05, 0.0), (0.2, 0.26, 0.22)),
            shell=Shell(path=((0.0, 0.0, 0.0), (0.0, 0.215, 0.0)), diameter_m=0.2, wall_m=0.014),
        ),
        LinkRow(
            joint="A6",
            link="flange",
            xyz_m=(0.0, 0.215, 0.0),
            rpy_rad=DOWN,
            range_deg=(-350.0, 350.0),
            stiffness_n_m_per_rad=1.3e5,
            inertial=box(9.0, (0.0, 0.0, -0.02), (0.16, 0.16, 0.06)),
            shell=Shell(path=((0.0, 0.0, -0.04), (0.0, 0.0, 0.12)), diameter_m=0.2, wall_m=0.02),
        ),
    ),
    tool=box(45.0, (0.03, 0.0, 0.07), (0.4, 0.25, 0.06)),
    wrist=("A5", "A6"),
    postures_deg=(
        (15.0, -70.0, -20.0, 30.0, 45.0, 0.0),
        (-60.0, -110.0, 50.0, -80.0, 70.0, 40.0),
        (90.0, -40.0, -60.0, 100.0, -60.0, -75.0),
        (-25.0, -95.0, -50.0, -20.0, -80.0, 120.0),
        (50.0, -125.0, 85.0, 65.0, 100.0, -30.0),
    ),
    youngs_modulus_pa=7.0e10,
    density_kg_m3=2700.0,
    peaks_n=(150.0, 400.0, 1000.0),
)
