"""How far a valve opens: the corners of every law are rounded over 1 % of full opening."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from seacrane.errors import Problem
from seacrane.numerics.regularise import smooth_limit
from seacrane.units import bar

ROUNDING = 0.01
"""Share of full opening over which corners are rounded: an opening is off by a quarter of it there."""


def opening(pressure: Any, crack: Any, full: Any) -> Any:
    """Fraction of full area: rises from 0 at `crack` to 1 at `full` with the pressure that lifts the poppet."""
    return smooth_limit((pressure - crack) / (full - crack), 0.0, 1.0, ROUNDING)


def rising(crack: tuple[str, float], full: tuple[str, float]) -> Iterator[Problem]:
    """What is wrong with a pair of pressures, given by name, of which the second must be the higher."""
    if crack[1] >= full[1]:
        what = f"must be above {crack[0]} = {crack[1] / bar:g} bar"
        yield Problem(full[0], f"{full[1] / bar:g} bar {what}")
