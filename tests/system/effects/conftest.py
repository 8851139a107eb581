"""What the tests of the effects share: a bare duplex and double-precision energies."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import openmm
import pytest
from numpy.typing import NDArray
from openmm import app

from dnawaves.duplex.build import build_duplex
from dnawaves.system.geometry import HelixFrame, helix_frame, pair_of_atoms, sugar_anchors

Array = NDArray[np.float64]
Evaluate = Callable[[Array], tuple[float, Array]]
FILE = "amber19/DNA.OL21.xml"


@dataclass(frozen=True)
class Bare:
    """A duplex as built and its force field."""

    force_field: app.ForceField
    topology: app.Topology
    positions_nm: Array

    def system(self, **options: object) -> openmm.System:
        return self.force_field.createSystem(
            self.topology, nonbondedMethod=app.NoCutoff, removeCMMotion=False, **options
        )

    @property
    def masses_Da(self) -> Array:
        return np.array([atom.element.mass._value for atom in self.topology.atoms()])

    @property
    def pairs(self) -> NDArray[np.intp]:
        return pair_of_atoms(self.topology)

    @property
    def frame(self) -> HelixFrame:
        return helix_frame(self.positions_nm[sugar_anchors(self.topology)])


@pytest.fixture(scope="session")
def bare() -> Callable[[str], Bare]:
    """Return a function of a sequence: the duplex as built."""

    def build(sequence: str) -> Bare:
        force_field = app.ForceField(FILE)
        return Bare(force_field, *build_duplex(sequence, force_field))

    return build


@pytest.fixture(scope="session")
def evaluator() -> Callable[[openmm.System], Evaluate]:
    """Return a function of a System: its energy and forces in double precision."""

    def make(system: openmm.System) -> Evaluate:
        context = openmm.Context(
            system, openmm.VerletIntegrator(0.001), openmm.Platform.getPlatformByName("Reference")
        )

        def evaluate(positions_nm: Array) -> tuple[float, Array]:
            context.setPositions(positions_nm)
            context.computeVirtualSites()
            state = context.getState(getEnergy=True, getForces=True)
            return state.getPotentialEnergy()._value, np.array(state.getForces(asNumpy=True)._value)

        return evaluate

    return make


@pytest.fixture(scope="session")
def only(evaluator: Callable[[openmm.System], Evaluate]) -> Callable[..., Evaluate]:
    """Return a function of masses and a force: energy and forces of that force alone."""

    def make(masses_Da: Array, force: openmm.Force) -> Evaluate:
        return evaluator(system_of(masses_Da, force))

    return make


@pytest.fixture(scope="session")
def bodies() -> Callable[..., openmm.System]:
    """Return a function of masses and forces: the System of particles under these forces alone."""
    return system_of


def system_of(masses_Da: Array, *forces: openmm.Force) -> openmm.System:
    system = openmm.System()
    for mass in masses_Da:
        system.addParticle(mass)
    for force in forces:
        system.addForce(force)
    return system


@pytest.fixture(scope="session")
def slope_and_force() -> Callable[..., list[tuple[float, float]]]:
    """Return minus the energy's slope beside the force along some random directions."""

    def compare(
        evaluate: Evaluate, positions_nm: Array, directions: int = 3, step: float = 1e-5
    ) -> list[tuple[float, float]]:
        generator = np.random.default_rng(5)
        force = evaluate(positions_nm)[1]
        found = []
        for _ in range(directions):
            direction = generator.normal(size=positions_nm.shape)
            direction /= np.linalg.norm(direction)
            fall = evaluate(positions_nm - step * direction)[0]
            rise = evaluate(positions_nm + step * direction)[0]
            found.append(((fall - rise) / (2 * step), float(np.sum(force * direction))))
        return found

    return compare
