"""Energy at constant energy: its drift, its error by timestep, and where a timestep breaks."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np
import openmm
from numpy.typing import NDArray
from scipy.sparse.linalg import eigsh

from dnawaves.accuracy.engine import multiple_timestep, split_forces
from dnawaves.scene.models import Observation
from dnawaves.stability.case import Found
from dnawaves.stability.judge import stopped
from dnawaves.stability.samples import built, context_of, relaxed, scene_of, warm
from dnawaves.system.duplex import SimulatedDuplex
from dnawaves.system.effects.thermostat import langevin_middle, velocity_verlet_with_friction
from dnawaves.system.forces import nonbonded_force
from dnawaves.trajectory.plan import Plan
from dnawaves.trajectory.run import run_member
from dnawaves.trajectory.verlet import driven_leapfrog, leapfrog
from dnawaves.units import BOLTZMANN_KJ_PER_MOL_K

Array = NDArray[np.float64]
SEQUENCE = "CGCG"
STEPS_PER_SAMPLE = 10
BLOCKS = 10
# How often the bonded forces are evaluated in a step of the multiple-timestep scheme.
INNER_STEPS = 4
INTEGRATORS: Mapping[str, Callable[[float], openmm.Integrator]] = {
    "leapfrog": leapfrog,
    "driven leapfrog": lambda dt: driven_leapfrog(dt, "0"),
    "velocity Verlet": lambda dt: velocity_verlet_with_friction(dt, 0.0),
    "Langevin middle, no friction": lambda dt: langevin_middle(0.0, 0.0, dt, 1),
    "multiple timestep": lambda dt: multiple_timestep(dt, INNER_STEPS),
}
# Those whose velocities are half a step behind the positions.
LATE = ("leapfrog", "driven leapfrog", "Langevin middle, no friction")


@dataclass(frozen=True)
class Energies:
    """Total energy and shadow energy (samples,), kJ/mol, with times in ps and mean temperature."""

    times_ps: Array
    total: Array
    shadow: Array
    temperature_K: float
    freedom: int

    def drift(self, energy: Array) -> tuple[float, float]:
        """Return the slope of an energy and its standard error over blocks, kT/ns/dof."""
        whole = len(energy) // BLOCKS * BLOCKS
        time, mean = (a[:whole].reshape(BLOCKS, -1).mean(axis=1) for a in (self.times_ps, energy))
        fit, covariance = np.polyfit(time, mean, 1, cov=True)
        per = BOLTZMANN_KJ_PER_MOL_K * self.temperature_K * self.freedom * 1e-3
        return fit[0] / per, float(np.sqrt(covariance[0, 0])) / per

    def fluctuation(self, energy: Array) -> float:
        """Return the root-mean-square deviation of an energy from its trend, kJ/mol."""
        return float(
            np.std(energy - np.polyval(np.polyfit(self.times_ps, energy, 1), self.times_ps))
        )


def energies(
    duplex: SimulatedDuplex,
    start: tuple[Array, Array],
    integrator: str,
    timestep_ps: float,
    duration_ps: float,
    platform: str = "CPU",
) -> Energies:
    """Return energies of an unconstrained run at constant energy.

    A Verlet scheme conserves no energy but a shadow of it, for velocities v and forces F
    H - dt²/12 v.dF/dt - dt²/24 sum F²/m up to dt⁴ (Engle, Skeel & Drees 2005, J. Comput. Phys.
    206, 432). Its fluctuation is 65 times smaller at 0.5 fs and 4 times at 2 fs, so that a drift
    shows in a short run.
    """
    positions, velocities = start
    masses = duplex.masses_Da[:, None]
    scheme = INTEGRATORS[integrator](timestep_ps)
    late = 0.5 * timestep_ps if integrator in LATE else 0.0
    context = context_of(duplex.system, scheme, platform)
    context.setPositions(positions)
    context.setVelocities(velocities - late * _forces(context) / masses)
    samples = round(duration_ps / timestep_ps / STEPS_PER_SAMPLE)
    total, shadow, kinetic = (np.empty(samples) for _ in range(3))
    for sample in range(samples):
        scheme.step(STEPS_PER_SAMPLE - 2)
        before = _forces(context)
        scheme.step(1)
        state = context.getState(energy=True, forces=True, velocities=True)
        force = state.getForces(asNumpy=True)._value
        velocity = state.getVelocities(asNumpy=True)._value + late * force / masses
        scheme.step(1)
        slope = (_forces(context) - before) / (2 * timestep_ps)
        kinetic[sample] = 0.5 * np.sum(masses * velocity**2)
        total[sample] = state.getPotentialEnergy()._value + kinetic[sample]
        correction = np.sum(velocity * slope) / 12 + np.sum(force**2 / masses) / 24
        shadow[sample] = total[sample] - timestep_ps**2 * correction
    freedom = 3 * len(masses)
    temperature_K = float(2 * kinetic.mean() / freedom / BOLTZMANN_KJ_PER_MOL_K)
    times_ps = np.arange(samples, dtype=np.float64) * STEPS_PER_SAMPLE * timestep_ps
    return Energies(times_ps, total, shadow, temperature_K, freedom)


def drift(
    integrator: str,
    timestep_fs: float,
    duration_ps: float,
    temperature_K: float,
    environment: Mapping[str, object] | None = None,
    platform: str = "CPU",
    warm_up_steps: int = 2000,
) -> Found:
    """Return how fast the energy drifts, kT/ns/dof: that of the shadow energy without sign."""
    duplex = built(SEQUENCE, **(environment or {}))
    start = warm(duplex.system, duplex.positions_nm, temperature_K, warm_up_steps)
    if integrator == "multiple timestep":
        split_forces(duplex.system)
    run = energies(duplex, start, integrator, timestep_fs * 1e-3, duration_ps, platform)
    # The multiple-timestep scheme has another shadow.
    energy = run.total if integrator == "multiple timestep" else run.shadow
    slope, error = run.drift(energy)
    plain, plain_error = run.drift(run.total)
    return Found(
        "holds",
        abs(slope),
        f"{slope:+.1e} ± {error:.0e} at {run.temperature_K:.0f} K on {platform}; the energy itself "
        f"{plain:+.0e} ± {plain_error:.0e}, fluctuating by {run.fluctuation(run.total):.2g} kJ/mol",
    )


def constrained_drift(
    timestep_fs: float,
    duration_ps: float,
    temperature_K: float,
    tolerance: float,
    hydrogen_mass_Da: float | None = None,
) -> Found:
    """Return how fast the energy drifts with rigid bonds to hydrogen, kT/ns/dof, without sign."""
    duplex = built(
        SEQUENCE,
        temperature_K=temperature_K,
        constraints="hbonds",
        hydrogen_mass_Da=hydrogen_mass_Da,
    )
    system = duplex.system
    positions, velocities = warm(system, duplex.positions_nm, temperature_K)
    dt = timestep_fs * 1e-3
    scheme = leapfrog(dt)
    scheme.setConstraintTolerance(tolerance)
    context = context_of(system, scheme)
    context.setPositions(positions)
    context.setVelocities(velocities)
    masses = duplex.masses_Da[:, None]
    samples = round(duration_ps / dt / STEPS_PER_SAMPLE)
    kinetic, total, shadow = (np.empty(samples) for _ in range(3))
    for sample in range(samples):
        scheme.step(STEPS_PER_SAMPLE - 3)
        # Accelerations from velocities half a step apart, so that the constraints are in them.
        late = []
        for step in range(4):
            state = context.getState(velocities=True, energy=step == 1)
            late.append(np.array(state.getVelocities(asNumpy=True)._value))
            if step == 1:
                total[sample] = state.getPotentialEnergy()._value
            if step < 3:
                scheme.step(1)
        before, now, after = (np.diff(late, axis=0)) / dt
        velocity = (late[1] + late[2]) / 2
        kinetic[sample] = 0.5 * np.sum(masses * velocity**2)
        total[sample] += kinetic[sample]
        correction = np.sum(masses * (velocity * (after - before) / (24 * dt) + now**2 / 24))
        shadow[sample] = total[sample] - dt**2 * correction
    freedom = 3 * system.getNumParticles() - system.getNumConstraints()
    found_K = float(2 * kinetic.mean() / freedom / BOLTZMANN_KJ_PER_MOL_K)
    times_ps = np.arange(samples, dtype=np.float64) * STEPS_PER_SAMPLE * dt
    run = Energies(times_ps, total, shadow, found_K, freedom)
    (slope, error), (plain, plain_error) = run.drift(shadow), run.drift(total)
    return Found(
        "holds",
        abs(slope),
        f"{slope:+.1e} ± {error:.0e} at {found_K:.0f} K; the energy itself {plain:+.0e} ± "
        f"{plain_error:.0e}; fluctuation {run.fluctuation(shadow):.2g} against "
        f"{run.fluctuation(total):.2g} kJ/mol",
    )


def order(
    timesteps_fs: Sequence[float],
    duration_ps: float,
    temperature_K: float,
    which: str,
    platform: str = "CPU",
) -> Found:
    """Return the power of the timestep with which the energy, or its shadow, fluctuates."""
    duplex = built(SEQUENCE)
    start = warm(duplex.system, duplex.positions_nm, temperature_K)
    sizes = []
    for timestep_fs in timesteps_fs:
        run = energies(duplex, start, "leapfrog", timestep_fs * 1e-3, duration_ps, platform)
        sizes.append(run.fluctuation(run.total if which == "energy" else run.shadow))
    power = float(np.polyfit(np.log(timesteps_fs), np.log(sizes), 1)[0])
    listed = ", ".join(f"{s:.2g}" for s in sizes)
    return Found("holds", power, f"{listed} kJ/mol at {', '.join(map(str, timesteps_fs))} fs")


def truncation(duration_ps: float, temperature_K: float) -> Found:
    """Return how much more the energy fluctuates where forces end at the cutoff with a jump."""
    sizes, drifts = [], []
    for truncated in (True, False):
        duplex = built(SEQUENCE)
        start = warm(duplex.system, duplex.positions_nm, temperature_K)
        if truncated:
            nonbonded = nonbonded_force(duplex.system)
            nonbonded.setUseSwitchingFunction(False)
            nonbonded.setReactionFieldDielectric(1.0)
        run = energies(duplex, start, "leapfrog", 0.001, duration_ps)
        sizes.append(run.fluctuation(run.shadow))
        drifts.append(run.drift(run.shadow)[0])
    return Found(
        "holds",
        sizes[0] / sizes[1],
        f"{sizes[0]:.2g} against {sizes[1]:.2g} kJ/mol; drift {drifts[0]:+.1e} against "
        f"{drifts[1]:+.1e} kT/ns/dof",
    )


def breaking_timestep(shares: Sequence[float], steps: int) -> Found:
    """Return the first of some timesteps, in parts of 2/omega_max, at which a run is stopped."""
    duplex, limit_ps = _at_the_limit()
    for share in sorted(shares):
        result = stopped(partial(_kicked, duplex, share * limit_ps, steps))
        if result.outcome == "explodes":
            return Found("holds", share, f"2/omega_max is {limit_ps * 1e3:.3f} fs. {result.remark}")
    return Found("holds", np.inf, f"2/omega_max is {limit_ps * 1e3:.3f} fs: none broke")


def beyond_the_limit(share: float, steps: int) -> Found:
    """Return how a run with a timestep beyond 2/omega_max stops: three facts in its message."""
    duplex, limit_ps = _at_the_limit()
    return stopped(
        lambda: _kicked(duplex, share * limit_ps, steps),
        r"in step \d+",
        r"atom \d+ \([AB]:\d \S+\)",
        r"force of \S+ kJ/mol/nm",
    )


def declared_timestep(timestep_fs: float) -> Found:
    """Return how a scene with too long a timestep is refused: field and limit."""
    return stopped(lambda: Observation(timestep_fs=timestep_fs), "timestep_fs", "2.5")


def _at_the_limit() -> tuple[SimulatedDuplex, float]:
    duplex, _, hessian = relaxed(SEQUENCE)
    weights = np.repeat(1 / np.sqrt(duplex.masses_Da), 3)
    weighted = hessian.toarray() * weights * weights[:, None]
    highest = eigsh(weighted, k=1, which="LA", return_eigenvectors=False)
    return duplex, float(2 / np.sqrt(highest[0]))


def _kicked(duplex: SimulatedDuplex, timestep_ps: float, steps: int) -> None:
    kick = {"kind": "kick", "wave": "extension", "velocity_A_per_ps": 0.1, "pairs": 2}
    plan = Plan(timestep_ps, steps_per_frame=50, frames=steps // 50 + 1)
    run_member(duplex, scene_of(duplex, kick), plan, "x1", {})


def _forces(context: openmm.Context) -> Array:
    state = context.getState(forces=True)
    return np.array(state.getForces(asNumpy=True)._value)
