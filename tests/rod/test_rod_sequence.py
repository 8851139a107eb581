"""Chains whose steps and masses differ, pinned ends, forces in time, and the hard cases."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import scipy.linalg
import scipy.sparse
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from dnawaves.errors import InputError
from dnawaves.rod.chain import FiniteChain, PlaneChain, ScalarChain, SequenceChain
from dnawaves.rod.modal import ModalChain
from dnawaves.rod.rod import BEND_1, EXTENSION, TWIST, Rod
from dnawaves.rod.sequence import StepSequence, body_mass

PAPER = Rod.paper()
TIMES = np.linspace(0, 12, 25)
SCALE = np.sqrt(np.diag(PAPER.stiffness))


def random_sequence(seed: int, pairs: int) -> StepSequence:
    """Steps and masses that all differ, with every coupling."""
    random = np.random.default_rng(seed)
    roots = random.normal(size=(pairs - 1, 6, 6))
    stiffness = PAPER.stiffness + 0.1 * np.outer(SCALE, SCALE) * (roots @ roots.transpose(0, 2, 1))
    sequence = StepSequence(
        stiffness=stiffness,
        gamma0=np.array([0.0, 0.0, 1.0]) + 0.1 * random.normal(size=(pairs - 1, 3)),
        omega0_rad_per_nm=np.array([0.0, 0.1, 1.76]) + 0.2 * random.normal(size=(pairs - 1, 3)),
        mass=random.uniform(0.7, 1.3, (pairs, 1, 1)) * PAPER.spacing_nm * PAPER.mass,
        spacing_nm=PAPER.spacing_nm,
    )
    return sequence.with_bound(pairs // 2, body_mass(900.0, [80.0, 90.0, 70.0], [0.2, -0.4, 0.1]))


def integrate(chain: ModalChain, pattern: np.ndarray, friction: float, course) -> np.ndarray:
    """Return displacements and velocities (2, times, free) under pattern course(t), from rest."""
    free = np.flatnonzero(chain.free)
    n = len(free)
    mass, stiffness = (matrix[np.ix_(free, free)] for matrix in (chain.mass, chain.stiffness))
    load, spring = np.linalg.solve(mass, pattern.ravel()[free]), np.linalg.solve(mass, stiffness)

    def rates(t: float, state: np.ndarray) -> np.ndarray:
        acceleration = load * course(t) - friction * state[n:] - spring @ state[:n]
        return np.concatenate([state[n:], acceleration])

    motion = solve_ivp(
        rates, (0, 12), np.zeros(2 * n), "DOP853", TIMES, rtol=1e-10, atol=1e-13, max_step=0.1
    ).y.T
    return np.array([motion[:, :n], motion[:, n:]])


@pytest.mark.parametrize(("held", "pinned"), [((), ()), ((-1,), (0,)), ((), (0, 3))])
@pytest.mark.parametrize("friction", [0.0, 0.4, 6.0])
def test_a_heterogeneous_chain_answers_every_force_as_its_equations_say(
    held: tuple[int, ...], pinned: tuple[int, ...], friction: float
) -> None:
    chain = SequenceChain(random_sequence(5, 5), held, pinned)
    pattern = np.random.default_rng(2).normal(size=(5, 6)) * chain.free
    drive, width, centre, ramp = chain.frequencies_rad_per_ps[8], 0.6, 5.0, 4.0

    def ramped(t: float) -> float:
        return np.sin(drive * t) * ((1 - np.cos(np.pi * t / ramp)) / 2 if t < ramp else 1.0)

    def pulse(t: float) -> float:
        return np.exp(-(((t - centre) / width) ** 2) / 2)

    fine = np.linspace(0, 12, 1201)
    sampled = chain.sampled_response(pulse(fine), fine[1], pattern, friction)
    for computed, course in (
        (chain.pulse_response(TIMES, pattern, centre, width, friction), pulse),
        ([part[::50] for part in sampled], pulse),
        (chain.driven_response(TIMES, pattern, drive, friction, ramp), ramped),
    ):
        expected = integrate(chain, pattern, friction, course)
        for part, reference in zip(computed, expected, strict=True):
            # the integrator's tolerance, grown over 100 steps
            assert part[:, chain.free] == pytest.approx(
                reference, abs=1e-7 * np.abs(reference).max()
            )
            assert np.all(part[:, ~chain.free] == 0)


def test_only_what_is_observed_is_computed_and_it_is_the_same() -> None:
    chain = SequenceChain(random_sequence(1, 6), held=(0,))
    random = np.random.default_rng(0)
    observe = random.normal(size=(4, 36))
    kick = random.normal(size=(6, 6)) * chain.free
    whole = chain.kick_response(TIMES, kick, 0.2)
    for matrix in (observe, scipy.sparse.csr_array(observe)):
        seen = chain.kick_response(TIMES, kick, 0.2, observe=matrix)
        for part, field in zip(seen, whole, strict=True):
            # round-off of another order of sums
            assert part == pytest.approx(field.reshape(len(TIMES), 36) @ observe.T, abs=1e-10)
    with pytest.raises(InputError, match="observe"):
        chain.kick_response(TIMES, kick, observe=np.eye(6))


def test_a_diagonal_mass_is_the_same_as_its_matrix() -> None:
    random = np.random.default_rng(3)
    root = random.normal(size=(12, 12))
    mass, free = random.uniform(1, 16, 12), np.arange(12).reshape(4, 3) != 5
    stiffness = root @ root.T
    before = stiffness.copy()
    short, full = ModalChain(stiffness, mass, free), ModalChain(stiffness, np.diag(mass), free)
    assert np.array_equal(stiffness, before)
    kick = random.normal(size=(4, 3)) * free
    # round-off of two eigenproblems
    assert short.frequencies_rad_per_ps == pytest.approx(full.frequencies_rad_per_ps, rel=1e-10)
    assert short.kick_response(TIMES, kick)[0] == pytest.approx(
        full.kick_response(TIMES, kick)[0], abs=1e-10
    )
    with pytest.raises(InputError, match="not positive"):
        ModalChain(stiffness, -mass, free)
    with pytest.raises(InputError, match="no stable rest"):
        ModalChain(-stiffness, mass, free)


def test_pinned_ends_hold_the_position_and_leave_the_rotation() -> None:
    chain = FiniteChain(PAPER, 10, pinned=(0, -1))
    # the rod may only spin about its axis
    assert np.count_nonzero(chain.frequencies_rad_per_ps == 0) == 1
    kick = np.zeros((10, 6))
    kick[0, BEND_1] = 1.0
    position, _ = chain.kick_response(TIMES, kick)
    assert np.all(position[:, [0, -1], :3] == 0)
    assert np.abs(position[:, 0, BEND_1]).max() > 0.1
    plane = PlaneChain(PAPER, 10, pinned=(0, -1)).frequencies_rad_per_ps
    # every bend of one plane is found twice in the full chain
    distance = np.abs(chain.frequencies_rad_per_ps - plane[:, np.newaxis])
    assert np.all(np.sort(distance, axis=1)[:, 1] < 1e-9)


def test_the_softer_steps_stretch_more_and_all_carry_the_same_force() -> None:
    soft = replace(PAPER, stiffness=PAPER.stiffness * 0.25)
    sequence = StepSequence.uniform(PAPER, 10).with_steps(slice(3, 5), soft)
    forces = np.zeros((10, 6))
    forces[-1, EXTENSION] = 60.0
    stretch = np.diff(SequenceChain(sequence, held=(0,)).static_response(forces)[:, EXTENSION])
    usual = 60.0 * PAPER.spacing_nm / PAPER.stiffness[EXTENSION, EXTENSION]
    # round-off of the sum over modes
    assert stretch == pytest.approx(np.where(np.isin(range(9), [3, 4]), 4, 1) * usual, rel=1e-9)


def test_a_bound_body_moves_as_a_rigid_body_with_its_base_pair() -> None:
    centre, velocity = np.array([0.3, -0.2, 0.5]), np.array([1.0, 0.4, -0.7])
    spin, inertia = np.array([0.2, 1.1, -0.5]), np.array([3.0, 2.0, 5.0])
    motion = np.concatenate([velocity, spin])
    energy = motion @ body_mass(7.0, inertia, centre) @ motion / 2
    of_centre = velocity + np.cross(spin, centre)
    expected = (7.0 * of_centre @ of_centre + spin @ (inertia * spin)) / 2
    assert energy == pytest.approx(expected, rel=1e-14)


@settings(max_examples=20, deadline=None)
@given(seed=st.integers(0, 10**6), pairs=st.integers(2, 7))
def test_any_free_chain_has_six_rigid_motions_and_any_clamped_one_none(
    seed: int, pairs: int
) -> None:
    sequence = random_sequence(seed, pairs)
    free = SequenceChain(sequence)
    assert np.count_nonzero(free.frequencies_rad_per_ps == 0) == 6
    clamped = SequenceChain(sequence, held=(0,))
    assert np.all(clamped.frequencies_rad_per_ps > 0)
    # holding lowers no frequency and raises none past the next six (Rayleigh)
    count = 6 * pairs - 6
    assert np.all(clamped.frequencies_rad_per_ps > free.frequencies_rad_per_ps[:count] - 1e-9)
    assert np.all(clamped.frequencies_rad_per_ps < free.frequencies_rad_per_ps[6:] + 1e-9)


# -- hard cases


def test_two_base_pairs_vibrate_with_their_reduced_mass() -> None:
    chain = FiniteChain(PAPER, 2)
    frequencies = chain.frequencies_rad_per_ps
    assert np.count_nonzero(frequencies == 0) == 6
    a = PAPER.spacing_nm
    extension = np.sqrt(2 * PAPER.stiffness[2, 2] / PAPER.density_Da_per_nm) / a
    twist = np.sqrt(2 * PAPER.stiffness[5, 5] / PAPER.inertia_Da_nm[2, 2]) / a
    for expected in (extension, twist):
        # round-off
        assert np.min(np.abs(frequencies / expected - 1)) < 1e-12


def test_one_free_base_pair_between_held_ones_is_six_oscillators() -> None:
    chain = FiniteChain(PAPER, 3, held=(0, -1))
    assert chain.frequencies_rad_per_ps.shape == (6,)
    expected = np.sqrt(2 * PAPER.stiffness[2, 2] / PAPER.density_Da_per_nm) / PAPER.spacing_nm
    assert np.min(np.abs(chain.frequencies_rad_per_ps / expected - 1)) < 1e-12
    kick = np.zeros((3, 6))
    kick[1, EXTENSION] = 1.0
    position, _ = chain.kick_response(TIMES, kick)
    # round-off
    assert position[:, 1, EXTENSION] == pytest.approx(
        np.sin(expected * TIMES) / expected, abs=1e-12
    )


def test_everything_held_but_one_rotation() -> None:
    stiffness, mass = np.diag([3.0, 8.0]), np.array([1.0, 2.0])
    chain = ModalChain(stiffness, mass, np.array([[False, True]]))
    assert chain.frequencies_rad_per_ps == pytest.approx([2.0], rel=1e-15)


def test_a_free_chain_with_net_momentum_drifts_in_a_straight_line() -> None:
    chain = SequenceChain(random_sequence(9, 6))
    times = np.linspace(0, 1e5, 11)
    rigid = chain.shapes[:6].reshape(6, 36)
    kick = (np.random.default_rng(0).normal(size=6) @ rigid).reshape(6, 6)
    position, velocity = chain.kick_response(times, kick)
    # exactly: no vibration, however long; round-off of the projection on the modes
    assert velocity == pytest.approx(np.broadcast_to(kick, velocity.shape), abs=1e-13)
    assert position == pytest.approx(times[:, None, None] * kick, abs=1e-8)


def test_a_pulse_leaves_its_impulse_in_the_free_chain() -> None:
    chain = FiniteChain(PAPER, 12)
    force = np.zeros((12, 6))
    force[3, EXTENSION], force[7, TWIST] = 50.0, 8.0
    _, velocity = chain.pulse_response([60.0, 300.0], force, 6.0, 0.8)
    momentum = np.einsum("tpi,ij->tj", velocity, 0.34 * PAPER.mass)
    expected = force.sum(axis=0) * 0.8 * np.sqrt(2 * np.pi)
    # round-off
    assert momentum == pytest.approx(np.tile(expected, (2, 1)), abs=1e-9)


def test_drive_exactly_on_a_mode_grows_linearly_in_it_alone() -> None:
    chain = FiniteChain(PAPER, 8, held=(0,))
    mode = 10
    w, shape = chain.frequencies_rad_per_ps[mode], chain.shapes[mode]
    force = (chain.mass @ shape.ravel()).reshape(8, 6)
    position, _ = chain.driven_response(TIMES, force, w)
    expected = (np.sin(w * TIMES) - w * TIMES * np.cos(w * TIMES)) / (2 * w**2)
    # round-off times the size of the answer
    assert position == pytest.approx(expected[:, None, None] * shape, abs=1e-11)


def test_degenerate_bends_keep_to_their_planes() -> None:
    chain = FiniteChain(PAPER, 9)
    bends = chain.shapes[6:8]
    assert chain.frequencies_rad_per_ps[6] == pytest.approx(
        chain.frequencies_rad_per_ps[7], rel=1e-10
    )
    for shape in bends:
        assert np.all(shape[:, 0] == 0) or np.all(shape[:, 1] == 0)
    kick = np.zeros((9, 6))
    kick[4, 0] = 1.0
    position, _ = chain.kick_response(TIMES, kick)
    assert np.all(position[..., [1, 2, 3, 5]] == 0)


def test_a_rod_without_rise_separates_and_a_small_rise_changes_little() -> None:
    frequencies = [
        FiniteChain(replace(PAPER, gamma0=np.array([0, 0, rise])), 8, (0,)).frequencies_rad_per_ps
        for rise in (0.0, 1e-6)
    ]
    a = PAPER.spacing_nm
    shear = ScalarChain(np.full(8, PAPER.density_Da_per_nm * a), PAPER.stiffness[0, 0] / a, (0,))
    for expected in shear.frequencies_rad_per_ps:
        # twice: two planes; round-off
        assert np.sum(np.abs(frequencies[0] - expected) < 1e-10) == 2
    # the coupling enters linearly where bend and shear have equal frequencies
    assert frequencies[1] == pytest.approx(frequencies[0], abs=1e-5)


def test_a_hundredfold_shear_bends_as_the_bar_without_shear() -> None:
    stiffness = PAPER.stiffness.copy()
    stiffness[[0, 1], [0, 1]] *= 100
    chain = PlaneChain(replace(PAPER, stiffness=stiffness), 48, (0,))
    length = 47.5 * 0.34
    euler = (1.8751041 / length) ** 2 * np.sqrt(PAPER.stiffness[4, 4] / PAPER.density_Da_per_nm)
    # rotary inertia and the lattice: (1.9 radius of gyration/L)^2 and (1.9/48)^2
    assert chain.frequencies_rad_per_ps[0] == pytest.approx(euler, rel=5e-3)


@pytest.mark.parametrize("soft", [EXTENSION, TWIST])
def test_soft_modes_keep_their_digits_beside_a_stiffness_1e12_times_larger(soft: int) -> None:
    diagonal = np.full(6, 1e4)
    diagonal[soft] = 1e-8
    rod = replace(PAPER, stiffness=np.diag(diagonal))
    chain = FiniteChain(rod, 12, held=(0,))
    inertia = np.append(np.full(3, rod.density_Da_per_nm), np.diag(rod.inertia_Da_nm))
    n = np.arange(1, 12)
    expected = 2 / 0.34 * np.sqrt(1e-8 / inertia[soft]) * np.sin((2 * n - 1) * np.pi / 46)
    # singular values: round-off of the largest frequency, 1e6 times these
    assert chain.frequencies_rad_per_ps[:11] == pytest.approx(expected, rel=1e-8)


def test_a_coupled_stiffness_of_condition_1e12_obeys_the_static_law() -> None:
    basis = scipy.linalg.qr(np.random.default_rng(4).normal(size=(6, 6)))[0]
    stiffness = basis @ np.diag(np.logspace(-6, 6, 6)) @ basis.T
    stiffness = (stiffness + stiffness.T) / 2
    assert np.linalg.cond(stiffness) == pytest.approx(1e12, rel=0.05)
    rod = replace(PAPER, stiffness=stiffness, gamma0=np.zeros(3), omega0_rad_per_nm=np.zeros(3))
    chain = FiniteChain(rod, 4, held=(0,))
    assert np.all(chain.frequencies_rad_per_ps > 0)
    load = np.zeros((4, 6))
    load[-1] = stiffness @ np.ones(6)
    moved = chain.static_response(load)
    # every step carries the load, strain 1; round-off 1e-16 times the condition number, at worst
    assert moved[-1] == pytest.approx(np.full(6, 3 * 0.34), rel=1e-3)


def test_impossible_sequences_are_refused() -> None:
    sequence = StepSequence.uniform(PAPER, 4)
    with pytest.raises(InputError, match="positive definite"):
        replace(sequence, stiffness=-sequence.stiffness)
    with pytest.raises(InputError, match="not symmetric"):
        replace(sequence, mass=sequence.mass + np.triu(np.full((6, 6), 9.0), 1))
    with pytest.raises(InputError, match="gamma0 of the steps has shape"):
        replace(sequence, gamma0=np.zeros((5, 3)))
    with pytest.raises(InputError, match="spacing"):
        sequence.with_steps(slice(0, 1), replace(PAPER, spacing_nm=0.3))
    with pytest.raises(InputError, match="not in a chain"):
        sequence.with_bound(4, body_mass(100.0))
    with pytest.raises(InputError, match="mass of a base pair"):
        sequence.with_bound(0, body_mass(-1e6))
    with pytest.raises(InputError, match="not in a chain"):
        FiniteChain(PAPER, 4, pinned=(7,))
