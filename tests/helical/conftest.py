"""Duplexes as MDAnalysis universes, made in memory."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

import MDAnalysis
import numpy as np
import pytest
from MDAnalysis.lib.formats.libdcd import DCDFile
from scipy.spatial.transform import Rotation

from dnawaves.duplex.fibre import fibre_duplex
from dnawaves.frames.standard import standard_place, standard_ring

Residue = tuple[str, int, str, list[str], np.ndarray]


def universe_of(residues: Sequence[Residue]) -> MDAnalysis.Universe:
    """Return a universe of residues (segment, number, name, atom names, positions in Å)."""
    segments = list(dict.fromkeys(segment for segment, *_ in residues))
    universe = MDAnalysis.Universe.empty(
        sum(len(names) for *_, names, _ in residues),
        n_residues=len(residues),
        n_segments=len(segments),
        atom_resindex=np.repeat(range(len(residues)), [len(names) for *_, names, _ in residues]),
        residue_segindex=[segments.index(segment) for segment, *_ in residues],
        trajectory=True,
    )
    universe.add_TopologyAttr("names", [name for *_, names, _ in residues for name in names])
    universe.add_TopologyAttr("resids", [number for _, number, *_ in residues])
    universe.add_TopologyAttr("resnames", [name for _, _, name, *_ in residues])
    universe.add_TopologyAttr("segids", segments)
    universe.atoms.positions = np.concatenate([positions for *_, positions in residues])
    return universe


def fibre_universe(sequence: str) -> MDAnalysis.Universe:
    """Return the fibre model's heavy atoms, segments A and B, one frame."""
    duplex = fibre_duplex(sequence)
    labels = [*zip(duplex.chain_ids, duplex.residue_ids, duplex.residue_names, strict=True)]
    positions = np.asarray(10 * duplex.positions_nm)
    names = np.array(duplex.atom_names)
    residues = []
    for label in dict.fromkeys(labels):
        here = [number for number, other in enumerate(labels) if other == label]
        residues.append((*label, names[here].tolist(), positions[here]))
    return universe_of(residues)


def ideal_universe(
    strand_I: str,
    strand_II: str,
    pairs: Rotation,
    origins_A: np.ndarray,
    second: Rotation,
    antiparallel: bool = True,
) -> MDAnalysis.Universe:
    """Return rings and C1' of standard bases laid on pair frames.

    Base n of strand I has the frame of pair n; its partner (`strand_II` is spelt along strand I)
    is turned by `second` within it, and numbered against or along strand I.
    """
    count = len(strand_I)

    def residue(
        chain: str, number: int, letter: str, turn: Rotation, origin: np.ndarray
    ) -> Residue:
        names = ["C1'", *standard_ring(letter)]
        places = np.array([standard_place(letter, name) for name in names])
        return chain, number, f"D{letter}", names, turn.apply(places) + origin

    first = [residue("A", n + 1, strand_I[n], pairs[n], origins_A[n]) for n in range(count)]
    order = range(count - 1, -1, -1) if antiparallel else range(count)
    partners = [
        residue("B", number, strand_II[n], pairs[n] * second, origins_A[n])
        for number, n in enumerate(order, start=1)
    ]
    return universe_of(first + partners)


def write_dcd(path: Path, frames: np.ndarray, cells: np.ndarray | None = None) -> Path:
    """Write positions (frames, atoms, 3) with unit cells (A, gamma, B, beta, alpha, C)."""
    with DCDFile(str(path), "w") as file:
        # 1/20.45 of an AKMA time unit is one picosecond.
        file.write_header("", frames.shape[1], 0, 1, 20.45482949774598, True)
        for number, frame in enumerate(frames):
            cell = np.zeros(6) if cells is None else cells[number]
            file.write(np.asarray(frame, dtype=np.float32), cell)
    return path


@pytest.fixture(scope="session")
def make_universe() -> Callable[[str], MDAnalysis.Universe]:
    return fibre_universe


@pytest.fixture(scope="session")
def make_ideal() -> Callable[..., MDAnalysis.Universe]:
    return ideal_universe


@pytest.fixture(scope="session")
def make_dcd() -> Callable[..., Path]:
    return write_dcd
