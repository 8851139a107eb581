"""The rules of the suite call commands that exist, one for each case."""

from __future__ import annotations

import re
from pathlib import Path

from typer.testing import CliRunner

from dnawaves.cli import app
from dnawaves.stability.case import cases
from dnawaves.stability.table import read_table

RULES = Path(__file__).resolve().parents[2] / "workflow/rules/stability.smk"


def test_the_rules_commands_make_rows_and_the_table(tmp_path: Path) -> None:
    called = re.findall(r'"dnawaves stability (\w+) ', RULES.read_text(encoding="utf-8"))
    assert called == ["case", "table"]
    runner, row = CliRunner(), tmp_path / "row.json"
    one = runner.invoke(app, ["stability", "case", "rod_of_1", "--output", str(row)])
    assert one.exit_code == 0, one.output
    table, page = tmp_path / "table.csv", tmp_path / "report.html"
    both = ["--output", str(table), "--page", str(page)]
    gathered = runner.invoke(app, ["stability", "table", str(row), *both])
    assert gathered.exit_code == 0, gathered.output
    assert [row.case for row in read_table(table)] == ["rod_of_1"]
    assert "rod of 1" in page.read_text(encoding="utf-8")


def test_the_list_holds_every_case() -> None:
    listed = CliRunner().invoke(app, ["stability", "list"]).output
    assert [line.split()[0] for line in listed.splitlines()] == list(cases())
