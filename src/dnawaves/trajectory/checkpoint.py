"""Checkpoints of a run: a folder beside the output from which a killed run goes on.

The folder holds `run.json`, which says of what run it is, and one folder for each checkpoint,
named by its frame: the frames since the one before (`frames.npz`) and, in the last, the state of
each copy as OpenMM's State XML, which other machines read, with the variables of its drive. Each
appears whole or not at all.
"""

from __future__ import annotations

import json
import os
import shutil
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import openmm
from numpy.typing import NDArray

from dnawaves.errors import SimulationError
from dnawaves.files import read_json, write_json
from dnawaves.trajectory.dynamics import Saved

Frames = dict[str, NDArray[Any]]


def checkpoint_folder(output: Path) -> Path:
    """Return the folder of checkpoints that belongs to an output file."""
    return output.with_name(f".{output.stem}.checkpoint")


@dataclass(frozen=True)
class Checkpoint:
    """All frames so far, and the state of each copy at the last of them."""

    frames: Frames
    states: list[Saved]


class Checkpoints:
    """The checkpoints of one run, of which `run` holds all that defines it, as JSON."""

    def __init__(self, folder: Path, run: Mapping[str, Any]) -> None:
        self.folder = folder
        description = folder / "run.json"
        run = json.loads(json.dumps(run))
        found = read_json(description) if description.exists() else {}
        if found != run:
            if found:
                differing = ", ".join(
                    name for name in {**run, **found} if run.get(name) != found.get(name)
                )
                print(
                    f"{folder}: of another run (other {differing}), so removed",
                    file=sys.stderr,
                    flush=True,
                )
            # The description first: a removal that is cut short leaves nothing that looks whole.
            description.unlink(missing_ok=True)
            shutil.rmtree(folder, ignore_errors=True)
            write_json(description, run)

    @property
    def last_good(self) -> Path:
        """Where the last good state of a run that explodes is kept."""
        return self.folder / "last_good.xml"

    def save(self, frame: int, frames: Mapping[str, Any], states: Sequence[Saved]) -> None:
        """Keep the frames since the last checkpoint and the copies' states at frame `frame`."""
        earlier = self._saved()
        partial = self.folder / ".partial"
        shutil.rmtree(partial, ignore_errors=True)
        partial.mkdir()
        np.savez(partial / "frames.npz", **frames)
        for index, saved in enumerate(states):
            text = openmm.XmlSerializer.serialize(saved.state)
            (partial / f"state{index}.xml").write_text(text, encoding="utf-8")
        write_json(partial / "drive.json", {"variables": [saved.variables for saved in states]})
        os.replace(partial, self.folder / f"{frame:09d}")
        for folder in earlier:
            for path in folder.glob("state*.xml"):
                path.unlink()

    def latest(self) -> Checkpoint | None:
        """Return the last checkpoint, or None where there is none yet."""
        saved = self._saved()
        if not saved:
            return None
        parts = [_read(folder / "frames.npz") for folder in saved]
        frames = {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}
        count, expected = len(next(iter(frames.values()))), int(saved[-1].name) + 1
        if count != expected:
            raise SimulationError(
                f"{self.folder}: found {count} frames, expected {expected}; remove the folder"
            )
        variables = read_json(saved[-1] / "drive.json")["variables"]
        texts = [
            (saved[-1] / f"state{index}.xml").read_text("utf-8") for index in range(len(variables))
        ]
        states = [openmm.XmlSerializer.deserialize(text) for text in texts]
        return Checkpoint(frames, [Saved(*pair) for pair in zip(states, variables, strict=True)])

    def _saved(self) -> list[Path]:
        return sorted(path for path in self.folder.iterdir() if path.name.isdigit())


def _read(path: Path) -> Frames:
    with np.load(path) as content:
        return {name: content[name] for name in content.files}
