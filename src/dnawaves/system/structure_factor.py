"""The dynamic structure factor of the base pairs' six rigid-body coordinates, from normal modes."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from dnawaves.system.duplex import SimulatedDuplex
from dnawaves.system.modes import NormalModes
from dnawaves.units import GHZ_PER_RAD_PER_PS

Array = NDArray[np.float64]

# Velocity across, across and along the helix axis at the pair, then rotation about the same.
COORDINATES = ("shear", "shear_across", "extension", "bend_across", "bend", "twist")


def axis_shapes(modes: NormalModes, duplex: SimulatedDuplex) -> Array:
    """Return the modes' shapes (modes, N, 6) in the laboratory frame of the helix axis.

    The order is that of `COORDINATES`; linear motion is that of the point of the axis.
    """
    linear, angular = modes.shapes[..., :3], modes.shapes[..., 3:]
    linear = linear + np.cross(angular, duplex.pivots_nm - duplex.bodies.centres_nm)
    axes = duplex.frame.directions.T
    return np.concatenate([linear @ axes, angular @ axes], axis=-1)


def velocity_structure_factor(
    modes: NormalModes,
    shapes: Array,
    phases_rad: Array,
    frequencies_GHz: Array,
    width_GHz: float,
) -> Array:
    """Return S(q, f) of the velocities per kBT, (coordinates, phases, frequencies).

    With A(q) = Σ_n exp(-i q n) A_n / √N, the integral of S over positive frequencies is
    ⟨|A(q)|²⟩ / kBT, which is 1/mass for bodies that do not depend on each other; rigid motions
    are left out. Divided by (2πf)² it is S(q, f) of the displacements.

    Parameters
    ----------
    shapes : (modes, N, coordinates), such as those of `axis_shapes`
    phases_rad : q times the distance of neighbouring pairs
    width_GHz : standard deviation of the Gaussian that each mode is drawn as
    """
    moves = modes.vibrations
    centres_GHz = GHZ_PER_RAD_PER_PS * modes.frequencies_rad_per_ps[moves]
    pairs = shapes.shape[1]
    waves = np.exp(-1j * np.outer(phases_rad, np.arange(pairs))) / np.sqrt(pairs)
    # Modes far above the range are far more than those inside, and add nothing.
    near = centres_GHz < frequencies_GHz.max() + 6 * width_GHz
    weights = np.abs(np.einsum("qn,mnc->cqm", waves, shapes[moves][near])) ** 2
    distance = (frequencies_GHz - centres_GHz[near, None]) / width_GHz
    lines = np.exp(-0.5 * distance**2) / (width_GHz * np.sqrt(2 * np.pi))
    return np.asarray(weights @ lines)
