"""What helical parameters cost: against merely reading, against mdna, and as things grow.

python benchmarks/helical.py [--mdna PYTHON] [SECTION...], with sections speed, growth, memory,
workers and solvated (all by default) and PYTHON the interpreter of an environment that holds
mdna (`python3 -m venv mdna && mdna/bin/pip install mdna==0.2.0`). Prints Markdown tables. One
thread; processor times, the shortest of several runs; wall times for workers. Trajectories are
fibre B-DNA with 0.1 Å of noise, in a temporary folder: 700 MB for all sections.
"""

from __future__ import annotations

import os

os.environ.update({name: "1" for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS")})

import argparse
import subprocess
import sys
import time
import warnings
from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory

import MDAnalysis
import numpy as np
from MDAnalysis.lib.formats.libdcd import DCDFile
from openmm.app import Element, PDBFile, Topology
from openmm.unit import nanometer

from dnawaves.duplex.fibre import fibre_duplex
from dnawaves.helical.analysis import HelicalParameters

SEQUENCE = "CGATTAAGCGTCATGACCTGAATC"
FRAMES = 2000

MDNA = """
import sys, time, warnings
warnings.simplefilter("ignore")
import mdtraj, mdna
trajectory, topology = sys.argv[1:]
shortest = float("inf")
for _ in range(3):
    started = time.process_time()
    loaded = mdtraj.load(trajectory, top=topology)
    mdna.compute_rigid_parameters(loaded, chainids=[0, 1])
    shortest = min(shortest, time.process_time() - started)
print(shortest)
"""

ANALYSIS = """
import sys, time, warnings
warnings.simplefilter("ignore")
import MDAnalysis
from dnawaves.helical.analysis import HelicalParameters
topology, trajectory, kept, backend = sys.argv[1:]
universe = MDAnalysis.Universe(topology, trajectory)
analysis = HelicalParameters(universe, keep_frames=kept == "frames")
started = time.perf_counter()
analysis.run(backend=backend, n_workers=2 if backend != "serial" else 1)
print(time.perf_counter() - started)
"""


def write_structure(folder: Path, sequence: str) -> Path:
    """Write the fibre model of a sequence as PDB."""
    duplex = fibre_duplex(sequence)
    topology = Topology()
    chains = {name: topology.addChain(name) for name in dict.fromkeys(duplex.chain_ids)}
    residues = {}
    for chain, number, residue, atom in zip(
        duplex.chain_ids, duplex.residue_ids, duplex.residue_names, duplex.atom_names, strict=True
    ):
        if (chain, number) not in residues:
            residues[chain, number] = topology.addResidue(residue, chains[chain], str(number))
        element = Element.getBySymbol(atom[0])
        topology.addAtom(atom, element, residues[chain, number])
    path = folder / f"{len(sequence)}.pdb"
    with open(path, "w", encoding="utf-8") as file:
        PDBFile.writeFile(topology, duplex.positions_nm * nanometer, file, keepIds=True)
    return path


def write_trajectory(path: Path, positions_A: np.ndarray, frames: int) -> Path:
    """Write frames of noise about a structure as DCD."""
    rng = np.random.default_rng(0)
    noise = rng.normal(scale=0.1, size=(50, *positions_A.shape)).astype(np.float32)
    with DCDFile(str(path), "w") as file:
        file.write_header("", len(positions_A), 0, 1, 20.45, True)
        for frame in range(frames):
            file.write(positions_A + noise[frame % 50], np.zeros(6))
    return path


def make(folder: Path, sequence: str, frames: int) -> tuple[Path, Path]:
    """Return a structure and a trajectory of it."""
    structure = write_structure(folder, sequence)
    trajectory = folder / f"{len(sequence)}x{frames}.dcd"
    if not trajectory.exists():
        positions = MDAnalysis.Universe(str(structure)).atoms.positions
        write_trajectory(trajectory, positions, frames)
    return structure, trajectory


def shortest_s(work: Callable[[], object], repeats: int = 7, wall: bool = False) -> float:
    """Return the shortest processor (or wall) time of some runs."""
    clock = time.perf_counter if wall else time.process_time
    times = []
    for _ in range(repeats):
        started = clock()
        work()
        times.append(clock() - started)
    return min(times)


def read_and_run_s(universe: MDAnalysis.Universe, repeats: int = 7) -> tuple[float, float]:
    """Return the times of merely reading the base atoms, and of the analysis with reading."""
    analysis = HelicalParameters(universe)
    atoms = analysis.duplexes.indices.tolist()
    with DCDFile(universe.trajectory.filename) as file:
        read_s = shortest_s(lambda: file.readframes(indices=atoms), repeats)
    return read_s, shortest_s(analysis.run, repeats)


def speed(folder: Path, mdna: Path | None) -> None:
    print(f"\n| 24 base pairs x {FRAMES} frames, DCD | ms | against reading |\n|---|---|---|")
    structure, trajectory = make(folder, SEQUENCE, FRAMES)
    universe = MDAnalysis.Universe(str(structure), str(trajectory))
    read_s, run_s = read_and_run_s(universe, repeats=15)
    lean = HelicalParameters(universe, keep_frames=False)
    rows = {
        "reading the base atoms, libdcd": read_s,
        "reading and analysis": run_s,
        "the same, without origins and axes": shortest_s(lean.run, 15),
    }
    if mdna is not None:
        command = [str(mdna), "-c", MDNA, str(trajectory), str(structure)]
        printed = subprocess.check_output(command, text=True)
        rows["mdna, loading and default"] = float(printed.split()[-1])
    for name, seconds in rows.items():
        print(f"| {name} | {1e3 * seconds:.1f} | {seconds / read_s:.2f} |")
    if mdna is not None:
        print(f"\nmdna takes {rows['mdna, loading and default'] / run_s:.1f} times as long.")


def growth(folder: Path, mdna: Path | None) -> None:
    print("\n| base pairs | frames | read, ms | read and analyse, ms | µs per frame and pair |")
    print("|---|---|---|---|---|")
    sizes = [(24, 500), (24, 1000), (24, 2000), (24, 4000), (12, 2000), (48, 2000), (96, 2000)]
    for pairs, frames in sizes:
        sequence = (SEQUENCE * 4)[:pairs]
        structure, trajectory = make(folder, sequence, frames)
        read_s, run_s = read_and_run_s(MDAnalysis.Universe(str(structure), str(trajectory)))
        each = 1e6 * run_s / (pairs * frames)
        print(f"| {pairs} | {frames} | {1e3 * read_s:.1f} | {1e3 * run_s:.1f} | {each:.2f} |")


def memory(folder: Path, mdna: Path | None) -> None:
    print("\n| `dnawaves helical`, 24 base pairs | frames | peak memory, MiB |\n|---|---|---|")
    program = (
        "import sys\n"
        "from pathlib import Path\n"
        "from dnawaves.helical.steps import helical_step\n"
        "helical_step(Path(sys.argv[1]), [Path(sys.argv[2])], Path(sys.argv[3]))\n"
        "status = Path('/proc/self/status').read_text()\n"
        "print(int(status.split('VmHWM:')[1].split()[0]) / 1024)\n"
    )
    for ending in ("nc", "csv"):
        for frames in (2000, 10000, 50000):
            structure, trajectory = make(folder, SEQUENCE, frames)
            output = folder / f"out.{ending}"
            command = [sys.executable, "-c", program, *map(str, (structure, trajectory, output))]
            peak = float(subprocess.check_output(command, text=True, stderr=subprocess.DEVNULL))
            print(f"| .{ending} | {frames} | {peak:.0f} |")


def workers(folder: Path, mdna: Path | None) -> None:
    print("\n| 24 base pairs x 50,000 frames, wall time | one, s | two workers, s | faster by |")
    print("|---|---|---|---|")
    structure, trajectory = make(folder, SEQUENCE, 50000)

    def analyse(keep_frames: bool, how: str) -> float:
        # Each in a process of its own: memory that has been used before comes for nothing.
        words = [sys.executable, "-c", ANALYSIS, str(structure), str(trajectory)]
        words += ["frames" if keep_frames else "parameters", how]
        quiet = subprocess.DEVNULL
        return min(float(subprocess.check_output(words, text=True, stderr=quiet)) for _ in range(3))

    def command(ending: str, number: int) -> float:
        words = [sys.executable, "-m", "dnawaves", "helical", str(structure), str(trajectory)]
        words += ["--output", str(folder / f"out.{ending}"), "--workers", str(number)]
        quiet = subprocess.DEVNULL
        return shortest_s(lambda: subprocess.run(words, check=True, stderr=quiet), 3, wall=True)

    rows = {
        "run(), parameters": (analyse(False, "serial"), analyse(False, "multiprocessing")),
        "run(), and frames": (analyse(True, "serial"), analyse(True, "multiprocessing")),
        "`dnawaves helical` to .csv": (command("csv", 1), command("csv", 2)),
        "`dnawaves helical` to .nc": (command("nc", 1), command("nc", 2)),
    }
    for name, (one, two) in rows.items():
        print(f"| {name} | {one:.2f} | {two:.2f} | {one / two:.2f} |")


def solvated(folder: Path, mdna: Path | None) -> None:
    atoms, frames = 30000, 400
    print(f"\n| 24 base pairs among {atoms} atoms x {frames} frames | read, ms | analyse, ms |")
    print("|---|---|---|")
    structure = MDAnalysis.Universe(str(write_structure(folder, SEQUENCE)))
    waters = (atoms - len(structure.atoms)) // 3
    water = MDAnalysis.Universe.empty(
        3 * waters, waters, atom_resindex=np.repeat(np.arange(waters), 3), trajectory=True
    )
    water.add_TopologyAttr("names", ["OW", "HW1", "HW2"] * waters)
    water.add_TopologyAttr("resnames", ["SOL"] * waters)
    water.atoms.positions = np.random.default_rng(1).uniform(-30, 30, (3 * waters, 3))
    water.add_TopologyAttr("resids", range(1, waters + 1))
    water.add_TopologyAttr("segids", ["W"])
    whole = MDAnalysis.Merge(structure.atoms, water.atoms)
    trajectory = write_trajectory(folder / "solvated.dcd", whole.atoms.positions, frames)
    whole.load_new(str(trajectory))
    read_s, run_s = read_and_run_s(whole, repeats=3)
    size_MB = 1e-6 * trajectory.stat().st_size
    print(f"| DCD, {size_MB:.0f} MB | {1e3 * read_s:.0f} | {1e3 * run_s:.0f} |")
    xtc = folder / "solvated.xtc"
    with MDAnalysis.Writer(str(xtc), len(whole.atoms)) as writer:
        for _ in whole.trajectory:
            writer.write(whole.atoms)
    whole.load_new(str(xtc))
    loop_s = shortest_s(lambda: [timestep.frame for timestep in whole.trajectory], 2)
    run_s = shortest_s(HelicalParameters(whole).run, 2)
    size_MB = 1e-6 * xtc.stat().st_size
    print(f"| XTC, {size_MB:.0f} MB | {1e3 * loop_s:.0f} | {1e3 * run_s:.0f} |")


SECTIONS = {section.__name__: section for section in (speed, growth, memory, workers, solvated)}

if __name__ == "__main__":
    warnings.simplefilter("ignore")
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument("--mdna", type=Path)
    parser.add_argument("sections", nargs="*", metavar="SECTION", choices=[*SECTIONS, []])
    chosen = parser.parse_args()
    with TemporaryDirectory() as scratch:
        for title in chosen.sections or SECTIONS:
            SECTIONS[title](Path(scratch), chosen.mdna)
