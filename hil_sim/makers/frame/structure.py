"""A structure of nodes in absolute coordinates: beams, lumps, six-way springs, weight."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from armodal.hil_sim.makers.arm_table import Array, Inertial
from armodal.hil_sim.makers.frame.beams import Section, beam_mass, beam_stiffness

__all__ = ["Complex", "Law", "Spot", "Structure", "cross"]

Complex = npt.NDArray[np.complex128]
Rows = npt.NDArray[np.intp]
Law = Callable[[Complex], Complex]
"""Dynamic stiffness beyond the static one, over lines s."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Spot:
    """A place that moves with a node; node -1 is the ground."""

    node: int
    arm_m: Array  # (3,) from the node, world axes


@dataclass(slots=True)
class Structure:
    """Nodes and what is between them; matrices are dense and of some hundred rows."""

    nodes: list[Array] = field(default_factory=list)  # (3,) each, world
    elastic: list[tuple[Rows, Array, float]] = field(default_factory=list)  # rows, K, loss factor
    masses: list[tuple[Rows, Array]] = field(default_factory=list)
    laws: list[tuple[Array, Law]] = field(default_factory=list)  # (n,) vector, law
    weights: list[tuple[int, Array, float]] = field(default_factory=list)  # node, place, mass
    pulls: list[tuple[Spot, Array]] = field(default_factory=list)  # steady force (3,), world
    carried: list[tuple[int, int, bool]] = field(default_factory=list)  # node, before it, jointed
    turning: list[tuple[Array, float]] = field(default_factory=list)  # vector, inertia

    def node(self, place: Array, before: int = -1, *, jointed: bool = False) -> int:
        """Add a node that the node `before` carries (-1: the ground), through a beam or a joint."""
        self.nodes.append(np.array(place, dtype=np.float64))
        number = len(self.nodes) - 1
        self.carried.append((number, before, jointed))
        return number

    def beam(self, section: Section, first: int, second: int, loss: float) -> None:
        """Put a beam between two nodes, with its mass and weight."""
        ends = self.nodes[first], self.nodes[second]
        rows = np.concatenate([_rows(first), _rows(second)])
        self.elastic.append((rows, beam_stiffness(section, *ends), loss))
        self.masses.append((rows, beam_mass(section, *ends)))
        length = float(np.linalg.norm(ends[1] - ends[0]))
        mass = section.density_kg_m3 * section.area_m2 * length
        self.weights += [(node, self.nodes[node], 0.5 * mass) for node in (first, second)]

    def lump(self, node: int, body: Inertial, R: Array, at: Array) -> None:
        """Fix a rigid body to a node; its frame stands at `at`, turned by R."""
        center = R @ np.array(body.center_m) + at
        G = _of_node(center - self.nodes[node])
        inertia = R @ body.matrix() @ R.T
        mass = np.zeros((6, 6))
        mass[:3, :3], mass[3:, 3:] = body.mass_kg * np.eye(3), inertia
        self.masses.append((_rows(node), G.T @ mass @ G))
        self.weights.append((node, center, body.mass_kg))

    def spring(self, first: Spot, second: Spot, stiffness: Array, loss: float = 0.0) -> None:
        """Put a six-way spring, (6, 6) world axes, between two spots at one place."""
        rows, B = self.between(first, second)
        self.elastic.append((rows, B.T @ stiffness @ B, loss))

    def between(self, first: Spot, second: Spot) -> tuple[Rows, Array]:
        """Rows, and the (6, n) matrix of the second spot's motion less the first's."""
        pairs = [(s, sign) for s, sign in ((first, -1.0), (second, 1.0)) if s.node >= 0]
        rows = np.concatenate([_rows(spot.node) for spot, _ in pairs])
        return rows, np.hstack([sign * _of_node(spot.arm_m) for spot, sign in pairs])

    def spot_at(self, node: int, place: Array) -> Spot:
        """Return the spot at a place, that moves with a node."""
        arm = place - self.nodes[node] if node >= 0 else np.zeros(3)
        return Spot(node=node, arm_m=arm)

    def motion(self, spot: Spot) -> Array:
        """The (6, n) matrix of a spot's displacement and rotation."""
        T = np.zeros((6, self.size))
        T[:, _rows(spot.node)] = _of_node(spot.arm_m)
        return T

    @property
    def size(self) -> int:
        """Number of coordinates."""
        return 6 * len(self.nodes)

    def mass(self) -> Array:
        """Mass matrix, (n, n)."""
        M = np.zeros((self.size, self.size))
        for rows, part in self.masses:
            M[np.ix_(rows, rows)] += part
        for vector, inertia in self.turning:
            M += inertia * np.outer(vector, vector)
        return M

    def stiffness(self) -> tuple[Array, Array]:
        """Static stiffness and its loss part (the sum of loss factors times stiffness)."""
        K, lost = np.zeros((self.size, self.size)), np.zeros((self.size, self.size))
        for rows, part, loss in self.elastic:
            K[np.ix_(rows, rows)] += part
            if loss:
                lost[np.ix_(rows, rows)] += loss * part
        return K, lost

    def under_load(self, gravity_m_s2: Array) -> Array:
        """Stiffness that weight and pulls add, (n, n), as the structure is a tree of stiff pieces.

        A piece L that carries a force f turns by the rotation vector of its ends' mean: its end
        moves by theta x (theta x L) / 2 besides. Where two nodes at one place pass on a moment m,
        the rotation between them is theta_2 - theta_1 - theta_1 x theta_2 / 2 seen from the first.
        Both are second-order terms of the exponential map (Selig, Geometric Fundamentals of
        Robotics, section 4.4).
        """
        K = np.zeros((self.size, self.size))
        force = [np.zeros(3) for _ in self.nodes]  # beyond a node, itself in it
        moment = [np.zeros(3) for _ in self.nodes]  # about the node
        loads = [(n, at - self.nodes[n], mass * gravity_m_s2) for n, at, mass in self.weights]
        loads += [(spot.node, spot.arm_m, pull) for spot, pull in self.pulls if spot.node >= 0]
        for node, arm, load in loads:
            force[node] += load
            moment[node] += np.cross(arm, load)
            rows = _rows(node)[3:]
            K[np.ix_(rows, rows)] += _pulled(arm, load)
        for node, before, jointed in reversed(self.carried):
            if before < 0:
                continue
            L = self.nodes[node] - self.nodes[before]
            force[before] += force[node]
            moment[before] += moment[node] + np.cross(L, force[node])
            first, second = _rows(before)[3:], _rows(node)[3:]
            both = np.concatenate([first, second])
            # A joint is where its outer node is: the arm to it turns with the inner node.
            mean = np.outer([1.0, 0.0], [1.0, 0.0]) if jointed else np.full((2, 2), 0.25)
            K[np.ix_(both, both)] += np.kron(mean, _pulled(L, force[node]))
            # Springs pass on minus the moment of what hangs beyond; the potential is -m . rotation.
            twist = 0.5 * cross(moment[node])
            K[np.ix_(first, second)] += twist
            K[np.ix_(second, first)] += twist.T
        return K


def cross(v: Array) -> Array:
    """Matrix of v x, (3, 3)."""
    return np.array([[0.0, -v[2], v[1]], [v[2], 0.0, -v[0]], [-v[1], v[0], 0.0]])


def _pulled(L: Array, f: Array) -> Array:
    """Hessian, (3, 3), of -f . (theta x (theta x L)) / 2."""
    return (f @ L) * np.eye(3) - 0.5 * (np.outer(f, L) + np.outer(L, f))


def _rows(node: int) -> Rows:
    return np.arange(6 * node, 6 * node + 6, dtype=np.intp)


def _of_node(arm_m: Array) -> Array:
    """Displacement and rotation at the end of a rigid arm, from those of its node, (6, 6)."""
    G = np.eye(6)
    G[:3, 3:] = -cross(arm_m)
    return G
