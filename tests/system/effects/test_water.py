"""A box of water and ions around ten base pairs."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import openmm
import pytest
from numpy.typing import NDArray
from openmm import app
from scipy.spatial import cKDTree

from dnawaves.system.effects.water import (
    WATER_FILES,
    Solvated,
    along_z,
    build_explicit,
    solvate,
)
from dnawaves.system.forces import charges_e, nonbonded_force
from dnawaves.system.geometry import helix_frame, sugar_anchors

SEQUENCE = "CGATCGATCG"
PHOSPHATES = 2 * len(SEQUENCE) - 2
PADDING_nm = 0.5
SALT_M = 0.15


class Box:
    def __init__(self, duplex: Any, water: Any, salt_M: float = SALT_M) -> None:
        self.duplex = duplex
        self.field = app.ForceField("amber19/DNA.OL21.xml", WATER_FILES[water])
        self.solvated: Solvated = solvate(
            duplex.topology,
            duplex.positions_nm,
            duplex.frame,
            self.field,
            water,
            padding_nm=PADDING_nm,
            salt_M=salt_M,
        )
        self.system = build_explicit(self.solvated.topology, self.field)
        self.count = {
            name: sum(residue.name == name for residue in self.solvated.topology.residues())
            for name in ("HOH", "NA", "CL")
        }


@pytest.fixture(scope="module", params=["OPC", "TIP3P"])
def box(request: pytest.FixtureRequest, bare: Callable[[str], Any]) -> Box:
    return Box(bare(SEQUENCE), request.param)


def test_the_box_is_neutral_and_as_salty_as_declared(box: Box) -> None:
    # Amber's charges are written with four to six digits.
    assert sum(charges_e(nonbonded_force(box.system))) == pytest.approx(0, abs=1e-3)
    assert box.count["NA"] == PHOSPHATES + box.count["CL"]
    # One ion pair per 55.4/0.15 molecules of water and ions, rounded (55.4 mol/l of water).
    solvent = sum(box.count.values())
    assert abs(box.count["CL"] - solvent * SALT_M / 55.4) <= 1


def test_the_water_has_waters_density(box: Box) -> None:
    place, lengths = box.solvated.positions_nm, box.solvated.box_nm
    duplex = place[: box.solvated.duplex_atoms]
    middle = (duplex.min(axis=0) + duplex.max(axis=0)) / 2
    oxygens = np.array(
        [
            atom.index
            for atom in box.solvated.topology.atoms()
            if atom.residue.name == "HOH" and atom.name == "O"
        ]
    )
    anywhere = middle + np.random.default_rng(0).uniform(-0.5, 0.5, (100_000, 3)) * lengths

    def in_bulk(points: NDArray[np.float64]) -> NDArray[np.bool_]:
        # Waters that would touch the duplex or an image are left out of the box at first.
        faces = np.min(lengths / 2 - np.abs(points - middle), axis=1)
        return (cKDTree(duplex).query(points)[0] > 0.5) & (faces > 0.15)

    volume = in_bulk(anywhere).mean() * lengths.prod()
    assert volume > 10
    # 33.4 molecules/nm³ is water at 298 K. 500 of them: 4 %; and the barostat's work is to come.
    assert in_bulk(place[oxygens]).sum() / volume == pytest.approx(33.4, rel=0.1)


def test_the_box_holds_the_duplex_along_z(box: Box) -> None:
    count = box.solvated.duplex_atoms
    assert count == box.duplex.topology.getNumAtoms()
    place = box.solvated.positions_nm[:count]
    axis = helix_frame(place[sugar_anchors(box.duplex.topology)]).axis
    np.testing.assert_allclose(axis, [0, 0, 1], atol=1e-6)
    # A rigid turn: distances are kept.
    before, after = (np.linalg.norm(x[0] - x[1:], axis=1) for x in (box.duplex.positions_nm, place))
    np.testing.assert_allclose(before, after, atol=1e-12)
    room = box.solvated.box_nm - np.ptp(place, axis=0)
    assert (room >= 2 * PADDING_nm - 1e-12).all()
    assert room[2] == pytest.approx(2 * PADDING_nm)
    assert abs(place[:, 2].min() + place[:, 2].max()) < 1e-12


def test_water_is_rigid_and_nothing_removes_the_centre_of_masss_motion(box: Box) -> None:
    assert box.system.getNumConstraints() == 3 * box.count["HOH"]
    names = {force.getName() for force in box.system.getForces()}
    assert "CMMotionRemover" not in names
    assert nonbonded_force(box.system).getNonbondedMethod() == openmm.NonbondedForce.PME


def test_it_runs(box: Box) -> None:
    integrator = openmm.LangevinMiddleIntegrator(300, 5, 0.001)
    integrator.setRandomNumberSeed(1)
    context = openmm.Context(
        box.system, integrator, openmm.Platform.getPlatformByName("CPU"), {"Threads": "2"}
    )
    context.setPositions(box.solvated.positions_nm)
    openmm.LocalEnergyMinimizer.minimize(context, 100.0, 30)
    context.setVelocitiesToTemperature(300, 1)
    integrator.step(30)
    state = context.getState(getEnergy=True)
    # Minus 40 kJ/mol a molecule is bulk water's potential energy; a box with clashes is far above.
    assert -70 < state.getPotentialEnergy()._value / box.count["HOH"] < -25


def test_opc_has_its_charge_where_its_authors_put_it(bare: Callable[[str], Any]) -> None:
    box = Box(bare("CGAT"), "OPC", salt_M=0.0)
    residue = next(r for r in box.solvated.topology.residues() if r.name == "HOH")
    place = {atom.name: box.solvated.positions_nm[atom.index] for atom in residue.atoms()}
    # Izadi, Anandakrishnan & Onufriev 2014 (J. Phys. Chem. Lett. 5, 3863): 0.1594 A.
    assert np.linalg.norm(place["M"] - place["O"]) == pytest.approx(0.01594, abs=1e-5)


def test_the_same_seed_gives_the_same_box(bare: Callable[[str], Any]) -> None:
    duplex = bare("CGAT")
    one, other = (Box(duplex, "TIP3P").solvated.positions_nm for _ in range(2))
    np.testing.assert_array_equal(one, other)


def test_force_is_minus_the_gradient(bare: Callable[[str], Any], evaluator: Any) -> None:
    box = Box(bare("CGAT"), "TIP3P", salt_M=0.5)
    evaluate, place = evaluator(box.system), moved_apart(box)
    forces, step = evaluate(place)[1], 1e-6
    # One atom at a time: the energy jumps by some 0.01 kJ/mol where a pair crosses the cutoff.
    for name in ("P", "N1", "Na", "Cl", "O", "H1"):
        atom = [a.index for a in box.solvated.topology.atoms() if a.name == name][-1]
        shift = np.zeros_like(place)
        shift[atom] = step * np.array([0.6, 0.0, 0.8])
        slope = (evaluate(place - shift)[0] - evaluate(place + shift)[0]) / (2 * step)
        # Round-off: 1e-16 of 1e6 kJ/mol of pair terms over the step.
        assert slope == pytest.approx(forces[atom] @ shift[atom] / step, abs=1e-2)
        assert np.linalg.norm(forces[atom]) > 10


def moved_apart(box: Box) -> NDArray[np.float64]:
    context = openmm.Context(
        box.system, openmm.VerletIntegrator(0.001), openmm.Platform.getPlatformByName("CPU")
    )
    context.setPositions(box.solvated.positions_nm)
    openmm.LocalEnergyMinimizer.minimize(context, 100.0, 20)
    return np.array(context.getState(getPositions=True).getPositions(asNumpy=True)._value)


def test_along_z_puts_base_pair_one_at_the_bottom(bare: Callable[[str], Any]) -> None:
    duplex = bare("CGAT")
    upright = along_z(duplex.positions_nm, duplex.frame)
    assert upright[duplex.pairs == 0, 2].mean() < upright[duplex.pairs == 3, 2].mean()
