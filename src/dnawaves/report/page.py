"""The page: all parts of the report put together, with everything that it needs inside."""

from __future__ import annotations

from collections.abc import Iterable
from importlib.metadata import version

import xarray as xr
import yaml

from dnawaves.comparison.compare import ONE
from dnawaves.comparison.groups import groups
from dnawaves.comparison.judge import CONFIDENCE
from dnawaves.report.answers import answers, false_alarms, main_system
from dnawaves.report.costs import (
    NOT_RECORDED,
    costs_figure,
    costs_table,
    effects_table,
    jobs_table,
)
from dnawaves.report.derived import attenuation, coupling, diffusion
from dnawaves.report.dispersion import dispersion_figure, standing_points
from dnawaves.report.gather import Results
from dnawaves.report.molecule import segments_figure, structure_factor_figure, twins_table
from dnawaves.report.numbers import BLANK, counted, digits
from dnawaves.report.routes import constants_table, wave_routes
from dnawaves.report.scene_section import SceneSection, scene_section
from dnawaves.report.speeds import speeds_figure
from dnawaves.report.structure import B_FORM, STEP_PARAMETERS, step_profile, structure_table
from dnawaves.report.studies import studies
from dnawaves.report.style import Illustration
from dnawaves.report.tables import VERDICT_HEADER, spreads, verdicts
from dnawaves.report.template import fill_with_figures
from dnawaves.report.theory import errata_table, paper_dispersion
from dnawaves.report.trends import by_sequence, by_temperature, lag_distance
from dnawaves.waves.record import AXIAL_WAVES

TITLE = "Does DNA carry waves as the elastic rod says?"


def render(results: Results) -> str:
    """Return the report as HTML that opens without a network."""
    return fill_with_figures(
        "report.html.j2",
        title=TITLE,
        answers=answers(results),
        confidence=f"{100 * CONFIDENCE:g} %",
        routes=wave_routes(results),
        spreads=spreads(results.table),
        systems=results.systems,
        false_alarms=false_alarms(results.table),
        scenes=_scenes(results),
        speeds=_speeds(results),
        verdict_header=VERDICT_HEADER,
        blank=BLANK,
        verdicts=verdicts(results.table[results.table["scope"] == ONE]),
        dispersion=_dispersion(results),
        molecule={name: _molecule(results, name) for name in results.systems},
        twins=twins_table(results),
        derived=_derived(results),
        structures=structure_table(list(results.systems.values())),
        profiles={name: _profiles(system.structure) for name, system in results.systems.items()},
        errata=errata_table(),
        paper_dispersion=paper_dispersion(results.table),
        costs=_costs(results),
        effects=effects_table({name: its.costs for name, its in results.systems.items()}),
        studies=studies(
            results.folder, {name: scene.spec for name, scene in results.scenes.items()}
        ),
        versions=_versions(results),
        configuration=_configuration(results),
        config_name=results.config.name,
        outside=OUTSIDE,
    )


# Measured sound in DNA, Å/ps: aligned films of 40 % calf-thymus DNA (Liu et al. 2005, J. Chem.
# Phys. 123, doi 10.1063/1.2128702).
OUTSIDE = {"Brillouin light scattering": 18.0, "inelastic X-ray scattering": 31.0}


def _speeds(results: Results) -> list[Illustration]:
    if results.table["speed_A_per_ps"].isna().all():
        return []
    return [
        Illustration(
            "All speeds at a glance",
            speeds_figure(results.table),
            "Each dot is an estimate with the range over its fits; the black tick is what the "
            "paper's rod gives for the same thing. Estimates of one wave should lie above each "
            "other. Standing bends and shears are in the dispersion figure.",
        )
    ]


def _dispersion(results: Results) -> list[Illustration]:
    shown = []
    for name in results.systems:
        table = results.single(name)
        if len(standing_points(table)):
            shown.append(
                Illustration(
                    f"Dispersion, {name}",
                    dispersion_figure(table, results.spacing_A(name)),
                    "Frequency of each standing wave over its wavenumber. Dashed: branches of the "
                    "paper's rod as a chain of base pairs. Solid: the chain whose speed is that of "
                    "the lowest standing wave; a uniform rod would carry the higher ones on the "
                    "same line. Bend is the lower, shear the upper of two mixed branches.",
                )
            )
    return shown


def _molecule(results: Results, name: str) -> dict[str, object]:
    system = results.systems[name]
    figures = []
    if system.segments is not None:
        figures.append(segments_figure(system.segments, results.single(name)))
    if system.structure_factor is not None:
        figures += [
            structure_factor_figure(system.structure_factor, wave, results.spacing_A(name))
            for wave in AXIAL_WAVES
        ]
    return {"constants": constants_table(results, system), "figures": figures}


def _derived(results: Results) -> list[Illustration | str]:
    """Return what follows from speeds and frictions: figures, or a line where there is no data."""
    system = main_system(results)
    found = (
        attenuation(results, system),
        diffusion(results, system),
        coupling(system),
        by_sequence(results),
        by_temperature(results),
        lag_distance(results),
    )
    return [line if illustration is None else illustration for illustration, line in found]


def _scenes(results: Results) -> list[SceneSection]:
    first = {
        name: group.scenes[0]
        for group in groups(scene.spec for scene in results.scenes.values())
        for name in group.scenes[1:]
    }
    return [
        scene_section(scene, results.systems[scene.spec.system.name].constants, first.get(name, ""))
        for name, scene in results.scenes.items()
    ]


def _profiles(structure: xr.Dataset) -> list[Illustration]:
    return [
        Illustration(
            name.capitalize(),
            step_profile(structure, name),
            "The band is where the interior mean of B-DNA lies." if name in B_FORM else "",
        )
        for name in STEP_PARAMETERS
    ]


def _costs(results: Results) -> dict[str, object]:
    jobs = results.jobs
    if not jobs:
        return {"note": f"The time and memory of the jobs were {NOT_RECORDED}."}
    known = [job.wall_s for job in jobs if job.wall_s is not None]
    return {
        "note": f"{counted(len(jobs), 'job')} took {digits(sum(known) / 60)} minutes one after the "
        "other; jobs that ran side by side took less. This page's own job is not among them.",
        "figures": [
            Illustration(
                "Where the time went", costs_figure(jobs), "Seconds of each job, one bar per scene."
            )
        ],
        "table": costs_table(jobs),
        "jobs": jobs_table(jobs),
    }


def _versions(results: Results) -> dict[str, str]:
    attributes: Iterable[tuple[str, object]] = (
        pair
        for system in results.systems.values()
        for source in (system.structure.attrs, system.start)
        for pair in source.items()
    )
    found: dict[str, set[str]] = {}
    for name, value in attributes:
        if name.startswith("version_"):
            found.setdefault(name.removeprefix("version_"), set()).add(str(value))
    found.setdefault("plotly", set()).add(version("plotly"))
    return {name: ", ".join(sorted(values)) for name, values in sorted(found.items())}


def _configuration(results: Results) -> str:
    content = {
        "systems": {
            name: system.spec.model_dump(mode="json") for name, system in results.systems.items()
        },
        "scenes": {
            name: {
                "system": scene.spec.system.name,
                **scene.spec.model_dump(mode="json", exclude={"system", "name"}),
            }
            for name, scene in results.scenes.items()
        },
    }
    return yaml.safe_dump(content, sort_keys=False, allow_unicode=True)
