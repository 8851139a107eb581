"""The rod's constants of one system by every route that was taken, side by side, as one table.

`results/systems/{system}/constants.csv`, one row per route and quantity:

==========  =====================================================================================
route       `topology`; `hessian, segments of {n} steps`, `hessian, wave of {n} steps`, `hessian
            K(q->0)`; `static`; the same three with `thermal` (whole base pairs) and `thermal bases`
            (frames of the bases); `hessian, steps {AG}` and `thermal, steps {AG}`, the mean of the
            inner steps of one kind, for each; `paper`; `published`
quantity    name with its unit, see below
value       the constant
low, high   the ends of its interval; blank where there is none
interval    the interval's method in words
source      what it was taken from
==========  =====================================================================================

Quantities of `topology`: spacing_A, twist_deg_per_bp, mass_Da_per_bp, density_Da_per_A,
inertia_1_Da_A, inertia_2_Da_A, inertia_3_Da_A (per length, about the centre of mass, along the
axes of the base-pair frame), inertia_axial_Da_A, inertia_transverse_Da_A (about the helix axis).

Quantities of every other route, as far as it knows them: stretch_modulus_pN,
twist_rigidity_pN_nm2, twist_stretch_coupling_pN_nm (elements of the stiffness matrix: at fixed
twist, at fixed length), stretch_modulus_relaxed_pN, twist_rigidity_relaxed_pN_nm2 (the other free
to follow), bend_rigidity_pN_nm2, shear_stiffness_pN (means of the two axes across);
speed_extension_A_per_ps, speed_twist_A_per_ps (long waves, coupled), speed_bend_A_per_ps,
speed_shear_A_per_ps (short waves): the speeds that follow with the density and inertia of
`topology`.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from importlib import resources
from pathlib import Path

import numpy as np
import pandas as pd
import xarray as xr
from numpy.typing import NDArray

from dnawaves.errors import InputError
from dnawaves.files import read_netcdf
from dnawaves.frames.fit import Frames
from dnawaves.helical.dataset import pair_frames
from dnawaves.motion.pair_frames import frames_in_time
from dnawaves.rod.rod import BEND_1, EXTENSION, SHEAR_1, TWIST, Rod
from dnawaves.scene.excitations import Nothing
from dnawaves.scene.load import read_system
from dnawaves.scene.models import SceneSpec, SystemSpec
from dnawaves.scene.pairs import fixed_counts
from dnawaves.system.duplex import SimulatedDuplex
from dnawaves.system.relax import read_relaxed
from dnawaves.system.snapshots import read_equilibrated, read_mean
from dnawaves.system.stiffness import base_pair_frames
from dnawaves.units import A_PER_NM, KJ_PER_MOL_PER_PN_NM
from dnawaves.waves.constants.axis_strains import AxisStrains
from dnawaves.waves.constants.rod_mass import RodMass, rod_mass, topology_constants
from dnawaves.waves.constants.rod_stiffness import (
    WAVES_IN_STEPS,
    kinds_compliance,
    segments_compliance,
    stiffness_of,
    wave_compliance,
)
from dnawaves.waves.constants.segments import inner_pairs, segment_lengths
from dnawaves.waves.constants.table import PAPER, TOPOLOGY, Constant, write_constants
from dnawaves.waves.constants.thermal_stiffness import thermal_constants, thermal_strains
from dnawaves.waves.table import read_table

Array = NDArray[np.float64]

# Single precision of what two files hold of one structure, in Å.
SAME_PLACE_A = 1e-3


def constants_step(
    system_json: Path,
    built: Path,
    start: Path,
    output: Path,
    modes: Path | None = None,
    speeds: Sequence[Path] = (),
    motions: Sequence[Path] = (),
    helical: Sequence[Path] = (),
) -> None:
    """Write the table of a system's rod constants.

    `start` is what `dnawaves relax` wrote, or `dnawaves equilibrate` above 0 K; `modes` those of
    the free duplex, at T = 0. Of `speeds`, those of static scenes count; of `motions` and
    `helical`, those of equilibrium scenes above 0 K with free ends.
    """
    spec = read_system(system_json)
    duplex = (read_mean if spec.thermal else read_relaxed)(spec, built, start)
    mass = rod_mass(duplex)
    rows = [
        Constant(TOPOLOGY, name, value, source="masses and positions of the atoms")
        for name, value in topology_constants(duplex).items()
    ]
    if modes is not None:
        dataset = read_netcdf(modes, "strain_compliance", "height")
        rows += hessian_constants(duplex, mass, dataset)
    rows += static_constants([read_table(path) for path in speeds], spec.name, mass)
    if spec.thermal:
        rows += _thermal(spec, built, start, mass, motions, helical)
    rows += [*paper_constants(), *published_constants()]
    write_constants(output, rows)


def hessian_constants(
    duplex: SimulatedDuplex, mass: RodMass, modes: xr.Dataset
) -> Iterator[Constant]:
    """Yield the constants of segments and waves of a minimum's harmonic motion.

    They are exact for this structure; the interval is the range over the segments of one length.
    """
    heights_A = modes["height"].values
    axis = AxisStrains.of_structure(base_pair_frames(duplex), duplex.frame)
    covariance = axis.covariance(modes["strain_compliance"].values)
    source = "normal modes of the relaxed duplex"
    for steps in segment_lengths(len(heights_A)):
        every = segments_compliance(covariance, heights_A, steps)
        found = _with_speeds(every.mean(axis=0), mass)
        each = [_with_speeds(one, mass) for one in every]
        text = f"range over {len(each)} segments of one structure"
        for name, value in found.items():
            values = [value, *(one[name] for one in each)]
            yield Constant(
                f"hessian, segments of {steps} steps",
                name, value, min(values), max(values), text, source,
            )  # fmt: skip
    longest = 2 * (len(inner_pairs(len(heights_A))) - 1)
    compliances = {
        f"hessian, wave of {n} steps": wave_compliance(covariance, heights_A, n)
        for n in WAVES_IN_STEPS
        if n <= longest
    }
    compliances["hessian K(q->0)"] = wave_compliance(covariance, heights_A, np.inf)
    kinds = kinds_compliance(covariance, heights_A, duplex.spec.duplex.sequence)
    compliances |= {f"hessian, steps {kind}": one for kind, one in kinds.items()}
    for route, compliance in compliances.items():
        for name, value in _with_speeds(compliance, mass).items():
            yield Constant(
                route, name, value, interval="none: exact linear response", source=source
            )


def _with_speeds(compliance: Array, mass: RodMass) -> dict[str, float]:
    stiffness = stiffness_of(compliance)
    return stiffness | mass.speeds(stiffness)


def static_constants(
    tables: Sequence[pd.DataFrame], system: str, mass: RodMass
) -> Iterator[Constant]:
    """Yield the moduli that static loads found, from tables of speeds.

    A load along the axis finds the modulus at fixed twist, one about it at fixed length: the
    guided end moves no other way. The speed is that of the coupling-free rod.
    """
    quantities = {
        "extension": ("stretch_modulus_pN", mass.density_Da_per_A / A_PER_NM),
        "twist": ("twist_rigidity_pN_nm2", mass.inertia_axial_Da_A / A_PER_NM**3),
    }
    for table in tables:
        chosen = (table["estimator"] == "static") & (table["system"] == system)
        for row in table[chosen & table["speed_A_per_ps"].notna()].to_dict("records"):
            name, inertia = quantities[row["wave"]]
            source = f"scene {row['scene']}: {row['reason']}"
            value, low, high = (float(row[f"{x}_A_per_ps"]) for x in ("speed", "low", "high"))
            text = str(row["interval"])
            yield Constant(
                "static", f"speed_{row['wave']}_A_per_ps", value, low, high, text, source
            )
            # Da Å²/ps² is a hundredth of a kJ/mol.
            value, low, high = (inertia * v**2 / KJ_PER_MOL_PER_PN_NM for v in (value, low, high))
            yield Constant("static", name, value, low, high, text, source)


def _thermal(
    spec: SystemSpec,
    built: Path,
    start: Path,
    mass: RodMass,
    motions: Sequence[Path],
    helical: Sequence[Path],
) -> list[Constant]:
    temperature_K, rows = spec.environment.temperature_K, []
    found = []
    references: dict[int, tuple[Array, Frames]] = {}
    for path in motions:
        motion = read_netcdf(path, "displacement", "rotation", "centre")
        if in_equilibrium(SceneSpec.model_validate_json(motion.attrs["scene"])):
            found.append(
                frames_in_time(motion, _reference(motion, path, spec, built, start, references))
            )
    if found:
        source = f"{len(found)} runs at {temperature_K:g} K"
        strains = thermal_strains(found, temperature_K)
        rows += thermal_constants(strains, mass, "thermal", source, spec.duplex.sequence)
    if helical:
        frames = [pair_frames(read_netcdf(path)) for path in helical]
        source = f"bases of {len(frames)} runs at {temperature_K:g} K"
        strains = thermal_strains(frames, temperature_K)
        rows += thermal_constants(strains, mass, "thermal bases", source)
    return rows


def in_equilibrium(scene: SceneSpec) -> bool:
    """Return whether a scene's strains fluctuate as those of the free duplex."""
    free = not any(fixed_counts(scene.ends))
    return scene.system.thermal and isinstance(scene.excitation, Nothing) and free


def _reference(
    motion: xr.Dataset,
    path: Path,
    spec: SystemSpec,
    built: Path,
    start: Path,
    known: dict[int, tuple[Array, Frames]],
) -> Frames:
    """Return the base-pair frames of the snapshot that a record's displacements start from."""
    centre = motion["centre"].values
    for snapshot in range(1, spec.environment.to_snapshots.snapshots + 1):
        if snapshot not in known:
            duplex = read_equilibrated(spec, built, start, snapshot)
            known[snapshot] = (A_PER_NM * duplex.bodies.centres_nm, base_pair_frames(duplex))
        places, frames = known[snapshot]
        if places.shape == centre.shape and np.abs(places - centre).max() < SAME_PLACE_A:
            return frames
    raise InputError(f"{path}: found no snapshot of {start} that this record starts from")


def paper_constants() -> Iterator[Constant]:
    """Yield the constants of the paper's rod."""
    rod, source = Rod.paper(twisted=True), "Bishop & Zhmudsky"
    density, inertia = rod.density_Da_per_nm / A_PER_NM, A_PER_NM * np.diag(rod.inertia_Da_nm)
    pN = np.diag(rod.stiffness) / KJ_PER_MOL_PER_PN_NM
    stiffness = {
        "stretch_modulus_pN": pN[EXTENSION],
        "twist_rigidity_pN_nm2": pN[TWIST],
        "twist_stretch_coupling_pN_nm": 0.0,
        "stretch_modulus_relaxed_pN": pN[EXTENSION],
        "twist_rigidity_relaxed_pN_nm2": pN[TWIST],
        "bend_rigidity_pN_nm2": pN[BEND_1],
        "shear_stiffness_pN": pN[SHEAR_1],
    }
    found = {
        "spacing_A": A_PER_NM * rod.spacing_nm,
        "twist_deg_per_bp": np.degrees(rod.omega0_rad_per_nm[2] * rod.spacing_nm),
        "mass_Da_per_bp": rod.density_Da_per_nm * rod.spacing_nm,
        "density_Da_per_A": density,
        "inertia_axial_Da_A": inertia[2],
        "inertia_transverse_Da_A": inertia[0],
        **stiffness,
        **RodMass(density, float(inertia[2]), float(inertia[0])).speeds(stiffness),
    }
    for name, value in found.items():
        yield Constant(PAPER, name, float(value), source=source)


def published_constants() -> Iterator[Constant]:
    """Yield what single molecules have shown; the file says where."""
    file = resources.files(__package__).joinpath("data/published_constants.csv")
    with file.open(encoding="utf-8") as lines:
        table = pd.read_csv(lines, comment="#")
    for row in table.to_dict("records"):
        low, high = (None if pd.isna(row[x]) else float(row[x]) for x in ("low", "high"))
        text = "range over methods" if low is not None else ""
        yield Constant(
            "published", row["quantity"], float(row["value"]), low, high, text, row["source"]
        )
