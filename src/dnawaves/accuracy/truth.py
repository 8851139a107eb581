"""The known answers: of the linearised duplex, and of a kick of finite size at no timestep."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import eigh

from dnawaves.accuracy.models import Case, Numerics, Truth
from dnawaves.accuracy.observe import Observed, Observer, odd
from dnawaves.accuracy.pair_run import PairRun, kick_velocities
from dnawaves.accuracy.start import Start
from dnawaves.errors import SimulationError
from dnawaves.files import whole_file
from dnawaves.rod.oscillator import impulse_response
from dnawaves.scene.pairs import held_pairs
from dnawaves.system.modes import EIGENVALUE_TOLERANCE_PER_PS2, RIGID_MODES

Array = NDArray[np.float64]
# Part of the kick at which the linear motion is read: the readout itself bends at larger ones.
READ_AT = 1e-3


@dataclass(frozen=True)
class AtomModes:
    """Modes of the free atoms: frequencies (modes,) in rad/ps, shapes (3 atoms, modes) in Da^-1/2.

    `masses_Da` (3 atoms,) are infinite for atoms that are held.
    """

    frequencies_rad_per_ps: Array
    shapes: Array
    masses_Da: Array

    def after_kick(self, velocities: Array, times_ps: Array) -> tuple[Array, Array]:
        """Return displacement and velocity (frames, atoms, 3) after velocities (atoms, 3)."""
        amplitudes = self.shapes.T @ (self.masses_Da * velocities.ravel())
        parts = impulse_response(times_ps, self.frequencies_rad_per_ps, 0.0)
        moved, moving = (((amplitudes * part) @ self.shapes.T) for part in parts)
        return moved.reshape(len(times_ps), -1, 3), moving.reshape(len(times_ps), -1, 3)


def atom_modes(start: Start, case: Case) -> AtomModes:
    """Return the normal modes with the case's ends.

    Raises
    ------
    SimulationError
        When the structure is no minimum.
    """
    duplex = start.duplex
    held = held_pairs(case.ends, duplex.pair_count)
    free = np.repeat(~np.isin(duplex.pairs, held), 3)
    masses = np.repeat(duplex.masses_Da, 3)
    weights = 1 / np.sqrt(masses[free])
    weighted = start.hessian[free][:, free].toarray() * weights * weights[:, None]
    values, vectors = eigh(weighted, driver="evd", overwrite_a=True, check_finite=False)
    if values[0] < -EIGENVALUE_TOLERANCE_PER_PS2:
        raise SimulationError(f"no minimum: the lowest eigenvalue is {values[0]:.3g} ps^-2")
    if not held:
        values[np.argsort(np.abs(values))[:RIGID_MODES]] = 0.0
    shapes = np.zeros((len(free), len(values)))
    shapes[free] = weights[:, None] * vectors
    return AtomModes(np.sqrt(np.maximum(values, 0.0)), shapes, masses)


def linear_answer(start: Start, case: Case, interval_ps: float) -> Observed:
    """Return the exact answer of the linearised duplex to the case's kick."""
    duplex, modes = start.duplex, atom_modes(start, case)
    frames = math.ceil(case.duration_ps / interval_ps - 1e-9)
    times_ps = np.asarray(interval_ps * np.arange(frames + 1), dtype=np.float64)
    moved, moving = modes.after_kick(READ_AT * kick_velocities(duplex, case), times_ps)
    observer = Observer(duplex, case.excitation.wave)
    velocity, parameters = [], []
    for sign in (1, -1):
        places = duplex.positions_nm + sign * moved
        velocity.append(
            np.array([observer.velocity(x, sign * v) for x, v in zip(places, moving, strict=True)])
        )
        parameters.append(observer.helical(places))
    return Observed(times_ps, odd(*velocity) / READ_AT, odd(*parameters) / READ_AT)


def converged_answer(start: Start, case: Case, truth: Truth, interval_fs: float) -> Observed:
    """Return the answer to the case's own kick at no timestep, in double precision.

    Richardson's extrapolation of a second-order method: fine + (fine - coarse)/3.
    """
    coarse, fine = (
        _run(start, case, timestep_fs, interval_fs) for timestep_fs in truth.timesteps_fs
    )
    return Observed(
        fine.times_ps,
        fine.velocity + (fine.velocity - coarse.velocity) / 3,
        fine.helical + (fine.helical - coarse.helical) / 3,
    )


def _run(start: Start, case: Case, timestep_fs: float, interval_fs: float) -> Observed:
    numerics = Numerics(platform="Reference", timestep_fs=timestep_fs, interval_fs=interval_fs)
    run = PairRun(start.duplex, case, numerics)
    run.advance(case.duration_ps)
    return run.observed()


def write_answers(path: Path, answers: dict[str, Observed]) -> None:
    """Write known answers by name."""
    arrays = {
        f"{name}_{part}": getattr(one, part)
        for name, one in answers.items()
        for part in ("times_ps", "velocity", "helical")
    }
    with whole_file(path) as temporary, temporary.open("wb") as file:
        np.savez_compressed(file, **arrays)


def read_answers(path: Path) -> dict[str, Observed]:
    """Read what `write_answers` wrote; empty where the system has no minimum."""
    with np.load(path) as content:
        names = sorted({key.split("_")[0] for key in content})
        return {
            name: Observed(
                *(content[f"{name}_{part}"] for part in ("times_ps", "velocity", "helical"))
            )
            for name in names
        }
