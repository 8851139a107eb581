"""The command line: each command parses its arguments and calls one function of the library.

Imports of the library stand inside the commands: `dnawaves --help` and the small steps must not
pay for OpenMM.
"""

from __future__ import annotations

import sys

# The order of these imports is that of the commands in `dnawaves --help`.
from dnawaves.cli import scenes, systems, waves
from dnawaves.cli.accuracy import app as accuracy_app
from dnawaves.cli.arguments import app
from dnawaves.cli.stability import app as stability_app
from dnawaves.errors import InputError, SimulationError

__all__ = ["app", "main", "scenes", "systems", "waves"]

app.add_typer(accuracy_app, name="accuracy")
app.add_typer(stability_app, name="stability")


def main() -> None:
    """Run the command line; what a user can act on is one message, not a traceback."""
    try:
        app()
    except InputError as error:
        _fail(error, 2)
    except SimulationError as error:
        _fail(error, 1)


def _fail(error: Exception, code: int) -> None:
    print(f"dnawaves: {error}", file=sys.stderr)
    sys.exit(code)
