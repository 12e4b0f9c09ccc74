"""What the tests of our exports share: their names, and what moves them."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from seacrane.fmi.export import Version
from seacrane.model import Dae

MODELS = ("slew_drive", "boom_drive", "jib_drive", "winch_drive", "crane", "example")

Exported = Callable[[str, Version], Path]


def excitation(dae: Dae, share: NDArray[np.float64]) -> dict[str, NDArray[np.float64]]:
    """Values over time for each input that moves something: `share` of a command, or of a small change of a load."""
    full = {"spool": 0.3, "speed": 0.02, "rod_velocity": 0.02, "slew.torque": 2e5}
    moved = {}
    for v in dae.inputs:
        if v.name in full:
            moved[v.name] = v.start + full[v.name] * share
        elif v.unit in ("N", "N.m"):
            moved[v.name] = v.start * (1.0 + 0.02 * share)
    return moved
