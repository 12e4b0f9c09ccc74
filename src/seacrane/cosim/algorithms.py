"""Co-simulation algorithms: who steps when, how far, and with whose outputs. Swapping one changes one argument.

They are frozen and compose from the inside out:

    Jacobi(step) or GaussSeidel(step)      who steps with whose outputs, `rates`, `extrapolation`, `conserve`
    Iterative(that, FixedPoint() | Newton())           the macro step repeated until outputs and inputs agree
    Adaptive(that, PowerResidual() | StepDoubling())   the macro step chosen by its error

    Adaptive(Iterative(GaussSeidel(0.01, extrapolation="linear"), Newton()), StepDoubling(1e-5), smallest=1e-5)

Sources: M. Busch, Continuous approximation techniques for co-simulation methods, ZAMM 96 (2016), for extrapolation and
the order of convergence; R. Kübler and W. Schiehlen, Two methods of simulator coupling, Mathematical and Computer
Modelling of Dynamical Systems 6 (2000), for iteration and the stability with direct feedthrough; U. Küttler and W. A.
Wall, Fixed-point fluid-structure interaction solvers with dynamic relaxation, Computational Mechanics 43 (2008), for
Aitken's factor; S. Sicklinger et al., Interface Jacobian-based co-simulation, International Journal for Numerical
Methods in Engineering 98 (2014); S. Sadjina, L. T. Kyllingstad, S. Skjong and E. Pedersen, Energy conservation and
power bonds in co-simulations, Engineering with Computers 33 (2017), for the control by residual power; M. Benedikt et
al., NEPCE: a nearly energy-preserving coupling element, 5th International Conference on Computational Methods for
Coupled Problems (2013), for the correction.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Final, Literal, Protocol

from seacrane.cosim.ordering import derived_order, feedthrough, links
from seacrane.errors import CosimError, Problem, nearest

if TYPE_CHECKING:
    from seacrane.cosim.system import System

NANOSECONDS = 1_000_000_000

Extrapolation = Literal["hold", "linear", "quadratic"]
DEGREE: Final[Mapping[str, int]] = {"hold": 0, "linear": 1, "quadratic": 2}


@dataclass(frozen=True)
class Schedule:
    """What a loop needs to know of an algorithm.

    `groups` of slaves step one after the other, the slaves of a group side by side. `substeps` and `every` are the
    steps of a slave in a macro step, and the macro steps in a step of a slave, where that is not 1.
    """

    step_ns: int
    order: tuple[str, ...]
    groups: tuple[tuple[str, ...], ...]
    substeps: Mapping[str, int] = field(default_factory=dict)
    every: Mapping[str, int] = field(default_factory=dict)
    degree: int = 0
    conserve: bool = False
    iteration: Iterative | None = None
    control: Adaptive | None = None

    @property
    def repeats(self) -> bool:
        """Whether all slaves must be able to go back to a saved state."""
        return self.iteration is not None or (
            self.control is not None and isinstance(self.control.control, StepDoubling)
        )

    @property
    def signals(self) -> tuple[str, ...]:
        """What the algorithm tells of itself, as variables that can be read and recorded."""
        adaptive = ("macro_step", "coupling_error", "rejected") if self.control is not None else ()
        return (*adaptive, *(("iterations",) if self.iteration is not None else ()))


class Algorithm(Protocol):
    """Decides the steps; `step` [s] is the macro step, at whose multiples a run can be observed and paused."""

    @property
    def step(self) -> float: ...

    def schedule(self, slaves: Sequence[str], system: System | None = None) -> Schedule:
        """The schedule for slaves of these names, in the order of adding, connected as they are in the system."""


# ---------------------------------------------------------------- who steps with whose outputs
@dataclass(frozen=True)
class Jacobi:
    """All slaves step with the outputs of the last macro step, in any order or in parallel.

    `step` [s] is the macro step, to the nearest nanosecond.

    `rates` gives steps per macro step by the name of a slave, where that is not 1: 4 for four sub-steps, 1/4 for one
    step at the end of every fourth macro step.

    `extrapolation` is how the inputs vary over a step: `"hold"` keeps the newest outputs; `"linear"` and `"quadratic"`
    put a polynomial through the last two or three. A slave that takes derivatives of its inputs (all compiled models,
    FMUs with canInterpolateInputs) gets the straight line with the polynomial's mean and first moment over its step;
    any other one holds the polynomial's mean. The error in the macro step is of order 1 with hold and 2 with linear;
    quadratic is of order 3, but for what the start costs, where all slaves take derivatives. Outputs that depend
    directly on an input which is held lag by half a step and bring the order back to 1. At the start, and after
    `Execution.set` or a manipulation has changed a value, there is no history: the next macro step holds, and what
    lies before it is never used again.

    With `conserve`, what the inputs of a bond have missed of its outputs, integrated over the macro step, is added in
    the next one, so that no impulse or volume is lost between the sides; with hold this raises the order to 2 where
    outputs do not depend on inputs directly.
    """

    step: float
    rates: Mapping[str, float] = field(default_factory=dict, kw_only=True)
    extrapolation: Extrapolation = field(default="hold", kw_only=True)
    conserve: bool = field(default=False, kw_only=True)

    def __post_init__(self) -> None:
        _check(self.step, self.extrapolation)

    def schedule(self, slaves: Sequence[str], system: System | None = None) -> Schedule:
        substeps, every = _rates(self.rates, slaves)
        step, degree = nanoseconds(self.step, "step"), DEGREE[self.extrapolation]
        return Schedule(step, tuple(slaves), (tuple(slaves),), substeps, every, degree, self.conserve)


@dataclass(frozen=True)
class GaussSeidel:
    """Slaves step one after the other with the newest outputs: more accurate and more stable than `Jacobi`.

    `order` is that of adding, unless given by name; `"derived"` finds the one in which the fewest connections are
    delayed by a macro step, first of all into inputs that outputs depend on directly. Slaves that are not connected
    with each other may run in parallel. Inputs from slaves that have stepped already are interpolated.

    The other arguments are those of `Jacobi`.
    """

    step: float
    order: Sequence[str] | Literal["derived"] | None = None
    rates: Mapping[str, float] = field(default_factory=dict, kw_only=True)
    extrapolation: Extrapolation = field(default="hold", kw_only=True)
    conserve: bool = field(default=False, kw_only=True)

    def __post_init__(self) -> None:
        _check(self.step, self.extrapolation)

    def schedule(self, slaves: Sequence[str], system: System | None = None) -> Schedule:
        order, joined = tuple(slaves), links(system)
        if self.order == "derived":
            order = derived_order(slaves, joined, feedthrough(system))
        elif self.order is not None:
            order = _given_order(self.order, slaves)
        substeps, every = _rates(self.rates, slaves)
        step, degree = nanoseconds(self.step, "step"), DEGREE[self.extrapolation]
        return Schedule(step, order, _groups(order, joined), substeps, every, degree, self.conserve)


# ---------------------------------------------------------------- the step repeated
@dataclass(frozen=True)
class FixedPoint:
    """Outputs of one iteration are the inputs of the next, changed by `relaxation` times what they differ by.

    With `aitken`, that is the factor of the first iteration only, and each further one, from 0.1 to 1, follows from the
    last two differences. Converges where the coupling over a macro step is weak, or under-relaxed.
    """

    relaxation: float = 1.0
    aitken: bool = True

    def __post_init__(self) -> None:
        if not 0 < self.relaxation <= 2:
            raise CosimError.at("relaxation", "is no factor", value=self.relaxation, allowed="above 0, up to 2")


@dataclass(frozen=True)
class Newton:
    """Newton's method for the connected outputs at the end of the macro step, whatever the strength of the coupling.

    Of slaves that give directional derivatives, those of outputs with respect to inputs are taken first: they are all
    where a slave's outputs follow its inputs without delay. Of others, and as soon as an iteration reduces the error by
    less than four times, the sensitivity over the whole macro step is found by stepping the slave once more for each
    of its inputs, from its saved state. It is kept until the macro step changes by a factor of 2. All slaves step with
    the same guess, so that the order has no influence.
    """


@dataclass(frozen=True)
class Iterative:
    """Repeats each macro step of `base` until the outputs that it was done with are those that it gives.

    Inputs then interpolate: held, they have the value at the end of the macro step (order 1, and stable where explicit
    coupling is not); with `extrapolation="linear"` they go from the old to the new value (order 2). Converged is when
    no connected output changes by more than `tolerance` times the larger of its magnitude and its nominal value; after
    `most` iterations the run ends with a `CosimError` that names the outputs. All slaves must be able to save and
    restore their state.
    """

    base: Jacobi | GaussSeidel
    solver: FixedPoint | Newton = field(default_factory=FixedPoint)
    tolerance: float = field(default=1e-6, kw_only=True)
    most: int = field(default=30, kw_only=True)

    def __post_init__(self) -> None:
        _within(self.base, (Jacobi, GaussSeidel))
        _positive("tolerance", self.tolerance)
        if self.most < 1:
            raise CosimError.at("most", "is no number of iterations", value=self.most, allowed="1 or more")
        if self.base.conserve:
            raise CosimError.at("conserve", "has no meaning where each macro step is iterated: nothing is missed")

    @property
    def step(self) -> float:
        return self.base.step

    def schedule(self, slaves: Sequence[str], system: System | None = None) -> Schedule:
        plain = self.base.schedule(slaves, system)
        groups = (plain.order,) if isinstance(self.solver, Newton) else plain.groups
        return replace(plain, groups=groups, iteration=self)


# ---------------------------------------------------------------- the step chosen
@dataclass(frozen=True)
class PowerResidual:
    """The macro step by the residual power of the bonds, without any step being repeated for its error.

    In one macro step, the coupling of no bond shall create or lose more energy than `tolerance` times that which the
    bond moves in `step` seconds at its greatest power so far, or at `power` [W] where that is given. The residual is
    known after the step only: an error is answered by a shorter next step. A step that a slave discards, or whose
    iteration does not converge, is repeated with a smaller size where all slaves can save and restore their state.
    """

    tolerance: float = 1e-3
    power: float | None = None

    def __post_init__(self) -> None:
        _positive("tolerance", self.tolerance)
        if self.power is not None:
            _positive("power", self.power)


@dataclass(frozen=True)
class StepDoubling:
    """The macro step by Richardson's estimate: each is done as a whole and in two halves, which are kept.

    The error of the halves in any output shall be within `tolerance` times the larger of its magnitude and nominal
    value; otherwise the step is repeated with a smaller size, and so it is where a slave discards it or an iteration
    does not converge. All slaves must be able to save and restore their state.
    """

    tolerance: float = 1e-4

    def __post_init__(self) -> None:
        _positive("tolerance", self.tolerance)


@dataclass(frozen=True)
class Adaptive:
    """Divides each macro step of `base` into as many as its error asks for.

    The step of `base` is the greatest one, and the grid on which a run is recorded, paused and set; every point of the
    grid is reached exactly. `smallest` [s] bounds it from below, 1/1000 of the greatest unless given. `safety` is the
    share of the step that would just be tolerable. The size follows the errors of the last two steps (PI controller).
    The step taken last can be recorded as `macro_step`, its error as `coupling_error`, repeated steps as `rejected`.
    It begins with the smallest step, at the start and after `Execution.set` or a manipulation has changed a value.
    """

    base: Jacobi | GaussSeidel | Iterative
    control: PowerResidual | StepDoubling = field(default_factory=PowerResidual)
    smallest: float | None = field(default=None, kw_only=True)
    safety: float = field(default=0.9, kw_only=True)

    def __post_init__(self) -> None:
        _within(self.base, (Jacobi, GaussSeidel, Iterative))
        if not self.smallest_ns <= nanoseconds(self.step, "step"):
            raise CosimError.at(
                "smallest", "is above the greatest step", value=self.smallest, allowed=f"to {self.step:g} s"
            )
        if not 0 < self.safety <= 1:
            raise CosimError.at("safety", "is no share", value=self.safety, allowed="above 0, up to 1")

    @property
    def step(self) -> float:
        return self.base.step

    @property
    def smallest_ns(self) -> int:
        return max(2, nanoseconds(self.step / 1000 if self.smallest is None else self.smallest, "smallest"))

    def schedule(self, slaves: Sequence[str], system: System | None = None) -> Schedule:
        plain = self.base.schedule(slaves, system)
        if plain.every:
            raise CosimError(
                Problem(
                    f"rates.{name}",
                    "steps less often than the macro step, which is not fixed here",
                    allowed="1 or more",
                )
                for name in plain.every
            )
        return replace(plain, control=self)


ALGORITHMS: Final[Mapping[str, Callable[[float], Algorithm]]] = {
    "gauss-seidel": GaussSeidel,
    "gauss-seidel-linear": lambda step: GaussSeidel(step, extrapolation="linear"),
    "jacobi": Jacobi,
    "jacobi-linear": lambda step: Jacobi(step, extrapolation="linear"),
    "fixed-point": lambda step: Iterative(GaussSeidel(step, extrapolation="linear"), FixedPoint()),
    "newton": lambda step: Iterative(Jacobi(step, extrapolation="linear"), Newton()),
    "power-residual": lambda step: Adaptive(GaussSeidel(step), PowerResidual()),
    "step-doubling": lambda step: Adaptive(GaussSeidel(step), StepDoubling()),
}
"""Algorithms by the names they have on the command line and in files; each is made from a macro step [s]."""


# ---------------------------------------------------------------- checks
def nanoseconds(seconds: float, path: str) -> int:
    """A positive duration [s] as whole nanoseconds."""
    if not (math.isfinite(seconds) and round(seconds * NANOSECONDS) > 0):
        raise CosimError.at(path, "is not a duration", value=seconds, allowed="1e-9 s or more")
    return round(seconds * NANOSECONDS)


def _check(step: float, extrapolation: str) -> None:
    nanoseconds(step, "step")
    if extrapolation not in DEGREE:
        hint = nearest(extrapolation, DEGREE)
        raise CosimError.at("extrapolation", "is unknown", value=extrapolation, allowed=", ".join(DEGREE), hint=hint)


def _within(base: object, allowed: tuple[type, ...]) -> None:
    if not isinstance(base, allowed):
        names = ", ".join(kind.__name__ for kind in allowed)
        hint = "From the inside out: Adaptive(Iterative(GaussSeidel(step)))."
        raise CosimError.at("base", "is no algorithm that goes inside", value=base, allowed=names, hint=hint)


def _positive(name: str, value: float) -> None:
    if not (math.isfinite(value) and value > 0):
        raise CosimError.at(name, "must be positive", value=value)


def _given_order(given: Sequence[str], slaves: Sequence[str]) -> tuple[str, ...]:
    order = tuple(given)
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
    return order


def _rates(rates: Mapping[str, float], slaves: Sequence[str]) -> tuple[dict[str, int], dict[str, int]]:
    """Sub-steps, and macro steps for one step, of those slaves where they are above 1."""
    substeps, every, problems = {}, {}, []
    for name, rate in rates.items():
        path = f"rates.{name}"
        if name not in slaves:
            problems.append(Problem(path, "no such slave in the system", hint=nearest(name, slaves)))
        elif not (math.isfinite(rate) and rate > 0):
            problems.append(Problem(path, "is no rate", rate, "a whole number, or 1 over one"))
        elif abs(rate - round(rate)) < 1e-9 * rate:
            substeps[name] = round(rate)
        elif abs(1 / rate - round(1 / rate)) < 1e-9 / rate:
            every[name] = round(1 / rate)
        else:
            problems.append(Problem(path, "is no rate", rate, "a whole number, or 1 over one"))
    if problems:
        raise CosimError(problems)
    return {n: r for n, r in substeps.items() if r > 1}, {n: r for n, r in every.items() if r > 1}


def _groups(order: Sequence[str], joined: Iterable[tuple[str, str]]) -> tuple[tuple[str, ...], ...]:
    """Slaves in groups that are not connected within; each comes after the groups of all before it in the order that it
    is connected with, so that group after group gives what slave after slave would."""
    place = {name: i for i, name in enumerate(order)}
    before: dict[str, set[str]] = {name: set() for name in order}
    for link in joined:
        first, second = sorted(link, key=place.__getitem__)
        if first != second:
            before[second].add(first)
    level: dict[str, int] = {}
    groups: list[list[str]] = []
    for name in order:
        level[name] = max((level[n] + 1 for n in before[name]), default=0)
        if level[name] == len(groups):
            groups.append([])
        groups[level[name]].append(name)
    return tuple(map(tuple, groups))
