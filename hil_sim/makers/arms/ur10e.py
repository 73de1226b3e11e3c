"""UR10e with a block on its flange."""

from math import pi

from armodal.hil_sim.makers.arm_table import ArmTable, Inertial, LinkRow, Shell, box

TABLE = ArmTable(
    name="ur10e",
    source=(
        "Dimensions, masses and centres: Universal Robots, DH parameters for calculations of "
        "kinematics and dynamics. Inertias: of tubes of the links' size. Stiffness: of strain wave "
        "gears of the drives' size."
    ),
    base=box(4.0, (0.0, 0.0, 0.05), (0.19, 0.19, 0.1)),
    base_shell=Shell(path=((0.0, 0.0, 0.0), (0.0, 0.0, 0.1807)), diameter_m=0.17, wall_m=0.010),
    links=(
        LinkRow(
            joint="shoulder_pan",
            link="shoulder",
            xyz_m=(0.0, 0.0, 0.1807),
            rpy_rad=(0.0, 0.0, 0.0),
            range_deg=(-360.0, 360.0),
            stiffness_n_m_per_rad=34000.0,
            inertial=Inertial(
                mass_kg=7.369,
                center_m=(0.021, -0.027, 0.0),
                inertia_kg_m2=(0.034, 0.022, 0.035, 0.004, 0.0, 0.0),
            ),
            shell=Shell(
                path=((0.0, 0.0, -0.06), (0.0, 0.0, 0.0), (0.0, -0.1, 0.0)),
                diameter_m=0.15,
                wall_m=0.012,
            ),
        ),
        LinkRow(
            joint="shoulder_lift",
            link="upper_arm",
            xyz_m=(0.0, 0.0, 0.0),
            rpy_rad=(pi / 2.0, 0.0, 0.0),
            range_deg=(-360.0, 360.0),
            stiffness_n_m_per_rad=36000.0,
            inertial=Inertial(
                mass_kg=13.051,
                center_m=(-0.2327, 0.0, 0.158),
                inertia_kg_m2=(0.034, 0.77, 0.77, 0.0, -0.015, 0.0),
            ),
            shell=Shell(
                path=(
                    (0.0, 0.0, 0.1),
                    (0.0, 0.0, 0.17),
                    (-0.6127, 0.0, 0.17),
                    (-0.6127, 0.0, 0.11),
                ),
                diameter_m=0.13,
                wall_m=0.009,
            ),
        ),
        LinkRow(
            joint="elbow",
            link="forearm",
            xyz_m=(-0.6127, 0.0, 0.0),
            rpy_rad=(0.0, 0.0, 0.0),
            range_deg=(-360.0, 360.0),
            stiffness_n_m_per_rad=18500.0,
            inertial=Inertial(
                mass_kg=3.989,
                center_m=(-0.33155, 0.0, 0.068),
                inertia_kg_m2=(0.0101, 0.309, 0.307, 0.0, 0.009, 0.0),
            ),
            shell=Shell(
                path=(
                    (0.0, 0.0, 0.11),
                    (0.0, 0.0, 0.05),
                    (-0.57155, 0.0, 0.05),
                    (-0.57155, 0.0, 0.114),
                ),
                diameter_m=0.1,
                wall_m=0.006,
            ),
        ),
        LinkRow(
            joint="wrist_1",
            link="wrist_1_link",
            xyz_m=(-0.57155, 0.0, 0.17415),
            rpy_rad=(0.0, 0.0, 0.0),
            range_deg=(-360.0, 360.0),
            stiffness_n_m_per_rad=6900.0,
            inertial=Inertial(
                mass_kg=2.1,
                center_m=(0.0, -0.018, 0.007),
                inertia_kg_m2=(0.0030, 0.0026, 0.0022, 0.0, 0.0, 0.0),
            ),
            shell=Shell(
                path=((0.0, 0.0, -0.06), (0.0, 0.0, 0.0), (0.0, -0.06, 0.0)),
                diameter_m=0.09,
                wall_m=0.008,
            ),
        ),
        LinkRow(
            joint="wrist_2",
            link="wrist_2_link",
            xyz_m=(0.0, -0.11985, 0.0),
            rpy_rad=(pi / 2.0, 0.0, 0.0),
            range_deg=(-360.0, 360.0),
            stiffness_n_m_per_rad=6300.0,
            inertial=Inertial(
                mass_kg=1.98,
                center_m=(0.0, 0.018, -0.007),
                inertia_kg_m2=(0.0030, 0.0026, 0.0022, 0.0, 0.0, 0.0),
            ),
            shell=Shell(
                path=((0.0, 0.0, -0.06), (0.0, 0.0, 0.0), (0.0, 0.06, 0.0)),
                diameter_m=0.09,
                wall_m=0.008,
            ),
        ),
        LinkRow(
            joint="wrist_3",
            link="flange",
            xyz_m=(0.0, 0.11655, 0.0),
            rpy_rad=(-pi / 2.0, 0.0, 0.0),
            range_deg=(-360.0, 360.0),
            stiffness_n_m_per_rad=5600.0,
            inertial=Inertial(
                mass_kg=0.615,
                center_m=(0.0, 0.0, -0.026),
                inertia_kg_m2=(0.0004, 0.0004, 0.0003, 0.0, 0.0, 0.0),
            ),
            shell=Shell(
                path=((0.0, 0.0, -0.05), (0.0, 0.0, 0.0), (0.0, 0.0, 0.05)),
                diameter_m=0.1,
                wall_m=0.012,
            ),
        ),
    ),
    tool=box(2.4, (0.015, 0.0, 0.025), (0.18, 0.1, 0.05)),
    wrist=("wrist_2", "wrist_3"),
    postures_deg=(
        (25.0, -50.0, 55.0, -95.0, -80.0, 10.0),
        (-60.0, -95.0, 85.0, 30.0, 70.0, -40.0),
        (80.0, -125.0, 110.0, -60.0, -100.0, 65.0),
        (-15.0, -35.0, 90.0, -140.0, -65.0, -30.0),
        (40.0, -75.0, -50.0, 20.0, 105.0, 85.0),
    ),
    youngs_modulus_pa=7.0e10,
    density_kg_m3=2700.0,
    peaks_n=(15.0, 40.0, 100.0),
)
