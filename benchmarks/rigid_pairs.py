"""How much of a wave any lattice of rigid base pairs can describe at most.

python benchmarks/rigid_pairs.py RESULTS SCENE..., with RESULTS a folder that `snakemake` has filled
and kick scenes of it. The lattice has the molecule's own stiffness between all its base pairs,
relaxed inside (the inverse of the fluctuations of the free duplex's normal modes), and each pair's
own mass and inertia; nothing is fitted but the amplitude and the best of some frictions. Prints the
share of the motion of all six coordinates that it leaves, in all the record and in what lies below
some frequencies: what is left there no uniform lattice of rigid pairs can find.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import scipy.linalg
from numpy.typing import NDArray
from scipy.fft import dct

from dnawaves.files import read_netcdf
from dnawaves.rod.modal import ModalChain, free_pairs
from dnawaves.scene.load import read_scene
from dnawaves.scene.pairs import held_pairs
from dnawaves.units import A_PER_NM

Array = NDArray[np.float64]

FRICTIONS_PER_PS = (0.0, 0.1, 0.2, 0.4)
BELOW_RAD_PER_PS = (1.0, 2.0, 4.0, 8.0, np.inf)
RIGID_MOTIONS = 6


def stiffness(modes: Path) -> Array:
    """Return the stiffness (6N, 6N) of the pairs' rigid-body coordinates, nm and rad."""
    dataset = read_netcdf(modes, "eigenvalue", "shape")
    values, shapes = dataset["eigenvalue"].values, dataset["shape"].values
    vibrations = np.argsort(np.abs(values))[RIGID_MOTIONS:]
    flat = shapes[vibrations].reshape(len(vibrations), -1)
    compliance = (flat / values[vibrations, np.newaxis]).T @ flat
    eigenvalues, vectors = np.linalg.eigh(compliance)
    # The rigid motions have no stiffness, and no compliance here.
    kept = np.argsort(eigenvalues)[RIGID_MOTIONS:]
    return np.asarray((vectors[:, kept] / eigenvalues[kept]) @ vectors[:, kept].T)


def left_over(results: Path, name: str) -> list[float]:
    """Return the shares that the lattice leaves of a scene's first member."""
    scene = read_scene(results / "scenes" / name / "scene.json")
    motion = read_netcdf(results / "scenes" / name / scene.members[0] / "motion.nc", "velocity")
    parts = [
        motion[part] / unit for part, unit in (("velocity", A_PER_NM), ("angular_velocity", 1))
    ]
    velocity = np.concatenate([(part[0] - part[1]) / 2 for part in parts], axis=-1)
    blocks = [
        scipy.linalg.block_diag(mass * np.eye(3), inertia / A_PER_NM**2)
        for mass, inertia in zip(motion["mass"].values, motion["inertia"].values, strict=True)
    ]
    pairs = len(blocks)
    free = np.repeat(free_pairs(pairs, held_pairs(scene.ends, pairs))[:, np.newaxis], 6, axis=1)
    folder = results / "systems" / scene.system.name
    total = stiffness(folder / "modes" / "0-0.nc")
    chain = ModalChain(total, scipy.linalg.block_diag(*blocks), free, zero_mode=1e-8)
    roots = np.array([np.linalg.cholesky(block) for block in blocks])
    times = motion["time"].values
    seen = np.einsum("pij,tpi->tpj", roots, velocity)[:, free[:, 0]]
    kick = velocity[0] * free
    answers = [
        np.einsum("pij,tpi->tpj", roots, chain.kick_response(times, kick, friction)[1])
        for friction in FRICTIONS_PER_PS
    ]
    resolution = np.pi / (times[-1] + times[1])
    return [
        min(_left(seen, answer[:, free[:, 0]], below / resolution) for answer in answers)
        for below in BELOW_RAD_PER_PS
    ]


def _left(seen: Array, answer: Array, coefficients: float) -> float:
    """Return the share left of the slowest cosines over the record, amplitude fitted."""
    count = int(min(coefficients, len(seen)))
    data, model = (dct(field, axis=0, norm="ortho")[:count].ravel() for field in (seen, answer))
    return float(1 - (data @ model) ** 2 / (data @ data) / (model @ model))


def main(results: Path, names: list[str]) -> None:
    heads = [f"< {1e3 * w / 2 / np.pi:.0f} GHz" for w in BELOW_RAD_PER_PS[:-1]] + ["all"]
    print("| scene | " + " | ".join(heads) + " |")
    print("|---|" + "---|" * len(heads))
    for name in names:
        shares = " | ".join(f"{share:.0%}" for share in left_over(results, name))
        print(f"| {name} | {shares} |", flush=True)


if __name__ == "__main__":
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    main(Path(sys.argv[1]), sys.argv[2:])
