"""Generalised Born solvents: OBC2's two forms are one model, and limits that are known."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import openmm
import pytest
import scipy.constants
from openmm import app

from dnawaves.errors import InputError
from dnawaves.system.effects.implicit import (
    custom_born,
    inverse_debye_length_per_nm,
    native_obc2,
    obc2_parameters,
)
from dnawaves.system.forces import charges_e, nonbonded_force

FILE = "amber19/DNA.OL21.xml"
# e²/(4 pi eps0) in kJ/mol nm, and as OpenMM's generalised Born scripts write it.
COULOMB = scipy.constants.e**2 / (4 * np.pi * scipy.constants.epsilon_0) * scipy.constants.N_A * 1e6
SCRIPTS_COULOMB = 138.935485
OFFSET_nm = 0.009


@pytest.fixture(scope="module")
def duplex(bare: Callable[[str], Any]) -> Any:
    return bare("CGATCG")


def charges(duplex: Any) -> list[float]:
    # The System must outlive its force.
    system = duplex.system()
    return charges_e(nonbonded_force(system))


def lone(symbols: str) -> app.Topology:
    topology = app.Topology()
    chain = topology.addChain()
    for symbol in symbols:
        residue = topology.addResidue("X", chain)
        topology.addAtom(symbol, app.Element.getBySymbol(symbol), residue)
    return topology


@pytest.mark.parametrize("surface_area", [False, True])
def test_native_obc2_is_the_custom_form(duplex: Any, only: Any, surface_area: bool) -> None:
    native = native_obc2(duplex.topology, charges(duplex), surface_area=surface_area)
    custom = custom_born("OBC2", duplex.topology, FILE, surface_area=surface_area)
    generator = np.random.default_rng(1)
    shaken = duplex.positions_nm + generator.normal(0, 0.005, duplex.positions_nm.shape)
    energies, forces = zip(
        *(only(duplex.masses_Da, force)(shaken) for force in (native, custom)), strict=True
    )
    assert energies[0] < -5000
    # The two hold Coulomb's constant to 9 digits: they differ by 2e-7 of the energy and the forces.
    assert abs(SCRIPTS_COULOMB / COULOMB - 1) < 3e-7
    assert energies[0] == pytest.approx(energies[1], rel=3e-7)
    np.testing.assert_allclose(forces[0], forces[1], atol=3e-7 * np.abs(forces[1]).max())
    if not surface_area:
        # That constant is their whole difference: with it, equal to round-off.
        assert energies[0] * SCRIPTS_COULOMB / COULOMB == pytest.approx(energies[1], rel=1e-9)


def test_parameters_are_those_that_openmm_sets_for_obc2(duplex: Any) -> None:
    custom = custom_born("OBC2", duplex.topology, FILE)
    theirs = np.array(
        [custom.getParticleParameters(index)[1:] for index in range(custom.getNumParticles())]
    )
    ours = obc2_parameters(duplex.topology)
    # Theirs are the radius less the offset, and the scale times that.
    np.testing.assert_allclose(ours[:, 0] - OFFSET_nm, theirs[:, 0], atol=1e-12)
    np.testing.assert_allclose(ours[:, 1], theirs[:, 1] / theirs[:, 0], atol=1e-12)


@pytest.mark.parametrize("model", ["native", "OBC2", "GBn2"])
def test_force_is_minus_the_gradient(
    duplex: Any, only: Any, slope_and_force: Any, model: Any
) -> None:
    if model == "native":
        force: openmm.Force = native_obc2(duplex.topology, charges(duplex), surface_area=True)
    else:
        force = custom_born(model, duplex.topology, FILE, salt_M=0.15, surface_area=True)
    evaluate = only(duplex.masses_Da, force)
    for slope, along in slope_and_force(evaluate, duplex.positions_nm):
        # Round-off: 1e-16 of the pair terms, 1e7 kJ/mol together, over the step of 1e-5 nm.
        assert slope == pytest.approx(along, abs=1e-3)
        assert abs(along) > 1


@pytest.mark.parametrize("charge", [-1.0, 2.0])
def test_an_ion_has_borns_energy(only: Any, charge: float) -> None:
    force = native_obc2(lone("O"), [charge], solvent_dielectric=80.0)
    # Born 1920, with Amber's radius less the offset.
    born = -COULOMB / 2 * (1 - 1 / 80) * charge**2 / (0.15 - OFFSET_nm)
    energy, forces = only(np.array([16.0]), force)(np.zeros((1, 3)))
    # OpenMM's Coulomb constant is of 2010: 1e-9.
    assert energy == pytest.approx(born, rel=1e-8)
    assert not forces.any()


def test_distant_charges_feel_the_solvents_dielectric(only: Any) -> None:
    evaluate = only(np.array([16.0, 16.0]), native_obc2(lone("OO"), [1.0, -1.0]))
    distance = 10.0
    solvent = evaluate(np.array([[0.0, 0, 0], [0, 0, distance]]))[1][0, 2]
    attraction = COULOMB / distance**2
    # At 10 nm radii of 0.14 nm leave no trace but each charge's in the other's cavity: (0.14/10)^4
    # of the Born energy's 500 kJ/mol.
    assert attraction + solvent == pytest.approx(attraction / 78.5, abs=1e-5)


def test_debye_length_of_a_tenth_molar_salt() -> None:
    # 0.304 nm/sqrt(M) at 25 °C (Israelachvili, Intermolecular and Surface Forces, 14.35), 3 digits.
    debye = 0.73 / inverse_debye_length_per_nm(0.1, 298.15, 78.5)
    assert debye == pytest.approx(0.304 / np.sqrt(0.1), rel=2e-3)
    assert inverse_debye_length_per_nm(0.0, 298.15, 78.5) == 0.0


def test_salt_screens_the_phosphates(duplex: Any, only: Any) -> None:
    energies = [
        only(duplex.masses_Da, custom_born("OBC2", duplex.topology, FILE, salt_M=salt))(
            duplex.positions_nm
        )[0]
        for salt in (0.0, 0.1, 1.0)
    ]
    # Ions around a charged solute lower its energy, the more the more of them there are.
    assert energies[0] > energies[1] > energies[2]
    assert energies[0] - energies[1] > 10


def test_elements_without_parameters_are_refused() -> None:
    with pytest.raises(InputError, match="element Na"):
        native_obc2(lone_sodium(), [1.0])


def lone_sodium() -> app.Topology:
    topology = app.Topology()
    residue = topology.addResidue("NA", topology.addChain())
    topology.addAtom("NA", app.element.sodium, residue)
    return topology
