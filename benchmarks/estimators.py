"""Bias, spread, coverage and false alarms of every estimator, on synthetic truth.

python benchmarks/estimators.py [draws [processes]] prints Markdown tables; 200 draws by default,
in two processes: half an hour of one core. A chain of 24 base pairs, free at both ends, extension
at 8.19 Å/ps with a friction of 0.3 /ps, is pushed at its first base pair by a Gaussian force of
standard deviation 0.46 ps. SNR is the noise-free peak at the last base pair over the noise's
standard deviation there, in each of ten samples per full width at half maximum of the pulse.
Thermal noise is the chain's own.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from functools import partial

import numpy as np
from estimator_draws import (
    Outcome,
    coupled_waveform,
    equilibrium,
    flight,
    joint_waveform,
    modal,
    model_class,
    null,
    pick,
    plane_waveform,
    resonance,
    thermal_spectrum,
    truths,
    waveform,
)

DRAWS, PROCESSES = 200, 2


@dataclass(frozen=True)
class Case:
    """Rows of a table: their labels, and one draw of each."""

    draw: Callable[[np.random.Generator], Outcome | list[Outcome]]
    labels: tuple[str, ...]


def one(case: Case, seed: Sequence[int]) -> list[Outcome]:
    found = case.draw(np.random.default_rng(seed))
    return found if isinstance(found, list) else [found]


def speed_cases() -> list[Case]:
    conditions = [(10.0, "white"), (3.0, "white"), (10.0, "thermal"), (3.0, "thermal")]
    cases = [
        Case(partial(waveform, snr, kind), (f"waveform, {kind}, SNR {snr:g}",))
        for snr, kind in [
            *conditions,
            (1.0, "thermal"),
            (3.0, "thermal, from quiet data"),
            (10.0, "memory of 2 samples, not told"),
            (10.0, "thermal, not told"),
        ]
    ]
    cases += [
        Case(partial(modal, snr, kind), (f"modes 1-6, {kind}, SNR {snr:g}",))
        for snr, kind in [*conditions, (1.0, "thermal")]
    ]
    cases += [
        Case(
            partial(pick, estimator, snr, "thermal"),
            (f"{estimator}, " + ("no noise" if snr > 1e5 else f"thermal, SNR {snr:g}"),),
        )
        for estimator in ("correlation", "first peak", "66.3 % of it", "10 % of it")
        for snr in (1e6, 10.0, 3.0, 1.0)
    ]
    cases += [
        Case(
            partial(coupled_waveform, snr),
            tuple(
                f"coupled waveform, {name}, white, SNR {snr:g}"
                for name in ("extension", "twist", "coupling")
            ),
        )
        for snr in (10.0, 3.0)
    ]
    stiffnesses = ("shear stiffness", "bend stiffness")
    return [
        *cases,
        Case(
            partial(plane_waveform, 10.0),
            tuple(f"plane waveform, {name}, white, SNR 10" for name in stiffnesses),
        ),
        Case(
            partial(joint_waveform, 10.0),
            tuple(
                f"joint waveform of three scenes, six coordinates, {name}, white, 10"
                for name in ("stretch", "twist", "bend", "coupling")
            ),
        ),
        Case(thermal_spectrum, ("Whittle, 1 ns, modes 1-4",)),
        Case(resonance, ("resonance curve, frequency",)),
        Case(flight, ("flight against length",)),
        Case(equilibrium, ("answer from equilibrium, 2 ns",)),
    ]


def class_cases() -> list[Case]:
    return [
        Case(partial(model_class, truth, snr, "white"), (f"{truth}, SNR {snr:g}",))
        for truth in truths()
        for snr in (10.0, 3.0)
    ]


def null_cases() -> list[Case]:
    kinds = ("white", "thermal", "thermal, from quiet data")
    return [Case(partial(null, kind), (kind,)) for kind in kinds]


def run(
    case: Case, draws: int, pool: ProcessPoolExecutor | None = None
) -> dict[str, list[Outcome]]:
    """Return the outcomes by label; a draw's random numbers depend on its number alone."""
    seeds = [[number, sum(map(ord, case.labels[0]))] for number in range(draws)]
    work = partial(one, case)
    found = list(map(work, seeds) if pool is None else pool.map(work, seeds, chunksize=5))
    return {label: [each[i] for each in found] for i, label in enumerate(case.labels)}


def share(values: Sequence[bool | None]) -> str:
    known = [value for value in values if value is not None]
    return f"{100 * np.mean(known):.1f}" if known else ""


def row(label: str, outcomes: Sequence[Outcome]) -> str:
    errors = 100 * np.array([o.error for o in outcomes])
    flags = f"{share([o.covered for o in outcomes])} | {share([o.wrong for o in outcomes])}"
    if np.mean(~(np.abs(errors) < 50)) > 0.1:
        return f"| {label} | fails | | | {flags} |"
    good = errors[np.isfinite(errors)]
    if len(good) < len(errors):
        label += f" ({len(errors) - len(good)} of {len(errors)} draws give none)"
    low, middle, high = np.quantile(good, [0.16, 0.5, 0.84])
    return (
        f"| {label} | {middle:+.2f} ± {(high - low) / 2:.2f} | {good.mean():+.2f} "
        f"| {good.std():.2f} | {flags} |"
    )


def main() -> None:
    draws, processes = (
        int(sys.argv[place]) if len(sys.argv) > place else default
        for place, default in ((1, DRAWS), (2, PROCESSES))
    )
    with ProcessPoolExecutor(processes) as pool:
        print(f"Errors in %, {draws} draws. Flagged: as of the wrong model class.\n")
        print("| estimator | median ± half 16-84 % | mean | sd | coverage % | flagged % |")
        print("|---|---|---|---|---|---|")
        for case in speed_cases():
            for label, outcomes in run(case, draws, pool).items():
                print(row(label, outcomes), flush=True)
        print("\nTruths fitted with the uniform lattice, white noise of known strength.\n")
        print("| truth | flagged % | speed off by % |")
        print("|---|---|---|")
        for case in class_cases():
            for label, outcomes in run(case, draws, pool).items():
                error = 100 * np.mean([o.error for o in outcomes])
                flagged = share([o.wrong for o in outcomes])
                print(f"| {label} | {flagged} | {error:+.2f} |", flush=True)
        print("\nNothing but noise, at a nominal 5 %.\n")
        print("| noise | false alarms |")
        print("|---|---|")
        for case in null_cases():
            for label, outcomes in run(case, draws, pool).items():
                alarms = sum(bool(o.wrong) for o in outcomes)
                print(f"| {label} | {alarms} of {draws} |", flush=True)


if __name__ == "__main__":
    main()
