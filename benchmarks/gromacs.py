"""The same System in GROMACS beside OpenMM: energy and speed.

python benchmarks/gromacs.py PAIRS [THREADS]: a duplex of PAIRS base pairs without solvent and in
TIP3P. Needs `gmx` and `gmx_d` (Debian's package gromacs) and ParmEd (pip install parmed). Speeds
are of GROMACS in mixed precision and OpenMM's CPU platform, energies of both in double precision:
in mixed precision GROMACS is off by 2e-5 in water.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import openmm
import parmed
from numpy.typing import NDArray
from openmm import app, unit
from solvent import DNA, TIMESTEP_PS, ms_per_step, sequence_of

from dnawaves.duplex.build import build_duplex
from dnawaves.scene.models import Environment
from dnawaves.system.effects.water import WATER_FILES, build_explicit, solvate
from dnawaves.system.forces import build_system, charges_e, nonbonded_force
from dnawaves.system.geometry import helix_frame, sugar_anchors

Array = NDArray[np.float64]
CUTOFF_NM, SWITCH_NM = 0.9, 0.8
COULOMB = 138.935457644382
STEPS = {"none": 3000, "TIP3P": 300}
FINE = 1e-6
# A reaction field of infinite permittivity; PME at its usual accuracy for the speed.
REACTION_FIELD = "coulombtype = reaction-field\nepsilon-rf = 0\n"
PME = "coulombtype = PME\nDispCorr = EnerPres\n"
FINE_PME = f"{PME}ewald-rtol = {FINE}\nfourierspacing = 0.05\npme-order = 6\n"
COMMON = f"""
integrator = md-vv
cutoff-scheme = Verlet
dt = {TIMESTEP_PS}
comm-mode = none
nstlist = 10
nstcalcenergy = 100
nstenergy = 1000
rcoulomb = {CUTOFF_NM}
rvdw = {CUTOFF_NM}
vdw-modifier = Potential-switch
rvdw-switch = {SWITCH_NM}
"""


def structure(solvent: str, pairs: int) -> tuple[app.Topology, Array, openmm.System, openmm.System]:
    """Return topology, positions in nm, the System, and one without constraints to export."""
    files = (DNA, WATER_FILES["TIP3P"]) if solvent == "TIP3P" else (DNA,)
    field = app.ForceField(*files)
    topology, positions = build_duplex(sequence_of(pairs), field)
    if solvent == "none":
        system = build_system(topology, Environment(cutoff_nm=CUTOFF_NM, switch_nm=SWITCH_NM))
        # GROMACS is periodic: a box in which no image is in reach, the duplex in its middle.
        box = np.ptp(positions, axis=0) + 2.5
        topology.setPeriodicBoxVectors(tuple(np.diag(box)) * unit.nanometer)
        return topology, positions - positions.mean(axis=0) + box / 2, system, system
    frame = helix_frame(positions[sugar_anchors(topology)])
    box = solvate(topology, positions, frame, field, "TIP3P", salt_M=0.15)
    rigid = build_explicit(box.topology, field)
    flexible = field.createSystem(
        box.topology, nonbondedMethod=app.PME, rigidWater=False, removeCMMotion=False
    )
    return box.topology, box.positions_nm, rigid, flexible


def relaxed(system: openmm.System, positions_nm: Array) -> Array:
    """Return positions without clashes."""
    context = openmm.Context(system, openmm.VerletIntegrator(0.001))
    context.setPositions(positions_nm)
    openmm.LocalEnergyMinimizer.minimize(context, 100.0, 50)
    place = context.getState(getPositions=True).getPositions(asNumpy=True)
    return np.array(place.value_in_unit(unit.nanometer))


def potential(system: openmm.System, positions_nm: Array) -> float:
    """Return OpenMM's potential energy in double precision, kJ/mol."""
    platform = openmm.Platform.getPlatformByName("Reference")
    context = openmm.Context(system, openmm.VerletIntegrator(0.001), platform)
    context.setPositions(positions_nm)
    return context.getState(getEnergy=True).getPotentialEnergy()._value


def excluded_reaction_field(nonbonded: openmm.NonbondedForce, positions_nm: Array) -> float:
    """Return what GROMACS adds to OpenMM's reaction field: that of excluded pairs and of selves.

    A constant but for distances that bonds keep; kJ/mol.
    """
    charges = np.array(charges_e(nonbonded))
    k, c = 1 / (2 * CUTOFF_NM**3), 1.5 / CUTOFF_NM
    energy = -0.5 * c * np.sum(charges**2)
    for index in range(nonbonded.getNumExceptions()):
        i, j, *_ = nonbonded.getExceptionParameters(index)
        squared = np.sum((positions_nm[i] - positions_nm[j]) ** 2)
        if squared < CUTOFF_NM**2:
            energy += charges[i] * charges[j] * (k * squared - c)
    return float(COULOMB * energy)


def gmx(program: str, folder: Path, *arguments: str, answer: str | None = None) -> None:
    """Run a GROMACS command in a folder."""
    environment = {name: value for name, value in os.environ.items() if name != "OMP_NUM_THREADS"}
    done = subprocess.run(
        [program, "-nobackup", *arguments],
        cwd=folder,
        capture_output=True,
        text=True,
        check=False,
        input=answer,
        env=environment,
    )
    if done.returncode:
        sys.exit(done.stdout + done.stderr)


def run_gromacs(
    program: str, folder: Path, options: str, name: str, steps: int, threads: int
) -> None:
    """Run some steps from the structure in the folder."""
    # An energy is that of the positions as they are, to the last digit of the rigid waters.
    velocities = "gen-vel = yes\ngen-temp = 300\n" if steps else "continuation = yes\n"
    (folder / f"{name}.mdp").write_text(f"{options}{COMMON}nsteps = {steps}\n{velocities}")
    files = ("-f", f"{name}.mdp", "-c", "start.gro", "-p", "system.top", "-o", f"{name}.tpr")
    # GROMACS warns of runs without removal of the centre of mass's motion.
    gmx(program, folder, "grompp", *files, "-maxwarn", "2")
    run = ("-deffnm", name, "-ntmpi", "1", "-ntomp", str(threads), "-pin", "off")
    gmx(program, folder, "mdrun", *run)


def gromacs_energy(folder: Path, options: str) -> float:
    """Return GROMACS's potential energy in double precision, kJ/mol."""
    run_gromacs("gmx_d", folder, options, "energy", 0, 1)
    files = ("-f", "energy.edr", "-o", "energy.xvg", "-dp")
    gmx("gmx_d", folder, "energy", *files, answer="Potential\n")
    return float((folder / "energy.xvg").read_text().splitlines()[-1].split()[1])


def gromacs_ms_per_step(folder: Path, options: str, steps: int, threads: int) -> float:
    """Return what a step takes in mixed precision, from the log."""
    run_gromacs("gmx", folder, options, "speed", steps, threads)
    found = re.search(r"Performance:\s+(\S+)", (folder / "speed.log").read_text())
    assert found is not None
    return TIMESTEP_PS * 1e-3 * 86_400e3 / float(found[1])


def main(pairs: int, threads: int) -> None:
    print("solvent  particles  OpenMM_kJ_per_mol  difference  OpenMM_ms  GROMACS_ms  ratio")
    for solvent, steps in STEPS.items():
        topology, positions, system, exported = structure(solvent, pairs)
        positions = relaxed(system, positions)
        options, exact = (REACTION_FIELD,) * 2 if solvent == "none" else (PME, FINE_PME)
        with TemporaryDirectory() as temporary:
            folder = Path(temporary)
            whole = parmed.openmm.load_topology(topology, exported, positions * unit.nanometer)
            # Without a cell in the System ParmEd would write one that just holds the atoms.
            cell = topology.getUnitCellDimensions().value_in_unit(unit.angstrom)
            whole.box = [*cell, 90.0, 90.0, 90.0]
            whole.save(str(folder / "system.top"))
            whole.save(str(folder / "start.gro"), precision=7)
            theirs = gromacs_energy(folder, exact)
            their_cost = gromacs_ms_per_step(folder, options, steps, threads)
        cost = ms_per_step(system, positions, threads)
        if solvent == "none":
            energy = potential(system, positions)
            energy += excluded_reaction_field(nonbonded_force(system), positions)
        else:
            nonbonded_force(system).setEwaldErrorTolerance(FINE)
            energy = potential(system, positions)
        print(
            f"{solvent:7s}  {system.getNumParticles():9d}  {energy:17.2f}  "
            f"{theirs / energy - 1:+10.1e}  {cost:9.2f}  {their_cost:10.2f}  "
            f"{cost / their_cost:5.2f}",
            flush=True,
        )


if __name__ == "__main__":
    if len(sys.argv) < 2 or not (shutil.which("gmx") and shutil.which("gmx_d")):
        sys.exit(__doc__)
    main(int(sys.argv[1]), int(sys.argv[2]) if len(sys.argv) > 2 else 1)
