"""Heavy atoms of a B-DNA duplex from the fibre model.

Source: Arnott & Hukins (1972) Biochem. Biophys. Res. Commun. 47, 1504;
Chandrasekaran & Arnott (1996) J. Biomol. Struct. Dyn. 13, 1015 (calf thymus B-DNA).
"""

from __future__ import annotations

import csv
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from importlib.resources import files

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dnawaves.scene.sequence import check_sequence, reverse_complement
from dnawaves.units import A_PER_NM

TWIST_DEG = 36.0
RISE_A = 3.375

_CURRENT_NAMES = {"O1P": "OP1", "O2P": "OP2", "C5M": "C7"}
_PHOSPHATE = ("P", "OP1", "OP2")


@dataclass(frozen=True)
class FibreDuplex:
    """Heavy atoms of a duplex: chain A then B, each 5' to 3', its helix axis on z.

    Arrays run over atoms; `positions_nm` is (atoms, 3), `residue_ids` count from 1 in each chain.
    """

    atom_names: NDArray[np.str_]
    residue_names: NDArray[np.str_]
    residue_ids: NDArray[np.int64]
    chain_ids: NDArray[np.str_]
    positions_nm: NDArray[np.float64]

    @classmethod
    def of(
        cls, atoms: Sequence[tuple[str, str, int, str]], places_A: Sequence[ArrayLike]
    ) -> FibreDuplex:
        """Return a duplex of atoms (name, residue, number, chain) at places (3,) in Å."""
        names, residues, residue_ids, chains = zip(*atoms, strict=True)
        return cls(
            atom_names=np.array(names),
            residue_names=np.array(residues),
            residue_ids=np.array(residue_ids, dtype=np.int64),
            chain_ids=np.array(chains),
            positions_nm=np.array(places_A) / A_PER_NM,
        )


@cache
def nucleotide_table() -> dict[str, dict[str, tuple[float, float, float]]]:
    """Return base -> atom name -> (r in Å, phi in degrees, z in Å) of the published nucleotide."""
    text = files("dnawaves.duplex").joinpath("data/fibre_b_dna.csv").read_text(encoding="utf-8")
    rows = csv.DictReader(line for line in text.splitlines() if not line.startswith("#"))
    table: dict[str, dict[str, tuple[float, float, float]]] = {}
    for row in rows:
        name = _CURRENT_NAMES.get(row["atom"], row["atom"])
        cylindrical = (float(row["r_A"]), float(row["phi_deg"]), float(row["z_A"]))
        table.setdefault(row["base"], {})[name] = cylindrical
    return table


def fibre_duplex(sequence: str) -> FibreDuplex:
    """Build the heavy atoms of a duplex, strand I (chain A) running 5' to 3' along +z.

    Base pair 1 lies at z = 0 with its dyad on the x axis. The phosphates of both 5' ends are
    left out. Raises `InputError` for a sequence that `check_sequence` refuses.
    """
    check_sequence(sequence)
    last = len(sequence) - 1
    atoms: list[tuple[str, str, int, str]] = []
    positions: list[NDArray[np.float64]] = []
    for chain, strand in (("A", sequence), ("B", reverse_complement(sequence))):
        for index, base in enumerate(strand):
            pair = index if chain == "A" else last - index
            for name, cylindrical in nucleotide_table()[base].items():
                if index == 0 and name in _PHOSPHATE:
                    continue
                atoms.append((name, f"D{base}", index + 1, chain))
                positions.append(_place(cylindrical, pair, chain))
    return FibreDuplex.of(atoms, positions)


def _place(cylindrical: tuple[float, float, float], pair: int, chain: str) -> NDArray[np.float64]:
    """Return the position (3,) in Å of one atom of base pair `pair`, counted from 0."""
    r, phi, z = cylindrical
    # The published strand descends z as it runs 5' to 3'; the dyad about x turns it upwards.
    side = -1.0 if chain == "A" else 1.0
    angle = np.deg2rad(side * phi + pair * TWIST_DEG)
    return np.array([r * np.cos(angle), r * np.sin(angle), side * z + pair * RISE_A])
