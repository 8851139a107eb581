"""Drives on resonance, at the edge of the band and above it."""

from __future__ import annotations

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from dnawaves.rod.chain import ScalarChain
from dnawaves.rod.rod import Rod, short_wave_speeds_A_per_ps
from dnawaves.scene.excitations import Periodic
from dnawaves.scene.models import SceneSpec
from dnawaves.stability.case import Found
from dnawaves.stability.samples import HELD, relaxed, scene_of
from dnawaves.system.duplex import SimulatedDuplex
from dnawaves.system.modes import NormalModes, normal_modes
from dnawaves.trajectory.harmonic import respond
from dnawaves.trajectory.pattern import forces_at_full_strength
from dnawaves.trajectory.plan import Plan
from dnawaves.trajectory.run import run_member
from dnawaves.units import A_PER_NM, GHZ_PER_RAD_PER_PS

Array = NDArray[np.float64]
SEQUENCE = "CGCG"
PAPER = Rod.paper()
# The transients of a rise over so many periods are below 1e-6 of the steady answer.
RISE_PERIODS = 400
# Samples of ten periods.
EDGE_BLOCK = 200
FRAMES = 201
TIMESTEP_PS = 0.002


def resonance(force_pN: float, periods: int) -> Found:
    """Return how far the energy of a duplex driven at a mode is from the exact linear answer."""
    duplex, record, modes = _held()
    frequency = _resonant(duplex, modes)
    plan, scene = _plan(duplex, force_pN, frequency, periods)
    motion = run_member(duplex, scene, plan, "f1", {}).dataset()
    minimum = float(record.attrs["energy_kJ_per_mol"])
    exact = respond(duplex, modes, scene, plan, 1.0, minimum)["total_energy"].values - minimum
    gained = motion["total_energy"].values - motion["total_energy"].values[:, :1]
    half = FRAMES // 2
    growth = float(gained[:, -20:].mean() / gained[:, half - 10 : half + 10].mean())
    return Found(
        "holds",
        float(np.abs(gained - exact).max() / exact.max()),
        f"{frequency * GHZ_PER_RAD_PER_PS:.0f} GHz, {periods} periods: {gained[:, -1].mean():.3g} "
        f"kJ/mol, {growth:.2f} times that at half the time (4: amplitude grows as time)",
    )


def hard_resonance(force_pN: float, periods: int) -> Found:
    """Return how far work and gained energy differ under a drive far beyond the linear range."""
    duplex, _, modes = _held()
    frequency = _resonant(duplex, modes)
    plan, scene = _plan(duplex, force_pN, frequency, periods)
    motion = run_member(duplex, scene, plan, "f1", {}).dataset()
    gained = motion["total_energy"].values - motion["total_energy"].values[:, :1]
    work = motion["work"].values
    return Found(
        "holds",
        float(np.abs(gained - work).max() / np.abs(work).max()),
        f"{gained.max():.3g} kJ/mol gained at {frequency * GHZ_PER_RAD_PER_PS:.0f} GHz, largest "
        f"displacement {np.abs(motion['displacement'].values).max():.2g} Å",
    )


def beyond_the_band(times_edge: float, force_pN: float, periods: int) -> Found:
    """Return the largest energy of a duplex driven beyond its base pairs' band, of that in it.

    The edge is 2V/a with the first estimate V of extension; the unit is the largest energy under
    the same force on resonance, after half as many periods.
    """
    duplex, record, modes = _held()
    speed_nm_per_ps = float(record.attrs["first_estimate_extension_A_per_ps"]) / A_PER_NM
    edge = 2 * speed_nm_per_ps / duplex.spacing_nm
    resonant = _resonant(duplex, modes)
    largest = []
    for frequency, lasting in ((times_edge * edge, periods), (resonant, periods // 2)):
        plan, scene = _plan(duplex, force_pN, frequency, lasting)
        energy = run_member(duplex, scene, plan, "f1", {}).dataset()["total_energy"].values
        largest.append(float((energy - energy[:, :1]).max()))
    return Found(
        "holds",
        largest[0] / largest[1],
        f"{largest[0]:.2g} kJ/mol at {times_edge * edge * GHZ_PER_RAD_PER_PS:.0f} GHz against "
        f"{largest[1]:.2g} kJ/mol at {resonant * GHZ_PER_RAD_PER_PS:.0f} GHz",
    )


def evanescent(times_edge: float, pairs: int) -> Found:
    """Return how far the decay from pair to pair, above a lattice's band, is from exp(-kappa).

    kappa = 2 arcosh(omega/omega_edge), from omega = (2V/a) sin(ka/2) with k = pi/a + i kappa/a.
    """
    chain, edge = _chain(pairs)
    drive = times_edge * edge
    period = 2 * np.pi / drive
    # After a slow rise the steady answer is left, in phase with the drive.
    times = RISE_PERIODS * period + period * np.arange(64) / 64
    motion, _ = chain.driven_response(
        times, _at(0, pairs), drive, ramp_ps=0.9 * RISE_PERIODS * period
    )
    amplitude = np.abs(np.sin(drive * times) @ motion)
    kappa = 2 * np.arccosh(times_edge)
    ratios = amplitude[1:4] / amplitude[:3]
    return Found(
        "holds",
        float(np.abs(ratios / np.exp(-kappa) - 1).max()),
        f"each pair {ratios.mean():.5f} of the one before, exp(-kappa) is {np.exp(-kappa):.5f}",
    )


def at_the_edge(pushed: int, pairs: int, periods: int) -> Found:
    """Return the power of time with which the pushed pair's amplitude grows at the band's edge."""
    chain, drive = _chain(pairs)
    period = 2 * np.pi / drive
    times = period * np.arange(0, periods, 0.05)
    observe = _at(pushed, pairs)[None, :]
    moved = chain.driven_response(times, _at(pushed, pairs), drive, observe=observe)[0][:, 0]
    blocks = np.abs(moved).reshape(-1, EDGE_BLOCK).max(axis=1)
    middle = times.reshape(-1, EDGE_BLOCK).mean(axis=1)
    power = float(np.polyfit(np.log(middle[1:]), np.log(blocks[1:]), 1)[0])
    return Found("holds", power, f"{blocks[-1] / blocks[1]:.2f} times in {periods} periods")


def _chain(pairs: int) -> tuple[ScalarChain, float]:
    """Return a chain with the paper's extension wave, its last pair held, and its band's edge."""
    speed_A_per_ps, spacing_nm = short_wave_speeds_A_per_ps(PAPER)["extension"], PAPER.spacing_nm
    chain = ScalarChain.from_speed(pairs, speed_A_per_ps, spacing_nm, held=[-1])
    return chain, 2 * speed_A_per_ps / A_PER_NM / spacing_nm


def _at(pair: int, pairs: int) -> Array:
    """Return a unit force on one pair, none on the others."""
    return np.eye(pairs)[pair]


def _held() -> tuple[SimulatedDuplex, xr.Dataset, NormalModes]:
    duplex, record, hessian = relaxed(SEQUENCE)
    free = (duplex.pairs > 0) & (duplex.pairs < duplex.pair_count - 1)
    return duplex, record, normal_modes(hessian, duplex.masses_Da, duplex.bodies, free)


def _driven(duplex: SimulatedDuplex, force_pN: float, frequency_GHz: float) -> SceneSpec:
    excitation = {
        "kind": "periodic",
        "wave": "extension",
        "force_pN": force_pN,
        "pairs": 1,
        "frequencies_GHz": [frequency_GHz],
    }
    return scene_of(duplex, excitation, HELD)


def _plan(
    duplex: SimulatedDuplex, force_pN: float, frequency: float, periods: int
) -> tuple[Plan, SceneSpec]:
    """Return a plan of `periods` of a drive (rad/ps), and its scene."""
    frequency_GHz = frequency * GHZ_PER_RAD_PER_PS
    steps = max(1, round(periods * 1e3 / frequency_GHz / TIMESTEP_PS / (FRAMES - 1)))
    plan = Plan(TIMESTEP_PS, steps, FRAMES, frequency_GHz=frequency_GHz)
    return plan, _driven(duplex, force_pN, frequency_GHz)


def _resonant(duplex: SimulatedDuplex, modes: NormalModes) -> float:
    """Return the frequency (rad/ps) of the mode that a static push moves most."""
    # Which one it is depends neither on the size of the push nor on the drive's frequency.
    scene = _driven(duplex, force_pN=1.0, frequency_GHz=1.0)
    assert isinstance(scene.excitation, Periodic)
    forces = forces_at_full_strength(scene.excitation, scene.ends, duplex)
    rigid = duplex.bodies.velocity(duplex.positions_nm, forces / duplex.masses_Da[:, None])
    shares = modes.amplitudes(duplex.bodies.momenta(np.concatenate(rigid, axis=1)))
    frequencies = modes.frequencies_rad_per_ps
    return float(frequencies[np.argmax(np.abs(shares) / frequencies**2)])
