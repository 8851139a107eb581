"""A long run tells a log how far it is, in plain lines."""

from __future__ import annotations

import re
from itertools import chain, repeat
from types import SimpleNamespace

import pytest

from dnawaves.trajectory import progress as progress_module
from dnawaves.trajectory.progress import progress


def test_a_log_gets_ten_plain_lines(capsys: pytest.CaptureFixture[str]) -> None:
    with progress("scene x1", 20.0) as advance:
        for frame in range(1, 201):
            advance(0.1 * frame)
    lines = capsys.readouterr().err.splitlines()
    assert len(lines) == 10
    pattern = re.compile(r"scene x1: \d+\.\d of 20\.0 ps, \d+\.\d ns/day, \d+ s left")
    for line in lines:
        assert pattern.fullmatch(line)
    assert lines[-1].startswith("scene x1: 20.0 of 20.0 ps")
    assert lines[-1].endswith(" 0 s left")


def test_what_was_simulated_before_is_no_part_of_the_speed(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    clock_s = chain([5.0], repeat(15.0))
    monkeypatch.setattr(progress_module, "time", SimpleNamespace(monotonic=clock_s.__next__))
    with progress("scene x1", 20.0, done_ps=10.0) as advance:
        advance(12.0)
    (line,) = capsys.readouterr().err.splitlines()
    # 2 ps in 10 s; with the 10 ps from before it would be six times that. 8 ps take 40 s more.
    assert line == f"scene x1: 12.0 of 20.0 ps, {2e-3 / 10 * 86_400:.1f} ns/day, 40 s left"
