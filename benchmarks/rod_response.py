"""The closed-form response of a rod of 200 elements to a pulse, beside PyElastica's run.

python benchmarks/rod_response.py, in an environment that has PyElastica besides dnawaves:
`python -m pip install "pyelastica==1.0.*"`. Both push the first element of the paper's rod with
the same Gaussian force and find the speed of extension from what passes elements 50 and 150, by
cross-correlation. PyElastica takes the largest timestep that keeps the speed within 0.2 %. Each
starts in a process of its own, PyElastica once without and once with its compiled code cached.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

ELEMENTS, FIRST, LAST = 200, 50, 150
WIDTH_PS, CENTRE_PS, END_PS = 4.0, 20.0, 95.0
TOLERANCE = 2e-3
TIMESTEPS_PS = (0.4, 0.3, 0.2, 0.1, 0.05)
INTERVAL_PS = 1.0
WARM_RUNS = 7
ROUTES = {
    "closed form, six coordinates": "lattice",
    "closed form, extension alone": "extension",
    "PyElastica, nothing compiled": "pyelastica",
    "PyElastica, compiled code cached": "pyelastica",
}

Record = NDArray[np.float64]


def main() -> None:
    result = subprocess.run(
        [sys.executable, "-c", "import elastica"], capture_output=True, text=True, check=False
    )
    if result.returncode:
        sys.exit(
            "PyElastica is not installed here: python -m pip install 'pyelastica==1.0.*'\n"
            + result.stderr.strip().rpartition("\n")[2]
        )
    waits = {}
    print(f"{'':33s} {'process_s':>9s} {'warm_ms':>8s} {'again_ms':>8s}  speed_error_percent")
    with tempfile.TemporaryDirectory() as cache:
        for label, route in ROUTES.items():
            started = time.perf_counter()
            output = subprocess.run(
                [sys.executable, __file__, route],
                env={**os.environ, "NUMBA_CACHE_DIR": cache},
                capture_output=True,
                text=True,
                check=True,
            ).stdout
            found = json.loads(output)
            # the repetitions of the warm runs are not part of a start
            cold_s = time.perf_counter() - started - found["repeats_s"]
            waits[label] = (cold_s, found["warm_s"], found["again_s"])
            note = f"  timestep {found['timestep_ps']} ps" if "timestep_ps" in found else ""
            print(
                f"{label:33s} {cold_s:9.2f} {1e3 * found['warm_s']:8.2f} "
                f"{1e3 * found['again_s']:8.2f}  {100 * found['error']:+.3f}{note}"
            )
    print("\nhow many times sooner than PyElastica:")
    ours, other = list(waits)[:2], list(waits)[2:]
    for label in ours:
        for beside in other:
            cold, warm, again = (
                theirs / mine for mine, theirs in zip(waits[label], waits[beside], strict=True)
            )
            print(f"  {label} / {beside}: process {cold:.1f}, warm {warm:.1f}, again {again:.1f}")
    print(
        "\nprocess: interpreter, imports, compilation and one run. warm: one more run in the same\n"
        "process, rod set up anew (the chain's modes included). again: one more pulse on the rod\n"
        "that is set up (for PyElastica its steps alone)."
    )


def measure(prepare: Callable[[], Callable[[], float]]) -> dict[str, float]:
    """Return the error of the speed and the times of a warm run and of one more pulse."""
    error = prepare()()
    started = time.perf_counter()
    warm, again = [], []
    for _ in range(WARM_RUNS):
        begin = time.perf_counter()
        run = prepare()
        ready = time.perf_counter()
        run()
        end = time.perf_counter()
        warm.append(end - begin)
        again.append(end - ready)
    repeats = time.perf_counter() - started
    return {
        "error": error,
        "warm_s": float(np.median(warm)),
        "again_s": float(np.median(again)),
        "repeats_s": repeats,
    }


def speed_error(record: Record, interval_ps: float, spacing_nm: float, speed: float) -> float:
    """Return the relative error of the speed from the lag of the largest cross-correlation."""
    correlation = np.correlate(record[:, 1], record[:, 0], "full")
    top = int(np.argmax(correlation))
    before, peak, after = correlation[top - 1 : top + 2]
    lag = top - (len(record) - 1) + (before - after) / (2 * (before - 2 * peak + after))
    return (LAST - FIRST) * spacing_nm / (lag * interval_ps) / speed - 1


def closed_form(coordinates: str) -> dict[str, float]:
    from dnawaves.rod.chain import FiniteChain, ScalarChain
    from dnawaves.rod.rod import EXTENSION, Rod

    rod = Rod.paper()
    stiffness = rod.stiffness[EXTENSION, EXTENSION]
    speed = np.sqrt(stiffness / rod.density_Da_per_nm)
    times = np.arange(0, END_PS, INTERVAL_PS)

    def prepare() -> Callable[[], float]:
        if coordinates == "lattice":
            chain, width, axis = FiniteChain(rod, ELEMENTS), 6, EXTENSION
        else:
            masses = np.full(ELEMENTS, rod.density_Da_per_nm * rod.spacing_nm)
            chain, width, axis = ScalarChain(masses, stiffness / rod.spacing_nm), 1, 0
        pattern = np.zeros(chain.free.shape)
        pattern.flat[axis] = 1.0
        observe = np.zeros((2, ELEMENTS * width))
        observe[[0, 1], [FIRST * width + axis, LAST * width + axis]] = 1.0

        def run() -> float:
            _, velocity = chain.pulse_response(times, pattern, CENTRE_PS, WIDTH_PS, observe=observe)
            return speed_error(velocity, INTERVAL_PS, rod.spacing_nm, speed)

        return run

    return measure(prepare)


def pyelastica() -> dict[str, float]:
    import elastica

    from dnawaves.rod.rod import BEND_1, EXTENSION, SHEAR_1, SHEAR_2, TWIST, Rod

    rod = Rod.paper()
    stiffness = np.diag(rod.stiffness)
    speed = np.sqrt(stiffness[EXTENSION] / rod.density_Da_per_nm)

    class Simulator(elastica.BaseSystemCollection, elastica.Forcing):
        pass

    class Pulse(elastica.NoForces):
        def apply_forces(self, system: object, time: float = 0.0) -> None:
            force = np.exp(-(((time - CENTRE_PS) / WIDTH_PS) ** 2) / 2)
            system.external_forces[2, 0] += force  # type: ignore[attr-defined]

    def prepare(timestep_ps: float) -> Callable[[], float]:
        # a cylinder of this radius has the paper's ratio of bend to extension
        radius = 2 * np.sqrt(stiffness[BEND_1] / stiffness[EXTENSION])
        area = np.pi * radius**2
        straight = elastica.CosseratRod.straight_rod(
            ELEMENTS,
            np.zeros(3),
            np.array([0.0, 0.0, 1.0]),
            np.array([1.0, 0.0, 0.0]),
            ELEMENTS * rod.spacing_nm,
            radius,
            rod.density_Da_per_nm / area,
            youngs_modulus=stiffness[EXTENSION] / area,
            shear_modulus=stiffness[SHEAR_1] / area,
        )
        for axis in (SHEAR_1, SHEAR_2):
            straight.shear_matrix[axis, axis] = stiffness[axis]
        straight.bend_matrix[2, 2] = stiffness[TWIST]
        simulator = Simulator()
        simulator.append(straight)
        simulator.add_forcing_to(straight).using(Pulse)
        simulator.finalize()
        stepper = elastica.PositionVerlet()
        record = np.empty((int(END_PS / timestep_ps), 2))

        def run() -> float:
            now = np.float64(0.0)
            for row in record:
                now = stepper.step(simulator, now, timestep_ps)
                row[:] = straight.velocity_collection[2, [FIRST, LAST]]
            return speed_error(record, timestep_ps, rod.spacing_nm, speed)

        return run

    timestep = next(dt for dt in TIMESTEPS_PS if abs(prepare(dt)()) < TOLERANCE)
    return {**measure(lambda: prepare(timestep)), "timestep_ps": timestep}


if __name__ == "__main__":
    if len(sys.argv) == 1:
        main()
    elif sys.argv[1] == "pyelastica":
        print(json.dumps(pyelastica()))
    else:
        print(json.dumps(closed_form(sys.argv[1])))
