"""Random numbers that a killed run finds again, and that both signs of a run share."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import openmm

LARGEST_SEED = 2**31 - 1


def seed_at(seeds: Sequence[int], step: int) -> int:
    """Return the seed of the noise from a step on, by all that tells one run from another.

    Never zero, at which OpenMM takes a seed of its own.
    """
    drawn = np.random.SeedSequence([*seeds, step]).generate_state(1)[0]
    return 1 + int(drawn) % LARGEST_SEED


def shares_noise(integrator: openmm.Integrator, platform: str) -> bool:
    """Return whether a context draws from the one stream that all contexts of a process share.

    So do all on the Reference platform, and custom integrators on the CPU platform too.
    """
    custom = isinstance(integrator, openmm.CustomIntegrator)
    return platform == "Reference" or (platform == "CPU" and custom)


def restart_shared_noise(seed: int) -> None:
    """Start anew the stream of random numbers that contexts of this process share.

    OpenMM does so only where a context with such an integrator is made.
    """
    system = openmm.System()
    system.addParticle(1.0)
    integrator = openmm.CustomIntegrator(0.001)
    integrator.setRandomNumberSeed(seed)
    openmm.Context(system, integrator, openmm.Platform.getPlatformByName("Reference"))
