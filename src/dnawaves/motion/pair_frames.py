"""Base pairs in time: their frames, and their velocities seen from the duplex as a whole."""

from __future__ import annotations

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from dnawaves.frames.fit import Frames
from dnawaves.motion.fields import WAVE_COMPONENTS

Array = NDArray[np.float64]


def frames_in_time(motion: xr.Dataset, reference: Frames, sign: int = 0) -> Frames:
    """Return the base-pair frames (pairs, times) of a record, in Å.

    Each pair's frame moves with the pair's body; `reference` (pairs,) are the frames where the
    record's displacements and rotations are zero. `sign` counts the copies of the run from 0.
    """
    turn = _turns(motion, sign)
    centre = motion["centre"].values
    moved = centre + motion["displacement"].values[sign]
    arm = turn @ (reference.origin.T - centre)[..., np.newaxis]
    # axes are (axis, component, pair); turned as (time, pair, component, axis)
    axes = turn @ reference.axes.transpose(2, 1, 0)
    return Frames((moved + arm[..., 0]).transpose(2, 1, 0), axes.transpose(3, 2, 1, 0))


def following_velocities(motion: xr.Dataset, sign: int = 0) -> dict[str, Array]:
    """Return the velocity (time, pair) of each wave, Å/ps or rad/ps, as a duplex that tumbles sees.

    At each time the duplex is laid on the reference by the least-squares rotation of all its mass,
    pairs as rigid bodies (Kabsch 1976), and the velocities turn with it; the waves' directions are
    the reference's. As in `wave_fields` the linear motion is that of the pair's point at the axis.
    """
    turn = _turns(motion, sign)
    centre = motion["centre"].values
    back = _whole_turn(motion, turn, centre + motion["displacement"].values[sign])
    lever = turn @ (motion["pivot"].values - centre)[..., np.newaxis]
    angular = motion["angular_velocity"].values[sign]
    linear = motion["velocity"].values[sign] + np.cross(angular, lever[..., 0])
    seen = {
        kind: np.einsum("txy,tpx->tpy", back, velocity)
        for kind, velocity in (("linear", linear), ("angular", angular))
    }
    return {
        wave: np.asarray(seen[kind] @ motion["direction"].sel(axis=direction).values)
        for wave, (kind, direction) in WAVE_COMPONENTS.items()
    }


def _turns(motion: xr.Dataset, sign: int) -> Array:
    """Return the pairs' rotations (time, pair, 3, 3)."""
    vectors = motion["rotation"].values[sign]
    matrices = Rotation.from_rotvec(vectors.reshape(-1, 3)).as_matrix()
    return np.asarray(matrices.reshape(*vectors.shape, 3))


def _whole_turn(motion: xr.Dataset, turn: Array, centres: Array) -> Array:
    """Return the duplex's rotation (time, 3, 3) from the reference."""
    mass, inertia = motion["mass"].values, motion["inertia"].values
    reference = motion["centre"].values
    reference = reference - mass @ reference / mass.sum()
    about = centres - np.einsum("p,tpx->tx", mass, centres)[:, np.newaxis] / mass.sum()
    # second moments of mass of the bodies, from their inertia
    trace = np.trace(inertia, axis1=1, axis2=2)
    moments = trace[:, np.newaxis, np.newaxis] / 2 * np.eye(3) - inertia
    correlation = np.einsum("p,tpx,py->txy", mass, about, reference)
    correlation += np.einsum("tpxz,pzy->txy", turn, moments)
    u, _, vt = np.linalg.svd(correlation)
    u[:, :, 2] *= np.sign(np.linalg.det(u @ vt))[:, np.newaxis]
    return np.asarray(u @ vt)
