"""Reflection and transmission of waves by a stretch of differing base pairs in an endless chain.

The chain is uniform to the left and to the right of the stretch. There every motion of one
frequency is a sum of Bloch waves, displacement j proportional to factor^j. The stretch is solved
together with the amplitudes of the waves that leave it and of those that decay away from it:
nothing grows, and no matrix is inverted that an evanescent wave could spoil.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
import scipy.linalg
import scipy.sparse
import scipy.sparse.linalg
from numpy.typing import NDArray

from dnawaves.errors import InputError
from dnawaves.rod.rod import BEND_2, EXTENSION, SHEAR_1, TWIST, FloatArray, Rod
from dnawaves.rod.sequence import StepSequence

ComplexArray = NDArray[np.complex128]
Motion = Literal["extension", "twist", "transverse"]

# a Bloch factor this close to the unit circle is that of a wave that carries energy: the error of
# the eigenproblem is smaller, the decay of an evanescent wave away from a band's edge larger
UNIT_CIRCLE = 1e-8
# Bloch factors this close are one degenerate wave, whose shapes may be chosen
SAME_FACTOR = 1e-8


@dataclass(frozen=True, eq=False)
class Channels:
    """The waves of one frequency that carry energy in one direction along a uniform chain.

    `wavenumbers_rad_per_nm` (channels,) in the frame of the base pairs, within (-pi/a, pi/a];
    `group_speeds_A_per_ps` (channels,); `shares` (channels, 6), the part of the kinetic energy in
    each coordinate; `shapes` (channels, 6), complex amplitudes of an energy flux of 1 kJ/mol/ps.
    """

    wavenumbers_rad_per_nm: FloatArray
    group_speeds_A_per_ps: FloatArray
    shares: FloatArray
    shapes: ComplexArray

    @property
    def motions(self) -> list[Motion]:
        """What carries most of the kinetic energy of each wave."""
        names: list[Motion] = ["extension", "twist", "transverse"]
        axial = self.shares[:, [EXTENSION, TWIST]]
        parts = np.column_stack([axial, 1 - axial.sum(axis=1)])
        return [names[i] for i in np.argmax(parts, axis=1)]


@dataclass(frozen=True, eq=False)
class Scattering:
    """What a stretch does to waves of one frequency that come from the left.

    The amplitudes (outgoing, incoming) belong to waves of equal energy flux.
    """

    frequency_rad_per_ps: float
    incoming: Channels
    reflected: Channels
    transmitted: Channels
    reflection_amplitudes: ComplexArray
    transmission_amplitudes: ComplexArray

    @property
    def reflection(self) -> FloatArray:
        """Part of the energy flux of each incoming wave (columns) in each reflected one (rows)."""
        return np.abs(self.reflection_amplitudes) ** 2

    @property
    def transmission(self) -> FloatArray:
        """Part of the energy flux of each incoming wave (columns) in each transmitted one."""
        return np.abs(self.transmission_amplitudes) ** 2

    def between(self, incoming: Motion, outgoing: Motion) -> tuple[float, float]:
        """Return how much of the flux of one motion is reflected and transmitted as another.

        Averaged over the incoming waves of that motion, summed over the outgoing ones.
        """
        columns = [motion == incoming for motion in self.incoming.motions]
        if not any(columns):
            raise InputError(f"no {incoming} wave comes in at {self.frequency_rad_per_ps} rad/ps")
        parts = []
        for flux, channels in (
            (self.reflection, self.reflected),
            (self.transmission, self.transmitted),
        ):
            rows = [motion == outgoing for motion in channels.motions]
            parts.append(float(flux[rows][:, columns].sum(axis=0).mean()))
        return parts[0], parts[1]


def scatter(
    left: Rod, stretch: StepSequence, right: Rod, frequency_rad_per_ps: float
) -> Scattering:
    """Return what `stretch`, between two endless uniform chains, does to waves from the left.

    The first and last base pair of the stretch are joined to the chains by steps of these. Raises
    InputError if the frequency is not positive or lies at a band's edge (where waves stand), the
    spacings differ, or nothing propagates on the left.
    """
    if not frequency_rad_per_ps > 0:
        raise InputError(f"the frequency is {frequency_rad_per_ps} rad/ps; it must be positive")
    left_waves, right_waves = (_BlochWaves(rod, frequency_rad_per_ps) for rod in (left, right))
    incoming = left_waves.open(rightwards=True)
    if not len(incoming.shapes):
        raise InputError(f"no wave of {frequency_rad_per_ps} rad/ps propagates in the left chain")
    reflected, transmitted = left_waves.open(rightwards=False), right_waves.open(rightwards=True)
    balance = _force_balance(left, stretch, right, frequency_rad_per_ps)
    # unknown: amplitudes on the left, displacements of the stretch, amplitudes on the right
    outgoing = scipy.sparse.block_diag(
        [
            left_waves.outgoing(rightwards=False, first=-1),
            scipy.sparse.eye_array(6 * stretch.pairs),
            right_waves.outgoing(rightwards=True, first=0),
        ],
        format="csc",
    )
    source = np.zeros((balance.shape[1], len(incoming.shapes)), dtype=complex)
    source[:12] = left_waves.incoming(first=-1)
    solved = scipy.sparse.linalg.splu((balance @ outgoing).tocsc()).solve(-(balance @ source))
    return Scattering(
        frequency_rad_per_ps,
        incoming,
        reflected,
        transmitted,
        solved[: len(reflected.shapes)],
        solved[-6 : len(solved) - 6 + len(transmitted.shapes)],
    )


def _force_balance(
    left: Rod, stretch: StepSequence, right: Rod, frequency: float
) -> scipy.sparse.csr_array:
    """Return K - w^2 M for the stretch and two base pairs on either side, rows without the outer.

    The outermost base pairs only push the next ones.
    """
    ends = [StepSequence.uniform(rod, 3) for rod in (left, right)]
    if not all(np.isclose(end.spacing_nm, stretch.spacing_nm, rtol=1e-9, atol=0) for end in ends):
        raise InputError("the chains beside the stretch must have its spacing of base pairs")

    def joined(name: str, count: int) -> FloatArray:
        parts = (
            getattr(ends[0], name)[:count],
            getattr(stretch, name),
            getattr(ends[1], name)[:count],
        )
        return np.concatenate(parts)

    steps = {name: joined(name, 2) for name in ("stiffness", "gamma0", "omega0_rad_per_nm", "mass")}
    _, stiffness, mass = StepSequence(**steps, spacing_nm=stretch.spacing_nm).matrices()
    return scipy.sparse.csr_array((stiffness - frequency**2 * mass)[6:-6])


class _BlochWaves:
    """The twelve Bloch waves of a uniform chain at one frequency, sorted by where they go."""

    def __init__(self, rod: Rod, frequency: float) -> None:
        self.rod, self.frequency = rod, frequency
        link = StepSequence.uniform(rod, 2).links()[0]
        link = link.T @ link
        onsite = link[:6, :6] + link[6:, 6:] - frequency**2 * rod.spacing_nm * rod.mass
        self._onward = link[:6, 6:]
        factors, shapes = self._solve(onsite)
        size = np.abs(factors)
        carries = np.abs(size - 1) < UNIT_CIRCLE
        self._open: dict[bool, tuple[ComplexArray, ComplexArray]] = self._directed(
            factors[carries], shapes[:, carries]
        )
        self._closed = {
            True: (factors[~carries & (size < 1)], shapes[:, ~carries & (size < 1)]),
            False: (factors[~carries & (size > 1)], shapes[:, ~carries & (size > 1)]),
        }
        for side in (True, False):
            if len(self._open[side][0]) + len(self._closed[side][0]) != 6:
                raise InputError(
                    f"the frequency {frequency} rad/ps lies at the edge of a band of the chain"
                )

    def open(self, rightwards: bool) -> Channels:
        """Return the waves that carry energy one way."""
        factors, shapes = self._open[rightwards]
        mass = self.rod.spacing_nm * self.rod.mass
        # twice the kinetic energy of a base pair, averaged in time, by coordinate
        energies = (self.frequency**2 / 2 * shapes.conj() * (mass @ shapes)).real.T
        total = energies.sum(axis=1)
        return Channels(
            np.angle(factors) / self.rod.spacing_nm,
            10 * self.rod.spacing_nm / total,
            energies / total[:, np.newaxis],
            shapes.T,
        )

    def outgoing(self, rightwards: bool, first: int) -> ComplexArray:
        """Return (12, 6) displacements of two neighbours: waves that leave, then that decay."""
        (open_factors, open_shapes), (factors, shapes) = (
            waves[rightwards] for waves in (self._open, self._closed)
        )
        factors = np.concatenate([open_factors, factors])
        shapes = np.concatenate([open_shapes, shapes], axis=1)
        return np.concatenate([shapes * factors**first, shapes * factors ** (first + 1)])

    def incoming(self, first: int) -> ComplexArray:
        """Return (12, channels) displacements of two neighbours under the waves to the right."""
        factors, shapes = self._open[True]
        return np.concatenate([shapes * factors**first, shapes * factors ** (first + 1)])

    def _solve(self, onsite: FloatArray) -> tuple[ComplexArray, ComplexArray]:
        """Return factors (12,) and shapes (6, 12) of (onward f + onsite + onward^T/f) y = 0."""
        # displacements scaled by the stiffness: nm and rad, stiff and soft become alike
        root = np.linalg.inv(scipy.linalg.cholesky(self.rod.stiffness / self.rod.spacing_nm))
        onward, onsite = (root.T @ matrix @ root for matrix in (self._onward, onsite))
        zero, one = np.zeros((6, 6)), np.eye(6)
        factors, pairs = scipy.linalg.eig(
            np.block([[zero, one], [-onward.T, -onsite]]), np.block([[one, zero], [zero, onward]])
        )
        # the half of the vector that is larger has the better digits
        shapes = np.where(np.abs(factors) < 1, pairs[:6], pairs[6:])
        return factors, root @ (shapes / np.linalg.norm(shapes, axis=0))

    def _directed(
        self, factors: ComplexArray, shapes: ComplexArray
    ) -> dict[bool, tuple[ComplexArray, ComplexArray]]:
        """Return the waves that carry energy to the right and to the left, each of flux 1."""
        in_plane = np.isin(np.arange(6), [SHEAR_1, BEND_2])
        found: dict[bool, list[tuple[complex, ComplexArray]]] = {True: [], False: []}
        remaining = list(np.argsort(np.angle(factors)))
        while remaining:
            same = [i for i in remaining if abs(factors[i] - factors[remaining[0]]) < SAME_FACTOR]
            remaining = [i for i in remaining if i not in same]
            factor = factors[same].mean()
            power = shapes[:, same].conj().T @ self._onward @ shapes[:, same] * factor
            flux, mixing = np.linalg.eigh(self.frequency / 4 * (1j * power + (1j * power).conj().T))
            waves = shapes[:, same] @ mixing / np.sqrt(np.abs(flux))
            for rightwards in (True, False):
                chosen = waves[:, (flux > 0) == rightwards]
                # equal waves in two planes are told apart by the plane
                plane = chosen[in_plane].conj().T @ chosen[in_plane]
                turned = chosen @ np.linalg.eigh(plane)[1][:, ::-1] if chosen.shape[1] else chosen
                found[rightwards] += [(factor, wave) for wave in turned.T]
        return {
            side: (
                np.array([factor for factor, _ in waves], dtype=complex),
                np.array([wave for _, wave in waves], dtype=complex).reshape(-1, 6).T,
            )
            for side, waves in found.items()
        }
