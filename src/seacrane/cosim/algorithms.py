"""Co-simulation algorithms: who steps when, and with whose outputs. Swapping one changes one argument.

Both are explicit with a fixed macro step and of first order in it. Gauss-Seidel gives each slave the newest outputs of
those before it in the order, and is the more accurate and more stable one for the same step. Jacobi gives all slaves
the outputs of the last macro step, so that the order has no influence. (M. Busch, Continuous approximation techniques
for co-simulation methods, ZAMM 96, 2016, section 2.)
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Final, Protocol

from seacrane.errors import CosimError, Problem, nearest

NANOSECONDS = 1_000_000_000


@dataclass(frozen=True)
class Schedule:
    """What a loop needs to know of an algorithm: the macro step, the order, and whether inputs are all transferred
    before anyone steps (`simultaneous`) or each slave's just before it steps."""

    step_ns: int
    order: tuple[str, ...]
    simultaneous: bool


class Algorithm(Protocol):
    """Decides the steps; `step` is the macro step [s]."""

    @property
    def step(self) -> float: ...

    def schedule(self, slaves: Sequence[str]) -> Schedule:
        """The schedule for slaves of these names, given in the order of adding."""


@dataclass(frozen=True)
class GaussSeidel:
    """Slaves step one after the other with the newest outputs, in `order` (that of adding, unless given).

    `step` [s] is the macro step, to the nearest nanosecond.
    """

    step: float
    order: Sequence[str] | None = None

    def __post_init__(self) -> None:
        nanoseconds(self.step, "step")

    def schedule(self, slaves: Sequence[str]) -> Schedule:
        order = tuple(slaves if self.order is None else self.order)
        problems = [
            Problem(f"order.{name}", "no such slave in the system", hint=nearest(name, slaves))
            for name in order
            if name not in slaves
        ]
        problems += [
            Problem(f"order.{name}", "stands in the order twice")
            for name in sorted({n for n in order if order.count(n) > 1})
        ]
        problems += [Problem(f"order.{name}", "is missing in the order") for name in slaves if name not in order]
        if problems:
            raise CosimError(problems)
        return Schedule(nanoseconds(self.step, "step"), order, simultaneous=False)


@dataclass(frozen=True)
class Jacobi:
    """All slaves step with the outputs of the last macro step; `step` [s], to the nearest nanosecond."""

    step: float

    def __post_init__(self) -> None:
        nanoseconds(self.step, "step")

    def schedule(self, slaves: Sequence[str]) -> Schedule:
        return Schedule(nanoseconds(self.step, "step"), tuple(slaves), simultaneous=True)


ALGORITHMS: Final[dict[str, Callable[[float], Algorithm]]] = {"gauss-seidel": GaussSeidel, "jacobi": Jacobi}
"""Algorithms by the names they have on the command line and in files; each is made from a macro step [s]."""


def nanoseconds(seconds: float, path: str) -> int:
    """A positive duration [s] as whole nanoseconds."""
    if not (math.isfinite(seconds) and round(seconds * NANOSECONDS) > 0):
        raise CosimError.at(path, "is not a duration", value=seconds, allowed="1e-9 s or more")
    return round(seconds * NANOSECONDS)
