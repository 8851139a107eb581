"""The frame of the cross-sections, which turns with the helix, and that of the laboratory.

A rod with Omega0 turns by |Omega0| per arc length about that direction. In fixed axes a wave
exp(iks) of the cross-section's frame is three waves: its components along the axis keep k, its
circular components f+- = f1 +- i f2 about the axis have q = k +- |Omega0|. For a straight rod of
twist T > 0, q = k +- T.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.spatial.transform import Rotation

from dnawaves.errors import InputError
from dnawaves.rod.plane_waves import PlaneWaves
from dnawaves.rod.rod import FloatArray, Rod, cross_matrix

CIRCULAR = ("minus", "axial", "plus")


def to_laboratory(rod: Rod, fields: ArrayLike, arc_length_nm: ArrayLike) -> FloatArray:
    """Return six-vectors (..., places, 6) of the cross-sections' frames in the laboratory's.

    `arc_length_nm` is (places,); at 0 the frames agree. Displacements and rotations, velocities
    or forces alike: both halves of the six are turned.
    """
    return _turned(rod, fields, arc_length_nm, 1)


def to_material(rod: Rod, fields: ArrayLike, arc_length_nm: ArrayLike) -> FloatArray:
    """Return the inverse of `to_laboratory`."""
    return _turned(rod, fields, arc_length_nm, -1)


def laboratory_wavenumbers(rod: Rod, wavenumbers_rad_per_nm: ArrayLike) -> FloatArray:
    """Return the wavenumbers q (k, 3), rad/nm, of the waves `CIRCULAR` that make up wave k."""
    turn = np.linalg.norm(rod.omega0_rad_per_nm)
    k = np.asarray(wavenumbers_rad_per_nm, dtype=float)
    return k[..., np.newaxis] + turn * np.array([-1.0, 0.0, 1.0])


def laboratory_shares(waves: PlaneWaves) -> FloatArray:
    """Return the shares (k, wave, 3) of `CIRCULAR` in the kinetic energy; their sum is 1.

    An isotropic rod's bends and shears are wholly plus or minus: seen from the laboratory each is
    a single wave.
    """
    vectors, mass = waves.velocity_vectors, waves.rod.mass
    parts = [np.kron(np.eye(2), projector) @ vectors for projector in _projectors(waves.rod)]
    momentum = mass @ vectors
    return np.stack([(part.conj() * momentum).sum(axis=1).real for part in parts], axis=-1)


def _projectors(rod: Rod) -> list[NDArray[np.complex128]]:
    """Return the projectors (3, 3) on f-, on the axis and on f+."""
    turn = np.linalg.norm(rod.omega0_rad_per_nm)
    axis = rod.omega0_rad_per_nm / turn if turn > 0 else np.array([0.0, 0.0, 1.0])
    along = np.outer(axis, axis)
    across = np.eye(3) - along
    # (1, -i) exp(iks) is f+ alone: f1 - i f2 cancels in it, f1 + i f2 doubles
    rotation = 1j * cross_matrix(axis)
    return [(across + rotation) / 2, along, (across - rotation) / 2]


def _turned(rod: Rod, fields: ArrayLike, arc_length_nm: ArrayLike, sense: int) -> FloatArray:
    six, places = np.asarray(fields, dtype=float), np.asarray(arc_length_nm, dtype=float)
    if places.ndim != 1 or six.shape[-2:] != (len(places), 6):
        raise InputError(
            f"fields have shape {six.shape}; they must end in ({places.size}, 6), six numbers for "
            "each place"
        )
    rotations = Rotation.from_rotvec(sense * np.outer(places, rod.omega0_rad_per_nm)).as_matrix()
    halves = six.reshape(*six.shape[:-1], 2, 3)
    return np.einsum("nij,...nhj->...nhi", rotations, halves).reshape(six.shape)
