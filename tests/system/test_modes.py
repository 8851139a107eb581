"""Normal modes: chains of known stiffness to round-off, and the relaxed duplex."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import scipy.linalg
import scipy.sparse
from numpy.typing import NDArray

from dnawaves.errors import InputError, SimulationError
from dnawaves.files import write_json
from dnawaves.frames.fit import Frames
from dnawaves.frames.strain import step_strains
from dnawaves.rod.oscillator import impulse_response
from dnawaves.system.instability import SPOILT, instability
from dnawaves.system.modes import NormalModes, normal_modes, participation
from dnawaves.system.modes_file import read_modes
from dnawaves.system.rigid_body import RigidBodies
from dnawaves.system.steps import modes_step
from dnawaves.system.stiffness import base_pair_frames, strain_compliance, strain_shapes
from dnawaves.system.structure_factor import (
    COORDINATES,
    axis_shapes,
    velocity_structure_factor,
)

Array = NDArray[np.float64]
PAIRS, BEADS = 6, 5
INSIDE_PER_PS2 = 1e4


class Chain:
    """Bodies of beads; the energy is a known quadratic form of the bodies' rigid motion.

    Motion inside the bodies is stiff and by itself, so the bodies obey M q'' = -K q exactly.
    """

    def __init__(self, stiffness: Array, positions_nm: Array, masses_Da: Array, pairs: Any) -> None:
        self.pairs, self.masses_Da = pairs, masses_Da
        self.bodies = RigidBodies(positions_nm, masses_Da, pairs)
        to_bodies = self.bodies.velocity_map().toarray()
        count = len(self.bodies.masses_Da)
        self.mass = self.bodies.momenta(np.eye(6 * count).reshape(-1, count, 6)).reshape(
            6 * count, -1
        )
        inside = np.diag(np.repeat(masses_Da, 3)) - to_bodies.T @ self.mass @ to_bodies
        hessian = to_bodies.T @ stiffness @ to_bodies + INSIDE_PER_PS2 * inside
        self.hessian = scipy.sparse.csr_array(hessian)

    def modes(self, held: int) -> NormalModes:
        return normal_modes(self.hessian, self.masses_Da, self.bodies, self.pairs >= held)


def beads(seed: int) -> tuple[Array, Array, Any]:
    generator = np.random.default_rng(seed)
    pairs = generator.permutation(np.arange(PAIRS * BEADS) % PAIRS)
    positions_nm = generator.normal(0, 0.4, (len(pairs), 3)) + 0.34 * pairs[:, None]
    return positions_nm, generator.uniform(1, 31, len(pairs)), pairs


def linked(seed: int) -> Array:
    """Return a random stiffness (6 N, 6 N) between neighbours."""
    generator = np.random.default_rng(seed)
    stiffness = np.zeros((6 * PAIRS, 6 * PAIRS))
    for pair in range(PAIRS - 1):
        root = 10 * (np.eye(6, 12, k=6) - np.eye(6, 12) + 0.1 * generator.normal(size=(6, 12)))
        stiffness[6 * pair : 6 * pair + 12, 6 * pair : 6 * pair + 12] += root.T @ root
    return stiffness


def test_a_kicked_chain_moves_as_its_equation_says() -> None:
    stiffness = linked(1)
    chain, held, time_ps = Chain(stiffness, *beads(2)), 1, 0.7
    kick = np.random.default_rng(3).normal(size=(PAIRS, 6))
    kick[:held] = 0
    modes = chain.modes(held)
    amplitudes = modes.amplitudes(chain.bodies.momenta(kick))
    response = impulse_response([time_ps], modes.frequencies_rad_per_ps, 0.0)
    position, velocity = (modes.motion(amplitudes * part)[0].ravel() for part in response)
    free = slice(6 * held, None)
    n = 6 * (PAIRS - held)
    generator = np.zeros((2 * n, 2 * n))
    generator[:n, n:] = np.eye(n)
    generator[n:, :n] = -np.linalg.solve(chain.mass[free, free], stiffness[free, free])
    exact = scipy.linalg.expm(time_ps * generator) @ np.append(np.zeros(n), kick.ravel()[free])
    # Round-off of an eigenproblem whose eigenvalues span seven powers of ten.
    np.testing.assert_allclose(position[free], exact[:n], atol=1e-9 * np.abs(exact[:n]).max())
    np.testing.assert_allclose(velocity[free], exact[n:], atol=1e-9 * np.abs(exact[n:]).max())
    assert not position[: 6 * held].any()
    # What the kick put in is kinetic energy of the rigid motion, and all modes hold it.
    put_in = 0.5 * kick.ravel() @ chain.mass @ kick.ravel()
    assert 0.5 * amplitudes @ amplitudes == pytest.approx(put_in, rel=1e-12)


def test_a_held_chain_gives_way_as_its_inverse_stiffness_says() -> None:
    stiffness = linked(4)
    chain = Chain(stiffness, *beads(5))
    modes = chain.modes(1)
    forces = np.random.default_rng(6).normal(size=(PAIRS, 6))
    exact = np.linalg.solve(stiffness[6:, 6:], forces.ravel()[6:])
    # Round-off times the condition of the modes' eigenvalues, some 1e5.
    found = modes.static_response(forces).ravel()[6:]
    np.testing.assert_allclose(found, exact, atol=1e-10 * np.abs(exact).max())


def test_a_free_chain_refuses_what_would_carry_it_away(relaxed: Any) -> None:
    duplex = relaxed.duplex
    modes = free_modes(relaxed)
    push = np.zeros((duplex.pair_count, 6))
    push[0, 2] = 1.0
    with pytest.raises(InputError, match="do not balance"):
        modes.static_response(push)
    push[-1, 2] = -1.0
    # Two opposite forces off one line turn the duplex: their torque balances too.
    arm = duplex.bodies.centres_nm[-1] - duplex.bodies.centres_nm[0]
    push[-1, 3:] = np.cross(arm, [0, 0, 1.0])
    assert (modes.static_response(push)[0] - modes.static_response(push)[-1])[2] > 0


def test_a_structure_that_is_no_minimum_is_refused() -> None:
    chain = Chain(linked(1) - 5.0 * np.eye(6 * PAIRS), *beads(2))
    with pytest.raises(SimulationError, match="no minimum: its lowest eigenvalue is -"):
        _ = chain.modes(1).frequencies_rad_per_ps


def test_a_vibration_that_does_not_push_back_has_no_static_answer() -> None:
    modes = Chain(linked(1), *beads(2)).modes(1)
    # Within the tolerance of a minimum: its waves do not grow in the time of a record.
    values = modes.eigenvalues_per_ps2.copy()
    values[0] = -5e-5
    soft = replace(modes, eigenvalues_per_ps2=values)
    assert soft.frequencies_rad_per_ps[0] == 0
    for answer in (soft.static_response, lambda forces: soft.compliance(soft.shapes)):
        with pytest.raises(SimulationError, match="a vibration has the eigenvalue -5e-05 "):
            answer(np.ones((PAIRS, 6)))


def test_growth_along_a_negative_mode_starts_when_it_says() -> None:
    chain = Chain(linked(1) - 5.0 * np.eye(6 * PAIRS), *beads(2))
    weights = np.repeat(1 / np.sqrt(chain.masses_Da), 3)
    values, vectors = scipy.linalg.eigh(chain.hessian.toarray() * np.outer(weights, weights))
    found = instability(values, vectors, chain.masses_Da, chain.bodies)
    assert found.modes == int(np.sum(values < 0)) > 1
    modes = chain.modes(0)
    # By brute force: after the kick of each one pair that is most along each negative mode, the
    # velocity that has been added by growth, over all that was put in.
    onsets = []
    for mode in np.flatnonzero(values < 0):
        rate = np.sqrt(-values[mode])
        times = np.linspace(0, 20 / rate, 200_001)
        for pair in range(PAIRS):
            kick = np.zeros((PAIRS, 6))
            kick[pair] = modes.shapes[mode, pair]
            amplitudes = modes.amplitudes(chain.bodies.momenta(kick))
            growth = np.abs(amplitudes[mode]) * (np.cosh(rate * times) - 1)
            onsets.append(times[np.argmax(growth >= SPOILT * np.linalg.norm(amplitudes))])
    # To a step of the grid, one part in 1e4 of a growth time.
    assert found.onset_ps == pytest.approx(min(onsets), rel=1e-3)
    assert f"{found.modes} negative modes" in str(found)
    assert f"from {found.onset_ps:.3g} ps on" in str(found)


def test_a_minimum_has_no_growth(relaxed: Any) -> None:
    duplex = relaxed.duplex
    values = np.array([-1e-6, 0.5])  # round-off of a rigid motion, and a vibration
    vectors = np.zeros((3 * len(duplex.masses_Da), 2))
    found = instability(values, vectors, duplex.masses_Da, duplex.bodies)
    assert (found.modes, str(found)) == (0, "no mode is negative")


@pytest.fixture(scope="module")
def free(relaxed: Any) -> NormalModes:
    return free_modes(relaxed)


def free_modes(relaxed: Any) -> NormalModes:
    duplex = relaxed.duplex
    everything = np.ones(len(duplex.masses_Da), dtype=bool)
    hessian = scipy.sparse.csr_array(relaxed.hessian)
    return normal_modes(hessian, duplex.masses_Da, duplex.bodies, everything)


def test_a_free_duplex_has_six_rigid_motions(relaxed: Any, free: NormalModes) -> None:
    duplex = relaxed.duplex
    assert (~free.vibrations).sum() == free.rigid == 6
    rigid = free.shapes[~free.vibrations]
    # A rigid motion: every pair turns alike, and its centre moves with the turn.
    turn = rigid[:, :, 3:]
    # Differences of forces mix in the softest vibrations by their error over their eigenvalue.
    np.testing.assert_allclose(turn, np.repeat(turn[:, :1], 6, axis=1), atol=1e-6)
    centres = duplex.bodies.centres_nm
    moved = rigid[:, :1, :3] + np.cross(turn, centres - centres[0])
    np.testing.assert_allclose(rigid[:, :, :3], moved, atol=1e-6)
    # No step is strained; a vibration strains by 0.01 Å and more.
    strains = np.abs(strain_shapes(free, duplex)).max(axis=(1, 2))
    assert strains[~free.vibrations].max() < 1e-4
    # All the energy of a rigid motion is in the pairs, none inside them but that of what is mixed
    # in, 1e-6 squared.
    shares = sum(share.sum(axis=1) for share in participation(free, duplex).values())
    np.testing.assert_allclose(shares[~free.vibrations], 1, atol=1e-9)


def test_equipartition_holds_for_every_pair(relaxed: Any, free: NormalModes) -> None:
    # ⟨q' q'ᵀ⟩ = kBT M⁻¹, whatever the potential: the modes are complete, to the round-off of
    # products of shapes and momenta whose units differ a thousandfold.
    flat = free.shapes.reshape(len(free.shapes), -1)
    momenta = relaxed.duplex.bodies.momenta(free.shapes).reshape(len(free.shapes), -1)
    np.testing.assert_allclose(flat.T @ momenta, np.eye(flat.shape[1]), atol=1e-9)


def test_participation_is_a_share(relaxed: Any, free: NormalModes) -> None:
    duplex = relaxed.duplex
    shares = participation(free, duplex)
    total = sum(share.sum(axis=1) for share in shares.values())
    # Between none and all, to round-off.
    assert total.min() > -1e-12
    assert total.max() < 1 + 1e-9
    # A hydrogen's bond vibrates at 400 rad/ps and more inside its pair; the softest vibrations
    # of the duplex are waves.
    assert total[free.frequencies_rad_per_ps > 400].max() < 0.02
    assert total[6:10].min() > 0.5
    # Over all modes each wave's coordinate of each pair holds its degrees of freedom: round-off.
    for wave, degrees in {"extension": 1, "twist": 1, "bend": 2, "shear": 2}.items():
        np.testing.assert_allclose(shares[wave].sum(axis=0), degrees, atol=1e-9)


@pytest.mark.parametrize("wave", ["extension", "twist"])
def test_static_load_of_the_held_duplex(relaxed: Any, wave: str) -> None:
    duplex = relaxed.duplex
    moving = duplex.pairs >= 1
    hessian = scipy.sparse.csr_array(relaxed.hessian)
    modes = normal_modes(hessian, duplex.masses_Da, duplex.bodies, moving)
    # A load in the shape of the last pair's own rigid motion along or about the axis.
    motion = np.zeros((duplex.pair_count, 6))
    axis = duplex.frame.axis
    lever = duplex.bodies.centres_nm[-1] - duplex.pivots_nm[-1]
    motion[-1] = [*axis, 0, 0, 0] if wave == "extension" else [*np.cross(axis, lever), *axis]
    forces = duplex.bodies.momenta(motion)
    atoms = np.zeros_like(duplex.positions_nm)
    last = duplex.pairs == duplex.pair_count - 1
    arms = duplex.positions_nm[last] - duplex.bodies.centres_nm[-1]
    atoms[last] = motion[-1, :3] + np.cross(motion[-1, 3:], arms)
    push = (duplex.masses_Da[:, None] * atoms).ravel()
    free = np.repeat(moving, 3)
    moved = np.zeros(free.shape)
    moved[free] = np.linalg.solve(relaxed.hessian[np.ix_(free, free)], push[free])
    expected = duplex.bodies.velocity_map() @ moved
    # Round-off times the Hessian's condition of 1e6.
    largest = np.abs(expected).max()
    found = modes.static_response(forces)
    np.testing.assert_allclose(found.ravel(), expected, atol=1e-7 * largest)
    # The static compliance against a load is the sum over modes of their share over ω²: static
    # load and modes are one and the same answer.
    amplitudes = modes.amplitudes(forces)
    work = np.sum(amplitudes**2 / modes.eigenvalues_per_ps2)
    assert work == pytest.approx(float(push @ moved), rel=1e-7)


def test_lowest_mode_and_static_load_give_a_uniform_chain_the_same_stiffness() -> None:
    # Bodies of one kind, held at both ends, linked in extension and twist by uniform springs.
    count, spring = 8, np.diag([3e3, 3e3, 3e3, 40.0, 40.0, 40.0])
    corners = 0.5 * np.array([[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]])
    positions_nm = np.concatenate([corners + np.array([0, 0, 0.34 * n]) for n in range(count)])
    links = 2 * np.eye(count) - np.eye(count, k=1) - np.eye(count, k=-1)
    links[0, 0] = links[-1, -1] = 1
    pairs = np.repeat(np.arange(count), len(corners))
    chain = Chain(np.kron(links, spring), positions_nm, np.full(len(pairs), 20.0), pairs)
    inner = (pairs > 0) & (pairs < count - 1)
    modes = normal_modes(chain.hessian, chain.masses_Da, chain.bodies, inner)
    sine = np.sin(np.pi * np.arange(count) / (count - 1))
    for component in (2, 5):  # along and about the axis
        shape = np.zeros((count, 6))
        shape[:, component] = sine
        momenta = chain.bodies.momenta(shape)
        amplitudes = modes.amplitudes(momenta)
        # ω = 2 √(k/m) sin(π/2(N-1)), and so is √(load / response) under a load of that shape.
        mass = momenta[1, component] / sine[1]
        stiffness = spring[component, component]
        exact = 2 * np.sqrt(stiffness / mass) * np.sin(np.pi / (2 * (count - 1)))
        strongest = np.argmax(np.abs(amplitudes))
        # Both exact but for round-off.
        assert modes.frequencies_rad_per_ps[strongest] == pytest.approx(exact, rel=1e-9)
        response = modes.static_response(momenta)[:, component]
        assert np.sqrt(sine.sum() / response.sum()) == pytest.approx(exact, rel=1e-9)
    # The structure factor has its ridge where the lattice has its branch.
    shapes = modes.shapes[:, 1:-1]
    frequencies_GHz = np.linspace(0, 4000, 2001)
    factor = velocity_structure_factor(
        modes, shapes, np.array([np.pi / 2]), frequencies_GHz, width_GHz=60.0
    )
    lattice_GHz = 1e3 / np.pi * np.sqrt(3e3 / 80.0) * np.sin(np.pi / 4)
    # Six free bodies resolve a wavenumber to one mode's distance, about a sixth of the band.
    assert frequencies_GHz[np.argmax(factor[2, 0])] == pytest.approx(lattice_GHz, rel=0.15)


def test_structure_factor_holds_all_of_equipartition(relaxed: Any, free: NormalModes) -> None:
    duplex = relaxed.duplex
    # Beyond the fastest bond vibration, 111 THz; a trapezoid of lines 400 GHz wide.
    frequencies_GHz = np.arange(0.0, 120_000.0, 100.0)
    phases = np.array([0.0, 1.0, np.pi])
    factor = velocity_structure_factor(
        free, axis_shapes(free, duplex), phases, frequencies_GHz, width_GHz=400.0
    )
    total = np.trapezoid(factor, frequencies_GHz)
    along = COORDINATES.index("extension")
    inverse_mass = np.mean(1 / duplex.bodies.masses_Da)
    lever = duplex.bodies.centres_nm - duplex.pivots_nm
    own = np.linalg.inv(duplex.bodies.inertia_Da_nm2)
    crossed = np.cross(duplex.frame.axis, lever)
    # The point on the axis moves with the turn as well: ⟨v²⟩ = 1/m + (e × r) I⁻¹ (e × r).
    expected = inverse_mass + np.mean(np.einsum("nx,nxy,ny->n", crossed, own, crossed))
    # Rigid motions are left out: at q = 0 the whole moves, away from it they hold a few percent;
    # half of the lines below 400 GHz is drawn beyond zero.
    assert total[along, 2] == pytest.approx(expected, rel=0.1)
    assert total[along, 0] < total[along, 2]


def test_compliance_of_steps_of_known_stiffness(relaxed: Any) -> None:
    duplex = relaxed.duplex
    frames = base_pair_frames(duplex)
    generator = np.random.default_rng(9)
    roots = generator.normal(size=(duplex.pair_count - 1, 6, 6)) + 3 * np.eye(6)
    steps = 30.0 * roots @ roots.swapaxes(1, 2)  # kJ/mol per Å or rad, squared
    strains = strains_by_differences(duplex, frames)  # per nm and rad
    stiffness = np.einsum("sai,sab,sbj->ij", strains, steps, strains)
    chain = Chain(stiffness, duplex.positions_nm, duplex.masses_Da, duplex.pairs)
    compliance = strain_compliance(chain.modes(0), duplex)
    for one, step in enumerate(steps):
        for other in range(len(steps)):
            expected = np.linalg.inv(step) if one == other else np.zeros((6, 6))
            # Differences of strains: 1e-5 squared over six, and round-off over 1e-5.
            np.testing.assert_allclose(compliance[one, :, other], expected, atol=1e-7)


def strains_by_differences(duplex: Any, frames: Frames) -> Array:
    """Return the strains (N-1, 6, 6 N) per displacement in nm and rotation of each pair."""
    delta = 1e-5
    columns = []
    for pair in range(duplex.pair_count):
        lever = frames.origin[:, pair] - 10 * duplex.bodies.centres_nm[pair]
        for component in range(6):
            moved = []
            for sign in (1, -1):
                origin, axes = frames.origin.copy(), frames.axes.copy()
                if component < 3:
                    origin[component, pair] += sign * 10 * delta
                else:
                    turn = scipy.spatial.transform.Rotation.from_rotvec(
                        sign * delta * np.eye(3)[component - 3]
                    )
                    origin[:, pair] += turn.apply(lever) - lever
                    axes[:, :, pair] = turn.apply(axes[:, :, pair])
                moved.append(step_strains(Frames(origin, axes)).values)
            columns.append((moved[0] - moved[1]).T / (2 * delta))
    return np.moveaxis(np.array(columns), 0, -1)


def test_modes_from_files(relaxed: Any, tmp_path: Any) -> None:
    duplex = relaxed.duplex
    write_json(tmp_path / "system.json", duplex.spec.model_dump(mode="json"))
    files = (relaxed.built_file, relaxed.relaxed_file, relaxed.hessian_file)
    output = tmp_path / "modes" / "0-2.nc"
    modes_step(tmp_path / "system.json", *files, (0, 2), output)
    modes = read_modes(output, duplex, (0, 2))
    assert modes.rigid == 0
    assert not modes.shapes[:, -2:].any()
    # Held at one end, six base pairs still bend softly, and everything holds.
    assert modes.eigenvalues_per_ps2[0] > 1e-3
    with pytest.raises(InputError, match=r"0 and 2 base pairs held; allowed: .* with 0 and 1"):
        read_modes(output, duplex, (0, 1))
    with pytest.raises(InputError, match="fewer than 6 together"):
        modes_step(tmp_path / "system.json", *files, (3, 3), output)
