"""Thermal noise and how it averages out: single runs of the linearised duplex, drawn exactly."""

from __future__ import annotations

import numpy as np

from dnawaves.accuracy.models import Case, Numerics
from dnawaves.accuracy.observe import Observed, Observer
from dnawaves.accuracy.start import Start
from dnawaves.accuracy.truth import atom_modes
from dnawaves.units import BOLTZMANN_KJ_PER_MOL_K

SEED = 1


def averages(
    start: Start, case: Case, numerics: Numerics, linear: Observed, draws: int
) -> list[Observed]:
    """Return `draws` records, each the average of `numerics.replicas` single thermal runs.

    Every mode of a linear duplex in equilibrium is an independent oscillator whose velocity has
    the variance kBT in mass-weighted coordinates; the answer to the kick, `linear` at scale 1, is
    added to it. A pair of opposite signs from one snapshot would have no noise at all here: what
    is left of it in a real duplex comes from its anharmonicity.
    """
    assert numerics.replicas is not None
    modes, random = atom_modes(start, case), np.random.default_rng(SEED)
    observer = Observer(start.duplex, case.excitation.wave)
    shapes = modes.shapes.T.reshape(len(modes.frequencies_rad_per_ps), -1, 3)
    seen = np.array([observer.velocity(start.duplex.positions_nm, shape) for shape in shapes])
    every = round(numerics.interval_fs / 1e3 / linear.times_ps[1])
    times_ps = linear.times_ps[::every]
    phases = np.multiply.outer(times_ps, modes.frequencies_rad_per_ps)
    spread = np.sqrt(BOLTZMANN_KJ_PER_MOL_K * numerics.temperature_K)
    records = []
    for _ in range(draws):
        cosine, sine = (
            spread * random.standard_normal((numerics.replicas, len(seen))).mean(axis=0)
            for _ in range(2)
        )
        noise = (cosine * np.cos(phases) + sine * np.sin(phases)) @ seen
        signal = numerics.scale * linear.velocity[::every]
        # The helical parameters are not drawn.
        records.append(Observed(times_ps, signal + noise, linear.helical[:, ::every]))
    return records
