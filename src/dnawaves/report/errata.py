"""What in the paper has to be read with care before its numbers are held against a simulation."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from dnawaves.report.dispersion import GHZ_PER_RAD_PER_PS
from dnawaves.report.numbers import between, digits, listed
from dnawaves.rod.dispersion import (
    bend_shear_branches,
    eq46_expanded_residual,
    transverse_constants,
)
from dnawaves.rod.rod import SHEAR_1, TWIST, Rod, short_wave_speeds_A_per_ps
from dnawaves.rod.standing import bend_standing_wave
from dnawaves.units import A_PER_NM, BOLTZMANN_KJ_PER_MOL_K

ROOM_TEMPERATURE_K = 300.0
# The paper's DNA is a cylinder of this radius.
RADIUS_NM = 1.0


def errata(pairs: int, spacing_A: float) -> list[str]:
    """Return one paragraph per point, numbers computed from the paper's rod.

    `pairs` and `spacing_A` are those of the duplex that standing bends are compared for.
    """
    return [
        _short_waves(),
        _standing_bends(pairs, spacing_A),
        _equation_46(),
        _cylinder(),
        _pairwise_equal(),
        _stiffnesses(),
        _density(),
        _square_root(),
        "An impulse cannot act on a base pair that is held. The scenes kick or drive the base "
        "pairs next to the held end, or leave the first end free.",
        "Twist of an isotropic rod is a matter of the frame: seen from the laboratory its waves "
        "are those of the untwisted rod at shifted wavenumbers, so to first order they cannot "
        "sense topology, although the paper concludes that they do. Wavenumbers here are those of "
        "the laboratory.",
    ]


def _short_waves() -> str:
    rod = Rod.paper(twisted=True)
    inertia, stretch = rod.inertia_Da_nm[0, 0], rod.gamma0[2]
    gyration_A = A_PER_NM * np.sqrt(inertia / rod.density_Da_per_nm)
    cut_off = stretch * np.sqrt(rod.stiffness[SHEAR_1, SHEAR_1] / inertia)
    edge = np.pi / (rod.spacing_nm * A_PER_NM)
    twist = rod.omega0_rad_per_nm[2] / A_PER_NM
    speeds = short_wave_speeds_A_per_ps(rod)
    return (
        f"The speeds of bend ({digits(speeds['bend'])} Å/ps) and shear "
        f"({digits(speeds['shear'])} Å/ps) hold only for waves much shorter than those at "
        f"{digits(1 / gyration_A)} rad/Å, the inverse radius of gyration, and at {digits(twist)} "
        f"rad/Å, the helix's own turn. A chain of base pairs ends at {digits(edge)} rad/Å, so an "
        f"atomistic duplex never gets there. In long waves the lower branch is bending and slows "
        f"with the wavelength, and the upper one starts at a cut-off of "
        f"{digits(cut_off * GHZ_PER_RAD_PER_PS)} GHz. So the whole branches are compared, and the "
        f"'paper' value of a standing bend or shear is what the paper's rod does in the same shape."
    )


def _standing_bends(pairs: int, spacing_A: float) -> str:
    rod = replace(Rod.paper(), spacing_nm=spacing_A / A_PER_NM)
    length = (pairs - 1) * rod.spacing_nm
    modes = range(1, 4)
    held = [bend_standing_wave(rod, pairs, n, "held").frequency_rad_per_ps for n in modes]
    rule = bend_shear_branches(rod, [n * np.pi / length for n in modes], lattice=True)[:, 0]
    ratios = [digits(one / other) for one, other in zip(held, rule, strict=True)]
    return (
        f"The rule that the length is a whole number of half wavelengths is right for extension "
        f"and twist, but not for bend between held ends: the three lowest bends of the paper's "
        f"rod with {pairs} base pairs lie {listed(ratios)} times above it."
    )


def _equation_46() -> str:
    rod = Rod.paper(twisted=True)
    k = np.linspace(0.5, 9.0, 60)
    turn = rod.omega0_rad_per_nm[2]
    branches = bend_shear_branches(rod, k + turn, lattice=False).T
    printed, corrected = (
        [eq46_expanded_residual(rod, k, branch, as_printed=as_printed) for branch in branches]
        for as_printed in (True, False)
    )
    return (
        "Equation 46 has a misprint: both terms 4k²D²Ω₀⁴ must read 4k²D²Ω₀². At the rod's own "
        f"waves the printed equation misses by {between(np.min(printed), np.max(printed))} of the "
        f"size of its terms, the corrected one by {digits(np.max(corrected), 1)}."
    )


def _cylinder() -> str:
    rod = Rod.paper()
    cylinder = rod.density_Da_per_nm * RADIUS_NM**2 / 4
    share = transverse_constants(rod).inertia / cylinder
    speeds = short_wave_speeds_A_per_ps(rod)
    bend, twist = (digits(speeds[wave] * np.sqrt(share)) for wave in ("bend", "twist"))
    return (
        f"The moments of inertia are {digits(share, 2)} of those of a solid cylinder of "
        f"{RADIUS_NM * A_PER_NM:g} Å radius. With the cylinder's, bend would run at {bend} and "
        f"twist at {twist} Å/ps."
    )


def _pairwise_equal() -> str:
    speeds = short_wave_speeds_A_per_ps(Rod.paper())
    return (
        f"That extension ({digits(speeds['extension'])}) and bend ({digits(speeds['bend'])}), "
        f"twist ({digits(speeds['twist'])}) and shear ({digits(speeds['shear'])} Å/ps) agree in "
        "pairs is no result: the constants of a homogeneous cylinder force it."
    )


def _stiffnesses() -> str:
    rod = Rod.paper()
    thermal = BOLTZMANN_KJ_PER_MOL_K * ROOM_TEMPERATURE_K
    bend = transverse_constants(rod).bend / thermal
    twist = rod.stiffness[TWIST, TWIST] / thermal
    return (
        f"The bend and twist stiffnesses are worth persistence lengths of {digits(bend, 2)} and "
        f"{digits(twist, 2)} nm at {ROOM_TEMPERATURE_K:.0f} K. The usual bend value is 50 nm, so "
        "the two look swapped; this is a conjecture."
    )


def _density() -> str:
    rod = Rod.paper()
    mass = rod.density_Da_per_nm * rod.spacing_nm
    return (
        f"The paper's density is {digits(mass)} Da per base pair, more than that of a duplex "
        "without ions. Here density and inertia come from the topology that is simulated, and "
        "enter wherever a stiffness is turned into a speed."
    )


def _square_root() -> str:
    speed = short_wave_speeds_A_per_ps(Rod.paper())["extension"]
    return (
        "A stretch modulus half as large makes extension slower by the root of two, to "
        f"{digits(speed / np.sqrt(2))} Å/ps, not 'two times slower'."
    )
