"""The harmonic answer: what a simulation of a small kick with a small timestep converges to."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
import scipy.sparse
import xarray as xr
from numpy.typing import NDArray
from scipy.integrate import cumulative_simpson
from scipy.spatial.distance import pdist

from dnawaves.errors import InputError
from dnawaves.files import read_netcdf, write_json
from dnawaves.scene.models import SceneSpec
from dnawaves.scene.pairs import held_counts, held_pairs
from dnawaves.system.duplex import SimulatedDuplex
from dnawaves.system.modes import NormalModes, normal_modes
from dnawaves.system.relax import relax
from dnawaves.system.steps import modes_step
from dnawaves.trajectory.dynamics import Dynamics
from dnawaves.trajectory.harmonic import respond
from dnawaves.trajectory.pattern import forces_at_full_strength, kick_pattern
from dnawaves.trajectory.plan import Plan
from dnawaves.trajectory.record import Recorder
from dnawaves.trajectory.run import run_member
from dnawaves.trajectory.signed_copy import hold
from dnawaves.trajectory.steps import simulate_step
from dnawaves.trajectory.verlet import leapfrog

Array = NDArray[np.float64]
MakeScene = Callable[..., SceneSpec]
FAR_HELD = {"first": "free", "last": "held"}
HELD = {"first": "held", "last": "held"}
QUANTITIES = ("displacement", "rotation", "velocity", "angular_velocity")
MINIMUM = -1000.0


def odd(motion: xr.Dataset, name: str) -> Array:
    """Return half the difference of the two signs, (time, pair, xyz)."""
    return 0.5 * (motion[name].sel(sign=1) - motion[name].sel(sign=-1)).values


def difference(one: xr.Dataset, other: xr.Dataset, name: str, factor: float = 1.0) -> float:
    """Return the largest difference of two records' signals over the largest of the second."""
    reference = odd(other, name)
    return float(np.abs(factor * odd(one, name) - reference).max() / np.abs(reference).max())


@pytest.fixture(scope="module")
def smooth(as_built: Callable[..., SimulatedDuplex]) -> tuple[SimulatedDuplex, NormalModes]:
    """Return four base pairs with all atoms within the cutoff, and their modes.

    At a cutoff the stiffness of a pair of atoms jumps, so the answer to a kick that moves pairs
    across it is not analytic in the kick. Here nothing jumps.
    """
    built = as_built("CGAT", cutoff_nm=3.0, switch_nm=2.9, relaxation={"anneal_ps": 0.2})
    record, hessian = relax(built, 1, lambda line: None)
    duplex = built.with_positions(record["position_nm"].values)
    assert pdist(duplex.positions_nm).max() < 2.9
    modes = normal_modes(hessian, duplex.masses_Da, duplex.bodies, duplex.pairs < 3)
    return duplex, modes


def simulated(duplex: SimulatedDuplex, scene: SceneSpec, plan: Plan, scale: float) -> xr.Dataset:
    """Return the record of a pair of kicks in double precision."""
    kick = kick_pattern(scene.excitation, scene.ends, duplex.pair_count)  # type: ignore[arg-type]
    copies = []
    for sign in (1, -1):
        one = Dynamics(
            hold(duplex, held_pairs(scene.ends, duplex.pair_count)),
            leapfrog(plan.timestep_ps),
            platform="Reference",
        )
        one.start(duplex.positions_nm, sign * scale * kick.velocities(duplex))
        copies.append(one)
    recorder = Recorder(duplex, scene, plan, (1, -1))
    for index in range(plan.frames):
        states = []
        for one in copies:
            one.step(plan.steps_per_frame if index else 0)
            frame = one.frame()
            states.append((frame.positions_nm, frame.velocities_nm_per_ps, frame.energy_kJ_per_mol))
        recorder.add(states, [0.0, 0.0])
    return recorder.dataset()


@pytest.mark.parametrize("wave", ["extension", "twist"])
def test_simulation_converges_to_it_as_the_square_of_timestep_and_kick(
    smooth: tuple[SimulatedDuplex, NormalModes], make_scene: MakeScene, wave: str
) -> None:
    duplex, modes = smooth
    amplitude = {"velocity_A_per_ps": 1.0} if wave == "extension" else {}
    amplitude = amplitude or {"angular_velocity_rad_per_ps": 0.1}
    kick = {"kind": "kick", "wave": wave, "pairs": 1, **amplitude}
    scene = make_scene(duplex, kick, FAR_HELD)
    # A wave of 15 Å/ps crosses the three steps in 0.7 ps, one of 9 Å/ps in 1.1.
    small, frames = 1e-4, 20

    def run(timestep_ps: float, scale: float) -> tuple[xr.Dataset, xr.Dataset]:
        plan = Plan(timestep_ps, round(0.02 / timestep_ps), frames)
        exact = respond(duplex, modes, scene, plan, scale, MINIMUM)
        return simulated(duplex, scene, plan, scale), exact

    coarse, fine = run(0.001, small), run(0.0005, small)
    large, larger = run(0.001, 0.15), run(0.001, 0.3)
    for name in QUANTITIES:
        # The fastest vibration has omega 700 /ps: its own phase error over 0.4 ps at 1 fs is not
        # yet in the range of the square law, but next to nothing of the kick is in it.
        ratio = difference(*coarse, name) / difference(*fine, name)
        assert ratio == pytest.approx(4, rel=0.1)
        assert difference(*fine, name) < 2e-3
        # The rest of the difference at a finite kick: against the small one at this timestep.
        changes = [
            difference(one[0], coarse[0], name, small / scale)
            for one, scale in ((large, 0.15), (larger, 0.3))
        ]
        # The next term is the fourth power of a displacement of some 0.1 Å.
        assert changes[1] / changes[0] == pytest.approx(4, rel=0.05)


@pytest.fixture(scope="module")
def modes_of(relaxed: Any) -> Callable[[SceneSpec], NormalModes]:
    """Return a function of a scene: the relaxed duplex's modes with its ends."""
    hessian, known = scipy.sparse.csr_array(relaxed.hessian), {}
    duplex = relaxed.duplex

    def modes(scene: SceneSpec) -> NormalModes:
        held = held_counts(scene.ends)
        if held not in known:
            free = (duplex.pairs >= held[0]) & (duplex.pairs < duplex.pair_count - held[1])
            known[held] = normal_modes(hessian, duplex.masses_Da, duplex.bodies, free)
        return known[held]

    return modes


@pytest.mark.parametrize("wave", ["extension", "twist", "bend", "shear"])
def test_a_small_simulated_kick_agrees_on_every_base_pair(
    relaxed: Any, make_scene: MakeScene, modes_of: Any, wave: str
) -> None:
    duplex = relaxed.duplex
    size = {"velocity_A_per_ps": 0.01}
    if wave in ("twist", "bend"):
        size = {"angular_velocity_rad_per_ps": 0.001}
    scene = make_scene(duplex, {"kind": "kick", "wave": wave, "pairs": 2, **size}, FAR_HELD)
    # One crossing of six base pairs at 15 Å/ps.
    plan = Plan(timestep_ps=0.001, steps_per_frame=20, frames=51)
    simulation = run_member(duplex, scene, plan, "x1", {}).dataset()
    exact = respond(duplex, modes_of(scene), scene, plan, 1.0, MINIMUM)
    for name in ("velocity", "angular_velocity"):
        expected = odd(exact, name)[:, :-1]
        off = np.abs(odd(simulation, name)[:, :-1] - expected)
        # Each base pair's waveform to 2 % of its own peak.
        assert (off.max(axis=(0, 2)) / np.abs(expected).max(axis=(0, 2))).max() < 0.02
    kinetic = exact["difference_kinetic_energy"].values
    found = simulation["difference_kinetic_energy"].values
    np.testing.assert_allclose(found, kinetic, atol=0.01 * kinetic[0])


def test_its_record_has_the_form_of_a_simulated_one(
    relaxed: Any, make_scene: MakeScene, make_kick: Any, modes_of: Any
) -> None:
    scene = make_scene(relaxed.duplex, make_kick("extension"), FAR_HELD)
    plan = Plan(timestep_ps=0.002, steps_per_frame=5, frames=4)
    one = run_member(relaxed.duplex, scene, plan, "x1", {}).dataset()
    exact = scene.model_copy(update={"method": "harmonic"})
    other = respond(relaxed.duplex, modes_of(scene), exact, plan, 1.0, MINIMUM)
    assert set(other) == set(one)
    for name in other:
        assert other[name].dims == one[name].dims
        assert other[name].shape == one[name].shape
        assert other[name].attrs == one[name].attrs
    for name in ("injected_momentum", "injected_angular_momentum"):
        # Two ways to the same sums of velocities that are not small.
        np.testing.assert_allclose(other[name], one[name], rtol=1e-9, atol=1e-9)
    xr.testing.assert_equal(other.coords.to_dataset(), one.coords.to_dataset())
    assert (one.attrs["method"], other.attrs["method"]) == ("simulated", "harmonic")


def test_a_kick_goes_in_whole_and_its_energy_stays(
    relaxed: Any, make_scene: MakeScene, make_kick: Any, modes_of: Any
) -> None:
    duplex = relaxed.duplex
    scene = make_scene(duplex, make_kick("twist"), FAR_HELD)
    plan = Plan(timestep_ps=0.002, steps_per_frame=30, frames=40)
    motion = respond(duplex, modes_of(scene), scene, plan, 0.5, MINIMUM)
    kick = kick_pattern(scene.excitation, scene.ends, duplex.pair_count)  # type: ignore[arg-type]
    atoms = 0.5 * kick.velocities(duplex)
    linear, angular = duplex.bodies.velocity(duplex.positions_nm, atoms)
    # The modes are complete: round-off.
    start = motion.sel(sign=1).isel(time=0)
    np.testing.assert_allclose(start["velocity"], 10 * linear, atol=1e-10)
    np.testing.assert_allclose(start["angular_velocity"], angular, atol=1e-10)
    put_in = 0.5 * float(np.sum(duplex.masses_Da[:, None] * atoms**2))
    kinetic = motion["difference_kinetic_energy"].values
    assert kinetic[0] == pytest.approx(put_in, rel=1e-10)
    assert kinetic.min() < 0.7 * put_in
    # Nothing is lost: round-off of the sum of 1,100 modes.
    np.testing.assert_allclose(motion["total_energy"], MINIMUM + put_in, rtol=1e-10)
    assert not motion["work"].any()
    assert not motion["velocity"].isel(pair=-1).any()
    # Opposite kicks, opposite answers; twice the kick, twice the answer.
    twice = respond(duplex, modes_of(scene), scene, plan, 1.0, MINIMUM)
    for name in QUANTITIES:
        np.testing.assert_array_equal(motion[name].sel(sign=-1), -motion[name].sel(sign=1))
        np.testing.assert_allclose(twice[name], 2 * motion[name], rtol=1e-12)


@pytest.mark.parametrize("kind", ["pulse", "periodic"])
def test_the_work_of_a_drive_is_force_times_velocity(
    relaxed: Any, make_scene: MakeScene, modes_of: Any, kind: str
) -> None:
    duplex = relaxed.duplex
    excitation = {"kind": kind, "wave": "extension", "force_pN": 20, "pairs": 2}
    excitation |= {"frequencies_GHz": [500]} if kind == "periodic" else {}
    scene = make_scene(duplex, excitation, HELD)
    plan = Plan(
        timestep_ps=0.002,
        steps_per_frame=1,
        frames=801,
        frequency_GHz=500.0 if kind == "periodic" else None,
        pulse_width_ps=0.1 if kind == "pulse" else None,
    )
    motion = respond(duplex, modes_of(scene), scene, plan, 1.0, MINIMUM)
    times = motion["time"].values
    course = (
        np.sin(2 * np.pi * 0.5 * times)
        if kind == "periodic"
        else np.exp(-0.5 * ((times - 0.5) / 0.1) ** 2)
    )
    forces = forces_at_full_strength(scene.excitation, scene.ends, duplex)  # type: ignore[arg-type]
    # A rigid base pair is pushed evenly, so its centre of mass takes up all the power.
    on_pair = np.array([forces[duplex.pairs == pair].sum(axis=0) for pair in range(6)])
    velocity = motion["velocity"].sel(sign=1).values / 10
    power = course * np.einsum("tpx,px->t", velocity, on_pair)
    work = cumulative_simpson(power, x=times, initial=0)
    largest = np.abs(work).max()
    # Simpson's rule with 90 points in the shortest period that matters, 0.2 ps; a pulse starts
    # from 4e-6 of its height.
    np.testing.assert_allclose(motion["work"].sel(sign=1), work, atol=1e-3 * largest)
    np.testing.assert_allclose(motion["total_energy"], MINIMUM + motion["work"], rtol=1e-12)
    # The momentum that the drive puts in is the force times the integral of its course.
    impulse = np.outer(cumulative_simpson(course, x=times, initial=0), on_pair.sum(axis=0))
    injected = motion["injected_momentum"].sel(sign=1) / 10
    np.testing.assert_allclose(injected, impulse, atol=1e-4 * np.abs(impulse).max())


def test_a_harmonic_scene_is_answered_from_files(
    relaxed: Any, make_scene: MakeScene, make_kick: Any, tmp_path: Any
) -> None:
    duplex = relaxed.duplex
    scene = make_scene(duplex, make_kick("extension"), FAR_HELD, duration_ps=0.2)
    scene = scene.model_copy(update={"method": "harmonic"})
    write_json(tmp_path / "scene.json", scene.model_dump(mode="json"))
    write_json(tmp_path / "system.json", duplex.spec.model_dump(mode="json"))
    files = (relaxed.built_file, relaxed.relaxed_file, relaxed.hessian_file)
    for last in (1, 2):
        output = tmp_path / f"0-{last}.nc"
        modes_step(tmp_path / "system.json", *files, (0, last), output)

    def answer(modes: Any) -> None:
        scene_json, output = tmp_path / "scene.json", tmp_path / "motion.nc"
        simulate_step(scene_json, *files[:2], "x1", output, None, [], threads=1, modes=modes)

    with pytest.raises(InputError, match="needs the file of modes"):
        answer(None)
    with pytest.raises(InputError, match="base pairs held; allowed"):
        answer(tmp_path / "0-2.nc")
    assert not (tmp_path / "motion.nc").exists()
    answer(tmp_path / "0-1.nc")
    motion = read_netcdf(tmp_path / "motion.nc")
    assert motion.attrs["method"] == "harmonic"
    axis = motion["direction"].sel(axis="helix").values
    along = motion["velocity"].values[0, 0] @ axis
    np.testing.assert_allclose(along, [0.2, 0.2, 0, 0, 0, 0], atol=1e-9)
    energy = relaxed.record.attrs["energy_kJ_per_mol"]
    put_in = float(motion["difference_kinetic_energy"][0])
    assert float(motion["total_energy"][0, -1]) == pytest.approx(energy + put_in, rel=1e-12)
