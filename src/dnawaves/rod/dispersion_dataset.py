"""The dispersion relation as a table with units, and the curves of the paper's Figure 1."""

from __future__ import annotations

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from dnawaves.rod.branches import follow_branches
from dnawaves.rod.dispersion import bend_shear_branches, lattice_frequency
from dnawaves.rod.lab_frame import CIRCULAR, laboratory_shares, laboratory_wavenumbers
from dnawaves.rod.plane_waves import MOTIONS
from dnawaves.rod.rod import FloatArray, Rod, short_wave_speeds_A_per_ps
from dnawaves.units import A_PER_NM

COORDINATES = ("u1", "u2", "u3", "theta1", "theta2", "theta3")
RAD_PER_PS = {"units": "rad/ps"}
A_PER_PS = {"units": "angstrom/ps"}
RAD_PER_A = {"units": "rad/angstrom"}
SHARE = {"units": "1"}


def dispersion_dataset(rod: Rod, wavenumbers_rad_per_nm: ArrayLike, *, lattice: bool) -> xr.Dataset:
    """Return frequencies, velocities, polarisations and shares along the six branches of a rod.

    Branches are those of `follow_branches`, numbered from 1 by frequency at the first wavenumber.
    Wavenumbers are those of the cross-section's frame; `laboratory_wavenumber` has the others.
    At k = 0 phase velocities of waves with a cut-off are infinite.
    """
    waves = follow_branches(rod, wavenumbers_rad_per_nm, lattice=lattice)
    k = waves.wavenumbers_rad_per_nm
    vectors = waves.velocity_vectors.swapaxes(1, 2)
    vectors = vectors * np.repeat([A_PER_NM, 1.0], 3)
    along = ("wavenumber", "branch")
    return xr.Dataset(
        {
            "angular_frequency": (along, waves.frequencies_rad_per_ps, RAD_PER_PS),
            "phase_velocity": (along, waves.phase_velocities_A_per_ps, A_PER_PS),
            "group_velocity": (along, waves.group_velocities_A_per_ps, A_PER_PS),
            "strain_share": (
                (*along, "motion"),
                waves.strain_shares(),
                {**SHARE, "long_name": "share of the elastic energy"},
            ),
            "kinetic_share": (
                (*along, "motion"),
                waves.kinetic_shares(),
                {**SHARE, "long_name": "share of the kinetic energy"},
            ),
            "polarisation": (
                (*along, "coordinate", "part"),
                np.stack([vectors.real, vectors.imag], axis=-1),
                {
                    "units": "angstrom/ps (u), rad/ps (theta)",
                    "long_name": "velocity amplitude at v.M.v = 1 kJ/mol/nm",
                },
            ),
            "laboratory_wavenumber": (
                ("wavenumber", "circular"),
                laboratory_wavenumbers(rod, k) / A_PER_NM,
                RAD_PER_A,
            ),
            "laboratory_share": (
                (*along, "circular"),
                laboratory_shares(waves),
                {**SHARE, "long_name": "share of the kinetic energy"},
            ),
        },
        coords={
            "wavenumber": ("wavenumber", k / A_PER_NM, RAD_PER_A),
            "branch": range(1, 7),
            "motion": list(MOTIONS),
            "coordinate": list(COORDINATES),
            "part": ["real", "imaginary"],
            "circular": list(CIRCULAR),
        },
        attrs={
            "model": "lattice of rigid base pairs" if lattice else "continuous rod",
            "frame": "cross-section",
            "spacing_A": round(rod.spacing_nm * A_PER_NM, 12),
        },
    )


def figure_1_dataset(wavenumbers_rad_per_nm: ArrayLike, rod: Rod | None = None) -> xr.Dataset:
    """Return the closed-form branches of the paper's rod, continuous and as a lattice.

    Bishop & Zhmudsky: extension and twist, and bend and shear by eq. 48a at q = k (rod without
    intrinsic twist) and by eq. 46 at q = k + twist and k - twist (the paper's twisted rod).
    Another straight isotropic rod may be given for the paper's.
    """
    rod = Rod.paper(twisted=True) if rod is None else rod
    k = np.asarray(wavenumbers_rad_per_nm, dtype=float)
    turn = rod.omega0_rad_per_nm[2]
    speeds = short_wave_speeds_A_per_ps(rod)
    models = {"continuous rod": False, "lattice": True}
    shifts = {"untwisted": 0.0, "k + twist": turn, "k - twist": -turn}
    bends = [
        [bend_shear_branches(rod, k + shift, lattice=lattice) for shift in shifts.values()]
        for lattice in models.values()
    ]
    axial = {
        wave: np.stack([_axial_branch(rod, k, speeds[wave], lattice) for lattice in (False, True)])
        for wave in ("extension", "twist")
    }
    return xr.Dataset(
        {
            **{wave: (("model", "wavenumber"), axial[wave], RAD_PER_PS) for wave in axial},
            "bend_shear": (("model", "frame", "wavenumber", "branch"), np.array(bends), RAD_PER_PS),
        },
        coords={
            "wavenumber": ("wavenumber", k / A_PER_NM, RAD_PER_A),
            "model": list(models),
            "frame": list(shifts),
            "branch": ["lower", "upper"],
        },
    )


def _axial_branch(rod: Rod, k: FloatArray, speed_A_per_ps: float, lattice: bool) -> FloatArray:
    if lattice:
        return lattice_frequency(k, speed_A_per_ps, rod.spacing_nm)
    return np.abs(k) * speed_A_per_ps / A_PER_NM
