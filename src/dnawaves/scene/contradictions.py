"""Effects that cannot both be part of one scene."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Literal

Solvent = Literal["none", "OBC2", "GBn2", "OPC", "TIP3P"]
IMPLICIT, EXPLICIT = ("OBC2", "GBn2"), ("OPC", "TIP3P")


@dataclass(frozen=True)
class Contradiction:
    """Two declared effects, each with its value, and why they exclude each other."""

    first: str
    second: str
    why: str

    def __str__(self) -> str:
        """Return one sentence that names both."""
        return f"{self.first} contradicts {self.second}: {self.why}"


def contradictions(
    *,
    solvent: Solvent = "none",
    counterion_fraction: float = 0.0,
    salt_M: float = 0.0,
    surface_area: bool = False,
    cutoff_nm: float | None = None,
    switch_nm: float | None = None,
    barostat: bool = False,
    thermostat: bool = False,
    conserves_energy: bool = False,
    constraints: Literal["none", "hbonds"] = "none",
    frozen: Iterable[int] = (),
    loaded: Iterable[int] = (),
    heavier: Iterable[int] = (),
    excited: Iterable[int] = (),
    water: bool = False,
    temperature_K: float | None = None,
    relaxation: bool = False,
    equilibration: bool = False,
    harmonic: bool = False,
    static: bool = False,
    replicas: int = 1,
    snapshots: int | None = None,
    periods: float | None = None,
    duration_ps: float | None = None,
) -> list[Contradiction]:
    """Return every pair of effects that contradict each other; none for a sound scene.

    `conserves_energy` says that the scene measures at constant energy (NVE); `frozen`, `loaded`,
    `heavier` and `excited` are the base pairs that cannot move, bear a static load, carry added
    mass, are kicked or driven. A `temperature_K` of None is not known yet.
    """
    explicit, implicit = solvent in EXPLICIT, solvent in IMPLICIT
    stuck = sorted(frozenset(frozen))
    ends = f"frozen base pairs {_listed(stuck)}"
    heavy = sorted(frozenset(heavier))
    pushed, burdened, kicked = (
        sorted(frozenset(chosen) & {*stuck}) for chosen in (loaded, heavy, excited)
    )
    condensed = f"counterion_fraction {counterion_fraction:g}"
    cold, warm = temperature_K == 0, bool(temperature_K)
    heat = f"temperature_K {temperature_K or 0:g}"
    table = (
        (
            cold and (explicit or solvent == "GBn2"),
            f"solvent {solvent}",
            heat,
            "no minimum of it can be found to the tolerance",
        ),
        (
            cold and constraints != "none",
            f"constraints {constraints}",
            heat,
            "the minimum and its normal modes are those of free bonds",
        ),
        (
            cold and equilibration,
            "equilibration",
            heat,
            "there scenes start from the relaxed minimum",
        ),
        (
            cold and thermostat,
            "thermostat",
            heat,
            "there both signs conserve the energy that is put in",
        ),
        (
            cold and replicas > 1,
            f"replicas {replicas}",
            heat,
            "there is one minimum to start from",
        ),
        (
            warm and relaxation,
            "relaxation",
            heat,
            "there scenes start from equilibrated snapshots",
        ),
        (
            warm and harmonic,
            "method harmonic",
            heat,
            "normal modes are those of a minimum",
        ),
        (
            warm and static,
            "kind static",
            heat,
            "the answer to a load is a minimum under it",
        ),
        (
            snapshots is not None and replicas > snapshots,
            f"replicas {replicas}",
            f"equilibration.snapshots {snapshots}",
            "each replica starts from a snapshot of its own",
        ),
        (
            water and not explicit,
            "water",
            f"solvent {solvent}",
            "there is no box of water",
        ),
        (
            counterion_fraction > 0 and explicit,
            condensed,
            f"solvent {solvent}",
            "the explicit ions already neutralise the phosphates",
        ),
        (
            counterion_fraction > 0 and implicit,
            condensed,
            f"solvent {solvent}",
            "the model was fitted to screen the phosphates' full charges",
        ),
        (
            salt_M > 0 and solvent == "none",
            f"salt_M {salt_M:g}",
            "solvent none",
            "there is nothing that the salt is dissolved in",
        ),
        (
            surface_area and not implicit,
            "surface_area",
            f"solvent {solvent}",
            "the term stands for the surface towards an implicit solvent",
        ),
        *(
            (
                length_nm is not None and implicit,
                f"{name} {length_nm or 0:g}",
                f"solvent {solvent}",
                "the model takes every atom to see every other",
            )
            for name, length_nm in (("cutoff_nm", cutoff_nm), ("switch_nm", switch_nm))
        ),
        (
            barostat and not explicit,
            "barostat",
            f"solvent {solvent}",
            "there is no box whose volume could change",
        ),
        (
            barostat and not (thermostat or equilibration),
            "barostat",
            "no thermostat",
            "its moves are drawn at a temperature that nothing keeps",
        ),
        (
            barostat and bool(stuck),
            "barostat",
            ends,
            "it moves whole molecules, atoms without mass included",
        ),
        (
            thermostat and conserves_energy,
            "thermostat",
            "a scene at constant energy",
            "it takes out and puts in energy at every step",
        ),
        (
            barostat and conserves_energy,
            "barostat",
            "a scene at constant energy",
            "it takes out and puts in energy with the volume",
        ),
        (
            constraints != "none" and bool(stuck),
            f"constraints {constraints}",
            ends,
            "a constraint that touches an atom without mass cannot be satisfied",
        ),
        (
            bool(pushed),
            f"a static load on base pairs {_listed(pushed)}",
            ends,
            "what cannot move does not feel a load",
        ),
        (
            bool(burdened),
            f"added mass on base pairs {_listed(burdened)}",
            ends,
            "what cannot move does not feel its mass",
        ),
        (
            bool(kicked),
            f"an excitation of base pairs {_listed(kicked)}",
            ends,
            "what cannot move cannot be kicked or driven",
        ),
        (
            periods is not None and duration_ps is not None,
            f"excitation.periods {periods or 0:g}",
            f"observation.duration_ps {duration_ps or 0:g}",
            "each of them is the length of the record",
        ),
    )
    return [Contradiction(first, second, why) for found, first, second, why in table if found]


def _listed(pairs: list[int]) -> str:
    return ", ".join(str(pair + 1) for pair in pairs)
