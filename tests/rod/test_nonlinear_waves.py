"""Waves of the nonlinear rod at small amplitude: speeds, and the linear chain's response."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import scipy.linalg

from dnawaves.rod.chain import FiniteChain
from dnawaves.rod.dispersion import bend_shear_branches, strain_operator
from dnawaves.rod.nonlinear.chain import NonlinearChain
from dnawaves.rod.nonlinear.run import Load, Record, run
from dnawaves.rod.rod import (
    BEND_2,
    EXTENSION,
    SHEAR_1,
    TWIST,
    FloatArray,
    Rod,
    short_wave_speeds_A_per_ps,
)

PAPER = Rod.paper()
SPEED = short_wave_speeds_A_per_ps(PAPER)


def packet(
    rod: Rod,
    bodies: int,
    timestep_ps: float,
    coordinates: list[int],
    branch: int,
    carrier: float,
    width_nm: float,
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Return a wave that goes right, of one branch, about a quarter of the rod.

    Displacements and velocities (bodies, 6), the wavenumbers that it holds (k,), rad/nm, and the
    energy (k,) that each has. A sum of running waves of the lattice as leapfrog carries them:
    nothing goes left. (The wave that goes left is the trap: both in one window once gave 6.29 for
    shear.)
    """
    h = rod.spacing_nm
    k = 2 * np.pi * np.fft.rfftfreq(bodies, h)
    amplitude = np.exp(-(((k - carrier) * width_nm) ** 2) / 2) * (k > 0)
    strain = strain_operator(rod, k, lattice=True)[:, coordinates][:, :, coordinates]
    block = np.ix_(coordinates, coordinates)
    forces = strain.conj().transpose(0, 2, 1) @ rod.stiffness[block] @ strain
    shapes = np.zeros((2, len(k), 6), dtype=complex)
    energy = np.zeros(len(k))
    for i in np.flatnonzero(amplitude > 1e-12):
        squared, vectors = scipy.linalg.eigh(forces[i], rod.mass[block])
        omega, vector = np.sqrt(squared[branch]), vectors[:, branch]
        # of one phase at all wavenumbers: that of the largest part
        largest = vector[np.argmax(np.abs(vector))]
        vector = (
            vector * np.abs(largest) / largest * amplitude[i] * np.exp(-0.25j * k[i] * bodies * h)
        )
        own = omega * np.sqrt(1 - (omega * timestep_ps / 2) ** 2)
        shapes[0, i, coordinates], shapes[1, i, coordinates] = vector, -1j * own * vector
        energy[i] = (omega * amplitude[i]) ** 2
    displacement, velocity = np.fft.irfft(shapes, bodies, axis=1)
    return displacement, velocity, k, energy


def packet_speed_A_per_ps(chain: NonlinearChain, record: Record) -> FloatArray:
    """Return the speed of the centre of the kinetic energy (batch,)."""
    velocity = chain.velocities(record.states)
    energy = np.einsum("tbni,nij,tbnj->tbn", velocity, chain.steps.mass, velocity)
    place = 10 * chain.steps.spacing_nm * np.arange(chain.bodies)
    centre = (energy @ place) / energy.sum(axis=-1)
    return np.polyfit(record.times_ps, centre, 1)[0]


def carry(
    rod: Rod, waves: list[tuple], bodies: int, size: float, timestep_ps: float, steps: int
) -> tuple[FloatArray, list[tuple[FloatArray, FloatArray]]]:
    """Return the speeds of packets, each on a rod of its own, and their spectra."""
    packets = [packet(rod, bodies, timestep_ps, *wave) for wave in waves]
    chain = NonlinearChain.uniform(rod, bodies)
    # displacements of `size` at most, nm or rad
    scales = [size / np.abs(one[0]).max() for one in packets]
    moved, kicked = (
        np.stack([scale * one[part] for scale, one in zip(scales, packets, strict=True)])
        for part in (0, 1)
    )
    start = chain.kicked(chain.at_rest().displaced(moved), kicked)
    record = run(chain, start, timestep_ps, steps, record_every=steps // 10)
    return packet_speed_A_per_ps(chain, record), [one[2:] for one in packets]


def test_extension_and_twist_pulses_have_the_speed_of_the_rod() -> None:
    width, timestep = 10 * PAPER.spacing_nm, 0.04
    waves = [([EXTENSION], 0, 0.0, width), ([TWIST], 0, 0.0, width)]
    speeds, spectra = carry(PAPER, waves, 200, 1e-3, timestep, 600)
    for speed, (k, energy), name in zip(speeds, spectra, ("extension", "twist"), strict=True):
        # long waves: omega = (2V/h) sin(kh/2) and leapfrog, over the energy of the pulse
        sine = np.sin(k * PAPER.spacing_nm / 2)
        omega = 2 * SPEED[name] / 10 / PAPER.spacing_nm * sine
        group = SPEED[name] * np.sqrt(1 - sine**2) / np.sqrt(1 - (omega * timestep / 2) ** 2)
        # the rest of the Gaussian beyond the ends
        assert speed == pytest.approx(np.average(group, weights=energy), rel=1e-6)
        # the lattice's delay 3/16 (h/width)^2 of a pulse whose displacement is a Gaussian
        assert speed == pytest.approx(SPEED[name], rel=4 / 1600)
    # a prototype's 8.189 and 5.055 on a wider pulse
    assert speeds == pytest.approx([8.189, 5.055], rel=4 / 1600)


def test_shear_and_bend_packets_have_the_group_velocity_of_the_grid() -> None:
    fine = replace(PAPER, spacing_nm=0.01)
    carrier, width, timestep = 20.0, 0.5, 0.004
    plane = [SHEAR_1, BEND_2]
    waves = [(plane, branch, carrier, width) for branch in (0, 1)]
    speeds, spectra = carry(fine, waves, 800, 1e-6, timestep, 700)
    for branch, group in enumerate((5.038, 8.096)):
        k, energy = spectra[branch]
        held, step = energy > 1e-12 * energy.max(), 1e-4
        omega, ahead, behind = (
            bend_shear_branches(fine, k[held] + s, lattice=True)[:, branch]
            for s in (0, step, -step)
        )
        # leapfrog turns omega into 2/dt asin(omega dt/2)
        velocity = 10 * (ahead - behind) / (2 * step) / np.sqrt(1 - (omega * timestep / 2) ** 2)
        # the mean over the packet; its fringes at 2k, and the nonlinearity, (amplitude k)^2 = 4e-10
        speed = speeds[branch]
        assert speed == pytest.approx(np.average(velocity, weights=energy[held]), rel=1e-6)
        # of the carrier alone; the width of the spectrum and leapfrog change it by 0.1 %
        assert speed == pytest.approx(group, rel=2e-3)


def helical_rod() -> Rod:
    root = np.random.default_rng(1).normal(size=(6, 6))
    scale = np.sqrt(np.diag(PAPER.stiffness))
    return replace(
        PAPER,
        stiffness=PAPER.stiffness + 0.1 * np.outer(scale, scale) * (root @ root.T),
        inertia_Da_nm=np.diag([1.6, 0.13, 1.6]) * PAPER.inertia_Da_nm[2, 2],
        gamma0=np.array([0.02, -0.05, 1.0]),
        omega0_rad_per_nm=np.array([0.05, 0.1, 1.76]),
        centre_nm=np.array([0.1, -0.04, 0.02]),
    )


def test_difference_from_the_linear_response_falls_as_the_square_of_the_amplitude() -> None:
    chain = NonlinearChain.uniform(helical_rod(), 6, held=(-1,))
    linear = FiniteChain(helical_rod(), 6, held=(-1,))
    kick = np.random.default_rng(2).normal(size=(6, 6)) * chain.free[:, np.newaxis]
    size = 0.04 / 2.0 ** np.arange(5)
    start = chain.kicked(chain.at_rest(), size[:, np.newaxis, np.newaxis] * kick)
    record = run(chain, start, 0.0005, 4000, record_every=400)
    computed = record.states.displacements_from(chain.at_rest())
    expected = linear.kick_response(record.times_ps, kick)[0]
    difference = np.abs(computed - np.multiply.outer(size, expected).swapaxes(0, 1))
    difference = difference.max(axis=(0, 2, 3))
    # the next order, and the timestep's (omega dt)^2/24 of the linear response
    assert np.log2(difference[:-1] / difference[1:]) == pytest.approx(2.0, abs=0.1)
    # 1e-3 of the displacement at the smallest kick
    assert difference[-1] < 2e-3 * size[-1] * np.abs(expected).max()


def test_driven_end_moves_as_the_linear_chain_does() -> None:
    chain = NonlinearChain.uniform(PAPER, 8, held=(-1,))
    linear = FiniteChain(PAPER, 8, held=(-1,))
    pattern = np.zeros((8, 6))
    pattern[0] = 1e-3
    load = Load(pattern, lambda time_ps: float(np.sin(0.7 * time_ps)))
    record = run(chain, chain.at_rest(), 0.01, 800, record_every=100, load=load)
    expected = linear.driven_response(record.times_ps, pattern, 0.7)[0]
    computed = record.states.displacements_from(chain.at_rest())
    # the timestep: (omega dt)^2/24 at omega up to 4.8 /ps, over 40 rad
    assert computed == pytest.approx(expected, abs=2e-3 * np.abs(expected).max())
