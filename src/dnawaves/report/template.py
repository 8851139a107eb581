"""The templates of the pages, and what turns them into HTML."""

from __future__ import annotations

from itertools import count
from typing import Any

import jinja2
from plotly.offline import get_plotlyjs

from dnawaves.report.legend import legend
from dnawaves.report.style import Illustration


def fill(name: str, **content: Any) -> str:
    """Return a template of the folder `templates`, filled; no name may be left undefined."""
    environment = jinja2.Environment(
        loader=jinja2.PackageLoader("dnawaves.report"),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    return environment.get_template(name).render(content)


def fill_with_figures(name: str, **content: Any) -> str:
    """Return a filled template whose figures are drawn without a network."""
    numbers = count(1)
    return fill(
        name,
        # Two figures must not share an identifier.
        next_number=lambda: next(numbers),
        figure_json=_figure_json,
        legend=legend,
        plotly_js=get_plotlyjs(),
        **content,
    )


def _figure_json(illustration: Illustration) -> str:
    # A "</script>" inside would end the script.
    return str(illustration.figure.to_json()).replace("<", "\\u003c")
