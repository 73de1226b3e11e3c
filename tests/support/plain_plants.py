"""Plants so plain that their motion is known in closed form."""

import numpy as np
from scipy.linalg import eigh

from armodal.hil_sim.newton_euler import point_jacobian
from armodal.hil_sim.plant import build_plant, load_plant
from armodal.hil_sim.plant_file import PlantFile
from armodal.hil_sim.small_motion import Mounting, linearise

LENGTH = 0.5  # of every link, m
MASS = 4.0  # at the link's end, kg
OWN = 0.01  # inertia of the link's end, kg m^2
K, C = 3000.0, 0.05  # a little damping, so that it comes to rest


def chain_tables(axes="zz", *, k=K, c=C, gravity=0.0, effects=(), own=OWN):
    """Links along x, each a body at its end, hinged about the base's axes named."""
    tables = load_plant("rv4frl").truth.model_dump()
    links, points = [], []
    springs = k if isinstance(k, tuple) else (k,) * len(axes)
    for i, axis in enumerate(axes):
        links.append(
            {
                "name": f"link_{i + 1}",
                "joint": f"joint_{i + 1}",
                "origin_m": (LENGTH if i else 0.0, 0.0, 0.0),
                "axis": tuple(np.eye(3)["xyz".index(axis)].tolist()),
                "range_deg": (-180.0, 180.0),
                "mass_kg": MASS,
                "center_m": (LENGTH, 0.0, 0.0),
                "inertia_kg_m2": (own, 0.0, 0.0, own, 0.0, own),
                "stiffness_n_m_per_rad": springs[i],
                "damping_n_m_s_per_rad": None if springs[i] is None else c,
            }
        )
        points += [
            {
                "id": f"{name}{i + 1}",
                "link": f"link_{i + 1}",
                "position_m": (place * LENGTH, 0.0, 0.0),
                "normal": (0.0, 0.0, 1.0),
                "x_axis": (1.0, 0.0, 0.0),
            }
            for name, place in (("p", 1.0), ("m", 0.5))
        ]
    sensor = tables["accelerometer"] | {"mass_kg": 0.0}
    return tables | {
        "gravity_m_s2": (0.0, 0.0, -gravity),
        "links": tuple(links),
        "hidden_axis": None,
        "points": tuple(points),
        "effects": tuple(effects),
        "accelerometer": sensor,
    }


def chain(axes="zz", **how):
    return build_plant(PlantFile.model_validate(chain_tables(axes, **how)))


def straight(plant, point):
    """A sensor mounted without tilt."""
    return Mounting(point_id=point, R_link_sensor=plant.point(point).R_link_sensor)


def motion_of(plant, q_deg=None, point=None):
    q = np.zeros(len(plant.joints)) if q_deg is None else np.deg2rad(q_deg)
    return linearise(plant, q, None if point is None else straight(plant, point))


def hertz(M, K):
    """Natural frequencies of M q'' + K q = 0, ascending."""
    return np.sqrt(eigh(K, M, eigvals_only=True)) / (2.0 * np.pi)


def frequencies(motion):
    return hertz(motion.mass, motion.stiffness)


def flexibility(plant, motion, link, place):
    """(6, 6) static motion of a place on a link per force and moment there, base axes."""
    body = plant.bodies[plant.carrier[link]]
    point = motion.at.origin_m[body] + motion.at.R[body] @ np.array(place)
    J = np.zeros((6, len(motion.mass)))
    J[:, : len(plant.springs)] = point_jacobian(motion.at, body, point)[:, list(plant.springs)]
    return J @ np.linalg.solve(motion.stiffness, J.T)
