"""Kicks from far below to far above thermal motion: linear, nonlinear, refused."""

from __future__ import annotations

import numpy as np

from dnawaves.stability.case import Found, Outcome
from dnawaves.stability.judge import stopped
from dnawaves.stability.samples import relaxed, scene_of
from dnawaves.trajectory.plan import Plan
from dnawaves.trajectory.run import run_member
from dnawaves.units import A_PER_NM, BOLTZMANN_KJ_PER_MOL_K

SEQUENCE = "CGCG"
THERMAL_K = 300.0
# 0.5 ps: a wave crosses four base pairs in less.
PLAN = Plan(timestep_ps=0.001, steps_per_frame=20, frames=26)
# What half the kick may change: a shipped scene whose speed changed by so much got half its kick.
LINEAR = 0.02


def kick(times_thermal: float, platform: str = "CPU") -> Found:
    """Return how far the answer to a kick is from twice that to half of it.

    The unit of kicks is sqrt(kT/M) at 300 K, M the mean mass of a base pair.
    """
    duplex, _, _ = relaxed(SEQUENCE)
    thermal = np.sqrt(BOLTZMANN_KJ_PER_MOL_K * THERMAL_K / duplex.bodies.masses_Da.mean())
    velocity = float(times_thermal * thermal * A_PER_NM)
    excitation = {
        "kind": "kick",
        "wave": "extension",
        "velocity_A_per_ps": velocity,
        "pairs": 2,
        "scales": [1, 0.5],
    }
    refused = stopped(lambda: scene_of(duplex, excitation), "velocity_A_per_ps", "20")
    if refused.outcome == "refused":
        return refused
    scene = scene_of(duplex, excitation)
    whole, half = (
        run_member(duplex, scene, PLAN, member, {}, platform=platform).dataset()["velocity"]
        for member in scene.members
    )
    odd, odd_half = (0.5 * (one.sel(sign=1) - one.sel(sign=-1)).values for one in (whole, half))
    difference = float(np.linalg.norm(odd - 2 * odd_half) / np.linalg.norm(odd))
    outcome: Outcome = "holds" if difference < LINEAR else "flagged"
    return Found(outcome, difference, f"kicked with {velocity:.3g} Å/ps on {platform}")
