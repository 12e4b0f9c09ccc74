"""What a system is put together from, as frozen data: connections, transformations, bonds and connectors."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
import numpy.typing as npt

from seacrane.errors import CosimError, Problem
from seacrane.units import UNITS


@dataclass(frozen=True)
class Connection:
    """target = source * gain + bias; both are names in a system.

    The source is converted to the unit of the target first, and the bias is in that unit. With `convert` false the
    numbers are taken as they stand, whatever their units are.
    """

    source: str
    target: str
    gain: float = 1.0
    bias: float = 0.0
    convert: bool = True

    @property
    def terms(self) -> tuple[Connection, ...]:
        """Itself: what a transformation has one of for each pair of signals."""
        return (self,)


@dataclass(frozen=True)
class Transformation:
    """targets = matrix @ sources + bias: a sum of signals, a change of frame, any linear map of several of them.

    `matrix` has a row for each target and a column for each source. Each source is converted to the unit of the target
    first and the bias is in that unit, so sources that a row uses have the dimension of its target. With `convert`
    false the numbers are taken as they stand: so a moment about another point takes a force times an arm.
    """

    sources: tuple[str, ...]
    targets: tuple[str, ...]
    matrix: tuple[tuple[float, ...], ...]
    bias: tuple[float, ...] = ()
    convert: bool = True

    @classmethod
    def of(
        cls,
        sources: Sequence[str],
        targets: Sequence[str],
        matrix: npt.ArrayLike,
        bias: npt.ArrayLike | None = None,
        convert: bool = True,
    ) -> Transformation:
        """The same from arrays; `CosimError` if their shapes do not fit the names."""
        rows = np.asarray(matrix, dtype=float)
        offsets = np.zeros(len(targets)) if bias is None else np.asarray(bias, dtype=float)
        problems = []
        name = ", ".join(targets)
        if rows.shape != (len(targets), len(sources)):
            allowed = f"({len(targets)}, {len(sources)}): a row for each target, a column for each source"
            problems.append(Problem(name, "the matrix has another shape than its signals", rows.shape, allowed))
        if offsets.shape != (len(targets),):
            problems.append(Problem(name, "the bias has another shape than the targets", offsets.shape))
        if not (sources and targets):
            problems.append(Problem(name, "a transformation needs a source and a target"))
        if problems:
            raise CosimError(problems)
        return cls(
            tuple(sources),
            tuple(targets),
            tuple(tuple(float(x) for x in row) for row in rows),
            tuple(float(x) for x in offsets),
            convert,
        )

    @property
    def terms(self) -> tuple[Connection, ...]:
        """The connections that add up to it: one for each entry that is not 0, at least one for each target."""
        found = []
        for i, target in enumerate(self.targets):
            row = [(s, g) for s, g in zip(self.sources, self.matrix[i], strict=True) if g] or [(self.sources[0], 0.0)]
            bias = self.bias[i] if self.bias else 0.0
            for j, (source, gain) in enumerate(row):
                found.append(Connection(source, target, gain, 0.0 if j else bias, self.convert and gain != 0.0))
        return tuple(found)


@dataclass(frozen=True)
class Bond:
    """Two connections whose product is power: `effort` leaves the one side and `flow` the other.

    Each is a pair (source output, target input). Both are multiplied by `gain`, so that the power stays the same: -1
    where the two sides count their flow in opposite directions, another number for a lever or gear.
    """

    name: str
    effort: tuple[str, str]
    flow: tuple[str, str]
    gain: float = 1.0

    @property
    def connections(self) -> tuple[Connection, Connection]:
        """That of the effort and that of the flow."""
        return Connection(*self.effort, self.gain), Connection(*self.flow, self.gain)


@dataclass(frozen=True)
class Connector:
    """A name in the interface of a system, or a `signal` inside it that one output drives and many inputs take.

    Without a `unit` it takes that of the first thing it is connected to.
    """

    name: str
    kind: Literal["input", "output", "signal"]
    unit: str = ""


@dataclass(frozen=True)
class Experiment:
    """What a file says of how it is to be run: times and macro step [s], and the name of an algorithm.

    `steps` are those of slaves, by name, that are to step otherwise than all together.
    """

    start: float = 0.0
    stop: float | None = None
    step: float | None = None
    algorithm: str = ""
    steps: Mapping[str, float] = field(default_factory=dict)


def factor(source: str, target: str) -> float:
    """What a number in the unit `source` is multiplied by to be in the unit `target`; 1 if either is not known yet."""
    return UNITS[source].factor / UNITS[target].factor if source and target else 1.0


def composed(first: Connection, second: Connection, units: Sequence[str]) -> Connection:
    """Two connections in a row as one; `units` are those of the source, the point between, and the target."""
    start, between, end = units
    after = factor(between, end) if second.convert else 1.0
    bias = second.gain * after * first.bias + second.bias
    if first.convert and second.convert:
        return Connection(first.source, second.target, first.gain * second.gain, bias)
    before = factor(start, between) if first.convert else 1.0
    return Connection(first.source, second.target, first.gain * before * second.gain * after, bias, convert=False)


def is_power(effort: str, flow: str) -> bool:
    """Whether the product of two units is power; angles count as numbers."""
    watt = UNITS["W"].dimension
    exponents = zip(UNITS[effort].dimension[:3], UNITS[flow].dimension[:3], watt[:3], strict=True)
    return all(e + f == w for e, f, w in exponents)


def finite(connection: Connection) -> bool:
    return math.isfinite(connection.gain) and math.isfinite(connection.bias)
