"""The page of a study of accuracy: figures, fronts and what each effect saves and loses."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import pandas as pd

from dnawaves.accuracy.effects import effects
from dnawaves.accuracy.figures import drawn, mark, marks, work_precision
from dnawaves.accuracy.front import SAME_COST, order
from dnawaves.accuracy.match import shipped
from dnawaves.accuracy.table import MEASURES, read_csv, succeeded
from dnawaves.files import write_text
from dnawaves.report.numbers import BLANK, digits, percent
from dnawaves.report.style import Illustration, blank_figure
from dnawaves.report.tables import Table
from dnawaves.report.template import fill_with_figures
from dnawaves.scene.load import load_scenes
from dnawaves.scene.models import SceneSpec

TITLE = "What accuracy costs in time"
COST = "time, in parts of the default setting's"
WORDS = {"speed": "fitted speed", "waveform": "worst waveform", "helical": "helical parameters"}
# Settings that cost or err so little more than they need count as near enough to the front.
WITHIN = 2 * SAME_COST
NO_COSTS = pd.DataFrame({"system": [], "effect": [], "ms_saved": [], "ms_per_step_whole": []})


def accuracy_page_step(
    settings: Path, models: Path, costs: Sequence[Path], config: Path, output: Path
) -> None:
    """Write the study's page, with the settings of a configuration's scenes marked.

    `costs` are the tables of what each effect costs per step, the study's own system first.
    """
    per_step = pd.concat([NO_COSTS, *(pd.read_csv(path) for path in costs)])
    page = render(read_csv(settings), read_csv(models), per_step, load_scenes(config))
    write_text(output, page)


def illustrations(settings: pd.DataFrame, scenes: dict[str, SceneSpec]) -> list[Illustration]:
    """Return the study's figures, for this page and for the main report."""
    usual = settings.loc[settings["is_default"].astype(bool), "usual_case"]
    main = usual.iloc[0] if len(usual) else settings["usual_case"].iloc[0]
    names = [name for name in shipped(settings, scenes)["setting"] if name]
    names += list(settings.loc[settings["is_default"].astype(bool), "setting"])
    own = settings[(settings["usual_case"] == main) & settings["replicas"].isna()]
    others = settings[settings["case"] == settings["usual_case"]]
    others = others[others["declarable"].astype(bool) & others["replicas"].isna()]
    looks, shown = marks(settings), []

    def add(title: str, rows: pd.DataFrame, column: str, caption: str, front: str = "") -> None:
        if drawn(rows, column).empty:
            return
        figure = blank_figure(COST, "error (%)", 460)
        work_precision(figure, rows, column, looks, front or None)
        shown.append(Illustration(title, mark(figure, rows, column, names), caption))

    for name in MEASURES:
        add(
            f"Integration alone: {WORDS[name]}",
            own,
            f"{name}_integration_error",
            "Error against the same kick at no timestep. A second-order method falls along the "
            "dashed line: half the timestep, twice the time, a quarter of the error.",
        )
    for name in MEASURES:
        add(
            f"All in: {WORDS[name]}",
            own[own["case"] == main],
            f"{name}_error",
            "Error against the linear answer: timestep, rounding and the kick's own size together. "
            "The dotted line joins the settings that no other beats."
            + (" This error changes sign: where it vanishes is chance." if name == "speed" else ""),
            f"front_{name}",
        )
    add(
        "Every kind of shipped scene",
        others,
        "waveform_error",
        "The worst base pair's waveform, timestep and size of the kick varied. Diamonds are what "
        "the shipped scenes do.",
    )
    add(
        "Averaging thermal runs",
        settings[settings["replicas"].notna()],
        "waveform_error",
        "Single runs of the linearised duplex in equilibrium, averaged: the error falls as one "
        "over the root of their number.",
    )
    return shown


def fronts_table(settings: pd.DataFrame, scenes: dict[str, SceneSpec]) -> Table:
    """Return each scene's own setting, its errors, and how far it is from the Pareto front."""
    rows = []
    for _, one in shipped(settings, scenes).iterrows():
        if not one["setting"]:
            rows.append([one["scene"], one["reason"], *[BLANK] * (2 * len(MEASURES))])
            continue
        row = settings[settings["setting"] == one["setting"]].iloc[0]
        cells = [
            text
            for name in MEASURES
            for text in (percent(row[f"{name}_error"]), excess_words(row[f"excess_{name}"]))
        ]
        rows.append([one["scene"], str(one["setting"]), *cells])
    header = ["scene", "setting"]
    header += [text for name in MEASURES for text in (f"{WORDS[name]}, error", "from the front")]
    return Table(header, rows)


def excess_words(excess: float) -> str:
    """Return how far a setting is from the front in words."""
    if pd.isna(excess):
        return BLANK
    if excess <= 0:
        return "on it"
    return f"{digits(1 + excess, 2)} ×" + ("" if excess <= WITHIN else ", beaten")


def orders_table(settings: pd.DataFrame) -> Table:
    """Return the measured order of each line that should be of second order."""
    rows = []
    for title, line in settings[settings["slope"] == "timestep"].groupby("title", sort=False):
        cells = []
        for name in MEASURES:
            known = drawn(line, f"{name}_integration_error")
            enough = known["timestep_fs"].nunique() > 1
            cells.append(
                digits(order(known["timestep_fs"], known[f"{name}_integration_error"]), 2)
                if enough
                else BLANK
            )
        if any(cell != BLANK for cell in cells):
            rows.append([str(title), *cells])
    return Table(["line", *(WORDS[name] for name in MEASURES)], rows)


def effects_table(settings: pd.DataFrame, models: pd.DataFrame, costs: pd.DataFrame) -> Table:
    """Return what each effect saves and loses, as text."""
    return Table(
        ["effect", "setting", "time", "per step", "speed", "waveform", "helical", "note"],
        [
            [
                one.effect,
                one.setting,
                digits(one.cost, 2),
                one.per_step,
                percent(one.speed),
                percent(one.waveform),
                percent(one.helical),
                one.note,
            ]
            for one in effects(settings, models, costs)
        ],
    )


def settings_table(settings: pd.DataFrame) -> Table:
    """Return every setting with its errors and its time, or why it has none."""
    rows = []
    for _, row in settings.iterrows():
        cells = [percent(row[f"{name}_error"]) for name in MEASURES]
        cells += [percent(row[f"{name}_integration_error"]) for name in MEASURES]
        cells += [digits(row["relative_cost"], 2), digits(row["cpu_s"], 2), row["status"]]
        rows.append([str(row["setting"]), str(row["case"]), *cells])
    header = ["setting", "case", *MEASURES, *(f"{name}, integration" for name in MEASURES)]
    return Table([*header, "time", "processor s", "status"], rows)


def machine(settings: pd.DataFrame) -> str:
    """Return in words where the times were measured."""
    found = settings[["processor", "cores", "threads", "openmm"]].drop_duplicates()
    return "; ".join(
        f"{row['processor']} with {row['cores']} cores, {row['threads']} thread, "
        f"OpenMM {row['openmm']}"
        for _, row in found.iterrows()
    )


def render(
    settings: pd.DataFrame,
    models: pd.DataFrame,
    costs: pd.DataFrame,
    scenes: dict[str, SceneSpec],
) -> str:
    """Return the page as HTML that opens without a network."""
    return fill_with_figures(
        "accuracy.html.j2",
        title=TITLE,
        illustrations=illustrations(settings, scenes),
        count=len(settings),
        ran=len(succeeded(settings)),
        machine=machine(settings),
        tables={
            "Shipped scenes and the front": fronts_table(settings, scenes),
            "Measured order in the timestep": orders_table(settings),
            "What you save, what you lose": effects_table(settings, models, costs),
            "All settings": settings_table(settings),
        },
    )
