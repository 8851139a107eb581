"""Links of the nonlinear rod: their strain, its energy, the exact gradient, the linear limit."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from dnawaves.errors import InputError, SimulationError
from dnawaves.rod.chain import SequenceChain
from dnawaves.rod.dispersion import dispersion
from dnawaves.rod.limits import long_wave_speeds_A_per_ps
from dnawaves.rod.nonlinear.chain import NonlinearChain
from dnawaves.rod.nonlinear.energy import energy, gradient, potential_energy
from dnawaves.rod.nonlinear.state import State
from dnawaves.rod.rod import Rod
from dnawaves.rod.sequence import StepSequence, body_mass

PAPER = Rod.paper()
SEEDS = st.integers(0, 2**32 - 1)


def coupled_rod(seed: int) -> Rod:
    """A rod with every coupling, curved and twisted, its mass beside the axis and skew to it."""
    rng = np.random.default_rng(seed)
    root, scale = rng.normal(size=(6, 6)), np.sqrt(np.diag(PAPER.stiffness))
    axes = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    moments = np.array([1.6, 0.13, 1.7]) * PAPER.inertia_Da_nm[2, 2]
    return replace(
        PAPER,
        stiffness=PAPER.stiffness + 0.1 * np.outer(scale, scale) * (root @ root.T),
        inertia_Da_nm=axes @ np.diag(moments) @ axes.T,
        gamma0=np.array([0.02, -0.05, 1.0]),
        omega0_rad_per_nm=np.array([0.05, 0.1, 1.76]),
        centre_nm=0.1 * rng.normal(size=3),
    )


def mixed_chain(seed: int) -> NonlinearChain:
    """Four coupled base pairs, one step softer and bent, one pair with a body bound to its side."""
    rod = coupled_rod(seed)
    bent = replace(rod, stiffness=rod.stiffness / 3, omega0_rad_per_nm=np.array([0.3, 1.5, 1.0]))
    steps = StepSequence.uniform(rod, 4).with_steps(slice(1, 2), bent)
    return NonlinearChain(steps.with_bound(2, body_mass(5000.0, 900.0, (0.4, 0.1, 0.0))))


def scattered(chain: NonlinearChain, seed: int, turn: float = 0.7) -> State:
    rng = np.random.default_rng(seed)
    size = np.repeat([0.1, turn / np.sqrt(3)], 3)
    return chain.at_rest().displaced(size * rng.uniform(-1, 1, (chain.bodies, 6)))


@given(SEEDS)
@settings(max_examples=10, deadline=None)
def test_energy_is_that_of_the_rotation_vector_seen_in_the_mid_frame(seed: int) -> None:
    chain = mixed_chain(seed)
    state = scattered(chain, seed)
    expected = 0.0
    turns = Rotation.from_quat(state.quaternions)
    for j in range(chain.bodies - 1):
        psi = (turns[j].inv() * turns[j + 1]).as_rotvec()
        middle = turns[j] * Rotation.from_rotvec(psi / 2)
        chord = middle.inv().apply(state.origins_nm[j + 1] - state.origins_nm[j])
        deviation = np.concatenate([chord, psi]) - chain.rest_strains[j]
        expected += deviation @ chain.stiffness[j] @ deviation / 2
    # round-off of the strains
    assert potential_energy(chain, state) == pytest.approx(expected, rel=1e-12)


@given(SEEDS, st.sampled_from([0.0, 1e-9, 1e-4, 0.1, 0.7]))
@settings(max_examples=25, deadline=None)
def test_gradient_is_the_slope_of_the_energy(seed: int, turn: float) -> None:
    chain = mixed_chain(seed)
    state = scattered(chain, seed, turn)
    step = 1e-4
    unit = np.eye(24).reshape(24, 4, 6)

    def slope(h: float) -> np.ndarray:
        ahead, behind = (potential_energy(chain, state.displaced(s * unit)) for s in (h, -h))
        return (ahead - behind).reshape(4, 6) / (2 * h)

    # without the error of second order; what is left is h^4 and round-off of the energy over h
    expected = (4 * slope(step) - slope(2 * step)) / 3
    computed = gradient(chain, state)
    assert computed == pytest.approx(expected, abs=1e-8 * max(np.abs(computed).max(), 1e3))


def test_gradient_is_exact_for_a_link_turned_to_the_edge() -> None:
    chain = NonlinearChain.uniform(PAPER, 2)
    turn = np.zeros((2, 6))
    turn[1, 3:] = 0.899 * np.pi * np.array([0.6, 0.64, 0.48])
    state = chain.at_rest().displaced(turn)
    unit, step = np.eye(12).reshape(12, 2, 6), 1e-4
    ahead, behind = (potential_energy(chain, state.displaced(s * unit)) for s in (step, -step))
    expected = (ahead - behind).reshape(2, 6) / (2 * step)
    computed = gradient(chain, state)
    # central difference: step^2 times the third derivative
    assert computed == pytest.approx(expected, abs=1e-6 * np.abs(computed).max())


def test_a_link_turned_beyond_the_edge_is_named() -> None:
    chain = NonlinearChain.uniform(PAPER, 5)
    turn = np.zeros((5, 6))
    turn[3:, 4] = 0.901 * np.pi
    with pytest.raises(SimulationError, match=r"link 2 .* rotated by 0.90 pi.* 0.9 pi is allowed"):
        potential_energy(chain, chain.at_rest().displaced(turn))


def test_quaternions_of_either_sign_are_the_same_rotation() -> None:
    chain = mixed_chain(1)
    state = scattered(chain, 1)
    signs = np.array([1.0, -1.0, -1.0, 1.0])[:, np.newaxis]
    other = replace(state, quaternions=signs * state.quaternions)
    assert np.array_equal(gradient(chain, other), gradient(chain, state))


@given(SEEDS)
@settings(max_examples=10, deadline=None)
def test_moving_and_turning_the_whole_chain_changes_nothing(seed: int) -> None:
    chain = mixed_chain(seed)
    state = scattered(chain, seed)
    rng = np.random.default_rng(seed)
    turn = Rotation.random(rng=rng)
    moved = replace(
        state,
        origins_nm=turn.apply(state.origins_nm) + rng.normal(size=3),
        quaternions=(turn * Rotation.from_quat(state.quaternions)).as_quat(),
    )
    before, after = gradient(chain, state), gradient(chain, moved)
    # round-off of the rotated frames
    assert potential_energy(chain, moved) == pytest.approx(
        potential_energy(chain, state), rel=1e-11
    )
    assert after == pytest.approx(before, abs=1e-11 * np.abs(before).max())
    in_laboratory = np.einsum("nij,nkj->kni", state.axes, before.reshape(-1, 2, 3))
    torque = np.cross(state.origins_nm, in_laboratory[0]) + in_laboratory[1]
    # no net force or torque, to the round-off of the sum
    assert np.abs(in_laboratory[0].sum(axis=0)).max() < 1e-12 * np.abs(before).max()
    assert np.abs(torque.sum(axis=0)).max() < 1e-12 * np.abs(before).max()


@given(SEEDS)
@settings(max_examples=10, deadline=None)
def test_small_displacements_feel_the_stiffness_of_the_linear_lattice(seed: int) -> None:
    chain = mixed_chain(seed)
    linear = SequenceChain(chain.steps)
    unit = np.eye(24).reshape(24, 4, 6)
    size = 1e-4
    ahead, behind = (gradient(chain, chain.at_rest().displaced(s * unit)) for s in (size, -size))
    computed = (ahead - behind).reshape(24, 24) / (2 * size)
    # central difference: size^2 times the fourth derivative of the energy
    assert computed == pytest.approx(linear.stiffness, abs=1e-6 * np.abs(linear.stiffness).max())
    still = gradient(chain, chain.at_rest())
    # round-off of the positions times the stiffness
    assert np.abs(still).max() < 1e-12 * np.abs(linear.stiffness).max()


@given(SEEDS)
@settings(max_examples=10, deadline=None)
def test_velocities_and_kinetic_energy_are_those_of_the_kick(seed: int) -> None:
    chain = mixed_chain(seed)
    kick = np.random.default_rng(seed).normal(size=(3, 4, 6))
    state = chain.kicked(scattered(chain, seed), kick)
    # round-off of the mass matrices
    assert chain.velocities(state) == pytest.approx(kick, abs=1e-11)
    expected = np.einsum("bni,nij,bnj->b", kick, chain.steps.mass, kick) / 2
    assert chain.kinetic_energy(state) == pytest.approx(expected, rel=1e-11)
    assert energy(chain, state) == pytest.approx(expected + potential_energy(chain, state)[0])


def test_displacements_carry_one_state_into_the_other() -> None:
    chain = mixed_chain(2)
    moves = np.random.default_rng(3).uniform(-1, 1, (5, 4, 6))
    start = scattered(chain, 4)
    # round-off
    assert start.displaced(moves).displacements_from(start) == pytest.approx(moves, abs=1e-13)


def test_timestep_limit_is_that_of_the_fastest_wave() -> None:
    limit = NonlinearChain.uniform(PAPER, 40).timestep_limit_ps
    speed = max(long_wave_speeds_A_per_ps(PAPER).values())
    # Courant, Friedrichs, Lewy: h/V, here 3.4 A over 8.190 A/ps
    assert limit == pytest.approx(3.4 / speed, rel=1e-12)
    assert limit == pytest.approx(0.415, abs=5e-4)


@given(SEEDS)
@settings(max_examples=10, deadline=None)
def test_no_wave_of_a_coupled_lattice_is_unstable_below_the_limit(seed: int) -> None:
    rod = coupled_rod(seed)
    wavenumbers = np.linspace(-np.pi, np.pi, 201) / rod.spacing_nm
    fastest = dispersion(rod, wavenumbers, lattice=True).max()
    ratio = NonlinearChain.uniform(rod, 8).timestep_limit_ps * fastest / 2
    # of a step between its two whole bodies omega is sqrt(1/2) of that between their halves
    assert np.sqrt(0.5) <= ratio <= 1
    chain = mixed_chain(seed)
    fastest = SequenceChain(chain.steps).frequencies_rad_per_ps[-1]
    assert np.sqrt(0.5) <= chain.timestep_limit_ps * fastest / 2 <= 1


def test_two_bodies_are_stable_up_to_exactly_the_limit() -> None:
    chain = NonlinearChain.uniform(PAPER, 2)
    fastest = SequenceChain(chain.steps).frequencies_rad_per_ps[-1]
    # round-off of two eigenproblems
    assert chain.timestep_limit_ps == pytest.approx(2 / fastest, rel=1e-9)


def test_what_is_no_rigid_body_or_no_kick_is_refused() -> None:
    steps = StepSequence.uniform(PAPER, 3, np.diag([1.0, 2.0, 3.0, 1.0, 1.0, 1.0]))
    with pytest.raises(InputError, match="not that of a rigid body"):
        NonlinearChain(steps)
    chain = NonlinearChain.uniform(PAPER, 3, held=(-1,))
    with pytest.raises(InputError, match="kick beside it"):
        chain.kicked(chain.at_rest(), np.ones((3, 6)))
    with pytest.raises(InputError, match="shape"):
        chain.kicked(chain.at_rest(), np.ones((2, 6)))
    with pytest.raises(InputError, match="at least 2"):
        NonlinearChain.uniform(PAPER, 1)
