"""Is the structure that scenes start from B-DNA? Helical parameters, pairing, distance from ideal.

At T = 0 that is the relaxed minimum, above it the mean structure of the equilibration.
"""

from __future__ import annotations

from pathlib import Path
from tempfile import TemporaryDirectory

import MDAnalysis
import mdtraj
import numpy as np
import xarray as xr
from numpy.typing import NDArray

from dnawaves.duplex.build import watson_crick_bonds, write_pdb
from dnawaves.files import provenance, whole_file, write_netcdf
from dnawaves.helical.analysis import HelicalParameters
from dnawaves.motion.interior import interior
from dnawaves.scene.load import read_system
from dnawaves.system.duplex import SimulatedDuplex
from dnawaves.system.relax import read_relaxed
from dnawaves.system.snapshots import read_mean
from dnawaves.trajectory.record import base_atoms

# What still counts as B-DNA: bounds on the mean over the interior steps.
RISE_RANGE_A = (3.0, 3.6)
TWIST_RANGE_DEG = (30.0, 40.0)
FEWEST_BONDS = 2
# A step beyond these has lost its stacking: the duplex is kinked there, whatever the mean says.
KINK_RISE_RANGE_A = (2.4, 4.6)
KINK_ROLL_DEG = 45.0


def inspect_step(
    system_json: Path,
    built: Path,
    start: Path,
    output: Path,
    base_atoms_output: Path,
    structure: Path,
) -> None:
    """Write the structure as PDB, whole and base atoms only, and what it looks like.

    `start` is what `dnawaves relax` wrote, or `dnawaves equilibrate` above 0 K.
    """
    spec = read_system(system_json)
    duplex = (read_mean if spec.thermal else read_relaxed)(spec, built, start)
    with TemporaryDirectory() as folder:
        pdb = Path(folder) / "relaxed.pdb"
        write_pdb(duplex.topology, duplex.positions_nm, pdb)
        universe = MDAnalysis.Universe(str(pdb))
        dataset = inspect_structure(duplex, built, pdb)
        with whole_file(structure) as temporary:
            temporary.write_bytes(pdb.read_bytes())
        with whole_file(base_atoms_output) as temporary:
            universe.atoms[base_atoms(duplex)].write(str(temporary))
    write_netcdf(output, dataset)


def inspect_structure(duplex: SimulatedDuplex, built: Path, relaxed: Path) -> xr.Dataset:
    """Return helical parameters, hydrogen bonds and RMSD of a relaxed structure, with a verdict."""
    universe = MDAnalysis.Universe(str(relaxed))
    universe.atoms.positions = (10 * duplex.positions_nm).astype(np.float32)
    dataset = HelicalParameters(universe.atoms).run().results.dataset.isel(time=0)
    bonds = hydrogen_bonds(duplex, relaxed)
    lost = [
        str(label)
        for label, count in zip(dataset["pair"].values, bonds, strict=True)
        if count < FEWEST_BONDS
    ]
    kinked = kinked_steps(dataset)
    inside = interior(dataset.sizes["step"])
    means = {
        name: float(dataset[name].isel(step=inside).mean()) for name in ("rise", "twist", "roll")
    }
    dataset["hydrogen_bonds"] = (
        ("pair",),
        bonds,
        {"long_name": "Watson-Crick hydrogen bonds (Baker and Hubbard 1984)"},
    )
    dataset.attrs |= {
        "interior_rise_A": means["rise"],
        "interior_twist_deg": means["twist"],
        "interior_roll_deg": means["roll"],
        "rmsd_to_built_A": heavy_atom_rmsd_A(built, relaxed),
        "lost_pairs": ", ".join(lost),
        "kinked_steps": ", ".join(kinked),
        "verdict": b_form_verdict(means["rise"], means["twist"], lost, kinked),
        "system": duplex.spec.name,
        **provenance("MDAnalysis", "mdtraj"),
    }
    return dataset


def kinked_steps(dataset: xr.Dataset) -> list[str]:
    """Return the steps whose rise or roll says that the bases are no longer stacked."""
    low, high = KINK_RISE_RANGE_A
    rise, roll = dataset["rise"].values, dataset["roll"].values
    # A step without a frame is not stacked either: NaN fails every comparison.
    kinked = ~((rise >= low) & (rise <= high) & (np.abs(roll) <= KINK_ROLL_DEG))
    return [
        f"{label} (rise {rise[index]:.1f} Å, roll {roll[index]:.0f}°)"
        for index, label in enumerate(dataset["step"].values)
        if kinked[index]
    ]


def b_form_verdict(
    rise_A: float, twist_deg: float, lost_pairs: list[str], kinked: list[str]
) -> str:
    """Return 'B-DNA', or what is not as in B-DNA."""
    faults = []
    for name, value, (low, high), unit in (
        ("rise", rise_A, RISE_RANGE_A, "Å"),
        ("twist", twist_deg, TWIST_RANGE_DEG, "°"),
    ):
        if not low <= value <= high:
            faults.append(f"interior {name} {value:.2f} {unit} outside {low:g}-{high:g} {unit}")
    if lost_pairs:
        faults.append(f"Watson-Crick pair lost: {', '.join(lost_pairs)}")
    if faults:
        return "not B-DNA: " + "; ".join(faults + [f"kinked at {step}" for step in kinked])
    return "B-DNA on average, kinked at " + "; ".join(kinked) if kinked else "B-DNA"


def hydrogen_bonds(duplex: SimulatedDuplex, structure: Path) -> NDArray[np.int64]:
    """Return the number of Watson-Crick hydrogen bonds of each base pair, found by mdtraj."""
    frame = mdtraj.load(str(structure))
    found = {
        frozenset((int(donor), int(acceptor)))
        for donor, _, acceptor in mdtraj.baker_hubbard(frame, freq=0.0, periodic=False)
    }
    return np.array(
        [
            sum(frozenset(bond) in found for bond in pair)
            for pair in watson_crick_bonds(duplex.topology)
        ],
        dtype=np.int64,
    )


def heavy_atom_rmsd_A(built: Path, relaxed: Path) -> float:
    """Return the heavy atoms' least-squares RMSD between two structures, by mdtraj."""
    one, other = (mdtraj.load(str(path)) for path in (built, relaxed))
    # Water, if any, is in the built structure only, and comes last.
    heavy = other.topology.select("element != H")
    return 10 * float(mdtraj.rmsd(other, one, atom_indices=heavy)[0])
