"""What a run keeps: the rigid-body motion of every base pair, energies, and the base atoms."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path

import MDAnalysis
import numpy as np
import xarray as xr
from numpy.typing import NDArray

from dnawaves.files import provenance
from dnawaves.scene.models import SceneSpec
from dnawaves.system.duplex import SimulatedDuplex
from dnawaves.trajectory.pattern import pivots
from dnawaves.trajectory.plan import Plan
from dnawaves.units import A_PER_NM

Array = NDArray[np.float64]
State = tuple[Array, Array, float]

SIGNS = {"plus": 1, "minus": -1}


class Recorder:
    """Collects the frames of the copies of one run."""

    def __init__(
        self, duplex: SimulatedDuplex, scene: SceneSpec, plan: Plan, signs: tuple[int, ...]
    ) -> None:
        self._duplex, self._scene, self._plan, self._signs = duplex, scene, plan, signs
        self._motion: list[Array] = []
        self._energy: list[list[float]] = []
        self._work: list[list[float]] = []
        self._difference_energy: list[float] = []
        self._atoms = base_atoms(duplex)
        self._written = MDAnalysis.Universe.empty(len(self._atoms), trajectory=True)
        self._writers: dict[int, MDAnalysis.coordinates.base.WriterBase] = {}

    @contextmanager
    def writing(self, trajectories: dict[int, Path]) -> Iterator[None]:
        """Keep trajectory files open: one of the base atoms for each sign that has a path."""
        with ExitStack() as stack:
            for sign, path in trajectories.items():
                writer = MDAnalysis.Writer(
                    str(path), n_atoms=len(self._atoms), dt=self._plan.interval_ps, nsavc=1
                )
                self._writers[sign] = stack.enter_context(writer)
            yield
        self._writers.clear()

    def add(self, states: list[State], work_kJ_per_mol: list[float]) -> None:
        """Record one frame: the state and the drive's work for each sign."""
        bodies = self._duplex.bodies
        self._motion.append(
            np.array(
                [
                    [*bodies.pose(positions), *bodies.velocity(positions, velocities)]
                    for positions, velocities, _ in states
                ]
            )
        )
        self._energy.append([energy for _, _, energy in states])
        self._work.append(work_kJ_per_mol)
        half = antisymmetric([velocities for _, velocities, _ in states])
        self._difference_energy.append(
            0.5 * float(np.sum(self._duplex.masses_Da[:, None] * half**2))
        )
        for sign, (positions, _, _) in zip(self._signs, states, strict=True):
            if sign in self._writers:
                self._written.atoms.positions = positions[self._atoms] * A_PER_NM
                self._writers[sign].write(self._written.atoms)

    def dataset(self) -> xr.Dataset:
        """Return the record with labels and units; velocities and positions in Å."""
        duplex, plan = self._duplex, self._plan
        # Collected as (time, sign, quantity, pair, xyz).
        motion = np.moveaxis(np.array(self._motion), 0, 2)
        dims = ("sign", "time", "pair", "xyz")
        frame = duplex.frame

        def vectors(values: Array, units: str, what: str) -> tuple[object, ...]:
            return dims, values, {"units": units, "long_name": what}

        return xr.Dataset(
            {
                "displacement": vectors(
                    motion[:, 0] * A_PER_NM, "angstrom", "displacement of the centre of mass"
                ),
                "rotation": vectors(motion[:, 1], "rad", "rotation vector from the reference"),
                "velocity": vectors(
                    motion[:, 2] * A_PER_NM, "angstrom/ps", "velocity of the centre of mass"
                ),
                "angular_velocity": vectors(motion[:, 3], "rad/ps", "angular velocity"),
                "total_energy": (
                    ("sign", "time"),
                    np.array(self._energy).T,
                    {"units": "kJ/mol"},
                ),
                "work": (("sign", "time"), np.array(self._work).T, {"units": "kJ/mol"}),
                "difference_kinetic_energy": (
                    ("time",),
                    np.array(self._difference_energy),
                    {"units": "kJ/mol"},
                ),
                "mass": (("pair",), duplex.bodies.masses_Da, {"units": "Da"}),
                "inertia": (
                    ("pair", "xyz", "abc"),
                    duplex.bodies.inertia_Da_nm2 * A_PER_NM**2,
                    {"units": "Da angstrom^2", "long_name": "about the centre of mass"},
                ),
                "centre": (
                    ("pair", "xyz"),
                    duplex.bodies.centres_nm * A_PER_NM,
                    {"units": "angstrom"},
                ),
                "pivot": (
                    ("pair", "xyz"),
                    pivots(duplex) * A_PER_NM,
                    {"units": "angstrom", "long_name": "point of the helix axis at the pair"},
                ),
                "direction": (("axis", "xyz"), frame.directions, {"units": "1"}),
            },
            coords={
                "sign": list(self._signs),
                "time": (
                    "time",
                    np.arange(len(self._energy)) * plan.interval_ps,
                    {"units": "ps"},
                ),
                "pair": duplex.labels,
                "height": (
                    "pair",
                    duplex.heights_nm * A_PER_NM,
                    {"units": "angstrom"},
                ),
                "xyz": ["x", "y", "z"],
                "axis": ["first", "second", "helix"],
            },
            attrs={
                "scene": self._scene.model_dump_json(),
                "timestep_fs": plan.timestep_ps * 1e3,
                "platform": "CPU",
                **({"frequency_GHz": plan.frequency_GHz} if plan.frequency_GHz else {}),
                **({"pulse_width_ps": plan.pulse_width_ps} if plan.pulse_width_ps else {}),
                **provenance("openmm", "numpy"),
            },
        )


def antisymmetric(values: list[Array]) -> Array:
    """Return half the difference of the two signs, in which even orders cancel; one as it is."""
    return values[0] if len(values) == 1 else 0.5 * (values[0] - values[1])


def base_atoms(duplex: SimulatedDuplex) -> NDArray[np.intp]:
    """Return the indices of the atoms that base frames need: the rings, and C1' for pairing."""
    ring = {"N1", "C2", "N3", "C4", "C5", "C6", "N7", "C8", "N9", "C1'"}
    return np.array(
        [atom.index for atom in duplex.topology.atoms() if atom.name in ring], dtype=np.intp
    )
