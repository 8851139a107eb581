"""The nonlinear rod beside PyElastica: an extension pulse along 200 elements, and 64 rods at once.

python benchmarks/rod_nonlinear.py PYTHON, with PYTHON the interpreter of an environment that holds
PyElastica 1.0: python -m venv elastica; elastica/bin/pip install pyelastica==1.0.0; then
elastica/bin/python. Each program runs in fresh processes, one at a time, on one thread; PyElastica
first without and then with what it has compiled (numba's cache). Same rod, timestep and pulse.
Rates are per second of processor time. Takes about a minute; let nothing else run meanwhile.
"""

from __future__ import annotations

import json
import math
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from functools import partial
from typing import Any

ELEMENTS, RODS = 200, 64
# of the time in which extension passes one element
TIMESTEP_SHARE = 0.1
PULSE_WIDTH_PS, PULSE_CENTRE_PS, PULSE_STRAIN = 2.0, 10.0, 1e-4
STATIONS = (50, 150)
# how often the velocities are looked at and the energy is taken, in steps
EVERY = 4
ENERGY_STEPS, KICKS_NM_PER_PS = 2000, (0.02, 0.05)
REPEATS = 5


def main(elastica: str) -> None:
    from dnawaves.rod.rod import Rod

    paper = Rod.paper()
    rod = {
        "density": paper.density_Da_per_nm,
        "inertia": paper.inertia_Da_nm.diagonal().tolist(),
        "stiffness": paper.stiffness.diagonal().tolist(),
        "spacing": paper.spacing_nm,
    }
    with tempfile.TemporaryDirectory() as cache:
        cold = {"dnawaves": worker(sys.executable, "dnawaves", "pulse", rod, cache)}
        cold["PyElastica"] = worker(elastica, "elastica", "pulse", rod, cache)
        again = worker(elastica, "elastica", "pulse", rod, cache)
        rates = {
            "dnawaves": worker(sys.executable, "dnawaves", "rates", rod, cache),
            "PyElastica": worker(elastica, "elastica", "rates", rod, cache),
        }
    print(f"extension pulse along {ELEMENTS} elements, from the start of a fresh process")
    for name, result in (*cold.items(), ("PyElastica, compiled before", again)):
        print(
            f"  {name:28s} {result['process_s']:6.2f} s, of the processor "
            f"{result['processor_s']:6.2f} s; speed {result['speed_A_per_ps']:.4f} A/ps; energy "
            f"changes by {result['pulse_energy']:.1e} once the pulse is in"
        )
    for name, other in (("cold", cold["PyElastica"]), ("compiled before", again)):
        ratios = [other[key] / cold["dnawaves"][key] for key in ("process_s", "processor_s")]
        print(
            f"  ratio PyElastica ({name}) / dnawaves: {ratios[0]:.1f}, of the processor's time "
            f"{ratios[1]:.1f}"
        )
    print(f"energy of {ELEMENTS} elements that bend and stretch: change in {ENERGY_STEPS} steps")
    for name, result in rates.items():
        for kick_nm_per_ps, energy in zip(KICKS_NM_PER_PS, result["energies"], strict=True):
            print(f"  {name:28s} kicked by {10 * kick_nm_per_ps:.1f} A/ps: {energy:.1e}")
    print("million element-steps per second, started and compiled, one thread")
    for name, result in rates.items():
        one, many = result["rates"]
        print(f"  {name:28s} one rod {one / 1e6:6.2f}, {RODS} rods together {many / 1e6:6.2f}")
    (_, ours), (one, many) = rates["dnawaves"]["rates"], rates["PyElastica"]["rates"]
    print(f"  ratio {RODS} rods dnawaves / one rod PyElastica: {ours / one:.2f}")
    print(f"  ratio {RODS} rods dnawaves / {RODS} rods PyElastica: {ours / many:.2f}")
    print("dnawaves, microseconds a step of one rod")
    for elements, seconds in rates["dnawaves"]["lengths"]:
        nanoseconds = 1e9 * seconds / elements
        print(f"  {elements:6d} elements {1e6 * seconds:9.1f}  ({nanoseconds:.0f} ns an element)")


def worker(python: str, name: str, task: str, rod: dict[str, Any], cache: str) -> dict[str, Any]:
    """Return what a fresh process measures, and how long it takes from start to end."""
    environment = dict(os.environ, NUMBA_CACHE_DIR=cache)
    environment.update(dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"), "1"))
    started, before = time.perf_counter(), os.times()
    command = [python, __file__, "--worker", name, task, json.dumps(rod)]
    output = subprocess.run(command, env=environment, check=True, capture_output=True, text=True)
    process_s, after = time.perf_counter() - started, os.times()
    processor_s = sum(after[2:4]) - sum(before[2:4])
    result = json.loads(output.stdout.splitlines()[-1])
    return {**result, "process_s": process_s, "processor_s": processor_s}


def speed(rod: dict[str, Any]) -> float:
    """Return the speed of extension, nm/ps."""
    return math.sqrt(rod["stiffness"][2] / rod["density"])


def timestep(rod: dict[str, Any]) -> float:
    return TIMESTEP_SHARE * rod["spacing"] / speed(rod)


def pulse_force(rod: dict[str, Any]) -> Callable[[float], float]:
    peak = PULSE_STRAIN * rod["stiffness"][2]
    return lambda t: peak * math.exp(-(((t - PULSE_CENTRE_PS) / PULSE_WIDTH_PS) ** 2) / 2)


def pulse_steps(rod: dict[str, Any]) -> int:
    """Return the steps until the pulse has reached the far end."""
    end_ps = PULSE_CENTRE_PS + ELEMENTS * rod["spacing"] / speed(rod)
    return EVERY * math.ceil(end_ps / timestep(rod) / EVERY)


def fastest(step: Callable[[], None], steps: int) -> float:
    """Return the processor time of the fastest of several runs of `step`, s per step."""
    seconds = []
    for _ in range(REPEATS):
        started = time.process_time()
        step()
        seconds.append(time.process_time() - started)
    return min(seconds) / steps


def arrivals_speed(times: Any, velocities: Any, rod: dict[str, Any]) -> float:
    """Return A/ps between the stations from the maxima of velocities (times, stations)."""
    import numpy as np

    arrivals = []
    for velocity in np.transpose(velocities):
        top = int(np.argmax(velocity))
        before, at, after = velocity[top - 1 : top + 2]
        shift = (before - after) / (2 * (before - 2 * at + after))
        arrivals.append(times[top] + shift * (times[1] - times[0]))
    distance = 10 * rod["spacing"] * (STATIONS[1] - STATIONS[0])
    return float(distance / (arrivals[1] - arrivals[0]))


def change(energies: Any) -> float:
    """Return the range of energies, relative to their mean."""
    import numpy as np

    return float(np.ptp(energies) / np.mean(energies))


def dnawaves_chain(rod: dict[str, Any], elements: int) -> Any:
    import numpy as np

    from dnawaves.rod.nonlinear.chain import NonlinearChain
    from dnawaves.rod.rod import Rod

    constants = Rod(
        rod["density"], np.diag(rod["inertia"]), np.diag(rod["stiffness"]), rod["spacing"]
    )
    return NonlinearChain.uniform(constants, elements)


def dnawaves_pulse(rod: dict[str, Any]) -> dict[str, Any]:
    import numpy as np

    from dnawaves.rod.nonlinear.energy import energy
    from dnawaves.rod.nonlinear.run import Load, run

    chain = dnawaves_chain(rod, ELEMENTS)
    pattern = np.zeros((ELEMENTS, 6))
    pattern[0, 2] = 1.0
    load = Load(pattern, pulse_force(rod))
    record = run(
        chain, chain.at_rest(), timestep(rod), pulse_steps(rod), record_every=EVERY, load=load
    )
    velocities = chain.velocities(record.states)[:, STATIONS, 2]
    within = record.times_ps > PULSE_CENTRE_PS + 6 * PULSE_WIDTH_PS
    return {
        "speed_A_per_ps": arrivals_speed(record.times_ps, velocities, rod),
        "pulse_energy": change(energy(chain, record.states)[within]),
    }


def kick(elements: int, size_nm_per_ps: float) -> Any:
    """Return smooth velocities (elements, 3), nm/ps: bend, and extension along axis 2."""
    import numpy as np

    places = np.pi * (np.arange(elements) + 0.5) / elements
    return size_nm_per_ps * np.stack(
        [np.cos(5 * places), np.zeros(elements), np.cos(4 * places)], axis=1
    )


def dnawaves_rates(rod: dict[str, Any]) -> dict[str, Any]:
    import numpy as np

    from dnawaves.rod.nonlinear.energy import energy
    from dnawaves.rod.nonlinear.run import run

    def kicked(elements: int, size_nm_per_ps: float) -> tuple[Any, Any]:
        chain = dnawaves_chain(rod, elements)
        velocities = np.hstack([kick(elements, size_nm_per_ps), np.zeros((elements, 3))])
        return chain, chain.kicked(chain.at_rest(), velocities)

    def seconds(chain: Any, start: Any, steps: int) -> float:
        return fastest(lambda: run(chain, start, timestep(rod), steps, record_every=steps), steps)

    energies = []
    for size in KICKS_NM_PER_PS:
        chain, start = kicked(ELEMENTS, size)
        record = run(chain, start, timestep(rod), ENERGY_STEPS, record_every=EVERY)
        energies.append(change(energy(chain, record.states)))
    one, many = seconds(chain, start, 500), seconds(chain, start.copies(RODS), 100)
    lengths = (100, 200, 1000, 5000, 20000)
    return {
        "energies": energies,
        "rates": [ELEMENTS / one, RODS * ELEMENTS / many],
        "lengths": [(n, seconds(*kicked(n, KICKS_NM_PER_PS[0]), 50)) for n in lengths],
    }


def elastica_rods(rod: dict[str, Any], rods: int) -> tuple[Any, list[Any], type]:
    """Return a simulator, its rods and the class of forces, with the rod's constants put in."""
    import elastica
    import numpy as np

    class Simulator(elastica.BaseSystemCollection, elastica.Forcing):
        pass

    simulator, made = Simulator(), []
    for _ in range(rods):
        one = elastica.CosseratRod.straight_rod(
            ELEMENTS,
            np.zeros(3),
            np.array([0.0, 0.0, 1.0]),
            np.array([1.0, 0.0, 0.0]),
            ELEMENTS * rod["spacing"],
            1.0,
            rod["density"] / np.pi,
            youngs_modulus=1.0,
            shear_modulus=1.0,
        )
        inertia = rod["spacing"] * np.array(rod["inertia"])
        one.shear_matrix[:] = np.diag(rod["stiffness"][:3])[..., np.newaxis]
        one.bend_matrix[:] = np.diag(rod["stiffness"][3:])[..., np.newaxis]
        one.mass_second_moment_of_inertia[:] = np.diag(inertia)[..., np.newaxis]
        one.inv_mass_second_moment_of_inertia[:] = np.diag(1 / inertia)[..., np.newaxis]
        simulator.append(one)
        made.append(one)
    return simulator, made, elastica.NoForces


def elastica_energy(one: Any, now: float) -> float:
    # strains are those of the middle of the last step until they are taken again
    one.compute_internal_forces_and_torques(now)
    return float(
        one.compute_translational_energy()
        + one.compute_rotational_energy()
        + one.compute_bending_energy()
        + one.compute_shear_energy()
    )


def elastica_pulse(rod: dict[str, Any]) -> dict[str, Any]:
    import elastica

    simulator, (one,), base = elastica_rods(rod, 1)
    force = pulse_force(rod)

    class Pulse(base):  # type: ignore[misc, valid-type]
        def apply_forces(self, system: Any, time: float = 0.0) -> None:
            system.external_forces[2, 0] += force(time)

    simulator.add_forcing_to(one).using(Pulse)
    simulator.finalize()
    stepper, now, times, velocities, energies = elastica.PositionVerlet(), 0.0, [], [], []
    for step in range(1, pulse_steps(rod) + 1):
        now = stepper.step(simulator, now, timestep(rod))
        if step % EVERY == 0:
            times.append(now)
            velocities.append([one.velocity_collection[2, station] for station in STATIONS])
            if now > PULSE_CENTRE_PS + 6 * PULSE_WIDTH_PS:
                energies.append(elastica_energy(one, now))
    return {
        "speed_A_per_ps": arrivals_speed(times, velocities, rod),
        "pulse_energy": change(energies),
    }


def elastica_rates(rod: dict[str, Any]) -> dict[str, Any]:
    import elastica

    stepper = elastica.PositionVerlet()

    def kicked(rods: int, size_nm_per_ps: float) -> tuple[Any, list[Any]]:
        simulator, made, _ = elastica_rods(rod, rods)
        for one in made:
            one.velocity_collection[:] = kick(ELEMENTS + 1, size_nm_per_ps).T
        simulator.finalize()
        return simulator, made

    def move(simulator: Any, steps: int) -> None:
        now = 0.0
        for _ in range(steps):
            now = stepper.step(simulator, now, timestep(rod))

    energies = []
    for size in KICKS_NM_PER_PS:
        simulator, (one,) = kicked(1, size)
        found = [elastica_energy(one, 0.0)]
        for _ in range(ENERGY_STEPS // EVERY):
            move(simulator, EVERY)
            found.append(elastica_energy(one, 0.0))
        energies.append(change(found))
    rates = []
    for rods, steps in ((1, 500), (RODS, 50)):
        simulator, _ = kicked(rods, KICKS_NM_PER_PS[0])
        # compiled, before the clock runs
        move(simulator, 1)
        seconds = fastest(partial(move, simulator, steps), steps)
        rates.append(rods * ELEMENTS / seconds)
    return {"energies": energies, "rates": rates}


TASKS = {
    ("dnawaves", "pulse"): dnawaves_pulse,
    ("dnawaves", "rates"): dnawaves_rates,
    ("elastica", "pulse"): elastica_pulse,
    ("elastica", "rates"): elastica_rates,
}

if __name__ == "__main__":
    if len(sys.argv) == 5 and sys.argv[1] == "--worker":
        print(json.dumps(TASKS[sys.argv[2], sys.argv[3]](json.loads(sys.argv[4]))))
    elif len(sys.argv) == 2:
        main(sys.argv[1])
    else:
        sys.exit(__doc__)
