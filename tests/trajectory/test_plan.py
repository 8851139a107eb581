"""How long, how often, how fast: from a first estimate, never from the paper's speed."""

from __future__ import annotations

from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dnawaves.errors import InputError
from dnawaves.rod.rod import Rod, short_wave_speeds_A_per_ps
from dnawaves.scene.models import Environment, NamedDuplex, SceneSpec, SystemSpec
from dnawaves.trajectory.plan import Plan, make_plan

HELD = {"first": "held", "last": "held"}
STATIC = {"first": "held", "last": "guided"}
ESTIMATES = {"extension": 15.0, "twist": 6.0}
PAIRS, SPACING_A = 24, 3.3
LENGTH_A = (PAIRS - 1) * SPACING_A


@pytest.fixture(scope="module")
def make(make_scene: Callable[..., SceneSpec]) -> Callable[..., SceneSpec]:
    spec = SystemSpec(
        duplex=NamedDuplex(name="long", sequence="CGATCAGTCAGCTAGCATGCGTAC"),
        environment_name="condensed",
        environment=Environment(),
    )
    # All that a plan needs of a duplex is its sequence.
    named = SimpleNamespace(spec=spec)
    return lambda excitation, ends=HELD, **observation: make_scene(
        named, excitation, ends, **observation
    )


def kick(wave: str, **more: Any) -> dict[str, Any]:
    linear = wave in ("extension", "shear")
    amplitude = "velocity_A_per_ps" if linear else "angular_velocity_rad_per_ps"
    return {"kind": "kick", "wave": wave, amplitude: 0.2, **more}


def drive(**more: Any) -> dict[str, Any]:
    return {"kind": "periodic", "wave": "extension", "force_pN": 20, **more}


def plan(scene: SceneSpec, member: str, *fitted: float) -> Plan:
    return make_plan(scene, member, ESTIMATES, LENGTH_A, SPACING_A, fitted)


@pytest.mark.parametrize(
    ("wave", "speed"), [("extension", 15.0), ("twist", 6.0), ("bend", 6.0), ("shear", 6.0)]
)
def test_record_lasts_the_crossings_of_the_estimated_speed(
    make: Callable[..., SceneSpec], wave: str, speed: float
) -> None:
    made = plan(make(kick(wave), crossings=1.5), "x1")
    duration_ps = 1.5 * LENGTH_A / speed
    covered_ps = (made.frames - 1) * made.interval_ps
    assert duration_ps <= covered_ps + 1e-9 < duration_ps + made.interval_ps + 1e-9
    assert made.timestep_ps == 0.002
    # Ten samples in the period pi a/V at the edge of the lattice's band of the fastest wave.
    shortest_ps = np.pi * SPACING_A / 15.0
    assert 10 <= shortest_ps / made.interval_ps < 11
    assert made.frequency_GHz is None
    assert made.pulse_width_ps is None


def test_estimate_twice_as_fast_halves_the_record(make: Callable[..., SceneSpec]) -> None:
    scene = make(kick("extension"))
    slow = make_plan(scene, "x1", {"extension": 10.0, "twist": 5.0}, LENGTH_A, SPACING_A)
    fast = make_plan(scene, "x1", {"extension": 20.0, "twist": 10.0}, LENGTH_A, SPACING_A)
    # To a timestep of 2 fs in an interval of 50 fs, and a frame.
    assert slow.interval_ps / fast.interval_ps == pytest.approx(2, abs=0.1)
    assert slow.steps / fast.steps == pytest.approx(2, abs=0.05)


@settings(max_examples=60, deadline=None)
@given(st.integers(1, 400), st.integers(1, 50), st.sampled_from([0.5, 1.0, 1.5, 2.0, 2.5]))
def test_declared_times_are_met_exactly(
    make: Callable[..., SceneSpec], frames: int, steps: int, timestep_fs: float
) -> None:
    interval_fs = steps * timestep_fs
    scene = make(
        kick("extension"),
        timestep_fs=timestep_fs,
        interval_fs=interval_fs,
        # Written as a person would: in decimals.
        duration_ps=round(frames * interval_fs / 1000, 9),
    )
    made = plan(scene, "x1")
    assert made.steps_per_frame == steps
    assert made.frames == frames + 1
    assert made.steps == frames * steps


def test_static_load_is_one_frame_whatever_the_plan(make: Callable[..., SceneSpec]) -> None:
    scene = make({"kind": "static", "wave": "twist", "torque_pN_nm": 5}, STATIC)
    assert plan(scene, "x1").frames >= 1


def test_pulse_spans_the_steps_that_keep_the_fronts_bias_small(
    make: Callable[..., SceneSpec],
) -> None:
    pulse = {"kind": "pulse", "wave": "twist", "torque_pN_nm": 20}
    made = plan(make(pulse, {"first": "free", "last": "held"}), "run")
    assert made.pulse_width_ps == pytest.approx(2.5 * SPACING_A / 6.0, rel=1e-12)
    # The bias of a pulse's speed on a lattice, a²/(16 sigma² V²), is 1 %.
    assert SPACING_A**2 / (16 * made.pulse_width_ps**2 * 6.0**2) == pytest.approx(0.01)
    # The record holds the whole pulse, ten widths, besides the crossings.
    duration_ps = 1.2 * LENGTH_A / 6.0 + 10 * made.pulse_width_ps
    covered_ps = (made.frames - 1) * made.interval_ps
    assert duration_ps <= covered_ps + 1e-9 < duration_ps + made.interval_ps + 1e-9
    declared = plan(make({**pulse, "width_fs": 150}, {"first": "free", "last": "held"}), "run")
    assert declared.pulse_width_ps == 0.15
    short = make(pulse, {"first": "free", "last": "held"}, duration_ps=1.0)
    with pytest.raises(InputError, match=r"duration_ps: found 1; allowed: above 6\.8"):
        plan(short, "run")


def test_member_of_another_scene_is_refused(make: Callable[..., SceneSpec]) -> None:
    scene = make(kick("extension", scales=(1, 0.5)))
    with pytest.raises(InputError, match=r"'test': found member 'x2'; allowed: x1, x0\.5"):
        plan(scene, "x2")


def test_each_declared_frequency_has_its_member(make: Callable[..., SceneSpec]) -> None:
    scene = make(drive(frequencies_GHz=(50, 2000)))
    assert scene.members == ("f1", "f2")
    assert plan(scene, "f1").frequency_GHz == 50
    fast = plan(scene, "f2")
    assert fast.frequency_GHz == 2000
    # The drive, 0.5 ps a period, is faster than the fastest wave: it sets the interval.
    assert fast.interval_ps <= 0.05 + 1e-12


def test_a_drive_rises_over_periods_of_its_own(make: Callable[..., SceneSpec]) -> None:
    sudden = make(drive(frequencies_GHz=[40.0, 80.0]))
    assert [plan(sudden, member).ramp_ps for member in sudden.members] == [0, 0]
    ramped = make(drive(frequencies_GHz=[40.0, 80.0], ramp_periods=1.5))
    # Periods of 25 and 12.5 ps.
    assert [plan(ramped, member).ramp_ps for member in ramped.members] == [37.5, 18.75]


@pytest.mark.parametrize("fitted", [3.0, 15.0])
def test_sweep_holds_the_lowest_modes_of_both_rods(
    make: Callable[..., SceneSpec], fitted: float
) -> None:
    scene = make(drive(sweep={"scenes": ["other"], "points": 4}))
    found = [plan(scene, member, fitted).frequency_GHz for member in scene.members]
    assert len(found) == 4
    assert all(np.diff(found) > 0)
    paper = short_wave_speeds_A_per_ps(Rod.paper())["extension"]
    for speed in (paper, fitted):
        # V/2L in 1/ps is 1e3 GHz. Inside, with 30 % to spare at the ends.
        mode_GHz = 1e3 * speed / (2 * LENGTH_A)
        assert found[0] * 1.29 < mode_GHz < found[-1] / 1.29


def test_sweep_holds_the_lowest_modes_of_all_fitted_rods(make: Callable[..., SceneSpec]) -> None:
    scene = make(drive(sweep={"scenes": ["slow", "fast"], "points": 2}))
    found = [plan(scene, member, 3.0, 15.0).frequency_GHz for member in scene.members]
    expected = [1e3 * speed / (2 * LENGTH_A) for speed in (3.0 / 1.3, 15.0 * 1.3)]
    assert found == pytest.approx(expected, rel=1e-12)


def test_sweep_without_the_fitted_speed_is_refused(make: Callable[..., SceneSpec]) -> None:
    scene = make(drive(sweep={"scenes": ["other"], "points": 4}))
    with pytest.raises(InputError, match="found 0 fitted speeds; allowed: one for each of other"):
        plan(scene, "f1")


def test_sweep_beyond_the_nyquist_frequency_is_refused_when_it_is_known(
    make: Callable[..., SceneSpec],
) -> None:
    # Frames every 4 ps see up to 125 GHz. The sweep's frequencies are not known before the fit.
    scene = make(drive(sweep={"scenes": ["other"], "points": 2}), interval_fs=4000)
    slow, fast = (1.3 * 1e3 * speed / (2 * LENGTH_A) for speed in (12.0, 15.0))
    assert slow < 125 < fast
    assert plan(scene, "f2", 12.0).frequency_GHz == pytest.approx(slow, rel=1e-12)
    with pytest.raises(InputError) as error:
        plan(scene, "f2", 15.0)
    # Half the drive's period: 1e6/2/128.46 GHz.
    allowed_fs = 5e5 / fast
    for part in ("'test'", "observation.interval_fs", "4000", f"below {allowed_fs:g}"):
        assert part in str(error.value)
    # The sweep's lowest frequency can be recorded.
    assert plan(scene, "f1", 15.0).frequency_GHz < 125
