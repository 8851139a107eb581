"""The Hessian against second derivatives in closed form, and its shortcuts."""

from __future__ import annotations

from typing import Any

import numpy as np
import openmm
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.spatial.distance import pdist

from dnawaves.system.hessian import Hessian, ReferenceForces, independent_groups

Array = NDArray[np.float64]
CUTOFF_NM, SWITCH_NM = 0.8, 0.6
SIGMA_NM, EPSILON = 0.3, 0.5
BOND_NM, SPRING = 0.32, 2e4
COULOMB = 138.935456
BEADS = 36


def bead_chain() -> tuple[openmm.System, Array, Array]:
    """Return a chain of charged Lennard-Jones beads ten times as long as the cutoff."""
    generator = np.random.default_rng(4)
    positions_nm = np.zeros((BEADS, 3))
    positions_nm[:, 1] = 0.3 * np.arange(BEADS)
    positions_nm += generator.uniform(-0.05, 0.05, positions_nm.shape)
    charges = generator.uniform(-0.5, 0.5, BEADS)
    system = openmm.System()
    force = openmm.NonbondedForce()
    force.setNonbondedMethod(openmm.NonbondedForce.CutoffNonPeriodic)
    force.setCutoffDistance(CUTOFF_NM)
    force.setReactionFieldDielectric(1e9)
    force.setUseSwitchingFunction(True)
    force.setSwitchingDistance(SWITCH_NM)
    bonds = openmm.HarmonicBondForce()
    for bead, charge in enumerate(charges):
        system.addParticle(12.0)
        force.addParticle(charge, SIGMA_NM, EPSILON)
        if bead:
            bonds.addBond(bead - 1, bead, BOND_NM, SPRING)
    system.addForce(force)
    system.addForce(bonds)
    return system, positions_nm, charges


def pair_derivatives(r: float, product: float, bonded: bool) -> tuple[float, float]:
    """Return the first and second derivative of a pair's energy by its distance."""
    first = second = 0.0
    if bonded:
        first, second = SPRING * (r - BOND_NM), SPRING
    if r >= CUTOFF_NM:
        return first, second
    first += COULOMB * product * (-1 / r**2 + r / CUTOFF_NM**3)
    second += COULOMB * product * (2 / r**3 + 1 / CUTOFF_NM**3)
    sixth = (SIGMA_NM / r) ** 6
    lj = 4 * EPSILON * (sixth**2 - sixth)
    lj1 = 4 * EPSILON * (-12 * sixth**2 + 6 * sixth) / r
    lj2 = 4 * EPSILON * (156 * sixth**2 - 42 * sixth) / r**2
    width = CUTOFF_NM - SWITCH_NM
    x = max(0.0, (r - SWITCH_NM) / width)
    s = 1 - 10 * x**3 + 15 * x**4 - 6 * x**5
    s1 = (-30 * x**2 + 60 * x**3 - 30 * x**4) / width
    s2 = (-60 * x + 180 * x**2 - 120 * x**3) / width**2
    return first + lj1 * s + lj * s1, second + lj2 * s + 2 * lj1 * s1 + lj * s2


def exact_hessian(positions_nm: Array, charges: Array) -> Array:
    """Return the chain's Hessian (3 beads, 3 beads) from the pairs' derivatives."""
    hessian = np.zeros((BEADS, 3, BEADS, 3))
    for i in range(BEADS):
        for j in range(i):
            arm = positions_nm[i] - positions_nm[j]
            r = float(np.linalg.norm(arm))
            first, second = pair_derivatives(r, charges[i] * charges[j], i == j + 1)
            along = np.outer(arm, arm) / r**2
            block = second * along + first / r * (np.eye(3) - along)
            hessian[i, :, i] += block
            hessian[j, :, j] += block
            hessian[i, :, j] -= block
            hessian[j, :, i] -= block
    return hessian.reshape(3 * BEADS, 3 * BEADS)


@pytest.mark.parametrize("threads", [1, 3])
def test_hessian_of_a_bead_chain_in_closed_form(threads: int) -> None:
    system, positions_nm, charges = bead_chain()
    # Beads further apart than two cutoffs are displaced together: the shortcut is in use.
    groups = independent_groups(positions_nm, 2 * CUTOFF_NM)
    assert len(groups) < BEADS / 3
    distances = pdist(positions_nm)
    # The force has a kink at the cutoff: no pair may cross it when displaced by 1e-5 nm.
    assert np.abs(distances - CUTOFF_NM).min() > 1e-4
    hessian, asymmetry = Hessian(system, CUTOFF_NM, threads)(positions_nm)
    exact = exact_hessian(positions_nm, charges)
    # Central differences: 1e-10/6 times a fourth derivative of 1e8, in 2e4 kJ/mol/nm².
    np.testing.assert_allclose(hessian, exact, atol=1e-2)
    assert np.abs(exact).max() > 2e4
    assert asymmetry < 1e-2
    np.testing.assert_array_equal(hessian, hessian.T)


def test_number_of_threads_does_not_change_a_digit() -> None:
    system, positions_nm, _ = bead_chain()
    one, three = (Hessian(system, CUTOFF_NM, threads)(positions_nm)[0] for threads in (1, 3))
    np.testing.assert_array_equal(one, three)


def test_hessian_of_the_duplex_along_random_directions(relaxed: Any) -> None:
    duplex, hessian = relaxed.duplex, relaxed.hessian
    forces = ReferenceForces(duplex.system)
    generator = np.random.default_rng(5)
    step = 2e-6
    for _ in range(4):
        direction = generator.normal(size=duplex.positions_nm.shape)
        direction /= np.abs(direction).max()
        backward = forces(duplex.positions_nm - step * direction)[1]
        forward = forces(duplex.positions_nm + step * direction)[1]
        difference = (backward - forward).ravel() / (2 * step)
        product = hessian @ direction.ravel()
        # All atoms move at once here, by another step. Fourth derivatives times step²/6; and where
        # a pair lies within a step of the cutoff the stiffness jumps by up to 1 in 7e5 kJ/mol/nm².
        assert np.abs(difference - product).max() < 2e-6 * np.abs(product).max()


def test_hessian_of_the_duplex_has_no_force_between_atoms_out_of_reach(relaxed: Any) -> None:
    positions_nm = relaxed.duplex.positions_nm
    cutoff_nm = relaxed.duplex.spec.environment.cutoff_nm
    distances = np.linalg.norm(positions_nm[:, None] - positions_nm, axis=2)
    blocks = relaxed.hessian.reshape(len(positions_nm), 3, len(positions_nm), 3)
    strength = np.abs(blocks).max(axis=(1, 3))
    assert (distances > cutoff_nm + 1e-3).any()
    assert strength[distances > cutoff_nm + 1e-3].max() == 0.0
    # Moving everything alike costs nothing: rows add up to zero. Each of 1,134 columns has the
    # differences' error of 1e-2 at most.
    assert np.abs(blocks.sum(axis=2)).max() < 1.0


@settings(max_examples=30, deadline=None)
@given(
    st.integers(0, 2**32 - 1),
    st.integers(1, 60),
    st.floats(0.05, 3.0),
)
def test_independent_groups_are_apart_and_complete(
    seed: int, atoms: int, separation_nm: float
) -> None:
    generator = np.random.default_rng(seed)
    positions_nm = generator.uniform(0, 1, (atoms, 3)) * [1.0, 5.0, 2.0]
    groups = independent_groups(positions_nm, separation_nm)
    assert sorted(np.concatenate(groups)) == list(range(atoms))
    for group in groups:
        if len(group) > 1:
            assert pdist(positions_nm[group]).min() > separation_nm
