"""The page on estimators: its example runs and prints what the page says."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

PAGE = Path(__file__).resolve().parents[2] / "docs" / "estimators.md"


def test_example_prints_what_the_page_says(capsys: pytest.CaptureFixture[str]) -> None:
    text = PAGE.read_text()
    code, output = re.findall(r"```(?:python)?\n(.*?)```", text, flags=re.S)[:2]
    exec(compile(code, str(PAGE), "exec"), {})
    assert capsys.readouterr().out == output
