"""One draw of each estimator on synthetic truth: see estimators.py."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cache

import numpy as np
from numpy.typing import NDArray
from scipy.signal import lfilter

from dnawaves.rod.chain import ScalarChain
from dnawaves.rod.modal import ModalChain
from dnawaves.rod.oscillator import gaussian_pulse_response, sine_drive_response
from dnawaves.rod.rod import Rod
from dnawaves.rod.standing import axial_wavenumber
from dnawaves.waves.estimators.correlation import first_peak_ps, lag_ps, threshold_ps
from dnawaves.waves.estimators.detection import Detector
from dnawaves.waves.estimators.equilibrium import equilibrium_response
from dnawaves.waves.estimators.flight import fit_flight
from dnawaves.waves.estimators.intervals import blocks
from dnawaves.waves.estimators.lattice_fit import Observation, Value, fit_lattice
from dnawaves.waves.estimators.lattices import AxialLattice, Lattice, RodLattice, ScalarLattice
from dnawaves.waves.estimators.modal_fit import fit_modes
from dnawaves.waves.estimators.noise import ColouredNoise, Noise, WhiteNoise, mode_directions
from dnawaves.waves.estimators.resonance import fit_resonance
from dnawaves.waves.estimators.sources import pulse
from dnawaves.waves.estimators.synthetic import noise_sd_for_snr, thermal_velocity, white_noise
from dnawaves.waves.estimators.whittle import whittle_fit

Array = NDArray[np.float64]

PAIRS, SPACING_NM, SPEED, FRICTION = 24, 0.34, 8.19, 0.3
WIDTH_PS = 0.46
CENTRE_PS = 4 * WIDTH_PS
INTERVAL_PS = WIDTH_PS * np.sqrt(8 * np.log(2)) / 10
# Two crossings: the pulse comes back from the far end.
TIMES_PS = np.arange(0, CENTRE_PS + 2 * 10 * SPACING_NM * (PAIRS - 1) / SPEED, INTERVAL_PS)
QUIET_FRAMES = 20 * len(TIMES_PS)
MODES = range(1, 7)
MEMORY = float(np.exp(-1 / 2))


@dataclass(frozen=True)
class Outcome:
    """Relative error of one estimate, whether its interval held the truth, and its flag."""

    error: float
    covered: bool | None = None
    wrong: bool | None = None


def outcome(value: Value, truth: float, wrong: bool | None = None) -> Outcome:
    return Outcome(value.value / truth - 1, value.low <= truth <= value.high, wrong)


@cache
def scene() -> tuple[ScalarLattice, Array]:
    """Return the lattice with its source and the noise-free record (time, pair)."""
    lattice = ScalarLattice(
        PAIRS, SPACING_NM, [], pulse(TIMES_PS, CENTRE_PS, WIDTH_PS), np.eye(PAIRS)[0]
    )
    return lattice, lattice.velocity({"speed_A_per_ps": SPEED, "friction_per_ps": FRICTION})


@cache
def chain() -> ScalarChain:
    return ScalarChain.from_speed(PAIRS, SPEED, SPACING_NM)


@cache
def thermal(sd: float, frames: int = len(TIMES_PS)) -> ColouredNoise:
    return ColouredNoise.of_thermal_motion(chain(), TIMES_PS[-frames:], FRICTION, sd**2)


def noisy(truth: Array, sd: float, kind: str, rng: np.random.Generator) -> tuple[Array, Noise]:
    """Return a record and what a fit is told of its noise: nothing, its covariance, quiet data."""
    if kind == "white":
        return truth + white_noise(truth, sd, rng), WhiteNoise()
    if kind == "memory of 2 samples, not told":
        innovation = white_noise(truth, sd * np.sqrt(1 - MEMORY**2), rng)
        return truth + lfilter([1.0], [1.0, -MEMORY], innovation, axis=0), WhiteNoise()
    record = truth + thermal_velocity(chain(), len(truth), INTERVAL_PS, FRICTION, sd**2, rng)
    if kind == "thermal":
        return record, thermal(sd)
    if kind == "thermal, not told":
        return record, WhiteNoise()
    quiet = thermal_velocity(chain(), QUIET_FRAMES, INTERVAL_PS, FRICTION, sd**2, rng)
    return record, ColouredNoise.of_quiet_data(quiet, len(truth), mode_directions(chain()))


def waveform(snr: float, kind: str, rng: np.random.Generator) -> Outcome:
    lattice, truth = scene()
    record, noise = noisy(truth, noise_sd_for_snr(truth[:, -1], snr), kind, rng)
    fit = fit_lattice([Observation(record, lattice, noise)], intervals=["speed_A_per_ps"])
    return outcome(fit["speed_A_per_ps"], SPEED, fit.model_class.wrong)


def modal(snr: float, kind: str, rng: np.random.Generator) -> Outcome:
    _, truth = scene()
    sd = noise_sd_for_snr(truth[:, -1], snr)
    record, _ = noisy(truth, sd, kind, rng)
    late = TIMES_PS > 2 * CENTRE_PS
    noise = thermal(sd, int(late.sum())) if kind == "thermal" else None
    fit = fit_modes(TIMES_PS[late], record[late], SPACING_NM, [], MODES, noise)
    return outcome(fit.speed_A_per_ps, SPEED, fit.model_class.wrong)


def pick(estimator: str, snr: float, kind: str, rng: np.random.Generator) -> Outcome:
    """Speed from the pulse's centre to the last base pair, or by correlation from the first."""
    _, truth = scene()
    record, _ = noisy(truth, noise_sd_for_snr(truth[:, -1], snr), kind, rng)
    distance = 10 * SPACING_NM * (PAIRS - 1)
    early, late = record[:, 0], record[:, -1]
    if estimator == "correlation":
        # Up to the reflection's return.
        first = int((1.5 * distance / SPEED + CENTRE_PS) / INTERVAL_PS)
        time: float | None = lag_ps(INTERVAL_PS, early[:first], late[:first])
    elif estimator == "first peak":
        time = first_peak_ps(TIMES_PS, late)
        time = None if time is None else time - CENTRE_PS
    else:
        time = threshold_ps(TIMES_PS, late, float(estimator.split()[0]) / 100)
        time = None if time is None else time - CENTRE_PS
    return Outcome(np.nan if time is None or time <= 0 else distance / time / SPEED - 1)


@cache
def coupled() -> tuple[AxialLattice, Array, dict[str, float]]:
    masses = (660.0, 330.0)
    pattern = np.zeros((PAIRS, 2))
    pattern[0] = masses[0], 0.7 * masses[1]
    respond = pulse(TIMES_PS, CENTRE_PS, WIDTH_PS)
    lattice = AxialLattice(PAIRS, SPACING_NM, [], respond, pattern, masses, forced=True)
    truth = dict(zip(lattice.names, (8.19, 5.06, -0.25, 0.3), strict=True))
    velocity = lattice.velocity(truth)
    assert velocity is not None
    return lattice, velocity.reshape(len(TIMES_PS), PAIRS, 2), truth


def field_waveform(
    lattice: Lattice,
    velocity: Array,
    truth: dict[str, float],
    names: Sequence[str],
    snr: float,
    rng: np.random.Generator,
) -> list[Outcome]:
    """Return an outcome for each name, of a record (time, pair, 2) in white noise."""
    sd = np.abs(velocity[:, -1]).max(axis=0) / snr
    record = velocity + white_noise(velocity, 1.0, rng) * sd
    observation = Observation(record, lattice, WhiteNoise(np.tile(sd, PAIRS)))
    fit = fit_lattice([observation], intervals=names)
    return [outcome(fit[name], truth[name], fit.model_class.wrong) for name in names]


def coupled_waveform(snr: float, rng: np.random.Generator) -> list[Outcome]:
    lattice, velocity, truth = coupled()
    return field_waveform(lattice, velocity, truth, lattice.names[:3], snr, rng)


@cache
def plane() -> tuple[RodLattice, Array, dict[str, float]]:
    pattern = np.zeros((PAIRS, 2))
    pattern[0] = 200.0, 0.0
    times = np.arange(0, 30, 0.2)
    free = {"shear": [(0, 0), (1, 1)], "bend": [(3, 3), (4, 4)]}
    respond = pulse(times, 3.2, 0.8)
    lattice = RodLattice(Rod.paper(), PAIRS, [], respond, pattern, free, plane=True)
    truth = {"shear": 1.3, "bend": 0.6, "friction_per_ps": 0.1}
    velocity = lattice.velocity(truth)
    assert velocity is not None
    return lattice, velocity.reshape(len(times), PAIRS, 2), truth


def plane_waveform(snr: float, rng: np.random.Generator) -> list[Outcome]:
    lattice, velocity, truth = plane()
    return field_waveform(lattice, velocity, truth, lattice.names[:2], snr, rng)


@cache
def rod_scenes() -> tuple[list[RodLattice], dict[str, float]]:
    """Return three scenes of 10 base pairs of the twisted rod, the first one held.

    Pushed along the axis, twisted and pushed across it; all six coordinates are read.
    """
    times = np.arange(0, 10, 0.15)
    free = {
        "stretch": [(2, 2)],
        "twist": [(5, 5)],
        "bend": [(3, 3), (4, 4)],
        "coupling_extension_twist": [(2, 5)],
    }
    patterns = np.zeros((3, 10, 6))
    patterns[[0, 1, 2], 1, [2, 5, 0]] = 400.0, 200.0, 400.0
    respond = pulse(times, 1.6, 0.4)
    first = RodLattice(Rod.paper(twisted=True), 10, [0], respond, patterns[0], free)
    truth = dict(zip(first.names, (1.6, 0.7, 1.2, -0.2, 0.2), strict=True))
    return [first, *(replace(first, pattern=pattern) for pattern in patterns[1:])], truth


def joint_waveform(snr: float, rng: np.random.Generator) -> list[Outcome]:
    """White noise in each coordinate, its sd a part of the largest answer of that coordinate."""
    lattices, truth = rod_scenes()
    observations = []
    for lattice in lattices:
        velocity = lattice.velocity(truth)
        assert velocity is not None
        field = np.zeros((len(velocity), *lattice.moving.shape))
        field[:, lattice.moving] = velocity
        largest = np.abs(field).max(axis=(0, 1))
        # Coordinates that the scene leaves still are not known without error either.
        sd = np.maximum(largest, 1e-3 * largest.max()) / snr
        record = field + white_noise(field, 1.0, rng) * sd
        noise = WhiteNoise(np.tile(sd, lattice.moving.all(axis=1).sum()))
        observations.append(Observation(record, lattice, noise))
    names = lattices[0].names[:4]
    fit = fit_lattice(observations, intervals=names)
    return [outcome(fit[name], truth[name], fit.model_class.wrong) for name in names]


def thermal_spectrum(rng: np.random.Generator) -> Outcome:
    """1 ns at a friction of 0.5 /ps, modes 1 to 4."""
    velocity = thermal_velocity(chain(), 10_000, 0.1, 0.5, 1.0, rng)
    wavenumbers = np.array([axial_wavenumber(PAIRS, p, "free", SPACING_NM) for p in range(1, 5)])
    modes = velocity @ chain().shapes[1:5].T
    fit = whittle_fit(modes, 0.1, wavenumbers, SPACING_NM, highest_rad_per_ps=2.5)
    return outcome(fit.speed_A_per_ps, SPEED, fit.wrong)


def resonance(rng: np.random.Generator) -> Outcome:
    """Three drives about a mode of 0.7 rad/ps, 20 ps each, noise a tenth of the largest answer."""
    times, drives, truth = np.arange(0, 20, 0.1), [0.5, 0.7, 0.95], 0.7
    runs = [sine_drive_response(times, [truth], 0.1, drive)[1][:, 0] for drive in drives]
    sd = noise_sd_for_snr(np.concatenate(runs), 10)
    fit = fit_resonance([times] * 3, [run + white_noise(run, sd, rng) for run in runs], drives)
    return outcome(fit.frequency_rad_per_ps, truth, fit.model_class.wrong)


def flight(rng: np.random.Generator) -> Outcome:
    """Five lengths, times with a delay of 0.7 ps and errors of 0.2 ps that nobody has told."""
    lengths = 3.4 * np.array([11.0, 17, 23, 35, 47])
    times = 0.7 + lengths / SPEED + 0.2 * rng.standard_normal(len(lengths))
    return outcome(fit_flight(lengths, times).speed_A_per_ps, SPEED)


def equilibrium(rng: np.random.Generator) -> Outcome:
    """Peak at base pair 12 of the answer to a kick of base pair 0, from 2 ns without forcing."""
    velocity = thermal_velocity(chain(), 20_000, 0.1, FRICTION, 1.0, rng)
    impulse = np.eye(PAIRS)[0]
    exact = chain().kick_response(np.arange(80) * 0.1, impulse, FRICTION)[1][:, 12]
    mean, error = equilibrium_response(blocks(velocity, 1000), impulse, 1.0, 80)
    peak = int(np.argmax(exact))
    # Student's t of 20 blocks.
    covered = abs(mean[peak, 12] - exact[peak]) < 2.093 * error[peak, 12]
    return Outcome(float(mean[peak, 12] / exact[peak] - 1), bool(covered))


def own_friction(solved: ModalChain, frictions_per_ps: Array, pattern: Array) -> Array:
    """Return the scene's record of a chain whose modes each have a friction of their own."""
    _, shapes = solved.modes()
    answers = [
        gaussian_pulse_response(TIMES_PS, [w], float(g), CENTRE_PS, WIDTH_PS)[1][:, 0]
        for w, g in zip(solved.frequencies_rad_per_ps, frictions_per_ps, strict=True)
    ]
    return np.array(answers).T @ ((shapes @ pattern)[:, np.newaxis] * shapes)


@cache
def truths() -> dict[str, Array]:
    """Return noise-free records: the fit's own class, and three that lie outside it."""
    pattern = np.eye(PAIRS)[0]
    stiffness = (SPEED / 10 / SPACING_NM) ** 2
    rng = np.random.default_rng(7)
    uneven = ScalarChain(np.ones(PAIRS), stiffness * rng.uniform(0.6, 1.4, PAIRS - 1))
    frictions = 0.1 + 0.1 * uneven.frequencies_rad_per_ps**2
    step, two_steps = (np.eye(PAIRS, k=k)[:-k] - np.eye(PAIRS)[:-k] for k in (1, 2))
    # The same speed of long waves: V^2 = (k1 + 4 k2) a^2/m.
    second = 0.15 * stiffness
    far = (stiffness - 4 * second) * step.T @ step + second * two_steps.T @ two_steps
    farther = ModalChain(far, np.eye(PAIRS), np.ones(PAIRS, dtype=bool))
    return {
        "uniform lattice (the fit's own class)": scene()[1],
        "uneven steps (±40 %), friction growing with frequency²": own_friction(
            uneven, frictions, pattern
        ),
        "couplings to second neighbours, 15 % of the first": farther.pulse_response(
            TIMES_PS, pattern, CENTRE_PS, WIDTH_PS, FRICTION
        )[1],
        "base pairs with inner vibrations, as atoms have": inner_vibrations(pattern),
    }


def inner_vibrations(pattern: Array) -> Array:
    """Return the scene's record of base pairs that each carry three masses on springs.

    A stand-in for the answer of all atoms: harmonic, but with many more modes than the lattice
    has, from 1 to 10 rad/ps, through all the wave's band and above.
    """
    rng = np.random.default_rng(8)
    stiffness = (SPEED / 10 / SPACING_NM) ** 2
    step = np.eye(PAIRS, k=1)[:-1] - np.eye(PAIRS)[:-1]
    size = 4 * PAIRS
    total = np.zeros((size, size))
    total[:PAIRS, :PAIRS] = stiffness * step.T @ step
    mass = np.concatenate([np.full(PAIRS, 0.7), np.full(3 * PAIRS, 0.1)])
    for inner in range(PAIRS, size):
        own = 0.1 * rng.uniform(1.0, 10.0) ** 2
        pair = inner % PAIRS
        for i, j, sign in (
            (inner, inner, 1),
            (pair, pair, 1),
            (inner, pair, -1),
            (pair, inner, -1),
        ):
            total[i, j] += sign * own
    solved = ModalChain(total, mass, np.ones(size, dtype=bool))
    force = np.concatenate([pattern, np.zeros(3 * PAIRS)])
    _, velocity = solved.pulse_response(TIMES_PS, force, CENTRE_PS, WIDTH_PS, FRICTION)
    return velocity[:, :PAIRS]


def model_class(truth: str, snr: float, kind: str, rng: np.random.Generator) -> Outcome:
    lattice, _ = scene()
    record = truths()[truth]
    sd = noise_sd_for_snr(record[:, -1], snr)
    data, noise = noisy(record, sd, kind, rng)
    if kind == "white":
        noise = WhiteNoise(sd)
    fit = fit_lattice([Observation(data, lattice, noise)], intervals=[])
    return Outcome(fit["speed_A_per_ps"].value / SPEED - 1, wrong=fit.model_class.wrong)


@cache
def detector(kind: str) -> Detector:
    lattice, truth = scene()
    noise = thermal(1.0) if kind == "thermal" else WhiteNoise()
    return Detector(lattice, Observation(truth, lattice, noise), np.random.default_rng(3))


def null(kind: str, rng: np.random.Generator) -> Outcome:
    """A record of noise alone; `wrong` says that a wave was found in it."""
    lattice, truth = scene()
    record, noise = noisy(np.zeros_like(truth), 1.0, kind, rng)
    own = detector(kind)
    if isinstance(noise, ColouredNoise) and np.isfinite(noise.quiet_samples):
        own = Detector(lattice, Observation(truth, lattice, noise), rng)
    return Outcome(0.0, wrong=own(record).p_value <= 0.05)
