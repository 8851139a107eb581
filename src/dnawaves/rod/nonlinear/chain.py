"""The nonlinear rod of Bishop & Zhmudsky, eqs. 1-4, as a chain of rigid bodies."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike
from scipy.spatial.transform import Rotation

from dnawaves.errors import InputError
from dnawaves.rod.measured import mid_frame_jacobian
from dnawaves.rod.modal import free_pairs
from dnawaves.rod.nonlinear.state import State
from dnawaves.rod.rod import FloatArray, Rod
from dnawaves.rod.sequence import StepSequence


class NonlinearChain:
    """Chain of rigid bodies whose links are elastic at any displacement and rotation.

    The energy of a link is 1/2 (e - e0) . K (e - e0) with the strain
    e = (R_mid^T (x_{j+1} - x_j), psi), psi = log(R_j^T R_{j+1}), R_mid = R_j exp(psi/2), that is
    h (Gamma, Omega) in the mid-frame. K is such that small motion is that of the linear lattice
    (`SequenceChain`) of the same steps: stiffness/h, brought from the lattice's strain to this one
    (`measured.mid_frame_jacobian`; the two are the same where there is no intrinsic curvature or
    twist). With h finer than a base pair the chain is the continuous rod, with h = a the lattice.

    Parameters
    ----------
    steps : StepSequence
        Stiffness, intrinsic strains, masses and spacing h.
    held : sequence of int
        Bodies (0 is the first, -1 the last) that neither move nor turn.

    Raises
    ------
    InputError
        If a mass is not that of a rigid body.
    """

    def __init__(self, steps: StepSequence, held: Sequence[int] = ()) -> None:
        self.steps = steps
        self.free = free_pairs(steps.pairs, held)
        self.mass, self.centres_nm, inertia = _rigid_bodies(steps.mass)
        self.moments, self.principal = _principal(inertia)
        omega = steps.spacing_nm * steps.omega0_rad_per_nm
        # the chord of a step at rest, seen in its mid-frame: a screw's arc is longer across it
        half = np.linalg.norm(omega, axis=1, keepdims=True) / 2
        axis = np.divide(omega, 2 * half, out=np.zeros_like(omega), where=half > 0)
        arc = steps.spacing_nm * steps.gamma0
        along = np.sum(axis * arc, axis=1, keepdims=True) * axis
        self.rest_strains = np.hstack([along + np.sinc(half / np.pi) * (arc - along), omega])
        self.stiffness = _mid_frame_stiffness(steps, self.rest_strains)

    @classmethod
    def uniform(cls, rod: Rod, bodies: int, held: Sequence[int] = ()) -> NonlinearChain:
        """Return the chain of a uniform rod, its spacing the rod's."""
        return cls(StepSequence.uniform(rod, bodies), held)

    @property
    def bodies(self) -> int:
        return len(self.mass)

    @cached_property
    def timestep_limit_ps(self) -> float:
        """Timestep 2/omega_max below which small motion is stable (Courant, Friedrichs, Lewy).

        omega_max is that of the stiffest single step between its bodies, each of which lends it
        the half of its mass that is not its other step's. No wave of the chain is faster; the
        fastest is as fast where its branch is alone, and has at least sqrt(1/2) of omega_max.
        """
        share = np.full(self.bodies, 0.5)
        share[[0, -1]] = 1.0
        roots = np.linalg.cholesky(self.steps.mass * share[:, np.newaxis, np.newaxis])
        inverse = np.linalg.inv(roots).transpose(0, 2, 1)
        links = self.steps.links()
        scaled = np.concatenate([links[..., :6] @ inverse[:-1], links[..., 6:] @ inverse[1:]], -1)
        squared = np.linalg.eigvalsh(scaled @ scaled.transpose(0, 2, 1))
        return float(2 / np.sqrt(squared.max()))

    def at_rest(self) -> State:
        """Return the chain without strain or motion; the first body's axes are the laboratory's."""
        turns = Rotation.from_rotvec(self.rest_strains[:, 3:]).as_matrix()
        halves_of_turns = Rotation.from_rotvec(self.rest_strains[:, 3:] / 2).as_matrix()
        axes = np.tile(np.eye(3), (self.bodies, 1, 1))
        for j, turn in enumerate(turns):
            axes[j + 1] = axes[j] @ turn
        middles = axes[:-1] @ halves_of_turns
        origins = np.zeros((self.bodies, 3))
        origins[1:] = np.einsum("nij,nj->ni", middles, self.rest_strains[:, :3]).cumsum(axis=0)
        quaternions = Rotation.from_matrix(axes).as_quat()
        return State(origins, quaternions, np.zeros((self.bodies, 6)))

    def kicked(self, state: State, velocities: ArrayLike) -> State:
        """Return the state with velocities (..., bodies, 6) added, in the bodies' own frames.

        nm/ps of the origins, rad/ps. Raises InputError if a held body is kicked.
        """
        velocity = np.asarray(velocities, dtype=float)
        if velocity.shape[-2:] != (self.bodies, 6):
            raise InputError(f"velocities have shape {velocity.shape}, not (..., {self.bodies}, 6)")
        if np.any(velocity[..., ~self.free, :]):
            raise InputError("the kick acts on a held body, which cannot move; kick beside it")
        spin = velocity[..., 3:]
        linear = velocity[..., :3] + np.cross(spin, self.centres_nm)
        own = np.stack(
            [self.mass[:, np.newaxis] * linear, np.einsum("nij,...nj->...ni", self._inertia, spin)]
        )
        momenta = np.concatenate(list(np.einsum("...nij,k...nj->k...ni", state.axes, own)), -1)
        momenta = state.momenta + momenta
        leading = momenta.shape[:-2]
        return State(
            np.broadcast_to(state.origins_nm, (*leading, self.bodies, 3)),
            np.broadcast_to(state.quaternions, (*leading, self.bodies, 4)),
            momenta,
        )

    def velocities(self, state: State) -> FloatArray:
        """Return the velocities (..., bodies, 6) in the bodies' own frames: nm/ps, rad/ps."""
        own = np.einsum("...nji,...nkj->k...ni", state.axes, halves(state.momenta))
        spin = np.einsum("nij,...nj->...ni", np.linalg.inv(self._inertia), own[1])
        linear = own[0] / self.mass[:, np.newaxis] - np.cross(spin, self.centres_nm)
        return np.concatenate([linear, spin], axis=-1)

    def kinetic_energy(self, state: State) -> FloatArray:
        """Return the kinetic energy (...), kJ/mol."""
        velocity = self.velocities(state)
        momentum = np.einsum("nij,...nj->...ni", self.steps.mass, velocity)
        return np.sum(velocity * momentum, axis=(-2, -1)) / 2

    def momentum(self, state: State) -> FloatArray:
        """Return the total momentum (..., 3), Da nm/ps."""
        return state.momenta[..., :3].sum(axis=-2)

    def angular_momentum(self, state: State) -> FloatArray:
        """Return the total angular momentum (..., 3) about the laboratory's origin, Da nm^2/ps."""
        arm = state.origins_nm + np.einsum("...nij,nj->...ni", state.axes, self.centres_nm)
        orbital = np.cross(arm, state.momenta[..., :3])
        return (orbital + state.momenta[..., 3:]).sum(axis=-2)

    @property
    def _inertia(self) -> FloatArray:
        return np.einsum("nij,nj,nkj->nik", self.principal, self.moments, self.principal)


def halves(six_vectors: FloatArray) -> FloatArray:
    """Return (..., bodies, 2, 3) of (..., bodies, 6)."""
    return six_vectors.reshape(*six_vectors.shape[:-1], 2, 3)


def _rigid_bodies(blocks: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return masses (n,), centres (n, 3) and inertias about them (n, 3, 3) of blocks (n, 6, 6)."""
    mass, moment = blocks[:, 0, 0], blocks[:, 3:, :3]
    centre = np.stack([moment[:, 2, 1], moment[:, 0, 2], moment[:, 1, 0]], axis=1)
    centre /= mass[:, np.newaxis]
    arm = np.cross(centre[:, np.newaxis], np.eye(3)).transpose(0, 2, 1)
    rigid = np.zeros_like(blocks)
    rigid[:, range(3), range(3)] = mass[:, np.newaxis]
    rigid[:, 3:, :3] = mass[:, np.newaxis, np.newaxis] * arm
    rigid[:, :3, 3:] = rigid[:, 3:, :3].transpose(0, 2, 1)
    inertia = blocks[:, 3:, 3:] + mass[:, np.newaxis, np.newaxis] * arm @ arm
    rigid[:, 3:, 3:] = blocks[:, 3:, 3:]
    if np.abs(rigid - blocks).max() > 1e-9 * np.abs(blocks).max():
        raise InputError("a mass of the chain is not that of a rigid body: one mass, one centre")
    return mass, centre, inertia


def _principal(inertia: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return principal moments (n, 3) and axes (n, 3, 3), as columns, right-handed."""
    diagonal = np.diagonal(inertia, axis1=1, axis2=2)
    off = inertia * (1 - np.eye(3))
    if np.abs(off).max() <= 1e-12 * diagonal.max():
        return diagonal.copy(), np.tile(np.eye(3), (len(inertia), 1, 1))
    moments, axes = np.linalg.eigh(inertia)
    axes[..., 2] *= np.linalg.det(axes)[:, np.newaxis]
    return moments, axes


def _mid_frame_stiffness(steps: StepSequence, rest_strains: FloatArray) -> FloatArray:
    """Return the stiffness (links, 6, 6) of the strains (nm, rad) seen in the mid-frame."""
    different, where = np.unique(rest_strains, axis=0, return_inverse=True)
    inverse = np.linalg.inv(np.stack([mid_frame_jacobian(step) for step in different]))
    inverse = inverse[where.ravel()]
    stiffness = inverse.transpose(0, 2, 1) @ (steps.stiffness / steps.spacing_nm) @ inverse
    return (stiffness + stiffness.transpose(0, 2, 1)) / 2
