"""To which bend/shear branch a standing wave of a finite chain belongs."""

from __future__ import annotations

import numpy as np

from dnawaves.errors import InputError
from dnawaves.rod.dispersion import transverse_constants
from dnawaves.rod.rod import FloatArray, Rod


def lower_branch_share(rod: Rod, frequency_rad_per_ps: float, shape: FloatArray) -> float:
    """Return the share, 0 to 1, of the lower (bend) branch in a mode (pairs, 2) = (u1, th2).

    Between the cut-off and the top of the lower branch both branches carry waves of the same
    frequency, and the ends mix them: a mode is exactly a sum of two running pairs, one of each
    branch. The share is the lower pair's part of the sum of the two kinetic energies. Outside
    that range only one branch carries waves, and the share is 1 or 0.

    Raises InputError where I/rho + D/C < (Gamma0 a/2)^2: the upper branch of such a lattice falls
    from its cut-off, and the range is another.
    """
    a = rod.spacing_nm
    constants = transverse_constants(rod)
    rises = constants.inertia / constants.density + constants.bend / constants.shear
    if rises < (constants.stretch * a / 2) ** 2:
        raise InputError(
            "modes cannot be told to be bend or shear: the rod is so slender and stiff in shear "
            "that on this spacing the upper branch falls with the wavenumber"
        )
    upper_squared, lower_squared = _sine_squares(rod, frequency_rad_per_ps)
    if upper_squared <= 0:
        return 1.0
    if lower_squared >= (2 / a) ** 2:
        return 0.0
    weights = np.sqrt([constants.density, constants.inertia])
    position = a * np.arange(len(shape))
    waves = []
    for squared in (lower_squared, upper_squared):
        s = np.sqrt(squared)
        q = 2 / a * np.arcsin(a * s / 2)
        slope = 1 - constants.density * frequency_rad_per_ps**2 / (constants.shear * squared)
        ratio = s * slope / (constants.stretch * np.cos(q * a / 2))
        sine, cosine = np.sin(q * position), np.cos(q * position)
        waves += [np.stack([sine, ratio * cosine], 1), np.stack([cosine, -ratio * sine], 1)]
    basis = (np.array(waves) * weights).reshape(4, -1)
    amplitudes = np.linalg.lstsq(basis.T, (shape * weights).ravel(), rcond=None)[0]
    lower, upper = (float(np.sum((amplitudes[i : i + 2] @ basis[i : i + 2]) ** 2)) for i in (0, 2))
    return lower / (lower + upper)


def _sine_squares(rod: Rod, frequency_rad_per_ps: float) -> FloatArray:
    """Return (2/a sin(qa/2))^2 of the upper and of the lower branch at one frequency.

    Roots of the lattice's eq. 48a, solved for the wavenumber; negative where evanescent.
    """
    density, inertia, shear, bend, stretch = transverse_constants(rod)
    w2 = frequency_rad_per_ps**2
    half_sum = w2 / 2 * (density / shear + inertia / bend)
    half_sum -= w2 / 2 * density * (stretch * rod.spacing_nm / 2) ** 2 / bend
    product = density * w2 * (inertia * w2 - shear * stretch**2) / (shear * bend)
    root = np.sqrt(half_sum**2 - product)
    return np.array([half_sum - root, half_sum + root])
