"""Speeds from spectra of thermal motion: bias, coverage, and spectra that are no such lines."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray

from dnawaves.errors import InputError
from dnawaves.rod.chain import PlaneChain, ScalarChain
from dnawaves.scene.excitations import Nothing
from dnawaves.scene.models import SceneSpec
from dnawaves.waves.estimators.mode_spectra import SharedSpeed, shared_speed
from dnawaves.waves.estimators.synthetic import thermal_velocity
from dnawaves.waves.paper_answer import paper_rod
from dnawaves.waves.record import Record
from dnawaves.waves.thermal_spectrum import lowest_modes, spectrum_rows

Array = NDArray[np.float64]

SPACING_nm, SPEED_A_PER_PS, FRICTION_PER_PS, INTERVAL_ps = 0.34, 8.0, 0.15, 0.2
TOP_RAD_PER_PS = 4.0
CHAIN = ScalarChain.from_speed(24, SPEED_A_PER_PS, SPACING_nm)
SHAPES, WAVENUMBERS = lowest_modes(24, [], SPACING_nm)


def fitted(velocities: Array) -> SharedSpeed:
    modes = velocities.shape[-1]
    return shared_speed(
        list(velocities), INTERVAL_ps, WAVENUMBERS[:modes], SPACING_nm, TOP_RAD_PER_PS
    )


def motion(
    chain: ScalarChain, modes: int, runs: int, frames: int, rng: np.random.Generator
) -> Array:
    """Return thermal modes (run, time, mode) upon a flat background of a fifth of their power.

    One run is cut into many: the cuts remember each other for 7 of 80 ps and more.
    """
    fields = thermal_velocity(chain, runs * frames, INTERVAL_ps, FRICTION_PER_PS, 1.0, rng)
    moving = fields @ SHAPES[:modes].T
    moving = moving + np.sqrt(0.2) * rng.standard_normal(moving.shape)
    return moving.reshape(runs, frames, modes)


def test_modes_are_cosines_of_a_free_and_sines_of_a_held_chain() -> None:
    pairs = np.arange(12)
    free, wavenumbers = lowest_modes(12, [], SPACING_nm)
    cosine = np.cos(np.pi * (pairs + 0.5) / 12)  # DCT-II
    assert abs(free[0] @ cosine) == pytest.approx(np.linalg.norm(cosine), rel=1e-9)
    assert wavenumbers[0] == pytest.approx(np.pi / 12 / SPACING_nm, rel=1e-9)
    held, wavenumbers = lowest_modes(12, [0, 11], SPACING_nm)
    sine = np.sin(2 * np.pi * pairs / 11)
    assert abs(held[1] @ sine) == pytest.approx(np.linalg.norm(sine), rel=1e-9)
    assert wavenumbers[1] == pytest.approx(2 * np.pi / 11 / SPACING_nm, rel=1e-9)


def test_speed_and_interval_from_thermal_motion() -> None:
    rng, draws, runs = np.random.default_rng(1), 12, 2
    everything = motion(CHAIN, 2, draws * runs, 400, rng)
    fits = [fitted(everything[runs * n : runs * (n + 1)]) for n in range(draws)]
    speeds = np.array([fit.speed_A_per_ps.value for fit in fits])
    # sd(w) = sqrt(g/2T) over 160 ps and two modes is 3 % of the speed, 1 % of the mean of 12.
    assert speeds.mean() == pytest.approx(SPEED_A_PER_PS, rel=0.03)
    inside = [fit.speed_A_per_ps.low <= SPEED_A_PER_PS <= fit.speed_A_per_ps.high for fit in fits]
    # 95 % of 12: nine and fewer come once in 50 times.
    assert sum(inside) >= 10
    assert np.mean([fit.friction_per_ps for fit in fits]) == pytest.approx(
        FRICTION_PER_PS,
        rel=0.4,  # each is one of a grid's, in steps of 1.8
    )
    # A line of power 1 in 1.2, of which the band holds nearly all and of the background a quarter.
    assert np.mean([fit.modes[0].wave_share for fit in fits]) == pytest.approx(0.93, abs=0.05)
    # A flag of 5 %: three and more of 12 come once in 50 times.
    assert sum(fit.wrong for fit in fits) <= 2


@pytest.mark.parametrize("ends", ["held", "free"])
def test_the_paper_s_own_bends_have_a_ratio_of_one(
    make_scene: Callable[..., SceneSpec], make_record: Callable[..., Record], ends: str
) -> None:
    """Between ends that are clamped or free, where bends are no sines and a free duplex tumbles."""
    rng, frames, friction = np.random.default_rng(5), 1000, 0.1
    rod = paper_rod(SPACING_nm)
    chain = PlaneChain(rod, 24, [0, 23] if ends == "held" else [])
    spec, records = make_scene(Nothing(kind="none"), ends, ends), []
    for _ in range(2):
        one, other = (
            1e-3 * thermal_velocity(chain, frames, INTERVAL_ps, friction, 1.0, rng)
            for _ in range(2)
        )
        # About the first direction a positive turn moves what is above against the second.
        fields = {"shear": one[..., 0], "bend": one[..., 1]}
        fields |= {"across": other[..., 0], "bend_across": -other[..., 1]}
        for name, field in fields.items():
            # A flat background, as that of the pairs' own vibrations.
            noise = 0.5 * field.std() * rng.standard_normal(field.shape)
            fields[name] = field + noise * field.any(axis=0)
        motion = make_record(spec, "r1", fields).motion
        changed = motion.assign(
            mass=0 * motion["mass"] + rod.density_Da_per_nm * SPACING_nm,
            inertia=0 * motion["inertia"] + 100 * rod.inertia_Da_nm * SPACING_nm,
        ).assign_coords(time=INTERVAL_ps * np.arange(frames))
        records.append(Record(spec, "r1", changed))
    rows = [row for row in spectrum_rows(records) if row.wave in ("bend", "shear")]
    assert len(rows) == 8
    for row in rows:
        # Four of sd(w) = sqrt(g/2T) over 4 x 200 ps.
        error = 4 * np.sqrt(friction / 1600) / (2e-3 * np.pi * row.paper_frequency_GHz)
        assert row.ratio_to_paper == pytest.approx(1.0, abs=error), (row.wave, row.estimator)


def test_modes_off_the_dispersion_relation_look_wrong() -> None:
    rng = np.random.default_rng(2)
    both = motion(CHAIN, 2, 4, 500, rng)
    both[..., 1] = motion(CHAIN.scaled(0.6), 2, 4, 500, rng)[..., 1]
    found = fitted(both)
    assert found.wrong
    assert found.p_dispersion < 0.01
    # Each by itself is a line, where it is: to five standard errors of sqrt(g/2T) = 0.014 rad/ps.
    second = found.modes[1]
    assert second.frequency_rad_per_ps.value == pytest.approx(
        0.6 * CHAIN.frequencies_rad_per_ps[2], abs=0.07
    )
    assert all(mode.fits for mode in found.modes)


def test_two_lines_in_one_mode_look_wrong() -> None:
    rng = np.random.default_rng(3)
    two = motion(CHAIN, 1, 4, 1000, rng) + motion(CHAIN.scaled(6.0), 1, 4, 1000, rng)
    assert not fitted(two).modes[0].fits
    assert fitted(two).wrong


def test_a_mode_that_does_not_move_has_no_spectrum() -> None:
    moving = np.random.default_rng(6).standard_normal((1, 400, 2))
    with pytest.raises(InputError, match="does not move"):
        fitted(moving * [1.0, 0.0])


def test_a_record_too_short_is_refused() -> None:
    with pytest.raises(InputError, match=r"37\.7 ps and more"):
        fitted(np.ones((1, 50, 2)))
