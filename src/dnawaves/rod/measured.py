"""Rods from measurements: stiffness of base-pair steps, mass and inertia of base pairs."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import scipy.linalg
from numpy.typing import ArrayLike, NDArray

from dnawaves.errors import InputError
from dnawaves.rod.rod import FloatArray, Rod, cross_matrix
from dnawaves.units import A_PER_NM, KJ_PER_MOL_PER_PN_NM


class MassPerLength(NamedTuple):
    """Mass of a rod as `Rod` takes it; axes and origin are those of the base-pair frame."""

    density_Da_per_nm: float
    centre_nm: FloatArray
    inertia_Da_nm: FloatArray


def mass_per_length(
    positions_nm: ArrayLike,
    masses_Da: ArrayLike,
    pair_of_atom: NDArray[np.integer],
    origins_nm: ArrayLike,
    axes: ArrayLike,
    spacing_nm: float,
    pairs: Sequence[int] | None = None,
) -> MassPerLength:
    """Return the mean mass, centre and inertia of base pairs, per length.

    The mean is that of the kinetic energy, at equal motion of the frames.

    Parameters
    ----------
    positions_nm, masses_Da : (atoms, 3), (atoms,)
    pair_of_atom : (atoms,)
        Base pair of each atom, from 0; -1 for an atom of none.
    origins_nm, axes : (pairs, 3), (pairs, 3, 3)
        Frame of each base pair; `axes` as (pair, axis, component).
    pairs : sequence of int, optional
        Base pairs to average over; all by default.
    """
    positions, masses = np.asarray(positions_nm, float), np.asarray(masses_Da, float)
    origins, directions = np.asarray(origins_nm, float), np.asarray(axes, float)
    chosen = range(len(origins)) if pairs is None else pairs
    total = np.zeros((6, 6))
    for pair in chosen:
        mine = np.asarray(pair_of_atom) == pair
        if not mine.any():
            raise InputError(
                f"base pair {pair} (from 0) has no atoms to take mass and inertia from"
            )
        total += _mass_matrix((positions[mine] - origins[pair]) @ directions[pair].T, masses[mine])
    total /= len(chosen) * spacing_nm
    density, moment, about_origin = total[0, 0], total[3:, :3], total[3:, 3:]
    centre = np.array([moment[2, 1], moment[0, 2], moment[1, 0]]) / density
    inertia = about_origin + density * cross_matrix(centre) @ cross_matrix(centre)
    return MassPerLength(float(density), centre, (inertia + inertia.T) / 2)


def measured_rod(
    step_stiffness: ArrayLike, mean_step: ArrayLike, mass: MassPerLength, spacing_nm: float
) -> Rod:
    """Return the rod whose lattice has the measured stiffness of base-pair steps.

    Parameters
    ----------
    step_stiffness : (6, 6)
        Second derivative of a step's energy (kT times the inverse covariance) in displacement and
        rotation vector, seen in the mid-step frame: kJ/mol/nm^2, kJ/mol/nm, kJ/mol.
    mean_step : (6,)
        The step at rest in the same coordinates: nm, rad.
    """
    step = np.asarray(mean_step, dtype=float)
    jacobian = mid_frame_jacobian(step)
    stiffness = spacing_nm * jacobian.T @ np.asarray(step_stiffness, dtype=float) @ jacobian
    rotation = step[3:]
    gamma = np.linalg.solve(_across(rotation, _half_angle_sinc(rotation)), step[:3])
    return Rod(
        density_Da_per_nm=mass.density_Da_per_nm,
        inertia_Da_nm=mass.inertia_Da_nm,
        stiffness=(stiffness + stiffness.T) / 2,
        spacing_nm=spacing_nm,
        gamma0=gamma / spacing_nm,
        omega0_rad_per_nm=rotation / spacing_nm,
        centre_nm=mass.centre_nm,
    )


def step_stiffness_from_pN_A(step_stiffness_pN_A: ArrayLike) -> FloatArray:
    """Return a step's stiffness in kJ/mol, nm, rad from one in pN/A, pN, pN A."""
    per_nm = np.repeat([A_PER_NM, 1.0], 3)
    matrix = np.asarray(step_stiffness_pN_A, dtype=float)
    return KJ_PER_MOL_PER_PN_NM / A_PER_NM * matrix * np.outer(per_nm, per_nm)


def mid_frame_jacobian(step: ArrayLike) -> FloatArray:
    """Return the derivative (6, 6) of a step's coordinates by the lattice's strain times spacing.

    The coordinates are displacement R_mid^T dx (nm) and rotation vector log(R1^T R2) (rad); the
    lattice's strain is the small screw in the mid-frame by which the step exceeds the step at rest
    (see `dispersion.strain_operator`). The rotation vector's transverse part is larger by
    (t/2)/sin(t/2) at a twist t, 1.7 % at 36 degrees, and its mid-frame tips with the bend.
    """
    step = np.asarray(step, dtype=float)
    rotation = step[3:]
    half_turn = scipy.linalg.expm(cross_matrix(rotation / 2))
    # the half-step of the screw at rest, and the whole step, as seen from the mid-frame
    screw = np.linalg.solve(_across(rotation, _half_angle_sinc(rotation)), step[:3])
    half = _translation(screw / 2, rotation / 2)
    tip = np.linalg.inv(np.eye(3) + half_turn)
    jacobian = np.eye(6)
    jacobian[:3, 3:] = cross_matrix(step[:3]) @ tip - cross_matrix(half)
    jacobian[3:, 3:] = _across(rotation, 1 / _half_angle_sinc(rotation))
    return jacobian


def _translation(linear: FloatArray, rotation: FloatArray) -> FloatArray:
    """Return the translation of the screw exp(linear, rotation)."""
    generator = np.zeros((4, 4))
    generator[:3, :3], generator[:3, 3] = cross_matrix(rotation), linear
    return scipy.linalg.expm(generator)[:3, 3]


def _half_angle_sinc(rotation: FloatArray) -> float:
    """Return sin(t/2)/(t/2) for a rotation by t."""
    return float(np.sinc(np.linalg.norm(rotation) / (2 * np.pi)))


def _across(rotation: FloatArray, factor: float) -> FloatArray:
    """Return the matrix (3, 3) that keeps what lies along an axis and scales what lies across."""
    angle = np.linalg.norm(rotation)
    axis = rotation / angle if angle > 0 else np.zeros(3)
    along = np.outer(axis, axis)
    return factor * np.eye(3) + (1 - factor) * along


def _mass_matrix(places_nm: FloatArray, masses_Da: FloatArray) -> FloatArray:
    """Return the mass matrix (6, 6) of point masses about the origin of their frame."""
    offset = cross_matrix(masses_Da @ places_nm)
    second = np.einsum("a,ai,aj->ij", masses_Da, places_nm, places_nm)
    inertia = np.trace(second) * np.eye(3) - second
    return np.block([[masses_Da.sum() * np.eye(3), -offset], [offset, inertia]])
