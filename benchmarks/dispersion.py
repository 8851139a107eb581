"""How long the general dispersion relation takes, and what its frequencies are worth.

OMP_NUM_THREADS=1 python benchmarks/dispersion.py. For 100,000 wavenumbers of a rod with every
coupling prints wall and processor seconds, and the largest error against the closed form of the
paper's rod, relative to the highest frequency at a wavenumber: by singular values, as the library
does it, and by the eigenvalues of the square.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from threadpoolctl import threadpool_info

from dnawaves.rod.dispersion import dispersion, energy_roots, strain_operator
from dnawaves.rod.dispersion_dataset import figure_1_dataset
from dnawaves.rod.plane_waves import plane_waves
from dnawaves.rod.rod import Rod

Array = NDArray[np.float64]
WAVENUMBERS = 100_000


def by_eigenvalues(rod: Rod, wavenumbers: Array, lattice: bool) -> Array:
    stiffness_root, mass_root_inverse = energy_roots(rod)
    operator = stiffness_root @ strain_operator(rod, wavenumbers, lattice=lattice)
    operator = operator @ mass_root_inverse
    squared = np.linalg.eigvalsh(operator.conj().swapaxes(1, 2) @ operator)
    return np.sqrt(np.maximum(squared, 0))


def by_singular_values(rod: Rod, wavenumbers: Array, lattice: bool) -> Array:
    return dispersion(rod, wavenumbers, lattice=lattice)


def with_vectors(rod: Rod, wavenumbers: Array, lattice: bool) -> Array:
    return plane_waves(rod, wavenumbers, lattice=lattice).frequencies_rad_per_ps


def coupled_rod() -> Rod:
    root = np.random.default_rng(1).normal(size=(6, 6))
    rod = Rod.paper(twisted=True)
    return replace(
        rod,
        stiffness=rod.stiffness + 20 * root @ root.T,
        gamma0=np.array([0.05, -0.1, 1.0]),
        omega0_rad_per_nm=np.array([0.1, 0.2, 1.76]),
    )


def error(solve: Callable[[Rod, Array, bool], Array], wavenumbers: Array, lattice: bool) -> float:
    curves = figure_1_dataset(wavenumbers).isel(model=int(lattice))
    shifted = curves["bend_shear"].values[1:]
    six = np.vstack([curves["extension"], curves["twist"], shifted[0].T, shifted[1].T]).T
    exact = np.sort(six, axis=1)
    found = solve(Rod.paper(twisted=True), wavenumbers, lattice)
    return float((np.abs(found - exact) / exact[:, -1:]).max())


def main() -> None:
    threads = [info["num_threads"] for info in threadpool_info() if info["user_api"] == "blas"]
    print(f"numpy threads: {max(threads, default=1)}; {WAVENUMBERS} wavenumbers")
    wavenumbers = np.linspace(-9.0, 9.0, WAVENUMBERS)
    rod = coupled_rod()
    print("model      method                wall_s   cpu_s  largest_error")
    for lattice, model in ((False, "continuum"), (True, "lattice")):
        for name, solve in (
            ("singular values", by_singular_values),
            ("eigenvalues", by_eigenvalues),
            ("waves, velocities", with_vectors),
        ):
            solve(rod, wavenumbers[:100], lattice)
            started, busy = time.perf_counter(), time.process_time()
            solve(rod, wavenumbers, lattice)
            wall_s, cpu_s = time.perf_counter() - started, time.process_time() - busy
            worst = error(solve, wavenumbers, lattice)
            print(f"{model:9s}  {name:18s}  {wall_s:7.2f}  {cpu_s:6.2f}  {worst:.1e}")


if __name__ == "__main__":
    main()
