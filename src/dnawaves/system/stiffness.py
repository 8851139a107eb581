"""The compliance of base-pair steps at the minimum, from the duplex's normal modes."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from dnawaves.duplex.on_frames import base_frame, stacked
from dnawaves.frames.fit import Frames
from dnawaves.frames.parameters import pair_parameters
from dnawaves.frames.strain import in_own_frames, linear_strains, step_strains, strain_jacobian
from dnawaves.system.duplex import SimulatedDuplex
from dnawaves.system.geometry import strands
from dnawaves.system.modes import NormalModes
from dnawaves.system.structure_factor import axis_shapes
from dnawaves.units import A_PER_NM

Array = NDArray[np.float64]

STRAINS = ("shift", "slide", "rise", "tilt", "roll", "twist")


def base_pair_frames(duplex: SimulatedDuplex) -> Frames:
    """Return the standard reference frames of the base pairs, origins in Å."""
    first, second = (
        [
            base_frame(
                residue.name[-1],
                {atom.name: A_PER_NM * duplex.positions_nm[atom.index] for atom in residue.atoms()},
            )
            for residue in chain.residues()
        ]
        for chain in strands(duplex.topology)
    )
    return pair_parameters(stacked(first), stacked(second[::-1])).middle


def strain_shapes(modes: NormalModes, duplex: SimulatedDuplex) -> Array:
    """Return the strains of every step in every mode, (modes, N-1, 6), Å or rad per nm √Da.

    Mid-step rotation vectors and displacements, exact to first order. Each base pair, with its
    backbone, moves as the rigid body of `RigidBodies`, which carries the standard reference frame
    that it has at the minimum.
    """
    frames = base_pair_frames(duplex)
    lever = frames.origin.T - A_PER_NM * duplex.bodies.centres_nm
    linear, angular = A_PER_NM * modes.shapes[..., :3], modes.shapes[..., 3:]
    motion = np.concatenate([linear + np.cross(angular, lever), angular], axis=-1)
    own = in_own_frames(motion.transpose(2, 1, 0), frames)
    strains = linear_strains(strain_jacobian(step_strains(frames).values), own)
    return strains.transpose(2, 1, 0)


def strain_compliance(modes: NormalModes, duplex: SimulatedDuplex) -> Array:
    """Return ⟨ε ε⟩ / kBT between all steps of a free duplex, (N-1, 6, N-1, 6).

    Å and rad per kJ/mol; rigid motions have no strain. Multiplied by kBT it is the covariance
    that a harmonic duplex shows at that temperature; the inverse of one step's 6x6 block is that
    step's stiffness with all others free, the sum over all steps the compliance of long waves.
    """
    return modes.compliance(strain_shapes(modes, duplex))


def axis_compliance(modes: NormalModes, duplex: SimulatedDuplex) -> Array:
    """Return the covariance per kBT of the pairs' motion at the helix axis, (N, 6, N, 6).

    Å and rad per kJ/mol, in the order of `structure_factor.COORDINATES`. Rigid motions are left
    out, so of a free duplex only what does not change with them has a meaning, such as the
    variance of the distance between two pairs along the axis.
    """
    return modes.compliance(axis_shapes(modes, duplex) * np.repeat([A_PER_NM, 1.0], 3))
