"""A duplex on given base-pair frames: bent, overtwisted, or with the steps of a crystal.

The nucleotides are those of the fibre model, each moved as a rigid body. Bonds within a
nucleotide stay as published; only the backbone bonds from one to the next, O3'-P, show what the
steps ask of them: see `backbone_bonds_nm`.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dnawaves.duplex.fibre import FibreDuplex, fibre_duplex
from dnawaves.errors import InputError
from dnawaves.frames.fit import Frames, fit_frames
from dnawaves.frames.inverse import bases_from_pairs, pairs_from_steps
from dnawaves.frames.parameters import pair_parameters, step_parameters
from dnawaves.frames.rotation import along_axes, sum_of_axes
from dnawaves.frames.standard import standard_ring
from dnawaves.frames.vectors import Array
from dnawaves.units import A_PER_NM


class DuplexGeometry(NamedTuple):
    """Step parameters (6, steps), pair parameters (6, pairs), frames (pairs,) of the pairs."""

    step_values: Array
    pair_values: Array
    pairs: Frames


def duplex_from_steps(
    sequence: str, step_values: ArrayLike, pair_values: ArrayLike | None = None
) -> FibreDuplex:
    """Build the heavy atoms of a duplex with these base-pair step parameters.

    `step_values` is (6, steps): shift, slide, rise (Å), tilt, roll, twist (degrees);
    `pair_values` is (6, pairs): shear to opening, those of the fibre model by default. The first
    pair stands as in `fibre_duplex`. Raises `InputError` for a sequence that `check_sequence`
    refuses and for parameters of the wrong number or size.
    """
    pairs = geometry(fibre_duplex(sequence)).pairs
    first = Frames(pairs.origin[:, 0], pairs.axes[..., 0])
    steps = _of_shape(step_values, len(sequence) - 1, "step", sequence)
    return duplex_on_frames(sequence, pairs_from_steps(steps, first), pair_values)


def duplex_on_frames(
    sequence: str, pairs: Frames, pair_values: ArrayLike | None = None
) -> FibreDuplex:
    """Build the heavy atoms of a duplex whose base pairs have the frames `pairs` (pairs,), in Å.

    `pair_values` and what is raised: as in `duplex_from_steps`.
    """
    fibre = fibre_duplex(sequence)
    if pair_values is None:
        pair_values = geometry(fibre).pair_values
    targets = bases_from_pairs(_of_shape(pair_values, len(sequence), "pair", sequence), pairs)
    positions_nm = np.empty_like(fibre.positions_nm)
    for sources, target in zip(_strands(fibre), targets, strict=True):
        for pair, (atoms, source) in enumerate(sources):
            places_A = A_PER_NM * fibre.positions_nm[atoms].T
            local = along_axes(
                source.axes[..., np.newaxis], places_A - source.origin[:, np.newaxis]
            )
            moved_A = sum_of_axes(target.axes[:, :, pair, np.newaxis], local)
            positions_nm[atoms] = (moved_A + target.origin[:, pair, np.newaxis]).T / A_PER_NM
    return replace(fibre, positions_nm=positions_nm)


def geometry(duplex: FibreDuplex) -> DuplexGeometry:
    """Return the parameters and frames of a duplex; of the fibre model, for instance."""
    strand_I, strand_II = (stacked(frame for _, frame in strand) for strand in _strands(duplex))
    in_pairs = pair_parameters(strand_I, strand_II)
    in_steps = step_parameters(in_pairs.middle)
    return DuplexGeometry(in_steps.values, in_pairs.values, in_pairs.middle)


def base_frame(letter: str, places_A: Mapping[str, Array]) -> Frames:
    """Return the standard frame of a base whose atoms, by name, are at places (3,) in Å."""
    ring = standard_ring(letter)
    return fit_frames(np.array(list(ring.values())), np.array([places_A[name] for name in ring]).T)


def stacked(frames: Iterable[Frames]) -> Frames:
    """Return frames, each of one base or pair, as one (frames,)."""
    origins, axes = zip(*frames, strict=True)
    return Frames(np.stack(origins, axis=-1), np.stack(axes, axis=-1))


def backbone_bonds_nm(duplex: FibreDuplex) -> NDArray[np.float64]:
    """Return the lengths (strand, steps) of the bonds O3'-P, along strand I 5' to 3'.

    Row 0 is strand I, row 1 strand II; 0.160 nm in the fibre model.
    """
    is_O3, is_P = duplex.atom_names == "O3'", duplex.atom_names == "P"
    lengths = []
    for chain in "AB":
        here = duplex.chain_ids == chain
        oxygens = duplex.positions_nm[here & is_O3][:-1]
        lengths.append(np.linalg.norm(duplex.positions_nm[here & is_P] - oxygens, axis=1))
    return np.stack([lengths[0], lengths[1][::-1]])


def _strands(duplex: FibreDuplex) -> list[list[tuple[NDArray[np.int64], Frames]]]:
    """Return, for each strand along strand I, each nucleotide's atoms and the frame of its base."""
    strands = []
    for chain in "AB":
        here = duplex.chain_ids == chain
        residues = np.unique(duplex.residue_ids[here])
        atoms = [np.flatnonzero(here & (duplex.residue_ids == n)) for n in residues]
        strands.append([(indices, _base_frame(duplex, indices)) for indices in atoms])
    return [strands[0], strands[1][::-1]]


def _base_frame(duplex: FibreDuplex, atoms: NDArray[np.int64]) -> Frames:
    places_A = dict(
        zip(duplex.atom_names[atoms], A_PER_NM * duplex.positions_nm[atoms], strict=True)
    )
    return base_frame(duplex.residue_names[atoms[0]].removeprefix("D"), places_A)


def _of_shape(values: ArrayLike, number: int, what: str, sequence: str) -> Array:
    array = np.asarray(values, dtype=np.float64)
    if array.shape != (6, number):
        raise InputError(
            f"{what} parameters have shape {array.shape}; allowed for the {len(sequence)} base"
            f" pairs of {sequence}: (6, {number}), component first"
        )
    return array
