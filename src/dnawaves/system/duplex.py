"""A duplex that can be simulated: topology, forces, masses, base pairs, helix axis.

Water and ions, if any, come after the duplex's atoms; base pairs, bodies and the helix axis are
those of the duplex alone.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import openmm
from numpy.typing import NDArray
from openmm import app, unit
from pydantic import ValidationError

from dnawaves.errors import InputError
from dnawaves.files import read_netcdf
from dnawaves.scene.models import SystemSpec
from dnawaves.system.effects.masses import add_mass
from dnawaves.system.forces import build_system
from dnawaves.system.geometry import (
    HelixFrame,
    duplex_topology,
    helix_frame,
    pair_labels,
    pair_of_atoms,
    strands,
    sugar_anchors,
)
from dnawaves.system.rigid_body import RigidBodies

if TYPE_CHECKING:
    import xarray as xr

Array = NDArray[np.float64]


@dataclass(frozen=True)
class SimulatedDuplex:
    """A duplex in its environment at positions (atoms, 3) in nm.

    `added_Da` holds the mass that base pairs carry besides their own, by their indices.
    `velocities_nm_per_ps` (atoms, 3) are those of an equilibrated snapshot, None at T = 0;
    `box_nm` (3,) the lengths of the periodic box, None without one.
    """

    spec: SystemSpec
    topology: app.Topology
    positions_nm: Array
    added_Da: Mapping[int, float] = field(default_factory=dict)
    velocities_nm_per_ps: Array | None = None
    box_nm: Array | None = None

    @cached_property
    def system(self) -> openmm.System:
        """The OpenMM System with every atom free."""
        system = build_system(self.topology, self.spec.environment)
        if self.box_nm is not None:
            system.setDefaultPeriodicBoxVectors(*np.diag(self.box_nm))
        for pair, added_Da in self.added_Da.items():
            add_mass(system, np.flatnonzero(self.pairs == pair), added_Da)
        return system

    @cached_property
    def masses_Da(self) -> Array:
        """Masses of the atoms, shape (atoms,)."""
        return np.array(
            [
                self.system.getParticleMass(index).value_in_unit(unit.dalton)
                for index in range(self.system.getNumParticles())
            ]
        )

    @cached_property
    def pairs(self) -> NDArray[np.intp]:
        """Index of the base pair of each of the duplex's atoms, shape (solute,)."""
        return pair_of_atoms(self.topology)

    @property
    def solute(self) -> int:
        """Number of the duplex's atoms, which come first."""
        return len(self.pairs)

    @property
    def pair_count(self) -> int:
        """Number N of base pairs."""
        return len(self.spec.duplex.sequence)

    @property
    def labels(self) -> list[str]:
        """Label of each base pair, such as 'A:1-B:24'."""
        return pair_labels(self.topology)

    @cached_property
    def frame(self) -> HelixFrame:
        """The straight helix axis of these positions."""
        return helix_frame(self.positions_nm[sugar_anchors(self.topology)])

    @cached_property
    def bodies(self) -> RigidBodies:
        """The base pairs as rigid bodies about these positions."""
        atoms = slice(self.solute)
        return RigidBodies(self.positions_nm[atoms], self.masses_Da[atoms], self.pairs)

    @cached_property
    def heights_nm(self) -> Array:
        """Coordinate of each base pair along the axis: the midpoint of its C1' atoms, (N,)."""
        anchors = self.positions_nm[sugar_anchors(self.topology)]
        return self.frame.height_nm(anchors.mean(axis=0))

    @property
    def pivots_nm(self) -> Array:
        """The point of the helix axis at the height of each base pair, (N, 3)."""
        return self.frame.origin_nm + self.heights_nm[:, None] * self.frame.axis

    @property
    def spacing_nm(self) -> float:
        """Mean distance of neighbouring base pairs along the axis."""
        return float(self.heights_nm[-1] - self.heights_nm[0]) / (self.pair_count - 1)

    @property
    def axial_inertia_Da_nm2(self) -> Array:
        """Moment of inertia of each base pair about the helix axis, shape (N,)."""
        positions = self.positions_nm[: self.solute]
        arms = positions - self.frame.on_axis(positions)
        moments = self.masses_Da[: self.solute] * np.sum(arms**2, axis=1)
        return np.bincount(self.pairs, moments).astype(np.float64)

    def with_positions(self, positions_nm: Array) -> SimulatedDuplex:
        """Return the same duplex at other positions."""
        return replace(self, positions_nm=positions_nm)

    def without_solvent(self, positions_nm: Array) -> SimulatedDuplex:
        """Return the duplex alone at positions (solute, 3), to look at but not to simulate."""
        return SimulatedDuplex(self.spec, duplex_topology(self.topology), positions_nm)

    def with_added_mass(self, added_Da: Mapping[int, float]) -> SimulatedDuplex:
        """Return the same duplex with mass (Da) added to base pairs, by their indices."""
        return replace(self, added_Da=dict(added_Da))


def read_built(spec: SystemSpec, structure: Path) -> SimulatedDuplex:
    """Return the duplex of a structure file as `dnawaves build` wrote it.

    Raises `InputError` where strand I is not the system's sequence.
    """
    pdb = app.PDBFile(str(structure))
    found = "".join(residue.name[-1] for residue in strands(pdb.topology)[0].residues())
    if found != spec.duplex.sequence:
        raise InputError(f"{structure}: found {found}; allowed: {spec.duplex.sequence}")
    box = pdb.topology.getUnitCellDimensions()
    if (box is not None) != spec.explicit:
        raise InputError(
            f"{structure}: found {'a' if box else 'no'} box; "
            f"allowed: {'one' if spec.explicit else 'none'} with solvent {spec.environment.solvent}"
        )
    return SimulatedDuplex(
        spec,
        pdb.topology,
        np.array(pdb.positions.value_in_unit(unit.nanometer)),
        box_nm=None if box is None else np.array(box.value_in_unit(unit.nanometer)),
    )


def read_result(spec: SystemSpec, path: Path, what: str, *needed: str) -> xr.Dataset:
    """Return the NetCDF file that a step wrote for a system, such as its "minimum".

    Raises `InputError` where it is another system's, another version's or lacks what is needed.
    """
    dataset = read_netcdf(path, *needed)
    found = dataset.attrs.get("spec", "no system")
    try:
        same = SystemSpec.model_validate_json(found) == spec
    except ValidationError:
        same = False
    if not same:
        raise InputError(
            f"{path}: found the {what} of {found}; allowed: the {what} of {spec.model_dump_json()}"
        )
    return dataset
