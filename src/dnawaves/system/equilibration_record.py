"""What an equilibration has seen so far, and the file from which a killed one goes on."""

from __future__ import annotations

import sys
import zipfile
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from dnawaves.files import whole_file

Array = NDArray[np.float64]

# What each sample holds, and its units.
UNITS = {
    "temperature_K": "K",
    "potential_energy_kJ_per_mol": "kJ/mol",
    "end_to_end_nm": "nm",
    "volume_nm3": "nm3",
}
SAMPLED = tuple(UNITS)


@dataclass
class Record:
    """Samples so far, the snapshots, the structures of the duplex that are to be averaged.

    `samples` are rows of `SAMPLED`, `snapshots` positions and velocities (2, atoms, 3), `boxes`
    (3,), all lists over time. `structures` is the first structure and the sum of all, each laid on
    the first, about their centres of mass: (2, solute, 3); `averaged` is their number. The last
    moment, to go on from: positions and the integrator's own velocities `moment` (2, atoms, 3),
    `box_nm` (3,), empty without a box.
    """

    moment: Array
    box_nm: Array
    samples: list[Array] = field(default_factory=list)
    snapshots: list[Array] = field(default_factory=list)
    boxes: list[Array] = field(default_factory=list)
    structures: Array = field(default_factory=lambda: np.empty((2, 0, 3)))
    averaged: int = 0

    def average(self, positions_nm: Array, masses_Da: Array) -> None:
        """Take a structure (solute, 3) into the mean, laid on the first by least squares."""
        centred = positions_nm - masses_Da @ positions_nm / masses_Da.sum()
        if not self.averaged:
            self.structures = np.array([centred, np.zeros_like(centred)])
        turn, _ = Rotation.align_vectors(self.structures[0], centred, weights=masses_Da)
        self.structures[1] += turn.apply(centred)
        self.averaged += 1

    @property
    def mean_structure_nm(self) -> Array:
        """The mean structure (solute, 3), its centre of mass at the origin."""
        mean: Array = self.structures[1] / self.averaged
        return mean

    def series(self, name: str) -> Array:
        """Return one of `SAMPLED` over time, (samples,)."""
        return np.array(self.samples)[:, SAMPLED.index(name)]

    def save(self, path: Path, run: str) -> None:
        """Write the record, whole or not at all, with what says of which run it is."""
        arrays: dict[str, Any] = {name: np.array(value) for name, value in vars(self).items()}
        with whole_file(path) as temporary, temporary.open("wb") as file:
            np.savez(file, run=np.array(run), **arrays)


def load_record(path: Path, run: str) -> Record | None:
    """Return the record of a killed run, None where there is none or it is of another run."""
    if not path.exists():
        return None
    try:
        with np.load(path) as content:
            found = {name: content[name] for name in content.files}
    except (OSError, EOFError, ValueError, zipfile.BadZipFile) as error:
        print(f"{path}: cannot be read ({error}), so not used", file=sys.stderr, flush=True)
        return None
    if str(found.pop("run")) != run:
        print(f"{path}: of another run, so not used", file=sys.stderr, flush=True)
        return None
    lists = {name: list(found[name]) for name in ("samples", "snapshots", "boxes")}
    return Record(
        found["moment"],
        found["box_nm"],
        **lists,
        structures=found["structures"],
        averaged=int(found["averaged"]),
    )
