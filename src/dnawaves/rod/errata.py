"""What in the paper has to be read with care, each point with the number that shows it."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from dnawaves.rod.dispersion import bend_shear_branches, dispersion, eq46_expanded_residual
from dnawaves.rod.rod import EXTENSION, TWIST, Rod, short_wave_speeds_A_per_ps
from dnawaves.rod.standing import bend_standing_wave
from dnawaves.units import A_PER_NM, BOLTZMANN_KJ_PER_MOL_K, GHZ_PER_RAD_PER_PS

ROOM_TEMPERATURE_K = 300.0
# The paper's DNA is a cylinder of this radius.
CYLINDER_RADIUS_NM = 1.0
PAIRS = 24


class Erratum(NamedTuple):
    """One point: what the paper has, what holds, and the number that shows it."""

    paper: str
    correct: str
    shown_by: str


def errata() -> list[Erratum]:
    """Return all points; the numbers are computed from the paper's rod, here and now."""
    return [point() for point in POINTS]


def errata_markdown() -> str:
    """Return the points as a table in Markdown."""
    rows = [Erratum("the paper", "what holds", "shown by"), Erratum("---", "---", "---")]
    return "".join(f"| {' | '.join(row)} |\n" for row in [*rows, *errata()])


def _equation_46() -> Erratum:
    rod = Rod.paper(twisted=True)
    k = np.linspace(0.5, 9.0, 60)
    turn = rod.omega0_rad_per_nm[2]
    shifted = [bend_shear_branches(rod, k + sign * turn, lattice=False).T for sign in (1, -1)]
    branches = np.concatenate(shifted)
    printed, corrected = (
        np.array([eq46_expanded_residual(rod, k, one, as_printed=as_printed) for one in branches])
        for as_printed in (True, False)
    )
    return Erratum(
        "eq. 46: 4k²D²Ω₀⁴, twice",
        "4k²D²Ω₀², twice; factorised, with q = k ± Ω₀: (ρω² − Cq²)(Iω² − Dq²) = ρCΓ₀²ω²",
        f"at the rod's own waves, 0.05 to 0.9 rad/Å, the printed form misses by up to "
        f"{printed.max():.4f} of the size of its terms, the corrected one by "
        f"{_round_off(corrected.max(), 1e-11)}",
    )


def _branches() -> Erratum:
    rod = Rod.paper()
    shear, bend = (rod.stiffness[i, i] for i in (0, 3))
    inertia, density = rod.inertia_Da_nm[0, 0], rod.density_Da_per_nm
    k = 0.1
    lower, upper = bend_shear_branches(rod, [k], lattice=False)[0]
    flexural = k**2 / rod.gamma0[2] * np.sqrt(bend / density)
    cut_off = rod.gamma0[2] * np.sqrt(shear / inertia)
    gyration = np.sqrt(density / inertia) / A_PER_NM
    edge = np.pi / (rod.spacing_nm * A_PER_NM)
    return Erratum(
        "the upper branch is bend, the lower one shear",
        f"only for k ≫ √(ρ/I) = {gyration:.3f} rad/Å, while a chain of base pairs ends at "
        f"{edge:.3f} rad/Å; in long waves the lower branch is bending, ω = (k²/Γ₀)√(D/ρ), and the "
        f"upper one starts at the cut-off Γ₀√(C/I) = {cut_off * GHZ_PER_RAD_PER_PS:.1f} GHz",
        f"at 0.01 rad/Å the lower branch is {lower / flexural:.4f} of bending and the upper one "
        f"{upper / cut_off:.4f} of the cut-off",
    )


def _phase_speed() -> Erratum:
    rod = Rod.paper()
    speeds = []
    for pairs in (24, 12, 6):
        k = 2 * np.pi / (pairs * rod.spacing_nm)
        speeds.append(bend_shear_branches(rod, [k], lattice=False)[0, 0] / k * A_PER_NM)
    told = ", ".join(f"{speed:.2f}" for speed in speeds)
    return Erratum(
        "ω = Vk for every wave",
        "not for bend and shear: their speed depends on the wavelength, so whole branches are "
        "compared",
        f"the lower branch runs at {told} Å/ps at wavelengths of 24, 12 and 6 base pairs",
    )


def _standing_bends() -> Erratum:
    rod = Rod.paper()
    length = (PAIRS - 1) * rod.spacing_nm
    modes = range(1, 4)
    held = np.array([bend_standing_wave(rod, PAIRS, n, "held").frequency_rad_per_ps for n in modes])
    rule = bend_shear_branches(rod, [n * np.pi / length for n in modes], lattice=True)[:, 0]
    told = ", ".join(f"{ratio:.2f}" for ratio in held / rule)
    return Erratum(
        "L = nλ/2",
        "for extension and twist between held ends; for bend only between pinned ends",
        f"the three lowest bends of a chain of {PAIRS} base pairs with clamped ends have {told} "
        f"times the frequency of the rule, the length being the {PAIRS - 1} spacings between them",
    )


def _gauge() -> Erratum:
    k = np.linspace(0.01, 9.0, 200)
    turned, straight = Rod.paper(twisted=True), Rod.paper()
    turn = turned.omega0_rad_per_nm[2]
    material = dispersion(turned, k, lattice=False)
    branches = [bend_shear_branches(straight, k + sign * turn, lattice=False) for sign in (1, -1)]
    speeds = short_wave_speeds_A_per_ps(straight)
    axial = np.outer(k, [speeds["extension"] / A_PER_NM, speeds["twist"] / A_PER_NM])
    laboratory = np.sort(np.concatenate([*branches, axial], axis=1), axis=1)
    difference = np.abs(material - laboratory).max() / material.max()
    return Erratum(
        "waves sense the twist, so they sense topology",
        "twist of an isotropic rod is a gauge: in the laboratory its waves are those of the "
        "untwisted rod, to first order; only unequal bend stiffnesses would show the twist",
        f"all six branches at k of the twisted rod and at k ± Ω₀ of the untwisted one differ by "
        f"{_round_off(difference, 1e-13)} of the highest frequency",
    )


def _cylinder() -> Erratum:
    rod = Rod.paper()
    cylinder = rod.density_Da_per_nm * CYLINDER_RADIUS_NM**2 / 4
    share = rod.inertia_Da_nm[0, 0] / cylinder
    speeds = short_wave_speeds_A_per_ps(rod)
    bend, twist = (speeds[wave] * np.sqrt(share) for wave in ("bend", "twist"))
    return Erratum(
        "moments of inertia of a solid cylinder",
        "those of a cylinder of 10 Å radius are twice as large",
        f"the paper's are {share:.2f} of ρR²/4 and ρR²/2; with the cylinder's, bend would run at "
        f"{bend:.2f} and twist at {twist:.2f} Å/ps",
    )


def _pairwise_equal() -> Erratum:
    rod = Rod.paper()
    speeds = short_wave_speeds_A_per_ps(rod)
    return Erratum(
        "speeds that agree in pairs, as a result",
        "the constants of a homogeneous cylinder force it: D/C₃ ≈ I/ρ and D₃/C ≈ I₃/ρ",
        f"extension {speeds['extension']:.2f} and bend {speeds['bend']:.2f}, twist "
        f"{speeds['twist']:.2f} and shear {speeds['shear']:.2f} Å/ps",
    )


def _persistence() -> Erratum:
    rod = Rod.paper()
    thermal = BOLTZMANN_KJ_PER_MOL_K * ROOM_TEMPERATURE_K
    bend, twist = rod.stiffness[3, 3] / thermal, rod.stiffness[TWIST, TWIST] / thermal
    return Erratum(
        "bend 2.7, twist 2.06 × 10⁻²⁸ N m²",
        "the two look swapped (a conjecture): a persistence length of 50 nm belongs to bend",
        f"they are worth {bend:.0f} and {twist:.0f} nm at {ROOM_TEMPERATURE_K:.0f} K",
    )


def _density() -> Erratum:
    # The duplex's and the crystal's numbers are measured in tests/rod/test_rod_sources.py.
    rod = Rod.paper()
    return Erratum(
        "ρ = 3.22 × 10⁻¹⁵ kg/m, I₁ = I₂",
        "more than a duplex without ions weighs, and a base pair is long: density and inertia "
        "are taken from the topology",
        f"{rod.density_Da_per_nm * rod.spacing_nm:.0f} Da per base pair, where a duplex without "
        "ions has 616; base pairs 3 to 10 of the crystal 355D have principal moments of 1.02, 12.9 "
        "and 13.6 × 10⁻³⁴ kg m, not 4.03, 4.03 and 8.06",
    )


def _square_root() -> Erratum:
    rod = Rod.paper()
    half = np.sqrt(rod.stiffness[EXTENSION, EXTENSION] / 2 / rod.density_Da_per_nm) * A_PER_NM
    return Erratum(
        "half the stretch modulus: two times slower",
        "slower by √2",
        f"{half:.2f} instead of {short_wave_speeds_A_per_ps(rod)['extension']:.2f} Å/ps",
    )


def _names() -> Erratum:
    speed = short_wave_speeds_A_per_ps(Rod.paper())["shear"]
    return Erratum(
        "isotropic bending C₁ = C₂, shear D₁ = D₂; moduli",
        "C is shear and stretch (N), D is bend and twist (N m²), and neither is a modulus; d₂ is "
        "the long axis of the base pair; 'curvature' is the radius of curvature",
        f"√(C/ρ) = {speed:.2f} Å/ps is the shear wave",
    )


def _impulse() -> Erratum:
    return Erratum(
        "an impulse at a held end",
        "an impulse cannot act on what is held: kick beside it, or hold the far end only",
        "a scene that kicks a held base pair is refused",
    )


def _misprints() -> Erratum:
    rod = Rod.paper()
    speed = short_wave_speeds_A_per_ps(rod)["extension"]
    wavenumber = 2 * np.pi / (PAIRS * rod.spacing_nm * A_PER_NM)
    return Erratum(
        "C³; harmonic solutions in sin(s − Vt); (48 or 48)",
        "C₃; sin k(s − Vt), or all waves have the length 2π; (48 or 48a)",
        f"√(C₃/ρ) = {speed:.2f} Å/ps; a wave of {PAIRS} base pairs has k = {wavenumber:.3f} rad/Å",
    )


def _round_off(value: float, limit: float) -> str:
    """Return that a value is below a limit set in advance, or, if it is not, the value."""
    return f"less than {limit:.0e}" if value < limit else f"{value:.1e}"


POINTS: tuple[Callable[[], Erratum], ...] = (
    _equation_46,
    _branches,
    _phase_speed,
    _standing_bends,
    _gauge,
    _cylinder,
    _pairwise_equal,
    _persistence,
    _density,
    _square_root,
    _names,
    _misprints,
    _impulse,
)
