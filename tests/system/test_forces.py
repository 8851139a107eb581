"""The environment's forces: neutral phosphates, no jump at the cutoff, a gradient."""

from __future__ import annotations

import copy
from collections.abc import Callable

import numpy as np
import openmm
import pytest
import scipy.constants
from numpy.typing import NDArray
from openmm import unit

from dnawaves.system.duplex import SimulatedDuplex
from dnawaves.system.forces import FORCE_FIELD_FILES, charges_e, nonbonded_force
from dnawaves.system.hessian import ReferenceForces

AsBuilt = Callable[..., SimulatedDuplex]
SEQUENCE = "CGAT"
PHOSPHATES = 2 * len(SEQUENCE) - 2
# e²/(4 pi eps0) in kJ/mol nm.
COULOMB = scipy.constants.e**2 / (4 * np.pi * scipy.constants.epsilon_0) * scipy.constants.N_A * 1e6
CUTOFF_NM, SWITCH_NM = 0.9, 0.8


@pytest.mark.parametrize("fraction", [0.0, 0.25, 1.0])
def test_total_charge_is_that_of_the_bare_phosphates(as_built: AsBuilt, fraction: float) -> None:
    duplex = as_built(SEQUENCE, counterion_fraction=fraction)
    charge = sum(charges_e(nonbonded_force(duplex.system)))
    # Amber's charges are written with four to six digits and 250 of them add up.
    assert charge == pytest.approx(-PHOSPHATES * (1 - fraction), abs=1e-4)


def test_counterions_sit_in_equal_parts_on_p_op1_op2(as_built: AsBuilt) -> None:
    bare, neutral = (as_built(SEQUENCE, counterion_fraction=f) for f in (0, 0.6))
    added = np.subtract(*(charges_e(nonbonded_force(duplex.system)) for duplex in (neutral, bare)))
    names = np.array([atom.name for atom in bare.topology.atoms()])
    charged = np.isin(names, ["P", "OP1", "OP2"])
    assert charged.sum() == 3 * PHOSPHATES
    # 0.6/3 each, to the round-off of the sum.
    np.testing.assert_allclose(added, np.where(charged, 0.2, 0.0), atol=1e-12)


@pytest.mark.parametrize("fraction", [0.0, 0.6, 1.0])
def test_one_four_interactions_keep_ambers_scaling(as_built: AsBuilt, fraction: float) -> None:
    duplex = as_built(SEQUENCE, counterion_fraction=fraction)
    force = nonbonded_force(duplex.system)
    charges = charges_e(force)
    ratios = []
    for index in range(force.getNumExceptions()):
        i, j, product, _, _ = force.getExceptionParameters(index)
        # Bonded atoms and atoms of one angle do not act on each other at all.
        if product._value:
            ratios.append(product._value / (charges[i] * charges[j]))
    # One per dihedral angle's ends: more of them than atoms.
    assert len(ratios) > duplex.topology.getNumAtoms()
    # Amber divides 1-4 Coulomb by 1.2; the file has 0.8333333333 (ten digits).
    np.testing.assert_allclose(ratios, 1 / 1.2, rtol=1e-9)


def test_nothing_removes_the_centre_of_masss_motion_and_nothing_is_rigid(
    as_built: AsBuilt,
) -> None:
    system = as_built(SEQUENCE).system
    kinds = {type(force) for force in system.getForces()}
    assert kinds == {
        openmm.HarmonicBondForce,
        openmm.HarmonicAngleForce,
        openmm.PeriodicTorsionForce,
        openmm.NonbondedForce,
    }
    assert system.getNumConstraints() == 0


class TwoAtoms:
    """The environment's own nonbonded force with all but two phosphorus atoms made inert."""

    def __init__(self, duplex: SimulatedDuplex, *, charged: bool, dispersing: bool) -> None:
        system = copy.deepcopy(duplex.system)
        for index in reversed(range(system.getNumForces())):
            if not isinstance(system.getForce(index), openmm.NonbondedForce):
                system.removeForce(index)
        force = nonbonded_force(system)
        chains = duplex.topology.chains()
        self._atoms = [next(a.index for a in c.atoms() if a.name == "P") for c in chains]
        for index in range(force.getNumExceptions()):
            i, j, _, sigma, _ = force.getExceptionParameters(index)
            force.setExceptionParameters(index, i, j, 0, sigma, 0)
        for index in range(force.getNumParticles()):
            charge, sigma, epsilon = force.getParticleParameters(index)
            acts = index in self._atoms
            force.setParticleParameters(
                index, charge * (acts and charged), sigma, epsilon * (acts and dispersing)
            )
            if acts:
                self.charge_e, self.sigma_nm, self.epsilon = charge._value, sigma._value, epsilon
        self.epsilon = self.epsilon._value
        self._forces = ReferenceForces(system)
        self._positions = duplex.positions_nm.copy()

    def __call__(self, distance_nm: float) -> tuple[float, float]:
        """Return energy and repulsion at a distance."""
        one, other = self._atoms
        along = np.array([0.6, 0.0, 0.8])
        self._positions[other] = self._positions[one] + distance_nm * along
        energy, forces = self._forces(self._positions)
        np.testing.assert_allclose(forces[one], -forces[other], atol=1e-12)
        return energy, float(forces[other] @ along)


def test_coulomb_force_falls_to_zero_at_the_cutoff(as_built: AsBuilt) -> None:
    pair = TwoAtoms(as_built(SEQUENCE, counterion_fraction=0), charged=True, dispersing=False)
    strength = COULOMB * pair.charge_e**2
    assert strength > 100
    distances = np.array([0.4, 0.6, 0.8, 0.89, CUTOFF_NM - 1e-9])
    energies, forces = np.transpose([pair(distance) for distance in distances])
    # Reaction field of a conductor: field of a charge inside an earthed sphere. 1e-8: digits of
    # OpenMM's Coulomb constant and the dielectric constant 1e9 in place of infinity.
    np.testing.assert_allclose(
        forces, strength * (1 / distances**2 - distances / CUTOFF_NM**3), atol=1e-8 * strength
    )
    np.testing.assert_allclose(
        energies,
        strength * (1 / distances + distances**2 / (2 * CUTOFF_NM**3) - 1.5 / CUTOFF_NM),
        atol=1e-8 * strength,
    )
    # No jump: the last force inside is zero as it is outside.
    assert abs(forces[-1]) < 1e-8 * strength
    assert pair(CUTOFF_NM + 1e-9) == (0.0, 0.0)


def test_lennard_jones_is_switched_off_without_a_jump(as_built: AsBuilt) -> None:
    pair = TwoAtoms(as_built(SEQUENCE), charged=False, dispersing=True)

    def plain(distance: float) -> float:
        sixth = (pair.sigma_nm / distance) ** 6
        return 4 * pair.epsilon * (sixth**2 - sixth)

    distances = np.array([0.4, 0.7, 0.82, 0.85, 0.88])
    x = np.clip((distances - SWITCH_NM) / (CUTOFF_NM - SWITCH_NM), 0, 1)
    switch = 1 - 10 * x**3 + 15 * x**4 - 6 * x**5
    energies, forces = np.transpose([pair(distance) for distance in distances])
    # Round-off of a double only.
    np.testing.assert_allclose(energies, plain(distances) * switch, rtol=1e-12)
    step = 1e-6
    slope = [(pair(d - step)[0] - pair(d + step)[0]) / (2 * step) for d in distances]
    # Central differences of an energy of 1e-3 to 1 kJ/mol: 1e-16/1e-6 and step² f'''/6.
    np.testing.assert_allclose(forces, slope, rtol=1e-6, atol=1e-9)
    scale = abs(pair(SWITCH_NM)[1])
    for kink in (SWITCH_NM, CUTOFF_NM):
        # A continuous force of slope below 100 scale/nm changes by less than 1e-6 in 1e-9 nm.
        assert abs(pair(kink - 1e-9)[1] - pair(kink + 1e-9)[1]) < 1e-6 * scale
    assert pair(CUTOFF_NM + 1e-9) == (0.0, 0.0)


def test_every_force_field_builds_and_they_differ(as_built: AsBuilt) -> None:
    duplexes = {name: as_built(SEQUENCE, force_field=name) for name in FORCE_FIELD_FILES}
    positions_nm = duplexes["OL21"].positions_nm
    energies = {
        name: ReferenceForces(duplex.system)(positions_nm)[0] for name, duplex in duplexes.items()
    }
    # They differ in torsions only, by kJ/mol per nucleotide; the totals are near -5000.
    values = sorted(energies.values())
    assert np.diff(values).min() > 1.0
    assert values[-1] - values[0] < 200
    for duplex in duplexes.values():
        assert sum(charges_e(nonbonded_force(duplex.system))) == pytest.approx(0, abs=1e-4)


def shaken(duplex: SimulatedDuplex) -> NDArray[np.float64]:
    """Return positions off any minimum, so that every kind of force is large."""
    generator = np.random.default_rng(1)
    return duplex.positions_nm + generator.normal(0, 0.003, duplex.positions_nm.shape)


def test_force_is_minus_the_gradient_of_the_energy(as_built: AsBuilt) -> None:
    duplex = as_built(SEQUENCE)
    evaluate, positions_nm = ReferenceForces(duplex.system), shaken(duplex)
    force = evaluate(positions_nm)[1]
    generator = np.random.default_rng(2)
    step = 1e-5
    for _ in range(6):
        direction = generator.normal(size=positions_nm.shape)
        direction /= np.linalg.norm(direction)
        rise = evaluate(positions_nm + step * direction)[0]
        fall = evaluate(positions_nm - step * direction)[0]
        # Step² times the third derivative, 1e-10 · 1e6, and round-off, 1e-16 · 5e3 / 1e-5.
        assert (fall - rise) / (2 * step) == pytest.approx(np.sum(force * direction), abs=2e-4)
    assert np.linalg.norm(force) > 1e4


def test_the_platform_that_runs_agrees_with_the_one_that_minimises(as_built: AsBuilt) -> None:
    duplex = as_built(SEQUENCE)
    positions_nm = shaken(duplex)
    context = openmm.Context(
        duplex.system,
        openmm.VerletIntegrator(0.001),
        openmm.Platform.getPlatformByName("CPU"),
        {"Threads": "1"},
    )
    context.setPositions(positions_nm)
    state = context.getState(getForces=True)
    forces = state.getForces(asNumpy=True).value_in_unit(unit.kilojoule_per_mole / unit.nanometer)
    exact = ReferenceForces(duplex.system)(positions_nm)[1]
    # The CPU platform's nonbonded forces are in single precision (6e-8) and cancel in part.
    assert np.abs(forces - exact).max() < 3e-6 * np.abs(exact).max()
