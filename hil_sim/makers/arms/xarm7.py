"""xArm7 with a block on its flange."""

from math import pi

from armodal.hil_sim.makers.arm_table import ArmTable, Inertial, LinkRow, Shell, box

UP = (pi / 2.0, 0.0, 0.0)
DOWN = (-pi / 2.0, 0.0, 0.0)

TABLE = ArmTable(
    name="xarm7",
    source=(
        "Chain, masses and centres: robot description of the xArm 7 that UFACTORY publishes "
        "(xarm_ros). Inertias: its principal moments, along the nearest axes. Stiffness: of strain "
        "wave gears of the drives' size."
    ),
    base=box(1.9, (-0.02, 0.0, 0.06), (0.13, 0.12, 0.12)),
    base_shell=Shell(path=((0.0, 0.0, 0.0), (0.0, 0.0, 0.267)), diameter_m=0.11, wall_m=0.008),
    links=(
        LinkRow(
            joint="joint1",
            link="link1",
            xyz_m=(0.0, 0.0, 0.267),
            rpy_rad=(0.0, 0.0, 0.0),
            range_deg=(-360.0, 360.0),
            stiffness_n_m_per_rad=12500.0,
            inertial=Inertial(
                mass_kg=2.382,
                center_m=(-0.0002, 0.029, -0.0123),
                inertia_kg_m2=(0.0057, 0.0030, 0.0053, 0.0, 0.0, 0.0),
            ),
            shell=Shell(
                path=((0.0, 0.0, -0.06), (0.0, 0.0, 0.0), (0.0, 0.05, 0.0)),
                diameter_m=0.1,
                wall_m=0.008,
            ),
        ),
        LinkRow(
            joint="joint2",
            link="link2",
            xyz_m=(0.0, 0.0, 0.0),
            rpy_rad=DOWN,
            range_deg=(-117.0, 119.0),
            stiffness_n_m_per_rad=13000.0,
            inertial=Inertial(
                mass_kg=1.869,
                center_m=(0.0002, -0.1286, 0.0174),
                inertia_kg_m2=(0.0096, 0.0021, 0.0094, 0.0, 0.0, 0.0),
            ),
            shell=Shell(path=((0.0, 0.0, 0.0), (0.0, -0.293, 0.0)), diameter_m=0.09, wall_m=0.007),
        ),
        LinkRow(
            joint="joint3",
            link="link3",
            xyz_m=(0.0, -0.293, 0.0),
            rpy_rad=UP,
            range_deg=(-360.0, 360.0),
            stiffness_n_m_per_rad=7400.0,
            inertial=Inertial(
                mass_kg=1.638,
                center_m=(0.0466, -0.0246, -0.0077),
                inertia_kg_m2=(0.0029, 0.0035, 0.0021, 0.0, 0.0, 0.0),
            ),
            shell=Shell(
                path=((0.0, 0.0, -0.06), (0.0, 0.0, 0.0), (0.0525, 0.0, 0.0)),
                diameter_m=0.09,
                wall_m=0.007,
            ),
        ),
        LinkRow(
            joint="joint4",
            link="link4",
            xyz_m=(0.0525, 0.0, 0.0),
            rpy_rad=UP,
            range_deg=(-11.0, 225.0),
            stiffness_n_m_per_rad=7400.0,
            inertial=Inertial(
                mass_kg=1.727,
                center_m=(0.0705, -0.1158, 0.012),
                inertia_kg_m2=(0.0063, 0.0024, 0.0066, 0.0, 0.0, 0.0),
            ),
            shell=Shell(
                path=((0.0, 0.0, 0.0), (0.0775, -0.1, 0.0), (0.0775, -0.3425, 0.0)),
                diameter_m=0.08,
                wall_m=0.006,
            ),
        ),
        LinkRow(
            joint="joint5",
            link="link5",
            xyz_m=(0.0775, -0.3425, 0.0),
            rpy_rad=UP,
            range_deg=(-360.0, 360.0),
            stiffness_n_m_per_rad=4100.0,
            inertial=Inertial(
                mass_kg=1.320,
                center_m=(-0.0003, 0.016, -0.026),
                inertia_kg_m2=(0.0053, 0.0049, 0.0015, 0.0, 0.0, 0.0),
            ),
            shell=Shell(
                path=((0.0, 0.0, -0.12), (0.0, 0.0, -0.02), (0.0, 0.0, 0.02)),
                diameter_m=0.08,
                wall_m=0.007,
            ),
        ),
        LinkRow(
            joint="joint6",
            link="link6",
            xyz_m=(0.0, 0.0, 0.0),
            rpy_rad=UP,
            range_deg=(-97.0, 180.0),
            stiffness_n_m_per_rad=2900.0,
            inertial=Inertial(
                mass_kg=1.325,
                center_m=(0.0647, 0.0328, 0.0214),
                inertia_kg_m2=(0.0013, 0.0022, 0.0024, 0.0, 0.0, 0.0),
            ),
            shell=Shell(
                path=((0.0, 0.0, 0.0), (0.076, 0.0, 0.0), (0.076, 0.097, 0.0)),
                diameter_m=0.075,
                wall_m=0.007,
            ),
        ),
        LinkRow(
            joint="joint7",
            link="link7",
            xyz_m=(0.076, 0.097, 0.0),
            rpy_rad=DOWN,
            range_deg=(-360.0, 360.0),
            stiffness_n_m_per_rad=2600.0,
            inertial=Inertial(
                mass_kg=0.17,
                center_m=(0.0, -0.0068, -0.011),
                inertia_kg_m2=(0.00009, 0.00012, 0.00013, 0.0, 0.0, 0.0),
            ),
            shell=Shell(path=((0.0, 0.0, -0.02), (0.0, 0.0, 0.05)), diameter_m=0.076, wall_m=0.01),
        ),
    ),
    tool=box(1.1, (0.01, 0.0, 0.025), (0.14, 0.07, 0.05)),
    wrist=("joint6", "joint7"),
    postures_deg=(
        (15.0, -20.0, 10.0, 60.0, 20.0, 50.0, 0.0),
        (-70.0, -50.0, 40.0, 95.0, -60.0, 75.0, 35.0),
        (50.0, 25.0, -30.0, 80.0, 110.0, -40.0, -80.0),
        (-20.0, -5.0, 75.0, 120.0, 45.0, 20.0, 60.0),
        (110.0, -70.0, -15.0, 45.0, -30.0, 100.0, 120.0),
    ),
    youngs_modulus_pa=6.9e10,
    density_kg_m3=2680.0,
    peaks_n=(7.0, 18.0, 45.0),
)
