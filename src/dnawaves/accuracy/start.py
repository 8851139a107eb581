"""The minimum that all settings of a system start from, on disk."""

from __future__ import annotations

import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import scipy.sparse
from numpy.typing import NDArray

from dnawaves.accuracy.models import StudySystem
from dnawaves.accuracy.settings import system_spec
from dnawaves.errors import SimulationError
from dnawaves.files import whole_file
from dnawaves.system.duplex import SimulatedDuplex
from dnawaves.system.relax import relax
from dnawaves.system.steps import built_structure


@dataclass(frozen=True)
class Start:
    """A duplex at its minimum and the Hessian there (3 atoms, 3 atoms), kJ/mol/nm²."""

    duplex: SimulatedDuplex
    hessian: scipy.sparse.csr_array


def built_duplex(name: str, system: StudySystem) -> SimulatedDuplex:
    """Return the duplex of a system as it is built."""
    spec = system_spec(name, system)
    return SimulatedDuplex(spec, *built_structure(spec))


def prepare_step(name: str, system: StudySystem, output: Path, threads: int) -> None:
    """Relax a system and write its minimum; where there is none, write why."""

    def report(line: str) -> None:
        print(f"{name}: {line}", file=sys.stderr, flush=True)

    content: dict[str, NDArray[np.generic]] = {}
    try:
        dataset, hessian = relax(built_duplex(name, system), threads, report)
        matrix = scipy.sparse.csr_array(hessian)
        content = {
            "position_nm": dataset["position_nm"].values,
            "hessian_data": matrix.data,
            "hessian_indices": matrix.indices,
            "hessian_indptr": matrix.indptr,
        }
    except SimulationError as error:
        # Another molecule that has no minimum is a row of the study, not its end.
        report(str(error))
        content["failed"] = np.array(str(error))
    with whole_file(output) as temporary, temporary.open("wb") as file:
        np.savez_compressed(file, **content)  # type: ignore[arg-type]


def read_start(name: str, system: StudySystem, path: Path) -> Start:
    """Return what `prepare_step` wrote.

    Raises
    ------
    SimulationError
        When the system has no minimum.
    """
    with np.load(path) as content:
        if "failed" in content:
            raise SimulationError(str(content["failed"]))
        positions = content["position_nm"]
        parts = tuple(content[f"hessian_{part}"] for part in ("data", "indices", "indptr"))
    duplex = built_duplex(name, system).with_positions(positions)
    size = 3 * len(positions)
    return Start(duplex, scipy.sparse.csr_array(parts, shape=(size, size)))
