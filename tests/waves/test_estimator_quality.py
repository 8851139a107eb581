"""The small version of benchmarks/estimators.py: bias, coverage, flags and false alarms."""

from __future__ import annotations

import importlib
import sys
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
from scipy import stats

DRAWS = 25


@pytest.fixture(scope="module")
def benchmark() -> Iterator[ModuleType]:
    folder = str(Path(__file__).resolve().parents[2] / "benchmarks")
    sys.path.insert(0, folder)
    yield importlib.import_module("estimators")
    sys.path.remove(folder)


def few(share: float, draws: int = DRAWS) -> int:
    """Return the number of events of a probability that is passed once in 10,000 tests."""
    return int(stats.binom.isf(1e-4, draws, share))


@pytest.mark.parametrize(
    ("snr", "kind", "spread"),
    # Spreads of single draws, from 200: the mean of 25 lies within four of its standard errors,
    # which in every row is inside the 0.5 % and 1 % that are asked for at SNR 10 and 3.
    [
        (10.0, "white", 0.06e-2),
        (3.0, "white", 0.2e-2),
        (10.0, "thermal", 0.32e-2),
        (3.0, "thermal", 1.2e-2),
    ],
)
def test_full_waveform_fit(benchmark: ModuleType, snr: float, kind: str, spread: float) -> None:
    case = benchmark.Case(lambda rng: benchmark.waveform(snr, kind, rng), (f"{kind} {snr}",))
    outcomes = benchmark.run(case, DRAWS)[f"{kind} {snr}"]
    bias = np.mean([outcome.error for outcome in outcomes])
    assert abs(bias) < 4 * spread / np.sqrt(DRAWS)
    assert sum(not outcome.covered for outcome in outcomes) <= few(0.05)
    assert sum(outcome.wrong for outcome in outcomes) <= few(0.05)


def test_misfit_flags_what_lies_outside_the_model_class(benchmark: ModuleType) -> None:
    others = list(benchmark.truths())[1:]
    assert len(others) == 3
    for truth in others:
        case = benchmark.Case(
            lambda rng, truth=truth: benchmark.model_class(truth, 10.0, "white", rng), (truth,)
        )
        assert all(outcome.wrong for outcome in benchmark.run(case, 5)[truth])


@pytest.mark.parametrize("kind", ["white", "thermal"])
def test_noise_alone_is_no_wave(benchmark: ModuleType, kind: str) -> None:
    case = benchmark.Case(lambda rng: benchmark.null(kind, rng), (kind,))
    alarms = sum(outcome.wrong for outcome in benchmark.run(case, 200)[kind])
    # A nominal 5 % of 200 is 10; 17 are allowed.
    assert alarms <= 17


def test_a_weak_wave_is_one(benchmark: ModuleType) -> None:
    draws = sys.modules[benchmark.waveform.__module__]
    truth = draws.scene()[1]
    rng = np.random.default_rng(11)
    record = truth + np.abs(truth[:, -1]).max() * rng.standard_normal(truth.shape)
    # SNR 1 at one sample of one pair, but thousands of them.
    assert draws.detector("white")(record).p_value <= 0.01


def test_picks_have_the_biases_of_a_lattice(benchmark: ModuleType) -> None:
    rng = np.random.default_rng(12)
    errors = {
        name: benchmark.pick(name, 1e6, "white", rng).error
        for name in ("correlation", "first peak", "66.3 % of it", "10 % of it")
    }
    # a^2/(16 s^2 V^2) = 5.1 %; friction and ends, which have no part in it, add to that.
    assert errors["correlation"] == pytest.approx(-0.051, abs=0.01)
    assert errors["first peak"] < -0.03
    assert abs(errors["66.3 % of it"]) < 0.01
    assert errors["10 % of it"] > 0.1
