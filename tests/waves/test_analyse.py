"""Every kind of scene at T = 0: the answer of a lattice gives its speed, another model is told."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from dnawaves.rod.chain import PlaneChain, ScalarChain
from dnawaves.rod.modal import ModalChain, free_pairs
from dnawaves.rod.rod import Rod
from dnawaves.rod.standing import bend_standing_wave
from dnawaves.scene.excitations import Kick, Nothing, Periodic, Pulse, StandingWave, Static
from dnawaves.scene.models import SceneSpec
from dnawaves.units import KJ_PER_MOL_PER_PN_NM
from dnawaves.waves.analyse import analyse
from dnawaves.waves.cross_checks import cross_check_rows
from dnawaves.waves.paper_answer import paper_rod
from dnawaves.waves.record import Record
from dnawaves.waves.table import Estimate, spread

PAIRS, SPACING_NM = 24, 0.34
MASS_DA, BEND_INERTIA, TWIST_INERTIA = 600.0, 180.0, 300.0
TIMES_PS = np.arange(0, 9, 0.1)
HELD = [PAIRS - 1]
MakeRecord = Callable[..., Record]
MakeScene = Callable[..., SceneSpec]
# What is left in noise-free data of the model class: the optimiser's tolerance.
EXACT = 1e-3


def by_estimator(estimates: list[Estimate], wave: str) -> dict[str, Estimate]:
    return {one.estimator: one for one in estimates if one.wave == wave}


def kick(wave: str) -> Kick:
    linear = wave in ("extension", "shear")
    size = {"velocity_A_per_ps": 0.1} if linear else {"angular_velocity_rad_per_ps": 0.01}
    return Kick(kind="kick", wave=wave, scales=(1.0, 0.5), **size)


def excited() -> np.ndarray:
    pattern = np.zeros(PAIRS)
    pattern[:3] = 0.01
    return pattern


def chain(speed_A_per_ps: float, held: list[int] = HELD) -> ScalarChain:
    return ScalarChain.from_speed(PAIRS, speed_A_per_ps, SPACING_NM, held)


@pytest.mark.parametrize(("wave", "speed"), [("extension", 14.0), ("twist", 7.0)])
def test_a_kick_gives_the_speed_of_its_lattice(
    make_scene: MakeScene, make_record: MakeRecord, wave: str, speed: float
) -> None:
    # 1.5 crossings: the front has passed the pairs at which it is picked.
    times = np.arange(0, 1.5 * 10 * SPACING_NM * PAIRS / speed, 0.1)
    velocity = chain(speed).kick_response(times, excited(), 0.1)[1]
    spec = make_scene(kick(wave))
    records = [
        make_record(spec, member, {wave: scale * velocity})
        for member, scale in (("x1", 1.0), ("x0.5", 0.5))
    ]
    rows = by_estimator(analyse(records), wave)
    for estimator in ("waveform", "waveform, all waves", "waveform, next-nearest", "modes"):
        row = rows[estimator]
        assert row.speed_A_per_ps == pytest.approx(speed, rel=EXACT)
        assert row.low_A_per_ps <= row.speed_A_per_ps <= row.high_A_per_ps
        assert row.model_class == "fits"
    coupled = rows["waveform, coupled"]
    assert coupled.speed_A_per_ps == pytest.approx(speed, rel=EXACT)
    assert coupled.coupling == pytest.approx(0.0, abs=0.01)
    headline = rows["waveform"]
    assert headline.amplitude == pytest.approx(1.0, rel=EXACT)
    assert headline.friction_per_ps == pytest.approx(0.1, abs=1e-3)
    assert headline.half_kick_change == pytest.approx(0.0, abs=1e-6)
    assert (rows["arrival"].model_class, rows["correlation"].model_class) == ("", "")
    # A front is picked with a bias of some percent, alike in the paper's rod.
    paper = {"extension": 8.19, "twist": 5.06}[wave]
    assert rows["arrival"].ratio_to_paper == pytest.approx(speed / paper, rel=0.05)


@pytest.mark.parametrize(
    ("shown_at", "said"),
    # Base pair 21 shows what runs through 19; 19 what has run half as far.
    [({21: 19}, "at a farther base pair no later"), ({19: 10}, "differ by a factor of 2.1")],
)
def test_picks_that_follow_no_front_are_rejected(
    make_scene: MakeScene, make_record: MakeRecord, shown_at: dict[int, int], said: str
) -> None:
    times = np.arange(0, 1.5 * 10 * SPACING_NM * PAIRS / 14.0, 0.1)
    velocity = chain(14.0).kick_response(times, excited(), 0.1)[1]
    mixed = velocity.copy()
    for pair, other in shown_at.items():
        mixed[:, pair] = velocity[:, other]
    spec = make_scene(kick("extension"))
    record = make_record(spec, "x1", {"extension": mixed})
    row = by_estimator(cross_check_rows([record], spec.excitation), "extension")["arrival"]
    assert row.model_class.startswith("rejected: ")
    assert said in row.model_class


def loaded(
    make_scene: MakeScene, make_record: MakeRecord, loads: list[float], left: str = ""
) -> list[Record]:
    """Return a duplex under torques that make it 10 % stiffer for 10 pN nm each; 8 Å/ps unloaded.

    The last load is `left` to drive it out of its basin.
    """
    spec = make_scene(Static(kind="static", wave="twist", torque_pN_nm=20), "held", "guided")
    length = SPACING_NM * (PAIRS - 1)
    rigidity = TWIST_INERTIA / SPACING_NM * 0.8**2 / KJ_PER_MOL_PER_PN_NM
    records = []
    for load in loads:
        turn = load * length / rigidity / (1 + 0.01 * load)
        motion = make_record(
            spec, f"x{load:g}", {"twist": np.zeros((1, PAIRS))}, load=load, left_basin=""
        ).motion
        motion["rotation"].values[:, 0, -1, 2] = turn, -turn
        motion["linear_response"] = ("lock", [length / rigidity])
        records.append(Record(spec, f"x{load:g}", motion.assign_coords(lock=["nothing"])))
    records[-1].motion.attrs["left_basin"] = left
    return records


@pytest.mark.parametrize("loads", [[20.0, 6.0, 2.0], [20.0]])
def test_static_loads_are_given_with_their_limit(
    make_scene: MakeScene, make_record: MakeRecord, loads: list[float]
) -> None:
    row, limit = analyse(loaded(make_scene, make_record, loads))
    assert (row.estimator, limit.estimator) == ("static", "static, no load")
    # Round-off.
    assert limit.speed_A_per_ps == pytest.approx(8.0, rel=1e-9)
    assert row.speed_A_per_ps == pytest.approx(8.0 * np.sqrt(1.2), rel=1e-9)
    # Also of one load: how far it is from linear.
    assert row.low_A_per_ps == pytest.approx(8.0, rel=1e-9)
    assert row.high_A_per_ps == row.speed_A_per_ps
    for one in (row, limit):
        assert one.reason.endswith("a wave, coupled to the faster extension, is slower")


def test_a_load_that_leaves_the_basin_is_no_part_of_the_interval(
    make_scene: MakeScene, make_record: MakeRecord
) -> None:
    rows = analyse(loaded(make_scene, make_record, [6.0, 20.0], left="+1"))
    assert [row.estimator for row in rows] == ["static", "static x20", "static, no load"]
    assert rows[0].high_A_per_ps == pytest.approx(8.0 * np.sqrt(1.06), rel=1e-9)
    assert rows[1].speed_A_per_ps is None
    assert "+1 times 20 drove the duplex into another minimum" in rows[1].reason


def test_one_number_alone_has_no_interval() -> None:
    alone = spread(Estimate("s", "twist", "static"), [8.0], 5.0)
    assert (alone.speed_A_per_ps, alone.ratio_to_paper) == (8.0, 1.6)
    assert (alone.low_A_per_ps, alone.high_A_per_ps, alone.interval) == (None, None, "")


def test_a_kick_of_an_uneven_chain_is_rejected(
    make_scene: MakeScene, make_record: MakeRecord
) -> None:
    stiffness = np.where(np.arange(PAIRS - 1) % 2 == 0, 1.0, 0.1) * 30
    uneven = ScalarChain(np.ones(PAIRS), stiffness, HELD)
    velocity = uneven.kick_response(TIMES_PS, excited())[1]
    rows = by_estimator(
        analyse([make_record(make_scene(kick("extension")), "x1", {"extension": velocity})]),
        "extension",
    )
    assert rows["waveform, all waves"].model_class.startswith("rejected")
    # Long waves feel the mean compliance of two links: (V/a)^2 = 2/(1/30 + 1/3).
    expected = 10 * SPACING_NM * np.sqrt(2 / (1 / 30 + 1 / 3))
    # They are not quite alone: their own dispersion is that of half as many, twice as heavy pairs.
    assert rows["waveform"].speed_A_per_ps == pytest.approx(expected, rel=0.05)
    assert rows["waveform"].misfit < rows["waveform, all waves"].misfit


def test_springs_to_second_neighbours_are_found_as_such(
    make_scene: MakeScene, make_record: MakeRecord
) -> None:
    steps = [np.eye(PAIRS, k=k)[:-k] - np.eye(PAIRS)[:-k] for k in (1, 2)]
    share, square = 0.3, (12.0 / 10 / SPACING_NM) ** 2
    total = square * ((1 - share) * steps[0].T @ steps[0] + share / 4 * steps[1].T @ steps[1])
    far = ModalChain(total, np.ones(PAIRS), free_pairs(PAIRS, HELD))
    velocity = far.kick_response(TIMES_PS, excited())[1]
    rows = by_estimator(
        analyse([make_record(make_scene(kick("extension")), "x1", {"extension": velocity})]),
        "extension",
    )
    wider = rows["waveform, next-nearest"]
    assert wider.speed_A_per_ps == pytest.approx(12.0, rel=EXACT)
    assert wider.reason == "second neighbours' share of the stiffness 0.30"
    assert wider.misfit < 0.01 < rows["waveform, all waves"].misfit


@pytest.mark.parametrize("wave", ["bend", "shear"])
def test_a_kick_in_a_plane_gives_both_speeds(
    make_scene: MakeScene, make_record: MakeRecord, wave: str
) -> None:
    shear, bend = 6.0, 9.0
    plane = PlaneChain(timoshenko(shear, bend), PAIRS, HELD)
    source = np.zeros((PAIRS, 2))
    source[:, int(wave == "bend")] = excited()
    velocity = plane.kick_response(TIMES_PS, source, 0.05)[1]
    fields = {"shear": velocity[..., 0], "bend": velocity[..., 1]}
    estimates = analyse([make_record(make_scene(kick(wave)), "x1", fields)])
    assert estimates[0].wave == wave
    for one, speed in (("shear", shear), ("bend", bend)):
        row = by_estimator(estimates, one)["waveform"]
        assert row.speed_A_per_ps == pytest.approx(speed, rel=EXACT)
        assert row.model_class == "fits"


def timoshenko(shear_A_per_ps: float, bend_A_per_ps: float) -> Rod:
    density, inertia = MASS_DA / SPACING_NM, BEND_INERTIA / SPACING_NM
    across = density * (shear_A_per_ps / 10) ** 2
    tilt = inertia * (bend_A_per_ps / 10) ** 2
    stiffness = np.diag([across, across, across, tilt, tilt, tilt])
    return Rod(density, inertia * np.eye(3), stiffness, SPACING_NM)


@pytest.mark.parametrize("wave", ["twist", "shear"])
def test_a_pulse_is_fitted_with_the_force_that_acted(
    make_scene: MakeScene, make_record: MakeRecord, wave: str
) -> None:
    width = 0.4
    times = np.arange(0, 14, 0.1)
    unit = np.zeros(PAIRS)
    unit[:3] = 1.0
    if wave == "twist":
        pulse = Pulse(kind="pulse", wave=wave, torque_pN_nm=20)
        acceleration = 20 * KJ_PER_MOL_PER_PN_NM / (3 * TWIST_INERTIA) * unit
        fields = {"twist": chain(8.0).pulse_response(times, acceleration, 5 * width, width)[1]}
        speeds = {"twist": 8.0}
    else:
        pulse = Pulse(kind="pulse", wave=wave, force_pN=20)
        force = np.zeros((PAIRS, 2))
        force[:, 0] = 20 * KJ_PER_MOL_PER_PN_NM / 3 * unit
        plane = PlaneChain(timoshenko(6.0, 9.0), PAIRS, HELD)
        velocity = plane.pulse_response(times, force, 5 * width, width)[1]
        fields = {"shear": velocity[..., 0], "bend": velocity[..., 1]}
        speeds = {"shear": 6.0, "bend": 9.0}
    record = make_record(make_scene(pulse), "run", fields, pulse_width_ps=width)
    estimates = analyse([record])
    for one, speed in speeds.items():
        row = by_estimator(estimates, one)["waveform"]
        assert row.speed_A_per_ps == pytest.approx(speed, rel=EXACT)
        assert row.amplitude == pytest.approx(1.0, rel=EXACT)
        assert row.model_class == "fits"
    assert by_estimator(estimates, wave)["arrival"].arrival_ps > 0


def test_a_standing_wave_gives_frequency_width_and_speed(
    make_scene: MakeScene, make_record: MakeRecord
) -> None:
    both = chain(12.0, [0, PAIRS - 1])
    shape = np.sin(2 * np.pi * np.arange(PAIRS) / (PAIRS - 1))
    shape[[0, -1]] = 0.0
    velocity = both.kick_response(TIMES_PS, 0.01 * shape, 0.2)[1]
    excitation = StandingWave(kind="standing_wave", wave="extension", mode=2, velocity_A_per_ps=0.1)
    spec = make_scene(excitation, "held", "held")
    (row,) = analyse([make_record(spec, "x1", {"extension": velocity})])
    assert row.speed_A_per_ps == pytest.approx(12.0, rel=1e-5)
    assert row.friction_per_ps == pytest.approx(0.2, rel=1e-3)
    assert row.model_class == "fits"


def test_the_paper_s_own_bend_has_a_ratio_of_one(
    make_scene: MakeScene, make_record: MakeRecord
) -> None:
    rod = paper_rod(SPACING_NM)
    mode = bend_standing_wave(rod, PAIRS, 3, "held")
    source = np.stack([mode.displacement, mode.rotation_rad_per_nm], axis=1)
    held = [0, PAIRS - 1]
    times = np.arange(0, 15, 0.1)
    velocity = PlaneChain(rod, PAIRS, held).kick_response(times, 0.01 * source)[1]
    excitation = StandingWave(
        kind="standing_wave", wave="bend", mode=3, angular_velocity_rad_per_ps=0.01
    )
    fields = {"shear": velocity[..., 0], "bend": velocity[..., 1]}
    (row,) = analyse([make_record(make_scene(excitation, "held", "held"), "x1", fields)])
    assert row.ratio_to_paper == pytest.approx(1.0, rel=1e-6)


@pytest.mark.parametrize("mode", [1, 2])
def test_a_drive_gives_the_resonance_of_the_mode_that_it_drives(
    make_scene: MakeScene, make_record: MakeRecord, mode: int
) -> None:
    held = [0, PAIRS - 1]
    force = np.zeros(PAIRS)
    force[1:4] = 20 * KJ_PER_MOL_PER_PN_NM / (3 * MASS_DA)
    frequencies, times = (60.0, 110.0), np.arange(0, 20, 0.1)
    excitation = Periodic(
        kind="periodic",
        wave="extension",
        force_pN=20,
        frequencies_GHz=frequencies,
        ramp_periods=0.5,
    )
    spec = make_scene(excitation, "held", "held")
    records = []
    for member, frequency in zip(("f1", "f2"), frequencies, strict=True):
        ramp = 500 / frequency
        velocity = chain(11.0, held).driven_response(
            times, force, 2e-3 * np.pi * frequency, 0.1, ramp
        )[1]
        attrs = {"frequency_GHz": frequency, "ramp_ps": ramp, "drive_mode": mode}
        records.append(make_record(spec, member, {"extension": velocity}, **attrs))
    (row,) = analyse(records)
    assert row.speed_A_per_ps == pytest.approx(11.0, rel=1e-4)
    assert row.friction_per_ps == pytest.approx(0.1, rel=1e-3)
    assert row.amplitude == pytest.approx(1.0, rel=1e-3)
    assert row.phase_rad == pytest.approx(0.0, abs=1e-3)
    assert row.reason.startswith(f"mode {mode}")


@pytest.mark.parametrize(("size", "found"), [(2e-5, "no wave"), (5e-3, "moves by itself")])
def test_a_null_is_judged_by_what_moved(
    make_scene: MakeScene, make_record: MakeRecord, size: float, found: str
) -> None:
    spec = make_scene(Nothing(kind="none"), "held", "held")
    noise = np.random.default_rng(2).uniform(-1, 1, (60, PAIRS))
    noise[:, [0, -1]] = 0.0
    noise *= size / np.abs(noise).max()
    record = make_record(spec, "run", {"extension": noise / 10})
    record = Record(spec, "run", record.motion.isel(sign=[0]))
    rows = {row.wave: row for row in analyse([record])}
    assert set(rows) == {"extension", "twist", "bend", "shear"}
    assert rows["extension"].reason.startswith(
        f"{found}: the residual motion is at most {size:.2g}"
    )
    assert rows["extension"].p_value > 0.0125
    assert rows["twist"].reason.startswith("no wave")
    assert all(row.speed_A_per_ps is None for row in rows.values())


def test_a_null_with_a_wave_in_it_is_an_alarm(
    make_scene: MakeScene, make_record: MakeRecord
) -> None:
    spec = make_scene(Nothing(kind="none"), "held", "held")
    pattern = np.zeros(PAIRS)
    pattern[1:4] = 1e-3
    velocity = chain(13.0, [0, PAIRS - 1]).kick_response(TIMES_PS, pattern)[1]
    record = make_record(spec, "run", {"extension": velocity})
    rows = analyse([Record(spec, "run", record.motion.isel(sign=[0]))])
    assert rows[0].reason.startswith("a wave:")
    # The rank among 999 records of noise.
    assert rows[0].p_value == pytest.approx(1e-3)


def test_a_record_that_is_soon_useless_says_so(
    make_scene: MakeScene, make_record: MakeRecord
) -> None:
    velocity = chain(12.0).kick_response(TIMES_PS, excited())[1]
    record = make_record(make_scene(kick("extension")), "x1", {"extension": velocity})
    # The difference of the signs grows from the sixth frame on.
    growing = record.motion["difference_kinetic_energy"].copy()
    growing[5:] *= 10
    spoiled = Record(record.scene, "x1", record.motion.assign(difference_kinetic_energy=growing))
    (row,) = analyse([spoiled])
    assert row.speed_A_per_ps is None
    assert row.reason.startswith("only 5 usable frames")
