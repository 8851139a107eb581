"""Full-waveform fits of lattices: noise-free truth comes back, from starts that know nothing."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from dnawaves.errors import InputError
from dnawaves.rod.chain import FiniteChain, ScalarChain
from dnawaves.rod.rod import EXTENSION, TWIST, Rod
from dnawaves.waves.estimators.lattice_fit import Observation, fit_lattice
from dnawaves.waves.estimators.lattices import AxialLattice, RodLattice, ScalarLattice
from dnawaves.waves.estimators.noise import WhiteNoise
from dnawaves.waves.estimators.sources import drive, kick, pulse

PAIRS, SPACING_NM = 24, 0.34
TIMES_PS = np.arange(0, 14, 0.15)
# What is left in noise-free data of the model class: the optimiser's tolerance of 1e-8 in the sum
# of squares, a few 1e-5 in a parameter.
EXACT = 1e-4


def record(velocity: np.ndarray, moving: np.ndarray) -> np.ndarray:
    """Return the field (time, *field) of the moving channels (time, channel)."""
    full = np.zeros((len(velocity), *moving.shape))
    full[:, moving] = velocity
    return full


@pytest.mark.parametrize("speed", [5.06, 16.0, 35.0])
@pytest.mark.parametrize("held", [[], [23]])
def test_scalar_fit_finds_any_speed_without_being_told(speed: float, held: list[int]) -> None:
    respond = pulse(TIMES_PS, 1.0, 0.25)
    lattice = ScalarLattice(PAIRS, SPACING_NM, held, respond, np.eye(PAIRS)[0])
    truth = {"speed_A_per_ps": speed, "friction_per_ps": 0.2}
    velocity = record(3 * lattice.velocity(truth), lattice.moving)
    fit = fit_lattice([Observation(velocity, lattice)])
    assert fit["speed_A_per_ps"].value == pytest.approx(speed, rel=EXACT)
    assert fit["friction_per_ps"].value == pytest.approx(0.2, rel=1e-3)
    assert fit.amplitudes[0] == pytest.approx(3, rel=1e-3)
    assert fit.model_class.misfit < EXACT


@pytest.mark.parametrize("forced", [True, False])
def test_axial_lattice_is_the_full_chain_with_extension_and_twist_coupled(forced: bool) -> None:
    rod = Rod.paper()
    stiffness = np.array(rod.stiffness)
    coupling = -0.3 * np.sqrt(stiffness[EXTENSION, EXTENSION] * stiffness[TWIST, TWIST])
    stiffness[EXTENSION, TWIST] = stiffness[TWIST, EXTENSION] = coupling
    rod = replace(rod, stiffness=stiffness)
    mass = rod.density_Da_per_nm * rod.spacing_nm
    inertia = rod.inertia_Da_nm[2, 2] * rod.spacing_nm
    pattern = np.zeros((PAIRS, 2))
    pattern[1] = 1.0, 0.5
    six = np.zeros((PAIRS, 6))
    six[:, [EXTENSION, TWIST]] = pattern
    respond = pulse(TIMES_PS, 2.0, 0.5) if forced else kick(TIMES_PS)
    lattice = AxialLattice(PAIRS, rod.spacing_nm, [0], respond, pattern, (mass, inertia), forced)
    speeds = np.sqrt(np.diag(stiffness)[[EXTENSION, TWIST]] * rod.spacing_nm / [mass, inertia])
    values = dict(zip(lattice.names, (*(10 * speeds), -0.3, 0.1), strict=True))
    found = lattice.velocity(values)
    expected = respond(FiniteChain(rod, PAIRS, [0]), six, 0.1)[:, 1:, [EXTENSION, TWIST]]
    assert found is not None
    # Two routes to one linear problem: round-off of the eigensolver.
    np.testing.assert_allclose(
        found.reshape(expected.shape), expected, atol=1e-9 * np.abs(expected).max()
    )


def test_coupled_fit_finds_both_speeds_and_the_coupling() -> None:
    pattern = np.zeros((PAIRS, 2))
    pattern[0] = 660.0, 230.0
    respond = pulse(TIMES_PS, 2.0, 0.5)
    lattice = AxialLattice(PAIRS, SPACING_NM, [], respond, pattern, (660.0, 330.0), forced=True)
    truth = dict(zip(lattice.names, (14.0, 6.0, 0.2, 0.1), strict=True))
    velocity = record(lattice.velocity(truth), lattice.moving)
    fit = fit_lattice([Observation(velocity, lattice)], intervals=[])
    for name, value in truth.items():
        assert fit[name].value == pytest.approx(value, rel=1e-3)


def test_twist_seen_only_through_its_coupling_is_found_too() -> None:
    pattern = np.zeros((PAIRS, 2))
    pattern[0, 0] = 660.0
    respond = pulse(TIMES_PS, 2.0, 0.5)
    lattice = AxialLattice(PAIRS, SPACING_NM, [], respond, pattern, (660.0, 330.0), forced=True)
    truth = dict(zip(lattice.names, (8.19, 5.06, -0.25, 0.1), strict=True))
    velocity = record(lattice.velocity(truth), lattice.moving)
    fit = fit_lattice([Observation(velocity, lattice)], intervals=[])
    for name, value in truth.items():
        assert fit[name].value == pytest.approx(value, rel=1e-3)


def test_bend_and_shear_of_a_plane_are_found_far_from_the_start() -> None:
    pattern = np.zeros((12, 2))
    pattern[0] = 200.0, 0.0
    free = {"shear": [(0, 0), (1, 1)], "bend": [(3, 3), (4, 4)]}
    lattice = RodLattice(Rod.paper(), 12, [], kick(TIMES_PS), pattern, free, plane=True)
    truth = {"shear": 1.5, "bend": 0.6, "friction_per_ps": 0.1}
    velocity = record(lattice.velocity(truth), lattice.moving)
    fit = fit_lattice([Observation(velocity, lattice)], intervals=[])
    for name, value in truth.items():
        assert fit[name].value == pytest.approx(value, rel=1e-3)


def test_joint_fit_of_three_scenes_finds_the_constants_of_the_rod() -> None:
    pairs, rng = 8, np.random.default_rng(3)
    free = {"stretch": [(2, 2)], "twist": [(5, 5)], "coupling": [(2, 5)]}
    first = RodLattice(
        Rod.paper(twisted=True), pairs, [0], pulse(TIMES_PS, 1.6, 0.4), np.zeros((pairs, 6)), free
    )
    patterns = np.zeros((2, pairs, 6))
    patterns[0, 1, EXTENSION], patterns[1, 1, TWIST] = 400.0, 200.0
    scenes = [replace(first, pattern=pattern) for pattern in patterns]
    scenes.append(replace(scenes[0], respond=drive(TIMES_PS, 1.0)))
    truth = {"stretch": 1.6, "twist": 0.7, "coupling": -0.2, "friction_per_ps": 0.2}
    observations = []
    for lattice in scenes:
        velocity = record(lattice.velocity(truth), lattice.moving)
        sd = np.abs(velocity).max(axis=(0, 1)) / 10 + 1e-4 * np.abs(velocity).max()
        noisy = velocity + sd * rng.standard_normal(velocity.shape)
        observations.append(Observation(noisy, lattice, WhiteNoise(np.tile(sd, pairs - 1))))
    fit = fit_lattice(observations)
    for name, value in truth.items():
        # Of five standard errors, so that one fixed draw passes unless the fit is wrong.
        reach = 2.5 * (fit[name].high - fit[name].low) / 2
        assert fit[name].value == pytest.approx(value, abs=reach)
        assert reach < 0.4 * abs(value)
    assert not fit.model_class.wrong


def test_what_cannot_be_fitted_is_refused() -> None:
    lattice = ScalarLattice(PAIRS, SPACING_NM, [], kick(TIMES_PS), np.eye(PAIRS)[0])
    still = np.zeros((len(TIMES_PS), PAIRS))
    with pytest.raises(InputError, match="no wave"):
        fit_lattice([Observation(still, lattice)])
    with pytest.raises(InputError, match="not finite"):
        fit_lattice([Observation(still + np.nan, lattice)])
    with pytest.raises(InputError, match="friction_per_ps"):
        fit_lattice([Observation(still + 1, lattice)], starts=[{"speed_A_per_ps": 5.0}])
    with pytest.raises(InputError, match="off the diagonal"):
        RodLattice(Rod.paper(), 8, [], kick(TIMES_PS), np.zeros((8, 6)), {"coupling": [(2, 2)]})


def test_alternating_steps_are_the_wrong_model_class_in_white_noise_of_unknown_level() -> None:
    chain = ScalarChain(np.ones(PAIRS), np.where(np.arange(PAIRS - 1) % 2, 10.0, 2.0))
    source = np.eye(PAIRS)[0]
    respond = pulse(TIMES_PS, 1.0, 0.25)
    velocity = respond(chain, source, 0.2)
    noise = np.abs(velocity[:, -1]).max() / 10
    noisy = velocity + noise * np.random.default_rng(0).standard_normal(velocity.shape)
    lattice = ScalarLattice(PAIRS, SPACING_NM, [], respond, source)
    fit = fit_lattice([Observation(noisy, lattice)], intervals=[])
    assert fit.model_class.wrong
    assert fit.model_class.excess is None
