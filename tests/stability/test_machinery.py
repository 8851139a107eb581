"""Cases are declared with bounds and reasons, judged by them, and gathered into a table."""

from __future__ import annotations

import math
from pathlib import Path

import pytest
from pydantic import ValidationError

from dnawaves.errors import InputError, SimulationError
from dnawaves.report.stability_page import render
from dnawaves.stability import rods
from dnawaves.stability.case import REDUCED_SECONDS, Case, case_named, cases
from dnawaves.stability.judge import judge, stopped
from dnawaves.stability.steps import stability_step, table_step
from dnawaves.stability.table import read_rows, read_table

# What the issue asks for; each group has at least one case.
GROUPS = {
    "Energy drift",
    "Timestep",
    "Forces at a cutoff",
    "Kicks",
    "Drives",
    "Held ends",
    "Duplexes and starts",
    "Frames",
    "Rods",
    "Physical validity",
}


def declared(**changed: object) -> Case:
    return Case.model_validate(
        {
            "group": "Rods",
            "does": "Chains of two base pairs",
            "run": "rods.shortest",
            "expected": "holds",
            "quantity": "largest relative error",
            "bound": [0, 1e-13],
            "reason": "round-off of a square root, times a thousand",
            "seconds": 0.1,
            **changed,
        }
    )


def test_every_case_has_a_bound_a_reason_and_a_function() -> None:
    assert {case.group for case in cases().values()} == GROUPS
    for name, case in cases().items():
        # The name is part of a file's name.
        assert name.isidentifier()
        low, high = case.bound
        assert math.isfinite(low) and math.isfinite(high)
        assert len(case.reason.split()) >= 5
        # YAML takes 1e7, without a sign, for a word.
        words = [value for value in case.settings.values() if isinstance(value, str)]
        assert not any(word[0].isdigit() for word in words)
        module, function = case.run.split(".")
        source = Path(rods.__file__).with_name(f"{module}.py").read_text(encoding="utf-8")
        assert f"\ndef {function}(" in source


def test_the_suite_fits_its_time() -> None:
    seconds = [case.seconds for case in cases().values()]
    # Thirty minutes on two cores, of which each process takes some 3 s to start.
    assert (sum(seconds) + 3 * len(seconds)) / 2 < 30 * 60
    reduced = [case.seconds for case in cases().values() if case.reduced]
    # A minute on two cores.
    assert (sum(reduced) + 3 * len(reduced)) / 2 < 60
    assert len(reduced) > 20
    assert max(reduced) <= REDUCED_SECONDS


@pytest.mark.parametrize(
    "wrong",
    [
        {"bound": [1, 0]},
        {"reason": "so"},
        {"expected": "perhaps"},
        {"run": "rods"},
        {"bound": [0, math.inf]},
    ],
)
def test_a_case_without_a_sound_bound_and_reason_is_refused(wrong: dict[str, object]) -> None:
    with pytest.raises(ValidationError):
        declared(**wrong)


def test_a_case_passes_only_with_the_expected_outcome_and_number() -> None:
    assert judge("one", declared()).verdict == "pass"
    # The frequencies are right to round-off, so an error of 1 is not among what is found.
    outside = judge("one", declared(bound=[1, 2]))
    assert (outside.verdict, outside.found) == ("fail", "holds")
    other = judge("one", declared(expected="refused"))
    assert (other.verdict, other.found) == ("fail", "holds")


def test_an_error_that_is_not_expected_fails_and_says_why() -> None:
    refused = judge("one", declared(run="rods.nearly_singular", settings={"one_less": 1e-16}))
    assert (refused.verdict, refused.found, refused.value) == ("fail", "refused", None)
    assert "not positive definite" in refused.remark


def test_what_the_library_does_not_mean_to_raise_is_a_crash() -> None:
    with pytest.raises(TypeError):
        judge("one", declared(settings={"nonsense": 1}))


def test_stopped_tells_refusals_from_explosions_and_counts_what_is_named() -> None:
    def explode() -> None:
        raise SimulationError("in step 7, atom 3 (A:1 H5)")

    def refuse() -> None:
        raise InputError("timestep: found 9")

    found = stopped(explode, r"step \d+", r"atom \d+", "nothing of the kind")
    assert (found.outcome, found.value) == ("explodes", 2.0)
    assert stopped(refuse, "timestep").outcome == "refused"
    assert stopped(lambda: None, "anything").outcome == "holds"


def test_rows_go_into_a_table_and_a_page_and_a_failure_shows(tmp_path: Path) -> None:
    names = ["rod_of_2", "twist_180", "rod_of_1"]
    for name in names:
        stability_step(name, tmp_path / f"{name}.json")
    rows = read_rows([tmp_path / f"{name}.json" for name in names])
    # In the order of the declaration, not of the files.
    assert [row.case for row in rows] == ["twist_180", "rod_of_2", "rod_of_1"]
    table = tmp_path / "table.csv"
    table_step([tmp_path / f"{name}.json" for name in names], table)
    assert read_table(table) == rows
    page = render(rows)
    assert "3 cases, 3 as expected" in page
    failed = rows[0].model_copy(update={"verdict": "fail", "value": None})
    page = render([failed, *rows[1:]])
    assert 'class="fail"' in page
    assert "2 as expected; not so: twist_180" in page
    # A row without a number, and one with: a dash, and digits.
    assert "–" in page and "http" not in page


def test_an_unknown_case_is_refused_with_the_known_ones() -> None:
    with pytest.raises(InputError, match=r"found 'twist'; allowed: .*twist_180"):
        case_named("twist")
