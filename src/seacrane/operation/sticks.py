"""Recorded joysticks: what an operator did, to be done again."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass
from importlib import resources
from pathlib import Path

import numpy as np

from seacrane.errors import ParameterError, Problem, nearest
from seacrane.results import Recording

RECORDED = ("slew", "boom", "jib", "hoist")
"""The axes of a recording, which are those of a knuckle boom crane."""

COLUMNS = (*RECORDED, "deadman")


@dataclass(frozen=True)
class Sticks:
    """Stick positions in [-1, 1] over time [s], joined by straight lines; after its end it begins again."""

    recording: Recording

    def __post_init__(self) -> None:
        problems = [
            Problem(name, "is not in the recording", hint=nearest(name, self.recording))
            for name in COLUMNS
            if name not in self.recording
        ]
        problems += [
            Problem(name, "goes beyond its range", float(np.abs(self.recording[name]).max()), "-1 to 1")
            for name in COLUMNS
            if name in self.recording and np.abs(self.recording[name]).max() > 1
        ]
        if problems:
            raise ParameterError(problems)

    @classmethod
    def shipped(cls, name: str) -> Sticks:
        """A recording that comes with the package, such as `manoeuvre` (60 s, all axes of a knuckle boom crane)."""
        folder = resources.files("seacrane.operation") / "recordings"
        known = [Path(entry.name).stem for entry in folder.iterdir()]
        if name not in known:
            raise ParameterError.at(name, "there is no such recording", hint=nearest(name, known))
        with resources.as_file(folder / f"{name}.csv") as path:
            return cls(Recording.read_csv(path))

    @property
    def length(self) -> float:
        """How long the recording is [s]."""
        return float(self.recording.time[-1])

    def at(self, time: float) -> tuple[dict[str, float], bool]:
        """The axes and whether the dead man's switch is held, `time` [s] after the beginning."""
        t = time % self.length
        axes = {name: float(np.interp(t, self.recording.time, self.recording[name])) for name in RECORDED}
        return axes, bool(np.interp(t, self.recording.time, self.recording["deadman"]) >= 0.5)


def played(axes: Sequence[str]) -> dict[str, str]:
    """For each axis of a crane that of a recording which drives it: of the same name, or else boom and jib in turn."""
    others = itertools.cycle([name for name in ("boom", "jib") if name not in axes] or ["boom", "jib"])
    return {name: name if name in RECORDED else next(others) for name in axes}
