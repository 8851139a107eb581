"""How far the speeds depend on which minimum the anneal ends in.

python benchmarks/inherent_structures.py CONFIG SYSTEM SEED..., with SYSTEM a system of CONFIG such
as mixed24-condensed. Relaxes it once per seed and prints, for each, the energy, the speeds of the
linear static response and whether the structure is B-DNA.
"""

from __future__ import annotations

import sys
from pathlib import Path
from tempfile import TemporaryDirectory

from dnawaves.duplex.build import build_duplex, write_pdb
from dnawaves.motion.structure import inspect_structure
from dnawaves.scene.load import load_scenes
from dnawaves.system.duplex import read_built
from dnawaves.system.forces import load_force_field
from dnawaves.system.relax import relax
from dnawaves.trajectory.steps import first_estimates_in


def main(config: Path, name: str, seeds: list[int]) -> None:
    systems = {scene.system.name: scene.system for scene in load_scenes(config).values()}
    spec = systems[name]
    topology, positions = build_duplex(spec.duplex.sequence, load_force_field(spec.environment))
    print("seed  energy_kJ_per_mol  extension_A_per_ps  twist_A_per_ps  rmsd_A  structure")
    with TemporaryDirectory() as folder:
        built, relaxed = Path(folder) / "built.pdb", Path(folder) / "relaxed.pdb"
        write_pdb(topology, positions, built)
        for seed in seeds:
            relaxation = spec.environment.to_minimum.model_copy(update={"seed": seed})
            environment = spec.environment.model_copy(update={"relaxation": relaxation})
            seeded = spec.model_copy(update={"environment": environment})
            # From the file, as the workflow does: its rounding decides where an anneal ends too.
            duplex = read_built(seeded, built)
            dataset, _ = relax(duplex, threads=2, report=lambda line: None)
            minimum = duplex.with_positions(dataset["position_nm"].values)
            write_pdb(duplex.topology, minimum.positions_nm, relaxed)
            structure = inspect_structure(minimum, built, relaxed).attrs
            speeds = list(first_estimates_in(dataset.attrs).values())
            print(
                f"{seed:4d}  {dataset.attrs['energy_kJ_per_mol']:17.1f}  {speeds[0]:18.2f}  "
                f"{speeds[1]:14.2f}  {structure['rmsd_to_built_A']:6.2f}  {structure['verdict']}",
                flush=True,
            )


if __name__ == "__main__":
    if len(sys.argv) < 4:
        sys.exit(__doc__)
    main(Path(sys.argv[1]), sys.argv[2], [int(seed) for seed in sys.argv[3:]])
