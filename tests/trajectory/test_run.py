"""A kick goes in whole, travels no faster than it can, and never grows."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import annotated_types
import numpy as np
import openmm
import pytest
import xarray as xr
from numpy.typing import NDArray
from scipy.sparse.linalg import eigsh
from scipy.spatial.distance import cdist

from dnawaves.errors import SimulationError
from dnawaves.scene.models import Observation, SceneSpec
from dnawaves.system.duplex import SimulatedDuplex
from dnawaves.trajectory.pattern import kick_pattern
from dnawaves.trajectory.plan import Plan
from dnawaves.trajectory.run import run_member
from dnawaves.trajectory.signed_copy import Copy

Array = NDArray[np.float64]
MakeScene = Callable[..., SceneSpec]
MakeKick = Callable[..., dict[str, Any]]
WAVES = ("extension", "twist", "bend", "shear")
HELD = {"first": "held", "last": "held"}
# 0.5 ps: a crossing of six base pairs takes about 1 ps.
PLAN = Plan(timestep_ps=0.002, steps_per_frame=10, frames=26)


def odd(motion: xr.Dataset, name: str) -> Array:
    """Return half the difference of the two signs, (time, pair, xyz)."""
    return 0.5 * (motion[name].sel(sign=1) - motion[name].sel(sign=-1)).values


def relative(difference: Array, whole: Array) -> float:
    return float(np.linalg.norm(difference) / np.linalg.norm(whole))


@pytest.fixture(scope="module")
def runs(relaxed: Any, make_scene: MakeScene, make_kick: MakeKick) -> dict[str, xr.Dataset]:
    """Return a run of each wave, both ends free, and one kicked half as hard."""
    made = {
        wave: run_member(
            relaxed.duplex, make_scene(relaxed.duplex, make_kick(wave)), PLAN, "x1", {}
        ).dataset()
        for wave in WAVES
    }
    half = make_scene(relaxed.duplex, make_kick("extension", scales=(1, 0.5)))
    made["half"] = run_member(relaxed.duplex, half, PLAN, "x0.5", {}).dataset()
    return made


@pytest.mark.parametrize("wave", WAVES)
def test_momentum_and_angular_momentum_are_what_was_put_in_and_stay_so(
    relaxed: Any, make_scene: MakeScene, make_kick: MakeKick, wave: str
) -> None:
    duplex = relaxed.duplex
    scene = make_scene(duplex, make_kick(wave))
    velocities = kick_pattern(scene.excitation, scene.ends, 6).velocities(duplex)
    masses = duplex.masses_Da[:, None]

    def momenta(positions_nm: Array, v: Array) -> Array:
        return np.array([(masses * v).sum(axis=0), np.cross(positions_nm, masses * v).sum(axis=0)])

    put_in = momenta(duplex.positions_nm, velocities)
    copy = Copy(duplex, scene, PLAN, -1.0, threads=1)
    positions_nm, v, _ = copy.state()
    np.testing.assert_allclose(momenta(positions_nm, v), -put_in, atol=1e-12)
    copy.step(100)
    positions_nm, v, _ = copy.state()
    # Single-precision forces of 1e3 kJ/mol/nm on 378 atoms do not quite cancel: 1e-3 kJ/mol/nm in
    # sum for 0.2 ps, in 10 to 30 Da nm/ps. A remover of the centre of mass' motion would leave
    # no momentum at all.
    np.testing.assert_allclose(momenta(positions_nm, v), -put_in, atol=3e-4)
    assert np.abs(put_in).max() > 3


def test_momentum_of_the_recorded_base_pairs_stays(runs: dict[str, xr.Dataset]) -> None:
    motion = runs["extension"]
    momentum = np.einsum("p,stpx->stx", motion["mass"], motion["velocity"])
    along = momentum @ motion["direction"].sel(axis="helix").values
    # 0.2 Å/ps on the first two pairs; atol as above, in Da Å/ps.
    expected = 0.2 * motion["mass"].values[:2].sum()
    np.testing.assert_allclose(along, [[expected] * 26, [-expected] * 26], atol=3e-3)


def test_no_base_pair_moves_before_the_wave_is_there(
    near_minimum: Callable[..., SimulatedDuplex], make_scene: MakeScene, make_kick: MakeKick
) -> None:
    duplex = near_minimum("CGATCAGTCACG", 50.0, 100)
    # Two frames of one step each, then 0.1 ps.
    scene = make_scene(duplex, make_kick("extension", pairs=1))
    kick_nm_per_ps = 0.02
    copies = [Copy(duplex, scene, PLAN, sign, threads=1) for sign in (1.0, -1.0)]

    def speeds() -> Array:
        """Return each base pair's fastest atom in the difference, in kicks."""
        plus, minus = (copy.state()[1] for copy in copies)
        fastest = np.linalg.norm(plus - minus, axis=1) / 2 / kick_nm_per_ps
        return np.array([fastest[duplex.pairs == pair].max() for pair in range(12)])

    def step(steps: int) -> None:
        for copy in copies:
            copy.step(steps)

    kicked = duplex.positions_nm[duplex.pairs == 0]
    distance_nm = np.array(
        [cdist(kicked, duplex.positions_nm[duplex.pairs == pair]).min() for pair in range(12)]
    )
    out_of_reach = distance_nm > duplex.spec.environment.cutoff_nm + 0.01
    assert out_of_reach.sum() >= 5
    np.testing.assert_allclose(speeds(), [1] + [0] * 11, atol=1e-12)
    step(1)
    # Forces of single precision differ in the last digit: 1e-4 kJ/mol/nm · 1 fs / 1 Da = 1e-7
    # nm/ps. A remover of the centre of mass' motion would give all of them 1/12 of a kick.
    assert speeds()[out_of_reach].max() < 1e-4
    # Within reach the force is there, but small: second order in time.
    assert 0 < speeds()[2:4].min() < 0.01
    step(49)
    # In 0.1 ps the fastest sound measured in DNA (31 Å/ps by X-rays) goes one base pair far. What
    # has come further is the direct Coulomb force of pairs 1 and 2, to within two cutoffs.
    assert speeds()[7:].max() < 0.01
    assert speeds()[1] > 0.1


@pytest.mark.parametrize("wave", WAVES)
def test_energy_of_the_difference_is_never_more_than_was_put_in(
    runs: dict[str, xr.Dataset], wave: str
) -> None:
    energy = runs[wave]["difference_kinetic_energy"].values
    # At a true minimum the rest is potential energy and positive.
    assert energy[1:].max() < energy[0]
    # At 0.5 ps a good part has gone into strain, and not all.
    assert 0.2 < energy[-1] / energy[0] < 0.95


@pytest.mark.parametrize("wave", WAVES)
def test_total_energy_does_not_drift(runs: dict[str, xr.Dataset], wave: str) -> None:
    energy = runs[wave]["total_energy"].values
    # Potential energy of -5,468 kJ/mol in single precision: 6e-8 each of thousands of terms.
    assert np.abs(energy - energy[:, :1]).max() < 5e-3
    # And of the larger part of 23 kJ/mol after a kick ten times as hard, see the next test.


def test_total_energy_does_not_drift_after_a_hard_kick(
    relaxed: Any, make_scene: MakeScene, make_kick: MakeKick
) -> None:
    scene = make_scene(relaxed.duplex, make_kick("extension", velocity_A_per_ps=2.0))
    motion = run_member(relaxed.duplex, scene, PLAN, "x1", {}).dataset()
    energy = motion["total_energy"].values
    put_in = motion["difference_kinetic_energy"].values[0]
    assert put_in > 20
    # Verlet's energy oscillates by (omega dt)²/8 of what is in each mode: 1e-3 for the
    # carbon-carbon stretches that a kick of rigid pairs shakes, and those hold a small part.
    assert np.abs(energy - energy[:, :1]).max() < 1e-3 * put_in


def test_energy_drifts_by_less_than_a_percent_of_what_was_put_in(
    relaxed: Any, make_scene: MakeScene, make_kick: MakeKick
) -> None:
    """Over two crossings, at the default timestep."""
    scene = make_scene(relaxed.duplex, make_kick("extension", velocity_A_per_ps=0.5))
    motion = run_member(relaxed.duplex, scene, Plan(0.002, 10, 101), "x1", {}).dataset()
    times_ps, energy = motion["time"].values, motion["total_energy"].values
    put_in = motion["difference_kinetic_energy"].values[0]
    # 1.5 kJ/mol; each energy, in single precision, has 1e-3 kJ/mol of noise, their slope 3e-4 of
    # that over the record.
    slopes = np.polyfit(times_ps, energy.T, 1)[0]
    assert np.abs(slopes * times_ps[-1]).max() < 0.01 * put_in
    assert put_in > 1


def test_answer_is_linear_in_the_kick(runs: dict[str, xr.Dataset]) -> None:
    whole, half = (odd(runs[name], "velocity") for name in ("extension", "half"))
    # Odd in the kick, so the error is of third order. 0.2 Å/ps moves base pairs by 0.1 Å, in
    # potentials that soften over some Å: trials gave 0.4 %.
    assert relative(whole - 2 * half, whole) < 0.01
    energies = [runs[name]["difference_kinetic_energy"].values[0] for name in ("extension", "half")]
    assert energies[0] / energies[1] == pytest.approx(4, rel=1e-12)


def test_halving_the_timestep_quarters_the_error(
    relaxed: Any, make_scene: MakeScene, make_kick: MakeKick
) -> None:
    scene = make_scene(relaxed.duplex, make_kick("extension"))
    fields = []
    for steps in (10, 20, 40):
        plan = Plan(timestep_ps=0.02 / steps, steps_per_frame=steps, frames=9)
        motion = run_member(relaxed.duplex, scene, plan, "x1", {}).dataset()
        np.testing.assert_allclose(motion["time"], 0.02 * np.arange(9), atol=1e-12)
        fields.append(odd(motion, "velocity"))
    coarse, fine = fields[0] - fields[1], fields[1] - fields[2]
    # Second order: 4, less (omega dt)² = 0.1 for the stretches at 2 fs.
    assert np.linalg.norm(coarse) / np.linalg.norm(fine) == pytest.approx(4, abs=0.2)
    # So 2 fs, the default, is within 1e-3 of the limit.
    assert relative(coarse, fields[2]) < 1e-3


def test_every_timestep_that_may_be_declared_is_stable(relaxed: Any) -> None:
    duplex = relaxed.duplex
    weights = np.repeat(1 / np.sqrt(duplex.masses_Da), 3)
    highest = eigsh(
        relaxed.hessian * weights * weights[:, None], k=1, which="LA", return_eigenvectors=False
    )
    limit_ps = 2 / np.sqrt(highest[0])
    # Verlet is unstable beyond 2/omega: 2.86 fs for the O-H stretch at 3,700 /cm.
    assert limit_ps == pytest.approx(2.86e-3, rel=0.02)
    (longest,) = (
        bound.le
        for bound in Observation.model_fields["timestep_fs"].metadata
        if isinstance(bound, annotated_types.Le)
    )
    # An anharmonic bond may be a tenth stiffer than at its rest.
    assert longest / 1e3 < 0.9 * limit_ps
    assert Observation().timestep_fs / 1e3 < 0.75 * limit_ps


def test_held_base_pairs_do_not_move(
    relaxed: Any, make_scene: MakeScene, make_kick: MakeKick
) -> None:
    scene = make_scene(relaxed.duplex, make_kick("shear"), HELD)
    motion = run_member(relaxed.duplex, scene, PLAN, "x1", {}).dataset()
    held = motion.isel(pair=[0, 5])
    for name in ("velocity", "angular_velocity"):
        assert not held[name].values.any()
    # The pose of an unmoved pair: round-off of a singular value decomposition.
    for name in ("displacement", "rotation"):
        np.testing.assert_allclose(held[name], 0, atol=1e-12)
        assert (np.abs(motion[name].isel(pair=slice(1, 5), time=-1)).max("xyz") > 1e-5).all()
    # The kick acts next to the held end, on pairs 2 and 3.
    start = np.linalg.norm(motion["velocity"].isel(time=0, sign=0), axis=1)
    assert (start[1:3] > 0.1).all()
    assert not start[3:].any()
    # Their true masses are recorded all the same.
    np.testing.assert_allclose(motion["mass"], relaxed.duplex.bodies.masses_Da, rtol=1e-14)


def test_null_run_has_one_sign_and_no_wave(relaxed: Any, make_scene: MakeScene) -> None:
    scene = make_scene(relaxed.duplex, {"kind": "none"}, HELD)
    motion = run_member(relaxed.duplex, scene, PLAN, "run", {}).dataset()
    assert motion["sign"].values.tolist() == [1]
    # Forces of single precision, 1e-3 kJ/mol/nm on some 600 Da for 0.5 ps, against 0.2 Å/ps.
    assert np.abs(motion["velocity"].values).max() < 1e-5
    assert not motion["velocity"].values[:, 0].any()
    assert not motion["work"].values.any()


def test_explosion_names_step_atoms_and_forces_and_keeps_the_last_good_state(
    relaxed: Any, make_scene: MakeScene, make_kick: MakeKick, tmp_path: Path
) -> None:
    # 3 fs is beyond the stability limit of the O-H stretch: the chain ends' hydroxyls go first.
    scene = make_scene(relaxed.duplex, make_kick("extension"))
    found = []
    # Frames every 2 steps, and one frame after OpenMM itself has met what is not a number.
    for plan in (Plan(0.003, 2, 200), Plan(0.003, 1000, 2)):
        with pytest.raises(SimulationError) as error:
            run_member(relaxed.duplex, scene, plan, "x1", {}, checkpoints=tmp_path)
        pattern = (
            r"test x1: after (0\.\d{3}) ps, in step (\d+), atom (\d+) \([AB]:[16] HO[35]'\) "
            r"moves at (\S+) nm/ps under a force of (\S+) kJ/mol/nm, atom .*; "
            r"the last good state is in (.*)"
        )
        match = re.fullmatch(pattern, str(error.value))
        assert match is not None
        found.append(match)
        time_ps, step, atom, speed, force = (float(text) for text in match.groups()[:5])
        assert time_ps == pytest.approx(0.003 * (step - 1), abs=1e-3)
        state = openmm.XmlSerializer.deserialize(Path(match[6]).read_text())
        assert state.getStepCount() == step - 1
        before, limit = state.getVelocities(asNumpy=True)._value, 50.0
        assert np.linalg.norm(before, axis=1).max() < limit < speed
        # What the force did in that step: m dv = F dt, of 1 Da.
        change = speed - np.linalg.norm(before[int(atom)])
        assert 0 < change <= 1.01 * force * 0.003 / relaxed.duplex.masses_Da[int(atom)]
    # Both name the same step, as nothing is random.
    assert found[0][2] == found[1][2]


def test_absurd_kick_is_refused_at_once(
    relaxed: Any, make_scene: MakeScene, make_kick: MakeKick
) -> None:
    scene = make_scene(relaxed.duplex, make_kick("extension", scales=(5000,)))
    with pytest.raises(SimulationError, match=r"x5000: at the start .* moves at 100 nm/ps"):
        run_member(relaxed.duplex, scene, PLAN, "x5000", {})
