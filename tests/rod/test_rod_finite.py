"""Finite continuous rods: tables, the boundary determinant, and fine lattices."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import scipy.linalg
import scipy.optimize
from hypothesis import given, settings
from hypothesis import strategies as st

from dnawaves.errors import InputError
from dnawaves.rod.chain import FiniteChain
from dnawaves.rod.dispersion import bend_shear_branches
from dnawaves.rod.finite_rod import COORDINATE_SETS, End, FiniteRod
from dnawaves.rod.half_waves import PAIRINGS, half_wave_table
from dnawaves.rod.rod import Rod, short_wave_speeds_A_per_ps

PAPER = Rod.paper()
GHZ_PER_RAD_PER_PS = 1e3 / (2 * np.pi)
CUT_OFF = float(bend_shear_branches(PAPER, 0.0, lattice=False)[1])

# (ends, pairs): f1, f2, f3 in GHz
TIMOSHENKO: dict[tuple[End, End, int], tuple[float, float, float]] = {
    ("held", "held", 12): (43.3, 92.7, 150),
    ("held", "held", 24): (13.8, 33.6, 58.4),
    ("held", "held", 48): (3.75, 9.93, 18.6),
    ("free", "free", 12): (49.6, 107, 168),
    ("free", "free", 24): (14.4, 36.0, 62.9),
    ("free", "free", 48): (3.80, 10.1, 19.1),
    ("held", "free", 12): (9.18, 44.6, 100),
    ("held", "free", 24): (2.40, 13.8, 34.8),
    ("held", "free", 48): (0.61, 3.71, 10.0),
    ("pinned", "pinned", 12): (24.4, 78.0, 141),
    ("pinned", "pinned", 24): (6.61, 24.4, 49.2),
    ("pinned", "pinned", 48): (1.69, 6.61, 14.3),
}


def coupled_rod(seed: int) -> Rod:
    """A twisted, curved rod with every coupling and its mass beside the axis."""
    random = np.random.default_rng(seed)
    root, scale = random.normal(size=(6, 6)), np.sqrt(np.diag(PAPER.stiffness))
    return replace(
        PAPER,
        stiffness=PAPER.stiffness + 0.1 * np.outer(scale, scale) * (root @ root.T),
        inertia_Da_nm=np.diag([1.6, 0.3, 1.6]) * PAPER.inertia_Da_nm[2, 2],
        gamma0=np.array([0.0, 0.0, 1.0]) + 0.05 * random.normal(size=3),
        omega0_rad_per_nm=np.array([0.0, 0.1, 1.76]) + 0.1 * random.normal(size=3),
        centre_nm=0.1 * random.normal(size=3),
    )


@pytest.mark.parametrize(("first", "last", "pairs"), TIMOSHENKO)
def test_bends_of_the_paper_between_all_ends(first: End, last: End, pairs: int) -> None:
    rod = FiniteRod(PAPER, pairs * 0.34, (first, last), COORDINATE_SETS["bend"])
    lowest = rod.frequencies_rad_per_ps(3) * GHZ_PER_RAD_PER_PS
    # the reference is rounded to three digits (0.5 % at worst), to 0.01 GHz below 1 GHz
    assert lowest == pytest.approx(TIMOSHENKO[first, last, pairs], rel=0.005, abs=0.005)


@pytest.mark.parametrize(
    ("pairs", "extension_GHz", "twist_GHz"),
    [(12, 100.4, 61.95), (24, 50.2, 30.98), (48, 25.1, 15.5)],
)
def test_extension_and_twist_are_whole_or_odd_half_waves(
    pairs: int, extension_GHz: float, twist_GHz: float
) -> None:
    length, n = pairs * 0.34, np.arange(1, 9)
    for wave, expected in (("extension", extension_GHz), ("twist", twist_GHz)):
        first = 100 * short_wave_speeds_A_per_ps(PAPER)[wave] / (2 * length)
        # the reference holds three digits
        assert first == pytest.approx(expected, rel=0.003)
        for ends in PAIRINGS:
            fixed = [end == "held" or (end == "pinned" and wave == "extension") for end in ends]
            rod = FiniteRod(PAPER, length, ends, COORDINATE_SETS[wave])
            assert rod.zero_modes == (not any(fixed))
            found = rod.frequencies_rad_per_ps(8) * GHZ_PER_RAD_PER_PS
            # round-off of the dynamic stiffness
            assert found == pytest.approx(first * (n - (sum(fixed) == 1) / 2), rel=1e-10)


def boundary_determinants(w: np.ndarray, length: float, ends: tuple[End, End]) -> np.ndarray:
    """Return the determinant of the ends' conditions on the four waves of each frequency."""
    rho, inertia = PAPER.density_Da_per_nm, PAPER.inertia_Da_nm[0, 0]
    shear, bend = PAPER.stiffness[0, 0], PAPER.stiffness[4, 4]
    half = (rho * bend + inertia * shear) * w**2 / (2 * shear * bend)
    product = rho * w**2 * (inertia * w**2 - shear) / (shear * bend)
    rows = []
    for sign in (1, -1):
        q = np.sqrt((half + sign * np.sqrt(half**2 - product)).astype(complex))
        # theta' = ratio u'' etc. from rho w^2 u = -(C (u' - theta))'
        slope = q - rho * w**2 / (shear * q)
        for place, end in zip((0.0, length), ends, strict=True):
            sine, cosine = np.sin(q * place), np.cos(q * place)
            # u = sin, theta = slope cos; u = cos, theta = -slope sin
            u, angle = (sine, cosine), (slope * cosine, -slope * sine)
            moment = (-slope * q * sine, -slope * q * cosine)
            strain = ((q - slope) * cosine, -(q - slope) * sine)
            pairs = {"held": (u, angle), "pinned": (u, moment), "free": (strain, moment)}[end]
            rows.append(np.array(pairs))
    # (conditions at both ends, waves); the second wave of each pair is real up to a factor i
    matrix = np.concatenate([np.concatenate(rows[:2]), np.concatenate(rows[2:])], axis=1)
    return np.linalg.det(np.moveaxis(matrix, -1, 0))


@pytest.mark.parametrize("ends", PAIRINGS)
@pytest.mark.parametrize("pairs", [12, 30])
def test_bends_are_the_roots_of_the_boundary_determinant(ends: tuple[End, End], pairs: int) -> None:
    length = pairs * 0.34
    found = FiniteRod(PAPER, length, ends, COORDINATE_SETS["bend"]).frequencies_rad_per_ps(20)
    assert found[-1] > 1.2 * CUT_OFF
    # fine beside the smallest gap between frequencies
    grid = np.linspace(0.3 * found[0], (found[-2] + found[-1]) / 2, 20001)
    # at the cut-off a wavenumber vanishes, and the determinant with it
    near = np.abs(grid - CUT_OFF) < grid[1] - grid[0]
    roots = []
    for part in np.split(grid[~near], [np.count_nonzero(grid[~near] < CUT_OFF)]):
        # of one phase on each side of the cut-off
        phase = boundary_determinants(part[len(part) // 2 :][:1], length, ends)

        def real(w: float, phase: np.ndarray = phase) -> float:
            return float((boundary_determinants(np.array([w]), length, ends) / phase)[0].real)

        sign = np.sign((boundary_determinants(part, length, ends) / phase).real)
        for i in np.flatnonzero(sign[1:] != sign[:-1]):
            roots.append(scipy.optimize.brentq(real, part[i], part[i + 1], xtol=1e-14))
    # that root of the determinant is a mode of the pinned rod alone: uniform rotation
    exact = [w for w in found[:-1] if abs(w / CUT_OFF - 1) > 1e-9]
    assert len(found[:-1]) - len(exact) == (ends == ("pinned", "pinned"))
    # round-off of a determinant whose evanescent waves differ by a factor of some 1e3
    assert roots == pytest.approx(exact, rel=1e-9)


@pytest.mark.parametrize("ends", PAIRINGS)
def test_no_mode_is_missed_or_doubled_beside_a_fine_lattice(ends: tuple[End, End]) -> None:
    length, pairs = 8.0, 101
    fine = replace(PAPER, spacing_nm=length / (pairs - 1))
    blocks = np.tile(fine.spacing_nm * fine.mass, (pairs, 1, 1))
    # the ends of the rod are base pairs that own half a cell
    blocks[[0, -1]] /= 2
    where = {
        kind: [i for i, end in zip((0, -1), ends, strict=True) if end == kind] for kind in ends
    }
    chain = FiniteChain(fine, pairs, where.get("held", ()), blocks, where.get("pinned", ()))
    rod = FiniteRod(PAPER, length, ends)
    lattice = chain.frequencies_rad_per_ps
    assert np.count_nonzero(lattice == 0) == rod.zero_modes
    exact = rod.frequencies_rad_per_ps(50)
    assert exact[-1] > 1.2 * CUT_OFF
    # the lattice's error (w h/V)^2/24 with the slowest speed 5 nm/10 ps, and of the same order from
    # the shear of its links
    assert lattice[rod.zero_modes :][:50] == pytest.approx(
        exact, rel=3 * (exact[-1] * fine.spacing_nm / 0.5) ** 2 / 24
    )


@pytest.mark.parametrize("seed", [0, 1])
@pytest.mark.parametrize("ends", [("free", "free"), ("held", "pinned")])
def test_modes_of_a_coupled_rod_are_the_limit_of_its_lattice(
    seed: int, ends: tuple[End, End]
) -> None:
    rod, length = coupled_rod(seed), 4.0
    exact = FiniteRod(rod, length, ends).frequencies_rad_per_ps(12)
    errors = []
    for pairs in (31, 61):
        fine = replace(rod, spacing_nm=length / (pairs - 1))
        blocks = np.tile(fine.spacing_nm * fine.mass, (pairs, 1, 1))
        blocks[[0, -1]] /= 2
        held, pinned = ((), ()) if ends[0] == "free" else ((0,), (-1,))
        lattice = FiniteChain(fine, pairs, held, blocks, pinned).frequencies_rad_per_ps
        errors.append(lattice[lattice > 0][:12] / exact - 1)
    assert np.abs(errors[1]).max() < 2e-3
    # second order in the spacing; extrapolated, only the fourth order is left: the second squared
    extrapolated = (4 * errors[1] - errors[0]) / 3
    assert extrapolated == pytest.approx(0, abs=10 * np.abs(errors[0]).max() ** 2)


@settings(max_examples=15, deadline=None)
@given(
    seed=st.integers(0, 10**6),
    first=st.sampled_from(["free", "held", "pinned"]),
    last=st.sampled_from(["free", "held", "pinned"]),
    length=st.floats(0.3, 15),
)
def test_the_count_steps_by_one_at_every_frequency_and_ends_may_be_exchanged(
    seed: int, first: End, last: End, length: float
) -> None:
    rod = FiniteRod(coupled_rod(seed), length, (first, last))
    found = rod.frequencies_rad_per_ps(8)
    # below and above each by more than round-off; of two that close, both are counted
    step = 1e-7 * found[-1]
    count = rod.count_below(np.concatenate([found - step, found + step])) - rod.zero_modes
    below, above = np.split(count, 2)
    assert np.all(below <= np.arange(8)) and np.all(above >= np.arange(1, 9))
    # the same rod from its other end: s -> -s turns connection and couplings of its strains
    turned = FiniteRod(_turned(rod.rod), length, (last, first))
    assert turned.zero_modes == rod.zero_modes
    # round-off, relative to the largest since the lowest bends are soft
    assert turned.frequencies_rad_per_ps(8) == pytest.approx(found, abs=1e-9 * found[-1])


def _turned(rod: Rod) -> Rod:
    """Return the rod seen with axes 2 and 3 reversed, so that its last end comes first."""
    half_turn = np.diag([1.0, -1.0, -1.0])
    both = scipy.linalg.block_diag(half_turn, half_turn)
    # strains change sign once more, since they are derivatives along the reversed axis
    return replace(
        rod,
        stiffness=both @ rod.stiffness @ both,
        inertia_Da_nm=half_turn @ rod.inertia_Da_nm @ half_turn,
        gamma0=-half_turn @ rod.gamma0,
        omega0_rad_per_nm=-half_turn @ rod.omega0_rad_per_nm,
        centre_nm=half_turn @ rod.centre_nm,
    )


def test_shapes_are_mass_normalised_and_make_the_static_curve_of_a_clamped_bar() -> None:
    length, points = 50.0, 100
    rod = FiniteRod(PAPER, length, ("held", "free"), COORDINATE_SETS["bend"])
    frequencies, shapes = rod.modes(3, points)
    weight = np.full(points + 1, length / points)
    weight[[0, -1]] /= 2
    density = np.array([PAPER.density_Da_per_nm, PAPER.inertia_Da_nm[0, 0]])
    overlap = np.einsum("pis,i,s,qis->pq", shapes, weight, density, shapes)
    # trapezoid rule: (3 pi/100)^2/12
    assert overlap == pytest.approx(np.eye(3), abs=1e-3)
    assert np.all(shapes[:, 0] == 0)
    # slender cantilever (Euler): kL = 1.8751041, a shape whose slope at the tip is 1.3765 u/L;
    # shear and rotary inertia add (pi radius of gyration/L)^2 of some 1e-3
    assert shapes[0, -1, 1] / shapes[0, -1, 0] * length == pytest.approx(1.3765, rel=3e-3)
    k = 1.8751041 / length
    euler = k**2 * np.sqrt(PAPER.stiffness[4, 4] / PAPER.density_Da_per_nm)
    assert frequencies[0] == pytest.approx(euler, rel=3e-3)


def test_degenerate_bends_of_two_planes_have_orthogonal_shapes() -> None:
    rod = FiniteRod(PAPER, 8.0, ("free", "free"))
    frequencies, shapes = rod.modes(2, 60)
    assert frequencies[0] == pytest.approx(frequencies[1], rel=1e-12)
    first, second = (PAPER.mass**0.5 @ shape.T for shape in shapes)
    # trapezoid rule, as above
    assert abs(np.sum(first * second)) < 1e-3 * np.linalg.norm(first) * np.linalg.norm(second)


def test_where_the_half_wavelength_rule_holds_and_what_replaces_it() -> None:
    def row(wave, ends, length=24 * 0.34, count=3):
        return half_wave_table(PAPER, length, wave, ends, count)

    # the reference is rounded to 0.01
    ratios = [wave.ratio for wave in row("bend", ("held", "held"))]
    assert ratios == pytest.approx([2.08, 1.38, 1.19], abs=0.006)
    for wave, ends in (
        ("bend", ("pinned", "pinned")),
        ("extension", ("held", "held")),
        ("extension", ("free", "free")),
        ("twist", ("held", "held")),
    ):
        # exact; round-off
        assert [mode.ratio for mode in row(wave, ends)] == pytest.approx([1, 1, 1], rel=1e-9)
    clamped_free = [mode.half_waves for mode in row("extension", ("held", "free"))]
    assert clamped_free == pytest.approx([0.5, 1.5, 2.5], rel=1e-9)
    # a slender rod, 500 nm: roots of Euler's bar over pi, 1.50562 for the first of both held ends;
    # shear shortens by the radius of gyration over the length, some 1e-3 times (n + 1/2)
    for ends, expected in (
        (("held", "held"), [1.5056, 2.49975, 3.50001]),
        (("free", "free"), [1.5056, 2.49975, 3.50001]),
        (("held", "free"), [0.59686, 1.49418, 2.50025]),
        (("held", "pinned"), [1.24988, 2.25, 3.25]),
        (("free", "pinned"), [1.24988, 2.25, 3.25]),
    ):
        found = [mode.half_waves for mode in row("bend", ends, length=500.0)]
        assert found == pytest.approx(expected, rel=3e-3)
    # above the cut-off both branches mix and no bend is counted
    assert len(row("bend", ("free", "free"), 4.0, 9)) < 9


@pytest.mark.parametrize("shear_factor", [1.0, 100.0, 1e4])
def test_stiff_shear_makes_the_bar_of_rayleigh(shear_factor: float) -> None:
    stiffness = PAPER.stiffness.copy()
    stiffness[[0, 1], [0, 1]] *= shear_factor
    rod = replace(PAPER, stiffness=stiffness)
    found = FiniteRod(
        rod, 8.0, ("pinned", "pinned"), COORDINATE_SETS["bend"]
    ).frequencies_rad_per_ps(4)
    q = np.arange(1, 5) * np.pi / 8.0
    branches = bend_shear_branches(rod, np.append(0.0, q), lattice=False)
    # round-off: the stiffness of the parts exceeds that of the bend by shear_factor (8 nm/part)^2
    assert found == pytest.approx(np.sort(np.append(branches[1:, 0], branches[:, 1]))[:4], rel=1e-7)


def test_a_rod_without_rise_keeps_its_bend_and_shear_apart() -> None:
    flat = replace(PAPER, gamma0=np.zeros(3))
    found = FiniteRod(flat, 8.0, ("held", "held"), COORDINATE_SETS["bend"]).frequencies_rad_per_ps(
        10
    )
    speeds = np.array([PAPER.stiffness[0, 0] / 1, PAPER.stiffness[4, 4] / 1])
    speeds = np.sqrt(speeds / [PAPER.density_Da_per_nm, PAPER.inertia_Da_nm[0, 0]])
    rule = np.sort(np.outer(np.arange(1, 11) * np.pi / 8.0, speeds).ravel())
    # round-off
    assert found == pytest.approx(rule[:10], rel=1e-10)
    # rise 1e-9 is the same rod
    nearly = replace(PAPER, gamma0=np.array([0, 0, 1e-9]))
    close = FiniteRod(
        nearly, 8.0, ("held", "held"), COORDINATE_SETS["bend"]
    ).frequencies_rad_per_ps(10)
    assert close == pytest.approx(found, rel=1e-9)


def test_impossible_rods_are_refused() -> None:
    with pytest.raises(InputError, match="length"):
        FiniteRod(PAPER, 0.0, ("free", "free"))
    with pytest.raises(InputError, match="ends"):
        FiniteRod(PAPER, 1.0, ("free", "clamped"))  # type: ignore[arg-type]
    with pytest.raises(InputError, match="coupled to others"):
        FiniteRod(Rod.paper(twisted=True), 1.0, ("free", "free"), COORDINATE_SETS["bend"])
    with pytest.raises(InputError, match="at least one"):
        FiniteRod(PAPER, 1.0, ("free", "free")).frequencies_rad_per_ps(0)
