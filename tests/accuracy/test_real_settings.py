"""Six base pairs under real settings: known answers, orders, constraints, rows."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
import scipy.sparse
from numpy.typing import NDArray

from dnawaves.accuracy import pair_run
from dnawaves.accuracy.engine import FAST, SLOW, Engine, hydrogen_bonds, system_under
from dnawaves.accuracy.errors import errors, scaled
from dnawaves.accuracy.front import order
from dnawaves.accuracy.models import Case, Numerics, Study, Truth
from dnawaves.accuracy.observe import Observed
from dnawaves.accuracy.pair_run import PairRun
from dnawaves.accuracy.replicas import averages
from dnawaves.accuracy.row import measure
from dnawaves.accuracy.settings import Setting, expand
from dnawaves.accuracy.start import Start
from dnawaves.accuracy.truth import converged_answer, linear_answer
from dnawaves.motion.fields import wave_fields
from dnawaves.scene.models import SceneSpec
from dnawaves.scene.pairs import held_pairs
from dnawaves.system.modes import normal_modes
from dnawaves.trajectory.harmonic import respond
from dnawaves.trajectory.plan import Plan

CASE = Case.model_validate(
    {
        "system": "six",
        "ends": {"first": "free", "last": "held"},
        "excitation": {"kind": "kick", "wave": "extension", "velocity_A_per_ps": 0.1, "pairs": 2},
        "duration_ps": 0.24,
    }
)


@pytest.fixture(scope="module")
def start(relaxed: object) -> Start:
    return Start(relaxed.duplex, scipy.sparse.csr_array(relaxed.hessian))  # type: ignore[attr-defined]


@pytest.fixture(scope="module")
def linear(start: Start) -> Observed:
    return linear_answer(start, CASE, 0.02)


def run(start: Start, **numerics: object) -> Observed:
    one = PairRun(start.duplex, CASE, Numerics.model_validate(numerics))
    one.advance(CASE.duration_ps)
    return one.observed()


def setting(start: Start, vary: dict[str, object]) -> Setting:
    sequence = start.duplex.spec.duplex.sequence
    study = Study.model_validate(
        {
            "systems": {"six": {"sequence": sequence}},
            "cases": {"kick": CASE},
            "case": "kick",
            "lines": {"line": {"title": "line", "vary": {k: [v] for k, v in vary.items()}}},
        }
    )
    (one,) = expand(study).values()
    return one


def test_the_linear_answer_is_that_of_the_harmonic_scenes(start: Start, linear: Observed) -> None:
    duplex = start.duplex
    scene = SceneSpec(
        name="kick", system=duplex.spec, ends=CASE.ends, excitation=CASE.excitation, observation={}
    )
    free = ~np.isin(duplex.pairs, held_pairs(CASE.ends, duplex.pair_count))
    modes = normal_modes(start.hessian, duplex.masses_Da, duplex.bodies, free)
    motion = respond(duplex, modes, scene, Plan(0.002, 10, 13), 1.0, 0.0)
    expected = wave_fields(motion)["extension_velocity"].values
    # The atoms' way there reads poses at a thousandth of the kick: off by that, squared at most.
    assert np.abs(linear.velocity - expected).max() < 1e-4 * np.abs(expected).max()


def test_leapfrog_converges_as_the_square_of_the_timestep(start: Start) -> None:
    truth = Truth(timesteps_fs=(1.0, 0.5))
    known = converged_answer(start, CASE, truth, 60.0)
    steps = [1.0, 2.0]
    off = [
        errors(run(start, timestep_fs=h, platform="Reference"), known, CASE, 0.33).waveform
        for h in steps
    ]
    # Bonds to hydrogen, 0.7 rad/fs, bend the line by some (omega h)²/20 at 2 fs.
    assert abs(order(steps, off) - 2) < 0.25


@pytest.mark.parametrize(
    ("numerics", "allowed"),
    [
        # All within 3 %: what the kick's own size makes of six base pairs, and the timestep.
        ({"timestep_fs": 1}, 0.03),
        ({"integrator": "velocity Verlet"}, 0.03),
        ({"platform": "Reference"}, 0.03),
        ({"integrator": "multiple timestep", "timestep_fs": 2, "inner_steps": 2}, 0.03),
        # Bonds to hydrogen carry little of the wave.
        ({"constraints": "hbonds"}, 0.05),
        ({"constraints": "hbonds", "hydrogen_mass_Da": 2, "timestep_fs": 2}, 0.1),
        # In 0.24 ps friction of 0.01 /ps takes 0.24 % of a velocity.
        ({"integrator": "Langevin middle", "friction_per_ps": 0.01}, 0.03),
    ],
)
def test_every_kind_of_setting_sees_the_same_wave(
    start: Start, linear: Observed, numerics: dict[str, object], allowed: float
) -> None:
    assert errors(run(start, **numerics), linear, CASE, 0.33).waveform < allowed


def test_a_tenth_of_the_kick_is_nearer_to_the_linear_answer(start: Start, linear: Observed) -> None:
    whole = errors(run(start, platform="Reference"), linear, CASE, 0.33)
    tenth = errors(run(start, platform="Reference", scale=0.1), scaled(linear, 0.1), CASE, 0.33)
    assert tenth.waveform < whole.waveform
    assert tenth.helical < whole.helical


def test_constraints_keep_the_minimums_lengths_and_masses_their_sum(start: Start) -> None:
    duplex = start.duplex
    system = system_under(duplex, [5], Numerics(constraints="hbonds", hydrogen_mass_Da=3))
    free = [pair for pair in hydrogen_bonds(duplex) if duplex.pairs[pair[0]] != 5]
    assert system.getNumConstraints() == len(free)
    first, second, length = system.getConstraintParameters(0)
    arm = duplex.positions_nm[first] - duplex.positions_nm[second]
    assert length._value == pytest.approx(np.linalg.norm(arm))
    masses = np.array([system.getParticleMass(i)._value for i in range(len(duplex.pairs))])
    for pair in range(5):
        own = duplex.pairs == pair
        # Hydrogen's mass comes from its own heavy atom.
        assert masses[own].sum() == pytest.approx(duplex.masses_Da[own].sum())
    assert not masses[duplex.pairs == 5].any()


def test_of_several_timesteps_the_nonbonded_force_alone_has_the_long_one(start: Start) -> None:
    numerics = Numerics(integrator="multiple timestep", inner_steps=2)
    system = system_under(start.duplex, [], numerics)
    groups = {type(force).__name__: force.getForceGroup() for force in system.getForces()}
    assert groups.pop("NonbondedForce") == SLOW
    assert set(groups.values()) == {FAST}


def test_four_times_the_replicas_halve_the_noise(start: Start, linear: Observed) -> None:
    spread = [
        np.std(
            [
                one.velocity - linear.velocity[::3]
                for one in averages(start, CASE, Numerics(replicas=count), linear, draws=40)
            ]
        )
        for count in (4, 16)
    ]
    # 40 draws of five pairs and some independent times: the deviation is known to a few percent.
    assert spread[0] / spread[1] == pytest.approx(2, rel=0.15)


def test_a_row_of_a_real_setting(
    start: Start, linear: Observed, monkeypatch: pytest.MonkeyPatch
) -> None:
    taken, advance = [0], Engine.advance

    def counted(one: Engine, steps: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        taken[0] += steps
        return advance(one, steps)

    def clock() -> int:
        return taken[0]

    monkeypatch.setattr(Engine, "advance", counted)
    ticks = SimpleNamespace(process_time=clock, perf_counter=clock)
    monkeypatch.setattr(pair_run, "time", ticks)
    row = measure(setting(start, {"timestep_fs": 1}), start, start, {"linear": linear})
    assert row["status"] == "ok"
    assert 0 < row["waveform_error"] < 0.03  # type: ignore[operator]
    # By a clock that counts timesteps: twice as many as at the default's 2 fs.
    assert row["relative_cost"] == pytest.approx(2, rel=1e-12)
    assert row["processor"]


def test_what_cannot_be_run_is_a_row_that_says_why(start: Start, linear: Observed) -> None:
    known = {"linear": linear}
    unstable = measure(setting(start, {"timestep_fs": 5}), start, start, known)
    assert str(unstable["status"]).startswith("unstable")
    assert "waveform_error" not in unstable
    none = measure(setting(start, {"timestep_fs": 1}), None, start, {})
    assert none["status"] == "the system has no minimum"
