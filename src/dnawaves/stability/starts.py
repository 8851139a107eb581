"""Duplexes of any length and sequence, and starts that are bent, overtwisted or clash."""

from __future__ import annotations

from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from dnawaves.errors import SimulationError
from dnawaves.scene.environment import Relaxation
from dnawaves.stability.case import Found
from dnawaves.stability.judge import stopped
from dnawaves.stability.samples import ANNEAL_PS, built, context_of, relaxed, settled
from dnawaves.system.duplex import SimulatedDuplex
from dnawaves.system.relax import anneal, relax, started
from dnawaves.trajectory.guard import exploded
from dnawaves.trajectory.verlet import leapfrog
from dnawaves.units import A_PER_NM

Array = NDArray[np.float64]


def length(unit: str, pairs: int, steps: int) -> Found:
    """Return the rise (Å) of a duplex that is built, minimised and moved by some steps."""
    duplex = built((unit * pairs)[:pairs])
    integrator = leapfrog(0.001)
    context = context_of(duplex.system, integrator)
    context.setPositions(settled(duplex.system, duplex.positions_nm))
    context.setVelocitiesToTemperature(50.0, 1)
    start = context.getState(forces=True, energy=True)
    force = float(np.abs(start.getForces(asNumpy=True)._value).max())
    integrator.step(steps)
    state = context.getState(positions=True, velocities=True, energy=True)
    if exploded(np.array(state.getVelocities(asNumpy=True)._value)):
        raise SimulationError(f"exploded within {steps} steps")
    moved = duplex.with_positions(np.array(state.getPositions(asNumpy=True)._value))
    change = sum(
        sign * (one.getPotentialEnergy()._value + one.getKineticEnergy()._value)
        for sign, one in ((1, state), (-1, start))
    )
    return Found(
        "holds",
        A_PER_NM * moved.spacing_nm,
        f"{len(duplex.pairs)} atoms, {moved.pair_count} base pairs; largest force component "
        f"{force:.3g} kJ/mol/nm; energy changed by {change:+.2g} kJ/mol in {steps} steps",
    )


def sequence(letters: str) -> Found:
    """Return the rise (Å) of a duplex at its minimum, which has no negative mode."""
    duplex, record, _ = relaxed(letters)
    lowest = float(record["lowest_eigenvalue_per_ps2"][0])
    return Found("holds", A_PER_NM * duplex.spacing_nm, f"lowest eigenvalue {lowest:.1e} ps^-2")


def start(letters: str, **fields: float) -> Found:
    """Return the lowest eigenvalue (ps^-2) at the minimum below a bent or overtwisted start."""
    duplex = built(letters, relaxation={"anneal_ps": ANNEAL_PS, "start": fields})
    strained = context_of(duplex.system, leapfrog(0.001))
    strained.setPositions(started(duplex).positions_nm)
    before = strained.getState(energy=True).getPotentialEnergy()._value
    record, _ = relax(duplex, 1, lambda line: None)
    after = float(record.attrs["energy_kJ_per_mol"])
    relaxed_duplex = duplex.with_positions(record["position_nm"].values)
    return Found(
        "holds",
        float(record["lowest_eigenvalue_per_ps2"][0]),
        f"from {before:.3g} to {after:.4g} kJ/mol, "
        f"rise {A_PER_NM * relaxed_duplex.spacing_nm:.2f} Å",
    )


def clash(gap_nm: float) -> Found:
    """Return the least distance (nm) of unbonded atoms after a start with two atoms so close."""
    duplex, first, second = _clashing(gap_nm)
    positions = anneal(duplex, _short(duplex), lambda line: None)
    distance = float(np.linalg.norm(positions[first] - positions[second]))
    least = _least_distance(duplex, positions)
    return Found("holds", least, f"the two atoms ended {distance:.2f} nm apart")


def coincident() -> Found:
    """Return how two atoms in one place are reported: do both atoms' names stand in the message."""
    duplex, first, second = _clashing(0.0)
    atoms = list(duplex.topology.atoms())
    names = [f"{a.residue.chain.id}:{a.residue.id} {a.name}" for a in (atoms[first], atoms[second])]
    return stopped(lambda: anneal(duplex, _short(duplex), lambda line: None), *names)


def _short(duplex: SimulatedDuplex) -> Relaxation:
    relaxation = duplex.spec.environment.relaxation
    assert relaxation is not None
    return relaxation


def _clashing(gap_nm: float) -> tuple[SimulatedDuplex, int, int]:
    duplex = built("CGCG", relaxation={"anneal_ps": ANNEAL_PS})
    names = [
        (atom.residue.chain.id, atom.residue.id, atom.name) for atom in duplex.topology.atoms()
    ]
    first, second = names.index(("A", "1", "H5")), names.index(("B", "1", "O2"))
    positions = duplex.positions_nm.copy()
    positions[first] = positions[second] + [gap_nm, 0.0, 0.0]
    return duplex.with_positions(positions), first, second


def _least_distance(duplex: SimulatedDuplex, positions: Array) -> float:
    """Return the least distance of atoms that are three bonds apart or more."""
    bonded = {frozenset((a.index, b.index)) for a, b in duplex.topology.bonds()}
    neighbours: dict[int, set[int]] = {}
    for one, other in map(tuple, bonded):
        neighbours.setdefault(one, set()).add(other)
        neighbours.setdefault(other, set()).add(one)
    near = bonded | {
        frozenset(pair) for around in neighbours.values() for pair in combinations(around, 2)
    }
    distance = np.linalg.norm(positions[:, None] - positions, axis=-1)
    distance[np.diag_indices_from(distance)] = np.inf
    for one, other in map(tuple, near):
        distance[one, other] = distance[other, one] = np.inf
    return float(distance.min())
