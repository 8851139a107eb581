"""The scenes of a configuration as a table to read."""

from __future__ import annotations

from collections.abc import Mapping

from dnawaves.scene.models import SceneSpec

HEADER = ("scene", "duplex", "bp", "environment", "ends", "excitation", "method", "runs")


def scene_table(scenes: Mapping[str, SceneSpec]) -> str:
    """Return one aligned line for each scene below a header."""
    rows = [HEADER, *map(_row, scenes.values())]
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    return "\n".join(
        "  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip()
        for row in rows
    )


def _row(scene: SceneSpec) -> tuple[str, ...]:
    excitation, system = scene.excitation, scene.system
    wave = getattr(excitation, "wave", None)
    return (
        scene.name,
        system.duplex.name,
        str(len(system.duplex.sequence)),
        system.environment_name,
        f"{scene.ends.first}-{scene.ends.last}",
        f"{excitation.kind} {wave}" if wave else excitation.kind,
        scene.method,
        " ".join(scene.members),
    )
