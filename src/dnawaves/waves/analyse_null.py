"""The null: does an undisturbed duplex show a wave to an estimator that looks for one?"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from dnawaves.waves.estimators.detection import Detection, Detector
from dnawaves.waves.estimators.lattice_fit import Observation
from dnawaves.waves.estimators.lattices import ScalarLattice
from dnawaves.waves.estimators.long_waves import Projection
from dnawaves.waves.estimators.model_class import SIGNIFICANCE
from dnawaves.waves.estimators.noise import WhiteNoise
from dnawaves.waves.estimators.plane_lattice import PlaneLattice
from dnawaves.waves.estimators.sources import kick
from dnawaves.waves.observations import PLANE
from dnawaves.waves.record import AXIAL_WAVES, Record
from dnawaves.waves.rows import blank
from dnawaves.waves.scene_source import mean_mass, velocity_nm
from dnawaves.waves.table import Estimate

Array = NDArray[np.float64]

# Velocities that count as a wave where nothing was put in: 1 % of the shipped kicks.
STILL = {"extension": 1e-4, "twist": 1e-5, "bend": 1e-5, "shear": 1e-4}
UNITS = {"extension": "Å/ps", "twist": "rad/ps", "bend": "rad/ps", "shear": "Å/ps"}
# The search is for a kick of as many free base pairs at the first end as a scene kicks by default.
KICKED_PAIRS = 3
SEED = 1


def null_rows(record: Record) -> list[Estimate]:
    """Return a row for each wave: how much moves, and whether it looks like a wave.

    A wave is one that a search over all speeds and frictions finds at a false-alarm rate of 5 % in
    all four together, and that is larger than what counts as still: the residual motion of a duplex
    at rest is no noise, so that the search alone may well find something in it.
    """
    return [_row(record, wave) for wave in STILL]


def _row(record: Record, wave: str) -> Estimate:
    largest = float(np.abs(record.velocity(wave)).max())
    moved = f"the residual motion is at most {largest:.2g} {UNITS[wave]}"
    limit = f"a wave would be {STILL[wave]:g}"
    if largest == 0.0:
        return blank(record, wave, reason=f"no wave: {moved}; {limit}")
    found = detect(record, wave)
    rate = SIGNIFICANCE / len(STILL)
    likely = (
        f"the likeliest wave explains {found.explained:.1%} of it, p = {found.p_value:.2g} in "
        f"white noise; an alarm needs motion above the limit and p below {rate:.4g}, which noise "
        f"gives in {SIGNIFICANCE:.0%} of all nulls"
    )
    seen = "no wave"
    if largest >= STILL[wave]:
        seen = "a wave" if found.p_value < rate else "moves by itself"
    row = blank(record, wave, reason=f"{seen}: {moved}; {limit}; {likely}")
    return replace(row, p_value=found.p_value)


def detect(record: Record, wave: str) -> Detection:
    """Look for the answer to a kick at the first end, of any speed and friction."""
    free = np.delete(np.arange(record.pairs), record.held)
    kicked = np.zeros(record.pairs)
    kicked[free[:KICKED_PAIRS]] = 1.0
    respond, rng = kick(record.times_ps), np.random.default_rng(SEED)
    if wave in AXIAL_WAVES:
        chain = ScalarLattice(record.pairs, record.spacing_nm, record.held, respond, kicked)
        velocity = velocity_nm(record, wave)
        return Detector(chain, Observation(velocity, chain, WhiteNoise()), rng)(velocity)
    masses = (mean_mass(record, PLANE[0]), mean_mass(record, PLANE[1]))
    pattern = np.stack([kicked * (one == wave) for one in PLANE], axis=1)
    plane = PlaneLattice(record.pairs, record.spacing_nm, record.held, respond, pattern, masses)
    # Each coordinate by its energy; a common factor does not matter.
    fields = [velocity_nm(record, one) for one in PLANE]
    velocity = np.stack(fields, axis=-1)
    noise = Projection(np.diag(np.tile(np.sqrt(masses), len(free))))
    return Detector(plane, Observation(velocity, plane, noise), rng)(velocity)
