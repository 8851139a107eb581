"""Static loads on one body, such as a base pair: a force, a torque about the axis, a moment."""

from __future__ import annotations

import numpy as np
import openmm
from numpy.typing import NDArray

from dnawaves.units import PN_PER_KJ_PER_MOL_NM

Array = NDArray[np.float64]
Indices = NDArray[np.intp]

# Global parameter of both loads: 0 is none, 1 the full load, so that a load can be ramped.
LOAD = "load"


def rigid_body_forces(positions_nm: Array, masses_Da: Array, force: Array, torque: Array) -> Array:
    """Return the forces (atoms, 3) that accelerate atoms as one rigid body.

    They add up to `force` (3,), and to `torque` (3,) about the centre of mass, in kJ/mol/nm and
    kJ/mol; they do not strain the body.
    """
    arms = positions_nm - masses_Da @ positions_nm / masses_Da.sum()
    angular = np.linalg.solve(_inertia(arms, masses_Da), torque)
    accelerations = force / masses_Da.sum() + np.cross(angular, arms)
    forces: Array = masses_Da[:, None] * accelerations
    return forces


def force_load(
    positions_nm: Array,
    masses_Da: Array,
    atoms: Indices,
    force_pN: Array,
    point_nm: Array | None = None,
) -> openmm.CustomExternalForce:
    """Return a constant force (3,) on some atoms as one body, at its centre of mass.

    `positions_nm` (all, 3) and `masses_Da` (all,) are those of all atoms; `atoms` says which bear
    the load. With `point_nm` (3,) the force acts at that point, whose moment about the centre of
    mass is that of the given positions. The energy is zero there.
    """
    place, mass = positions_nm[atoms], masses_Da[atoms]
    total = np.asarray(force_pN) / PN_PER_KJ_PER_MOL_NM
    lever = np.zeros(3) if point_nm is None else point_nm - mass @ place / mass.sum()
    forces = rigid_body_forces(place, mass, total, np.cross(lever, total))
    load = _linear(f"-{LOAD}*", place, atoms, forces)
    load.addGlobalParameter(LOAD, 1.0)
    return load


def torque_load(
    positions_nm: Array, masses_Da: Array, atoms: Indices, torque_pN_nm: Array
) -> openmm.CustomCVForce:
    """Return a constant torque (3,) on some atoms as one body, without a net force.

    The energy is -T a, with a the angle by which the body has turned: the least-squares one, with
    the masses as weights, about the axis about which T would start to turn the body. The forces
    follow the body as it turns, so the torque about that axis is constant at every angle; at the
    given positions it is `torque_pN_nm` in all components. A torque about the helix axis twists,
    one across it is a bending moment. The atoms must not be wrapped into a periodic box.
    """
    place, mass = positions_nm[atoms], masses_Da[atoms]
    torque = np.asarray(torque_pN_nm) / PN_PER_KJ_PER_MOL_NM
    arms = place - mass @ place / mass.sum()
    turning = np.linalg.solve(_inertia(arms, mass), torque)
    axis = turning / np.linalg.norm(turning)
    across = arms - np.outer(arms @ axis, axis)
    load = openmm.CustomCVForce(f"-{LOAD}*torque*atan2(sine, cosine)")
    load.addGlobalParameter(LOAD, 1.0)
    load.addGlobalParameter("torque", float(torque @ axis))
    # The weighted arms add up to zero, so places may stand for arms: a shift changes nothing.
    inertia = float(np.sum(mass[:, None] * across**2))
    sine = mass[:, None] * np.cross(axis, across) / inertia
    cosine = mass[:, None] * across / inertia
    load.addCollectiveVariable("sine", _linear("", place, atoms, sine))
    load.addCollectiveVariable("cosine", _linear("", np.zeros_like(place), atoms, cosine))
    return load


def _linear(
    factor: str, origin_nm: Array, atoms: Indices, coefficients: Array
) -> openmm.CustomExternalForce:
    """Return the sum over atoms of a coefficient (3,) times the displacement from the origin."""
    force = openmm.CustomExternalForce(f"{factor}(fx*(x - x0) + fy*(y - y0) + fz*(z - z0))")
    for name in ("fx", "fy", "fz", "x0", "y0", "z0"):
        force.addPerParticleParameter(name)
    for atom, coefficient, origin in zip(atoms, coefficients, origin_nm, strict=True):
        force.addParticle(int(atom), [*coefficient, *origin])
    return force


def _inertia(arms: Array, masses: Array) -> Array:
    second = arms.T @ (masses[:, None] * arms)
    inertia: Array = np.trace(second) * np.eye(3) - second
    return inertia
