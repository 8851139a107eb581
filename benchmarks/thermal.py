"""Bias and coverage of what is estimated above 0 K, on synthetic truth.

python benchmarks/thermal.py [draws [words of rows]] prints a Markdown table; 200 draws by default,
half an hour of one core. Rows: the speed from spectra of thermal motion, the speed from replicas of
a kick, and the rod's constants from covariances of strains.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
import scipy.linalg
from numpy.typing import NDArray

from dnawaves.frames.fit import Frames
from dnawaves.rod.chain import ScalarChain
from dnawaves.rod.rod import BEND_1, EXTENSION, SHEAR_1, TWIST, Rod
from dnawaves.units import A_PER_NM, BOLTZMANN_KJ_PER_MOL_K, KJ_PER_MOL_PER_PN_NM
from dnawaves.waves.constants.rod_mass import RodMass
from dnawaves.waves.constants.thermal_stiffness import thermal_constants, thermal_strains
from dnawaves.waves.estimators.lattices import ScalarLattice
from dnawaves.waves.estimators.long_waves import lowest_waves
from dnawaves.waves.estimators.mode_spectra import shared_speed
from dnawaves.waves.estimators.replicas import Replicas, fit_replicas
from dnawaves.waves.estimators.sources import kick
from dnawaves.waves.estimators.synthetic import thermal_velocity
from dnawaves.waves.thermal_spectrum import HIGHEST_RAD_PER_PS, lowest_modes

Array = NDArray[np.float64]

SPACING_nm, SPEED_A_PER_PS, INTERVAL_ps = 0.34, 8.19, 0.1
COLD_K = 0.03


class Outcome(NamedTuple):
    """Estimate over truth less one, whether the interval holds the truth, the flag."""

    error: float
    inside: bool
    flagged: bool


def spectrum(rng: np.random.Generator, runs: int = 4, length_ps: float = 60.0) -> list[Outcome]:
    """24 free base pairs, friction 0.5 /ps, a background of half the line's height at mode 4."""
    chain = ScalarChain.from_speed(24, SPEED_A_PER_PS, SPACING_nm)
    shapes, wavenumbers = lowest_modes(24, [], SPACING_nm)
    frames = round(length_ps / INTERVAL_ps)
    modes = []
    for _ in range(runs):
        moving = thermal_velocity(chain, frames, INTERVAL_ps, 0.5, 1.0, rng) @ shapes.T
        modes.append(moving + np.sqrt(0.5) * rng.standard_normal(moving.shape))
    fit = shared_speed(modes, INTERVAL_ps, wavenumbers, SPACING_nm, HIGHEST_RAD_PER_PS)
    speed = fit.speed_A_per_ps
    inside = speed.low <= SPEED_A_PER_PS <= speed.high
    return [Outcome(speed.value / SPEED_A_PER_PS - 1, inside, fit.wrong)]


def replicas(rng: np.random.Generator, count: int = 4, snr: float = 5.0) -> list[Outcome]:
    """16 base pairs, one end held, three kicked; from 6 of 12 ps chaos grows by e every 2 ps.

    SNR: peak at the last free pair over the mean's noise there until then. Each replica ends 1 ps
    before the one before it.
    """
    pairs, held, friction = 16, [15], 0.3
    times = np.arange(0, 12, INTERVAL_ps)
    pattern = np.where(np.arange(pairs) < 3, 1.0, 0.0)
    chain = ScalarChain.from_speed(pairs, SPEED_A_PER_PS, SPACING_nm, held)
    wave = chain.kick_response(times, pattern, friction)[1]
    moving = np.array(
        [thermal_velocity(chain, len(times), INTERVAL_ps, friction, 1.0, rng) for _ in range(count)]
    )
    sd = np.sqrt(np.sum(chain.shapes[:, -2] ** 2))
    growth = np.exp(np.maximum(times - 6, 0) / 2.0)[:, np.newaxis]
    answers = wave + np.abs(wave[:, -2]).max() / snr * np.sqrt(count) / sd * growth * moving
    averaged = Replicas.of([one[: len(times) - 10 * k] for k, one in enumerate(answers)])
    lattice = ScalarLattice(pairs, SPACING_nm, held, kick(times[: averaged.frames]), pattern)
    directions = lowest_waves(pairs, held, 4)
    fit = fit_replicas([(averaged, lattice)], directions, "speed_A_per_ps", rng)
    inside = fit.value.low <= SPEED_A_PER_PS <= fit.value.high
    return [Outcome(fit.value.value / SPEED_A_PER_PS - 1, inside, fit.wrong)]


def covariance(rng: np.random.Generator, samples: int = 200, memory: float = 0.8) -> list[Outcome]:
    """12 base pairs of a twisted, coupled rod; successive frames remember each other (g = 4.6)."""
    rod = twisted_rod()
    straight = rod.averaged_about_axis().stiffness / KJ_PER_MOL_PER_PN_NM
    frames = thermal_frames(rod, 12, 5 * samples, COLD_K, rng, memory)
    found = thermal_constants(
        thermal_strains([frames], COLD_K), RodMass(190.0, 5000.0, 2500.0), "thermal"
    )
    truth = {
        "stretch_modulus_pN": straight[EXTENSION, EXTENSION],
        "twist_rigidity_pN_nm2": straight[TWIST, TWIST],
        "bend_rigidity_pN_nm2": straight[BEND_1, BEND_1],
        "shear_stiffness_pN": straight[SHEAR_1, SHEAR_1],
    }
    outcomes = []
    for one in found:
        if one.route == "thermal K(q->0)" and one.quantity in truth:
            exact = truth[one.quantity]
            assert one.low is not None and one.high is not None
            outcomes.append(Outcome(one.value / exact - 1, one.low <= exact <= one.high, False))
    return outcomes


def twisted_rod() -> Rod:
    """Return a rod like DNA: twisted, anisotropic, extension and twist coupled."""
    stiffness = np.diag([500.0, 700.0, 1300.0, 100.0, 200.0, 150.0])
    stiffness[EXTENSION, TWIST] = stiffness[TWIST, EXTENSION] = -90.0
    turn = np.array([0.0, 0.0, 1.8])
    return Rod(1900.0, np.diag([250.0, 250.0, 500.0]), stiffness, 0.34, omega0_rad_per_nm=turn)


def thermal_frames(
    rod: Rod,
    pairs: int,
    samples: int,
    temperature_K: float,
    rng: np.random.Generator,
    memory: float = 0.0,
) -> Frames:
    """Return frames (pairs, samples) of a rod's lattice in equilibrium.

    Each step is E exp(a strain) E with the half-step E at rest, its strain drawn from
    exp(-a strain.K.strain/2kT); successive samples are correlated by `memory`.
    """
    a = rod.spacing_nm
    energy = BOLTZMANN_KJ_PER_MOL_K * temperature_K
    root = np.linalg.cholesky(energy / a * np.linalg.inv(rod.stiffness))
    noise = rng.standard_normal((samples, pairs - 1, 6))
    for frame in range(1, samples):
        noise[frame] = memory * noise[frame - 1] + np.sqrt(1 - memory**2) * noise[frame]
    poses = np.tile(np.eye(4), (samples, 1, 1))
    half = _screws(a / 2 * np.concatenate([rod.gamma0, rod.omega0_rad_per_nm])[np.newaxis])
    kept = [poses]
    for strain in (noise @ root.T).swapaxes(0, 1):
        poses = poses @ half @ _screws(a * strain) @ half
        kept.append(poses)
    found = np.array(kept)
    return Frames(
        A_PER_NM * found[..., :3, 3].transpose(2, 0, 1), found[..., :3, :3].transpose(3, 2, 0, 1)
    )


def _screws(screws: Array) -> Array:
    generators = np.zeros((len(screws), 4, 4))
    x, y, z = screws[:, 3:].T
    generators[:, 0, 1], generators[:, 0, 2], generators[:, 1, 2] = -z, y, -x
    generators[:, :3, :3] -= generators[:, :3, :3].transpose(0, 2, 1)
    generators[:, :3, 3] = screws[:, :3]
    return np.asarray(scipy.linalg.expm(generators))


ROWS: dict[str, Callable[[np.random.Generator], list[Outcome]]] = {
    "spectrum, 4 runs of 60 ps, modes 1-4": spectrum,
    "replicas of a kick, 4, SNR 5": replicas,
    "replicas of a kick, 8, SNR 5": lambda rng: replicas(rng, 8),
    "covariance, 200 independent samples": covariance,
}


def table_row(name: str, draws: int, seed: int = 1) -> str:
    """Return a row of the table: bias and spread in %, coverage and flags in %."""
    outcomes = [one for i in range(draws) for one in ROWS[name](np.random.default_rng([seed, i]))]
    errors = 100 * np.array([one.error for one in outcomes])
    low, middle, high = np.quantile(errors, [0.16, 0.5, 0.84])
    inside = 100 * np.mean([one.inside for one in outcomes])
    flagged = 100 * np.mean([one.flagged for one in outcomes])
    return f"| {name} | {middle:+.2f} ± {(high - low) / 2:.2f} | {inside:.1f} | {flagged:.1f} |"


def main(arguments: Sequence[str]) -> None:
    """Print the table; arguments: draws (200), then words of the rows that are wanted."""
    draws = int(arguments[0]) if arguments else 200
    print("| estimator | median ± half 16-84 %, in % | coverage % | flagged % |\n|---|---|---|---|")
    for name in ROWS:
        if not arguments[1:] or any(word in name for word in arguments[1:]):
            print(table_row(name, draws), flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
