"""Above 0 K: both signs share snapshot, velocities and noise, so that only the kick differs."""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Any

import numpy as np
import openmm
import pytest
from numpy.typing import NDArray

from dnawaves.errors import InputError, SimulationError
from dnawaves.scene.models import AddedMass, SceneSpec
from dnawaves.system.duplex import SimulatedDuplex
from dnawaves.trajectory.dynamics import Dynamics
from dnawaves.trajectory.integrator import integrator_of
from dnawaves.trajectory.noise import LARGEST_SEED, seed_at
from dnawaves.trajectory.plan import Plan
from dnawaves.trajectory.run import run_member
from dnawaves.trajectory.signed_copy import Copy, moments
from dnawaves.trajectory.steps import read_start
from dnawaves.trajectory.verlet import Bath, driven_leapfrog, leapfrog
from dnawaves.units import BOLTZMANN_KJ_PER_MOL_K

Array = NDArray[np.float64]
MakeScene = Callable[..., SceneSpec]
KICK = {"kind": "kick", "wave": "extension", "velocity_A_per_ps": 1.0, "pairs": 2}
DRIVE = {
    "kind": "periodic",
    "wave": "twist",
    "torque_pN_nm": 100,
    "pairs": 1,
    "frequencies_GHz": [500.0],
}
HELD = {"first": "held", "last": "held"}
THERMOSTAT = {"friction_per_ps": 5.0, "seed": 3}
PLAN = Plan(0.001, 10, 6, frequency_GHz=500.0)


@pytest.fixture(scope="module")
def warm(equilibrated: Any) -> SimulatedDuplex:
    """Return four base pairs in their first snapshot."""
    return equilibrated()[1]


@pytest.fixture(scope="module")
def rigid(equilibrated: Any) -> SimulatedDuplex:
    """Return the same with rigid bonds to hydrogen."""
    return equilibrated(constraints="hbonds")[1]


@pytest.mark.parametrize("excitation", [KICK, DRIVE])
@pytest.mark.parametrize("thermostat", [None, THERMOSTAT])
@pytest.mark.parametrize("platform", ["CPU", "Reference"])
def test_copies_without_a_kick_stay_together_to_the_last_digit(
    warm: SimulatedDuplex, make_scene: MakeScene, excitation: Any, thermostat: Any, platform: str
) -> None:
    scene = make_scene(warm, excitation, thermostat=thermostat)
    # A third that starts from another snapshot's number has other noise.
    copies = [Copy(warm, scene, PLAN, 0.0, 1, platform, snapshot) for snapshot in (1, 1, 2)]
    for _ in range(3):
        for one in copies:
            one.step(10)
    first, second, third = (one.frame()[0] for one in copies)
    np.testing.assert_array_equal(first.positions_nm, second.positions_nm)
    np.testing.assert_array_equal(first.velocities_nm_per_ps, second.velocities_nm_per_ps)
    assert (first.positions_nm != third.positions_nm).any() == (thermostat is not None)
    for one in (copies[0], copies[1]):
        one.restore(first.saved, np.zeros((2, 3)))
        one.step(10)
    anew = [one.state()[0] for one in copies[:2]]
    np.testing.assert_array_equal(*anew)


@pytest.mark.parametrize("thermostat", [None, THERMOSTAT])
@pytest.mark.parametrize("constraints", ["none", "hbonds"])
def test_half_the_difference_of_the_signs_starts_as_the_kick_alone(
    equilibrated: Any, make_scene: MakeScene, thermostat: Any, constraints: str
) -> None:
    duplex = equilibrated(constraints=constraints)[1]
    scene = make_scene(duplex, KICK, thermostat=thermostat)
    motion = run_member(duplex, scene, PLAN, "x1r1", {}).dataset()
    odd = 0.5 * (motion["velocity"].sel(sign=1) - motion["velocity"].sel(sign=-1))
    along = odd.values @ motion["direction"].sel(axis="helix").values
    # 1 Å/ps on pairs 1 and 2 and nothing else; thermal velocities of the pairs are as large. The
    # rest is the tolerance of rigid bonds.
    np.testing.assert_allclose(along[0], [1, 1, 0, 0], atol=1e-5)
    assert np.abs(motion["velocity"].sel(sign=1).values[0, 2:]).max() > 0.2
    put_in = motion["injected_momentum"].values[0, 0]
    kicked = motion["mass"].values[:2].sum()
    np.testing.assert_allclose(np.linalg.norm(put_in), kicked, rtol=1e-9)
    # The difference's energy is that of the kick: 1 kJ/mol is 100 Da (Å/ps)².
    energy = motion["difference_kinetic_energy"].values
    assert energy[0] == pytest.approx(kicked / 200, rel=1e-4)
    # 0.05 ps later it has hardly begun to spread.
    assert 0.5 < energy[-1] / energy[0] < 1.1
    assert motion.attrs["temperature_K"] == 300
    assert ("thermostat_friction_per_ps" in motion.attrs) == (thermostat is not None)


def test_an_equilibrium_run_has_one_copy_and_its_temperature(
    rigid: SimulatedDuplex, make_scene: MakeScene
) -> None:
    scene = make_scene(rigid, {"kind": "none"}, thermostat=THERMOSTAT)
    plan = Plan(0.002, 20, 101)
    motion = run_member(rigid, scene, plan, "r1", {}).dataset()
    assert motion.sizes["sign"] == 1
    kelvin = motion["kinetic_temperature_K"].values[0, 25:]
    # 3 * 250 atoms less 92 rigid bonds: 658 degrees of freedom, each frame's temperature scatters
    # by sqrt(2/658) = 5.5 %; over 3 ps at a friction of 5/ps some 15 are independent: 1.4 %. Five
    # times that.
    assert kelvin.mean() == pytest.approx(300, rel=0.07)
    assert kelvin.std() == pytest.approx(300 * np.sqrt(2 / 658), rel=0.5)


def test_rigid_bonds_stay_rigid_and_energy_is_conserved_with_them(
    rigid: SimulatedDuplex, make_scene: MakeScene
) -> None:
    scene = make_scene(rigid, KICK)
    one = Copy(rigid, scene, Plan(0.001, 10, 2), 1.0, threads=1)
    system, bonds = rigid.system, []
    for index in range(system.getNumConstraints()):
        i, j, distance = system.getConstraintParameters(index)
        bonds.append((i, j, distance._value))
    i, j, lengths = (np.array(column) for column in zip(*bonds, strict=True))
    before, _ = one.frame()
    for _ in range(10):
        one.step(10)
    after, _ = one.frame()
    for frame in (before, after):
        bond = frame.positions_nm[i] - frame.positions_nm[j]
        speed = frame.velocities_nm_per_ps[i] - frame.velocities_nm_per_ps[j]
        # The tolerances of the constraints, 1e-7 and 1e-8 relative.
        np.testing.assert_allclose(np.linalg.norm(bond, axis=1), lengths, rtol=1e-6)
        assert np.abs(np.sum(bond * speed, axis=1)).max() < 1e-5
    # A leapfrog's energy oscillates by (omega dt)²/8 of what is in each mode: 1e-2 of the double
    # bonds' 1e2 kJ/mol at 1 fs, in random phases.
    assert abs(after.energy_kJ_per_mol - before.energy_kJ_per_mol) < 3


def test_the_driven_leapfrog_without_drive_is_openmms_with_rigid_bonds_too(
    rigid: SimulatedDuplex, make_scene: MakeScene
) -> None:
    found = []
    for excitation in ({"kind": "none"}, DRIVE):
        one = Copy(rigid, make_scene(rigid, excitation), PLAN, 0.0, 1, "Reference")
        one.step(10)
        found.append(one.frame()[0])
    plain, driven = found
    # Both keep the bonds to the constraints' tolerance, by different iterations.
    np.testing.assert_allclose(driven.positions_nm, plain.positions_nm, atol=1e-7)
    np.testing.assert_allclose(driven.velocities_nm_per_ps, plain.velocities_nm_per_ps, atol=1e-4)


@pytest.mark.parametrize("wave", ["extension", "twist"])
def test_work_and_momentum_of_a_pulse_balance_in_a_warm_duplex_with_rigid_bonds(
    rigid: SimulatedDuplex, make_scene: MakeScene, wave: str
) -> None:
    load = {"force_pN": 5000} if wave == "extension" else {"torque_pN_nm": 2000}
    pulse = {"kind": "pulse", "wave": wave, "pairs": 2, "width_fs": 40, **load}
    one = Copy(rigid, make_scene(rigid, pulse), Plan(0.001, 10, 8, pulse_width_ps=0.04), 4.0, 1)
    before, _ = one.frame()
    for _ in range(40):
        one.step(10)
        after, injected = one.frame()
    masses = rigid.masses_Da[:, None]
    put_in = injected.momenta
    found = moments(after.positions_nm, masses * after.velocities_nm_per_ps) - moments(
        before.positions_nm, masses * before.velocities_nm_per_ps
    )
    # Single precision of the forces, and the torque, which is followed from frame to frame.
    for part, whole in zip(found, put_in, strict=True):
        np.testing.assert_allclose(
            part, whole, atol=0.01 * np.abs(put_in[int(wave == "twist")]).max()
        )
    gained = after.energy_kJ_per_mol - before.energy_kJ_per_mol
    # Of some hundred kJ/mol; the thermal energy at 1 fs varies by some 0.4.
    assert gained == pytest.approx(injected.work_kJ_per_mol, rel=0.01, abs=1.5)
    assert injected.work_kJ_per_mol > 100


def test_the_driven_leapfrogs_bath_is_openmms_langevin_middle() -> None:
    """At 0 K friction alone is left, and both must agree; above, the temperature must be right."""
    positions, velocities = np.random.default_rng(1).normal(size=(2, 500, 3))

    def dynamics(integrator: openmm.Integrator, drive: bool) -> Dynamics:
        system = openmm.System()
        spring = openmm.CustomExternalForce("50*(x^2 + y^2 + z^2)")
        for particle in range(500):
            system.addParticle(12.0)
            spring.addParticle(particle, [])
        system.addForce(spring)
        pushed = np.zeros((500, 3)) if drive else None
        one = Dynamics(system, integrator, pushed, platform="Reference", seeds=(1,))
        one.start(0.1 * positions, velocities)
        return one

    friction, step_ps = 3.0, 0.02
    cold = [
        dynamics(openmm.LangevinMiddleIntegrator(0, friction, step_ps), False),
        dynamics(driven_leapfrog(step_ps, "0", bath=Bath(0.0, friction)), True),
    ]
    for one in cold:
        one.step(40)
    first, second = (one.frame() for one in cold)
    # Round-off of 40 steps.
    np.testing.assert_allclose(second.positions_nm, first.positions_nm, atol=1e-12)
    np.testing.assert_allclose(second.velocities_nm_per_ps, first.velocities_nm_per_ps, atol=1e-12)

    warm = dynamics(driven_leapfrog(step_ps, "0", bath=Bath(300.0, friction)), True)
    squares = []
    for _ in range(20):
        warm.step(100)
        squares.append(np.mean(warm.frame().positions_nm ** 2))
    # <k x²> = kT; 20 moments 2 ps apart of 1500 coordinates: sqrt(2/30000) = 0.8 %, times four.
    expected = BOLTZMANN_KJ_PER_MOL_K * 300 / 100
    assert np.mean(squares) == pytest.approx(expected, rel=0.033)


def test_an_explosion_is_told_even_where_noise_cannot_be_repeated(
    warm: SimulatedDuplex, make_scene: MakeScene
) -> None:
    scene = make_scene(warm, KICK, thermostat=THERMOSTAT)
    # 3.2 fs is beyond the limit of the bonds' stretches, 2.86 fs.
    with pytest.raises(SimulationError) as error:
        run_member(warm, scene, Plan(0.0032, 100, 50), "x1r1", {})
    pattern = (
        r"test x1r1: after \d+\.\d{3} ps, (in step \d+|within 100 steps), "
        r"atom \d+ \([AB]:\d \S+\) moves at \S+ nm/ps under a force of \S+ kJ/mol/nm, atom .*"
    )
    assert re.fullmatch(pattern, str(error.value))


def test_held_pairs_stay_where_the_snapshot_has_them(
    warm: SimulatedDuplex, make_scene: MakeScene
) -> None:
    scene = make_scene(warm, KICK | {"pairs": 1}, HELD, thermostat=THERMOSTAT)
    motion = run_member(warm, scene, PLAN, "x1r1", {}).dataset()
    held, free = motion.isel(pair=[0, 3]), motion.isel(pair=[1, 2])
    assert not held["velocity"].values.any()
    # Round-off of a singular value decomposition.
    np.testing.assert_allclose(held["displacement"], 0, atol=1e-12)
    assert (np.abs(free["velocity"].values) > 0.01).any(axis=-1).all()


def test_a_pair_that_carries_mass_starts_at_the_same_temperature(
    equilibrated: Any, make_scene: MakeScene
) -> None:
    files = equilibrated()
    scene = make_scene(files[1], KICK)
    loaded = scene.model_copy(update={"masses": (AddedMass(pair=2, mass_Da=5000),)})
    energies = []
    for one in (scene, loaded):
        duplex = read_start(one, files.built_file, files.equilibrated_file, "x1r1")
        assert duplex.velocities_nm_per_ps is not None
        energies.append(duplex.masses_Da @ np.sum(duplex.velocities_nm_per_ps**2, axis=1))
    assert energies[1] == pytest.approx(energies[0], rel=1e-12)  # round-off


def test_a_restrained_duplex_swings_as_its_stiffness_says(
    relaxed: Any, make_scene: MakeScene
) -> None:
    """All six pairs on springs of stiffness K each, kicked alike along the axis."""
    duplex, stiffness_pN_per_nm = relaxed.duplex, 5000.0
    ends = {
        "first": "restrained",
        "last": "restrained",
        "pairs": 3,
        "stiffness_pN_per_nm": stiffness_pN_per_nm,
    }
    kick = {"kind": "kick", "wave": "extension", "velocity_A_per_ps": 0.2, "pairs": 6}
    scene = make_scene(duplex, kick | {"first_pair": 1}, ends)
    motion = run_member(duplex, scene, Plan(0.002, 25, 41), "x1", {}).dataset()
    masses, axis = motion["mass"].values, motion["direction"].sel(axis="helix").values
    odd = 0.5 * (motion["displacement"].sel(sign=1) - motion["displacement"].sel(sign=-1)).values
    centre_A = (odd @ axis) @ masses / masses.sum()
    # A pN/nm is 1e-3 N/m; a Da 1.66053907e-27 kg.
    omega = np.sqrt(6 * 1e-3 * stiffness_pN_per_nm / (masses.sum() * 1.66053907e-27)) * 1e-12
    times_ps = motion["time"].values
    # Pairs differ in mass by 2e-3 and so in their own frequency: what that stirs up between them
    # comes back to the centre of mass in second order only.
    expected = 0.2 / omega * np.sin(omega * times_ps)
    np.testing.assert_allclose(centre_A, expected, atol=1e-3 * expected.max())
    assert omega * times_ps[-1] > 3


def test_rigid_bonds_of_frozen_atoms_are_refused_before_the_run(
    rigid: SimulatedDuplex, make_scene: MakeScene
) -> None:
    with pytest.raises(InputError, match=r"constraints: found \d+ that touch frozen atoms"):
        Copy(rigid, make_scene(rigid, KICK, HELD), PLAN, 1.0, threads=1)


def test_an_unknown_platform_is_refused_with_the_known(
    warm: SimulatedDuplex, make_scene: MakeScene
) -> None:
    with pytest.raises(InputError, match=r"platform: found 'Cuba'; allowed: .*CPU.*Reference"):
        Dynamics(warm.system, leapfrog(0.001), platform="Cuba")
    scene = make_scene(warm, {"kind": "none"})
    motion = run_member(warm, scene, Plan(0.001, 1, 2), "r1", {}, platform="Reference").dataset()
    assert motion.attrs["platform"] == "Reference"


def test_seeds_tell_runs_and_steps_apart_and_are_never_zero() -> None:
    seeds = [seed_at((one, two), step) for one in range(5) for two in (1, 2) for step in (0, 10)]
    assert len(set(seeds)) == len(seeds)
    assert all(0 < seed <= LARGEST_SEED for seed in seeds)
    assert seed_at((1, 2), 3) == seed_at((1, 2), 3)


def test_the_integrator_is_the_simplest_that_does(
    warm: SimulatedDuplex, make_scene: MakeScene
) -> None:
    def kind(excitation: Any, thermostat: Any) -> str:
        scene = make_scene(warm, excitation, thermostat=thermostat)
        return type(integrator_of(scene, PLAN)).__name__

    assert kind(KICK, None) == "VerletIntegrator"
    assert kind(KICK, THERMOSTAT) == "LangevinMiddleIntegrator"
    assert kind(DRIVE, None) == kind(DRIVE, THERMOSTAT) == "CustomIntegrator"
