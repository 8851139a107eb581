"""Motion of the nonlinear rod in time: what is conserved, order 2, its limits, its hard cases."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from dnawaves.errors import InputError, SimulationError
from dnawaves.rod.nonlinear import motion
from dnawaves.rod.nonlinear.chain import NonlinearChain
from dnawaves.rod.nonlinear.energy import energy, gradient
from dnawaves.rod.nonlinear.run import integrate, run
from dnawaves.rod.nonlinear.state import State
from dnawaves.rod.rod import EXTENSION, TWIST, Rod
from dnawaves.rod.sequence import StepSequence, body_mass

PAPER = Rod.paper()


def coupled_rod() -> Rod:
    """A rod with every coupling, curved and twisted, its mass beside the axis and skew to it."""
    rng = np.random.default_rng(1)
    root, scale = rng.normal(size=(6, 6)), np.sqrt(np.diag(PAPER.stiffness))
    axes = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    moments = np.array([1.6, 0.13, 1.7]) * PAPER.inertia_Da_nm[2, 2]
    return replace(
        PAPER,
        stiffness=PAPER.stiffness + 0.1 * np.outer(scale, scale) * (root @ root.T),
        inertia_Da_nm=axes @ np.diag(moments) @ axes.T,
        gamma0=np.array([0.02, -0.05, 1.0]),
        omega0_rad_per_nm=np.array([0.05, 0.1, 1.76]),
        centre_nm=np.array([0.1, -0.04, 0.02]),
    )


def mixed_chain(held: tuple[int, ...] = ()) -> NonlinearChain:
    """Four coupled base pairs, one step softer and bent, one pair with a body bound to its side."""
    rod = coupled_rod()
    bent = replace(rod, stiffness=rod.stiffness / 3, omega0_rad_per_nm=np.array([0.3, 1.5, 1.0]))
    steps = StepSequence.uniform(rod, 4).with_steps(slice(1, 2), bent)
    return NonlinearChain(steps.with_bound(2, body_mass(5000.0, 900.0, (0.4, 0.1, 0.0))), held)


def kicks(seed: int, *shape: int) -> np.ndarray:
    """Velocities of thermal size at about 1000 K: 0.1 nm/ps and 0.3 rad/ps."""
    return np.random.default_rng(seed).normal(size=(*shape, 6)) * np.repeat([0.1, 0.3], 3)


def integrated(chain: NonlinearChain, start: State, time_ps: float) -> State:
    """Return the state later, by Newton's and Euler's equations and an integrator of order 8."""
    n, inertia = chain.bodies, chain.steps.mass[:, 3:, 3:].copy()
    arm = np.zeros((n, 3, 3))
    arm[:, [0, 1, 2], [1, 2, 0]], arm[:, [1, 2, 0], [0, 1, 2]] = -1.0, 1.0
    centres = chain.centres_nm
    for body in range(n):
        c = centres[body]
        inertia[body] -= chain.mass[body] * (c @ c * np.eye(3) - np.outer(c, c))

    def state(y: np.ndarray) -> State:
        places, quaternions, momenta = np.split(y, [3 * n, 7 * n])
        quaternions = quaternions.reshape(n, 4)
        quaternions = quaternions / np.linalg.norm(quaternions, axis=1, keepdims=True)
        return State(places.reshape(n, 3), quaternions, momenta.reshape(n, 6))

    def rates(_: float, y: np.ndarray) -> np.ndarray:
        now = state(y)
        axes = now.axes
        spin = np.stack(
            [np.linalg.solve(inertia[b], axes[b].T @ now.momenta[b, 3:]) for b in range(n)]
        )
        centre = np.einsum("nij,nj->ni", axes, centres)
        turning = np.einsum("nij,nj->ni", axes, spin)
        velocity = now.momenta[:, :3] / chain.mass[:, np.newaxis] - np.cross(turning, centre)
        pull = -np.einsum("nij,nkj->nki", axes, gradient(chain, now).reshape(n, 2, 3))
        torque = pull[:, 1] - np.cross(centre, pull[:, 0])
        vector, scalar = now.quaternions[:, :3], now.quaternions[:, 3:]
        turn = np.hstack(
            [scalar * spin + np.cross(vector, spin), -np.sum(vector * spin, 1, keepdims=True)]
        )
        return np.concatenate(
            [velocity.ravel(), turn.ravel() / 2, np.hstack([pull[:, 0], torque]).ravel()]
        )

    first = np.concatenate([a.ravel() for a in vars(start).values()])
    found = solve_ivp(rates, (0, time_ps), first, "DOP853", rtol=1e-9, atol=1e-10)
    return state(found.y[:, -1])


def test_motion_is_that_of_newton_and_euler_to_second_order_in_the_timestep() -> None:
    chain = mixed_chain()
    start = chain.kicked(chain.at_rest(), kicks(3, 4) * 2)
    end = integrated(chain, start, 0.8)
    errors = []
    for timestep, steps in ((0.02, 40), (0.01, 80), (0.005, 160)):
        found = run(chain, start, timestep, steps, record_every=steps).states[-1]
        errors.append(np.abs(found.displacements_from(end)).max())
    # the next, fourth order: (omega dt)^2 of 4 % at the largest timestep
    assert np.log2(np.divide(errors[:-1], errors[1:])) == pytest.approx(2.0, abs=0.1)
    # (omega dt)^2/24 times omega t = 8 of displacements of 0.5 rad
    assert errors[-1] < 1e-3


@pytest.mark.parametrize(
    ("chain", "timestep"),
    [(NonlinearChain.uniform(PAPER, 8), 0.1), (NonlinearChain.uniform(coupled_rod(), 8), 0.04)],
    ids=["paper", "coupled"],
)
def test_long_runs_keep_momentum_angular_momentum_and_energy(
    chain: NonlinearChain, timestep: float
) -> None:
    start = chain.kicked(chain.at_rest(), kicks(5, 4, 8))
    record = run(chain, start, timestep, 5000, record_every=10)
    momentum = chain.momentum(record.states) - chain.momentum(start)
    size = np.linalg.norm(start.momenta[..., :3], axis=-1).sum(axis=-1)
    # round-off of 5000 kicks, which adds up as a random walk
    assert np.abs(momentum).max() < 1e-13 * size.min()
    turning = chain.angular_momentum(record.states) - chain.angular_momentum(start)
    reach = np.linalg.norm(record.states.origins_nm, axis=-1).max()
    # the same, and round-off of positions that have moved away by `reach`
    assert np.abs(turning).max() < 1e-13 * size.max() * reach
    error = energy(chain, record.states) / energy(chain, start) - 1
    # (omega dt)^2/8 of the fastest waves, of which white noise is full: omega dt is 0.4
    assert np.abs(error).max() < 0.03
    # what grows is lost in what swings: its mean changes by no more than three standard errors,
    # of records of which one in ten is independent of those before
    halves = np.split(error[1:], 2)
    change = np.mean(halves[1] - halves[0], axis=0)
    assert np.all(np.abs(change) < 3 * error.std(axis=0) * np.sqrt(2 / (len(halves[0]) / 10)))


def test_energy_error_falls_as_the_square_of_the_timestep() -> None:
    chain = NonlinearChain.uniform(coupled_rod(), 6)
    start = chain.kicked(chain.at_rest(), kicks(7, 6))
    swings = []
    for timestep in (0.04, 0.02, 0.01):
        record = run(chain, start, timestep, round(8 / timestep))
        swings.append(np.ptp(energy(chain, record.states)))
    # the next order, and where within a swing the records fall
    assert np.log2(np.divide(swings[:-1], swings[1:])) == pytest.approx(2.0, abs=0.15)


@given(st.integers(0, 2**32 - 1))
@settings(max_examples=5, deadline=None)
def test_any_motion_goes_back_to_where_it_came_from(seed: int) -> None:
    chain = mixed_chain(held=(0,))
    start = chain.kicked(chain.at_rest(), kicks(seed, 4) * chain.free[:, np.newaxis])
    there = run(chain, start, 0.05, 100, record_every=100).states[-1]
    back = run(chain, replace(there, momenta=-there.momenta), 0.05, 100, record_every=100).states[
        -1
    ]
    # round-off, grown along the way
    assert np.abs(back.displacements_from(start)).max() < 1e-9
    assert np.abs(there.displacements_from(start)[0]).max() < 1e-14


def test_rods_of_a_batch_move_as_each_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    chain = mixed_chain(held=(0,))
    velocities = kicks(8, 2, 3, 4) * chain.free[:, np.newaxis]
    start = chain.kicked(chain.at_rest(), velocities)
    alone = [[run(chain, start[i, j], 0.05, 50, record_every=25) for j in range(3)] for i in (0, 1)]
    for portion in (6400, 8):
        monkeypatch.setattr(motion, "BODIES_AT_A_TIME", portion)
        together = run(chain, start, 0.05, 50, record_every=25)
        for i, j in np.ndindex(2, 3):
            moved = together.states[:, i, j].displacements_from(alone[i][j].states)
            # round-off in another order of sums
            assert np.abs(moved).max() < 1e-12


def test_timestep_over_the_limit_is_refused_and_would_blow_up() -> None:
    chain = NonlinearChain.uniform(PAPER, 40)
    start = chain.kicked(chain.at_rest(), 1e-3 * kicks(9, 40))
    with pytest.raises(InputError, match=r"0\.42 ps; .* below 0\.4151 ps"):
        run(chain, start, 0.42, 10)
    error = energy(chain, run(chain, start, 0.40, 4000, record_every=10).states)
    # bounded: the energy that leapfrog keeps is 1/(1 - (omega dt/2)^2) = 14 times this at most
    assert error.max() < 14 * energy(chain, start)
    # 0.27 e-folds a step from white noise of 1e-4 rad: 40 to 60 steps, then on to other waves
    with pytest.raises(SimulationError, match=r"link \d+ .* at [\d.]+ ps"):
        integrate(chain, start, 0.42, 4000, record_every=4000)


@pytest.mark.parametrize(
    ("coordinate", "speed"), [(EXTENSION, 8.0), (TWIST, 3.0)], ids=["extension", "twist"]
)
def test_two_bodies_swing_as_a_harmonic_oscillator_at_any_amplitude(
    coordinate: int, speed: float
) -> None:
    """At 8 A/ps the link is pulled through zero length and turned over: Gamma3 < 0."""
    chain = NonlinearChain.uniform(PAPER, 2)
    kick = np.zeros((2, 6))
    kick[:, coordinate] = np.array([-0.5, 0.5]) * speed
    timestep, steps = 0.01, 600
    record = run(chain, chain.kicked(chain.at_rest(), kick), timestep, steps)
    found = np.diff(record.states.displacements_from(chain.at_rest())[..., coordinate])[:, 0]
    omega = (
        2
        / PAPER.spacing_nm
        * np.sqrt(PAPER.stiffness[coordinate, coordinate] / np.diag(PAPER.mass)[coordinate])
        / np.sqrt(2)
    )
    # leapfrog's own frequency and amplitude
    own = 2 / timestep * np.arcsin(omega * timestep / 2)
    swing = speed / omega / np.sqrt(1 - (omega * timestep / 2) ** 2)
    # round-off over 600 steps
    assert found == pytest.approx(swing * np.sin(own * record.times_ps), abs=1e-10 * swing)
    if coordinate == EXTENSION:
        assert found.min() < -PAPER.spacing_nm


def test_a_link_turned_too_far_is_named_with_its_time() -> None:
    chain = NonlinearChain.uniform(PAPER, 2)
    omega = np.sqrt(2 * PAPER.stiffness[TWIST, TWIST] / PAPER.inertia_Da_nm[2, 2]) / 0.34
    kick = np.zeros((2, 6))
    kick[:, TWIST] = np.array([-0.5, 0.5]) * 0.89 * np.pi * omega
    below = run(chain, chain.kicked(chain.at_rest(), kick), 0.005, 1000)
    # (omega dt)^2/8 of the energy
    assert energy(chain, below.states) == pytest.approx(energy(chain, below.states[0]), rel=1e-4)
    time_ps = np.arcsin(0.9 / 0.91) / omega
    with pytest.raises(SimulationError, match=r"link 0 .*0\.90 pi") as error:
        run(chain, chain.kicked(chain.at_rest(), kick * 0.91 / 0.89), 0.005, 1000)
    found = float(str(error.value).split(" at ")[1].split(" ps")[0])
    # the first step beyond
    assert 0 <= found - time_ps < 0.005 * 1.01


@pytest.mark.parametrize("rise", [0.0, 1e-9, 1.0])
def test_rods_of_no_rise_move_like_others(rise: float) -> None:
    """Gamma3 -> 0: the base pairs lie on top of each other and bend no longer shears."""
    rod = replace(PAPER, gamma0=np.array([0.0, 0.0, rise]))
    chain = NonlinearChain.uniform(rod, 8)
    start = chain.kicked(chain.at_rest(), kicks(10, 8))
    swing = energy(chain, run(chain, start, 0.04, 2000, record_every=10).states)
    # (omega dt)^2/8 at omega dt = 0.2
    assert swing == pytest.approx(energy(chain, start), rel=5e-3)


def test_shear_a_hundred_times_stiffer_needs_and_gets_a_shorter_timestep() -> None:
    stiffness = PAPER.stiffness.copy()
    stiffness[[0, 1], [0, 1]] *= 100
    chain = NonlinearChain.uniform(replace(PAPER, stiffness=stiffness), 20)
    # shear is 10 times faster, 50.3 A/ps, and a link turned at its ends adds 100 C/I
    fastest = np.hypot(2 * 50.34 / 3.4, 10 * 1.423)
    assert chain.timestep_limit_ps == pytest.approx(2 / fastest, rel=1e-3)
    start = chain.kicked(chain.at_rest(), kicks(11, 20))
    with pytest.raises(InputError, match="timestep"):
        run(chain, start, 0.07, 1)
    swing = energy(chain, run(chain, start, 0.006, 4000, record_every=10).states)
    # (omega dt)^2/8 at omega dt = 0.2
    assert swing == pytest.approx(energy(chain, start), rel=5e-3)


def test_a_bent_rod_kicked_hard_keeps_its_energy() -> None:
    """Half a circle of 20 base pairs, extension at 2 A/ps: links stretch by a sixth and swing."""
    bent = replace(PAPER, omega0_rad_per_nm=np.array([0.0, np.pi / 20 / 0.34, 0.0]))
    chain = NonlinearChain.uniform(bent, 20)
    kick = np.zeros((20, 6))
    kick[:5, EXTENSION] = 0.2
    kick[8:12, [0, 4]] = 0.2, 1.5
    start = chain.kicked(chain.at_rest(), kick)
    record = run(chain, start, 0.03, 6000, record_every=10)
    error = energy(chain, record.states) / energy(chain, start) - 1
    # (omega dt)^2/8 at omega dt = 0.15
    assert np.abs(error).max() < 3e-3
    turned = np.abs(record.states.displacements_from(record.states[0])[..., 3:]).max()
    assert turned > 1


def test_what_cannot_be_run_is_refused() -> None:
    chain = NonlinearChain.uniform(PAPER, 3, held=(0,))
    rest = chain.at_rest()
    for timestep in (0.0, -0.1, np.nan):
        with pytest.raises(InputError, match="timestep"):
            run(chain, rest, timestep, 1)
    with pytest.raises(InputError, match="3 bodies, not 5"):
        run(NonlinearChain.uniform(PAPER, 5, held=(0,)), rest, 0.1, 1)
    with pytest.raises(InputError, match="at least 1"):
        run(chain, rest, 0.1, 0)
    with pytest.raises(InputError, match="held body has momentum"):
        run(chain, replace(rest, momenta=np.ones((3, 6))), 0.1, 1)
