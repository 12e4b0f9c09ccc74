"""The search for designs that none beats in every goal: link lengths, pins and bores against reach, capacity, weight.

NSGA-II (K. Deb et al., A fast and elitist multiobjective genetic algorithm: NSGA-II, IEEE Transactions on Evolutionary
Computation 6(2), 2002), from pymoo. A generation follows from the one before it and the seed alone, so that a search
that was stopped goes on as if it had not been.
"""

from __future__ import annotations

import json
import math
import os
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final, Literal

import numpy as np
from numpy.typing import NDArray

from seacrane import design, documents
from seacrane.design import Crane, changes, chart, mass, planar
from seacrane.errors import ParameterError, Problem

Array = NDArray[np.float64]

FORMAT: Final = "seacrane-optimisation/1"

GOALS: Final = ("reach", "weight", "capacity")

LEAST_POPULATION: Final = 4
"""Fewer candidates do not make a generation."""

_POSTURES: Final = {1: 400, 2: 90, 3: 24}
"""Postures per joint for the loads of a candidate, by the number of joints in the plane."""


@dataclass(frozen=True)
class Variable:
    """A size that may change, by its path in the design (`changes.PATHS`), between two values [m]."""

    path: str
    low: float
    high: float


@dataclass(frozen=True)
class Goal:
    """What is wanted: the largest reach [m], the least weight of links and cylinders [kg], or the largest load [kg] at
    a radius [m] in a mode."""

    kind: Literal["reach", "weight", "capacity"]
    radius: float = 0.0
    mode: str = "harbour"

    @property
    def name(self) -> str:
        """Such as `capacity at 20 m, harbour`."""
        return f"capacity at {self.radius:g} m, {self.mode}" if self.kind == "capacity" else self.kind

    @property
    def larger_is_better(self) -> bool:
        return self.kind != "weight"


@dataclass(frozen=True, eq=False)
class Front:
    """The candidates after a generation.

    values (n, variables) [m]; goals (n, goals) in SI; violation (n,): 0 for a crane that can be built; best (n,): those
    that no other beats in every goal.
    """

    crane: Crane
    variables: tuple[Variable, ...]
    wanted: tuple[Goal, ...]
    seed: int
    generation: int
    values: Array
    goals: Array
    violation: Array

    @property
    def best(self) -> NDArray[np.bool_]:
        signed = self.goals * np.array([-1.0 if goal.larger_is_better else 1.0 for goal in self.wanted])
        good = self.violation <= 0
        beaten = np.zeros(len(signed), dtype=bool)
        for i in np.flatnonzero(good):
            others = signed[good]
            beaten[i] = np.any(np.all(others <= signed[i], axis=1) & np.any(others < signed[i], axis=1))
        marked: NDArray[np.bool_] = good & ~beaten
        return marked

    def design(self, index: int) -> Crane:
        """The crane of a candidate."""
        return _candidate(self.crane, self.variables, self.values[index])


def optimise(
    crane: Crane,
    variables: Sequence[Variable],
    goals: Sequence[Goal],
    *,
    population: int = 40,
    generations: int = 50,
    seed: int = 1,
    state: Front | None = None,
) -> Iterator[Front]:
    """The front after each generation, from generation 0, the first candidates, to `generations`.

    The crane as it stands is one of the first candidates. `state`, a front of an earlier search, is gone on from;
    crane, variables, goals and seed are then its own. `ParameterError` lists all that is wrong with them.
    """
    if state is not None:
        crane, variables, goals, seed = state.crane, state.variables, state.wanted, state.seed
    _check(crane, variables, goals, population)
    front = state if state is not None else _first(crane, tuple(variables), tuple(goals), population, seed)
    yield front
    while front.generation < generations:
        front = _next(front)
        yield front


def specification(data: object, crane: Crane) -> tuple[tuple[Variable, ...], tuple[Goal, ...]]:
    """Variables and goals from plain data, as a page or a file gives them.

    `{"variables": [{"path", "low", "high"}], "goals": [{"kind", "radius", "mode"}]}`; without bounds a variable varies
    by a quarter of its value, and at least 0.2 m for a pin, to both sides.
    """
    if not isinstance(data, Mapping):
        raise ParameterError.at("optimisation", "must be an object with variables and goals")
    problems: list[Problem] = []
    variables, goals = [], []
    for index, item in enumerate(_list(data, "variables", problems)):
        path = item.get("path") if isinstance(item, Mapping) else None
        if not isinstance(path, str):
            problems.append(Problem(f"variables[{index}].path", "must be the path of a size", allowed=changes.PATHS))
            continue
        now = changes.value(crane, path)
        span = max(0.25 * abs(now), 0.2 if ("base" in path or "eye" in path) else 0.0)
        bounds = [item.get("low", now - span), item.get("high", now + span)]
        if not all(isinstance(b, int | float) and math.isfinite(b) for b in bounds):
            problems.append(Problem(f"variables[{index}]", "low and high must be numbers in m", bounds, "finite"))
            continue
        variables.append(Variable(path, float(bounds[0]), float(bounds[1])))
    for index, item in enumerate(_list(data, "goals", problems)):
        kind = item.get("kind") if isinstance(item, Mapping) else None
        radius = item.get("radius", 0.0) if isinstance(item, Mapping) else 0.0
        if kind not in GOALS or not isinstance(radius, int | float):
            problems.append(Problem(f"goals[{index}].kind", "is not a goal", kind, ", ".join(GOALS)))
            continue
        goals.append(Goal(kind, float(radius), str(item.get("mode", "harbour"))))
    if problems:
        raise ParameterError(problems)
    return tuple(variables), tuple(goals)


def save(front: Front, path: str | os.PathLike[str]) -> None:
    """Write a front, from which `optimise` can go on."""
    documents.write(json.dumps(plain(front), indent=1, allow_nan=False) + "\n", path)


def plain(front: Front) -> dict[str, Any]:
    """A front as plain data."""
    return {
        "format": FORMAT,
        "seed": front.seed,
        "generation": front.generation,
        "variables": [{"path": v.path, "low": v.low, "high": v.high} for v in front.variables],
        "goals": [{"kind": g.kind, "radius": g.radius, "mode": g.mode, "name": g.name} for g in front.wanted],
        "values": front.values.tolist(),
        "results": front.goals.tolist(),
        "violation": front.violation.tolist(),
        "best": front.best.tolist(),
        "crane": json.loads(design.to_json(front.crane)),
    }


def read(path: str | os.PathLike[str]) -> Front:
    """A front that `save` has written. `ParameterError` if it is not one."""
    return loads(documents.read(path, ParameterError), origin=os.fspath(path))


def loads(content: bytes | str, *, origin: str = "the front") -> Front:
    """The front in the text of a file that `save` has written. `ParameterError`, naming `origin`, if it is not one."""
    data = documents.parsed(content, origin, ParameterError)
    if not isinstance(data, dict) or data.get("format") != FORMAT:
        raise ParameterError.at(origin, "is not a saved optimisation", allowed=repr(FORMAT))
    crane = design.loads(json.dumps(data.get("crane")), origin=origin)
    variables, goals = specification(data, crane)
    problems = [
        Problem(f"{origin}.{key}", "must be a whole number, 0 or more", data.get(key))
        for key in ("seed", "generation")
        if not isinstance(data.get(key), int) or isinstance(data.get(key), bool) or data[key] < 0
    ]
    values = _table(data, "values", len(variables), origin, problems)
    results = _table(data, "results", len(goals), origin, problems)
    violations = _table(data, "violation", 0, origin, problems)
    if not len(values) == len(results) == len(violations):
        problems.append(Problem(origin, "must have as many results and violations as values"))
    elif not problems and len(values) < LEAST_POPULATION:
        problems.append(Problem(origin, "has too few candidates", len(values), f"{LEAST_POPULATION} or more"))
    if problems:
        raise ParameterError(problems)
    return Front(crane, variables, goals, data["seed"], data["generation"], values, results, violations)


def _table(data: Mapping[str, Any], key: str, columns: int, origin: str, problems: list[Problem]) -> Array:
    """Finite numbers, a row of `columns` for each candidate, or one number where `columns` is 0."""
    shape = (-1, columns) if columns else (-1,)
    try:
        table = np.array(data.get(key), dtype=float)
        if table.shape == (len(table), *shape[1:]) and np.isfinite(table).all():
            return table
    except (TypeError, ValueError):
        pass
    allowed = f"rows of {columns} finite numbers" if columns else "finite numbers"
    problems.append(Problem(f"{origin}.{key}", "must be a list, an item for each candidate", allowed=allowed))
    return np.empty((0, *shape[1:]))


# ---------------------------------------------------------------- one generation after the other
def _first(crane: Crane, variables: tuple[Variable, ...], goals: tuple[Goal, ...], population: int, seed: int) -> Front:
    random = np.random.default_rng([seed, 0])
    low, high = _bounds(variables)
    values = low + (high - low) * random.random((population, len(variables)))
    values[0] = np.clip([changes.value(crane, variable.path) for variable in variables], low, high)
    return Front(crane, variables, goals, seed, 0, values, *_judged(crane, variables, goals, values))


def _next(front: Front) -> Front:
    try:
        import pymoo  # noqa: F401
    except ImportError:
        raise ParameterError.at(
            "optimisation", "needs the package pymoo", hint="pip install 'seacrane[studies]'"
        ) from None
    from pymoo.algorithms.moo.nsga2 import NSGA2
    from pymoo.core.evaluator import Evaluator
    from pymoo.core.population import Population
    from pymoo.core.problem import Problem as PymooProblem
    from pymoo.core.termination import NoTermination

    low, high = _bounds(front.variables)
    signs = np.array([-1.0 if goal.larger_is_better else 1.0 for goal in front.wanted])
    problem = PymooProblem(n_var=len(low), n_obj=len(signs), n_ieq_constr=1, xl=low, xu=high)
    generation = front.generation + 1
    algorithm = NSGA2(pop_size=len(front.values), sampling=front.values)
    seed = int(np.random.default_rng([front.seed, generation]).integers(2**31))
    algorithm.setup(problem, termination=NoTermination(), seed=seed, evaluator=Evaluator(), verbose=False)

    def told(people: Population, goals: Array, violation: Array) -> Population:
        people.set("F", goals * signs)
        people.set("G", violation[:, None])
        for person in people:
            person.evaluated = {"F", "G"}
        return people

    algorithm.ask()
    algorithm.tell(infills=told(Population.new("X", front.values), front.goals, front.violation))
    children = algorithm.ask()
    values = np.clip(children.get("X").astype(float), low, high)
    goals, violation = _judged(front.crane, front.variables, front.wanted, values)
    algorithm.tell(infills=told(children, goals, violation))
    people = algorithm.pop
    return Front(
        front.crane,
        front.variables,
        front.wanted,
        front.seed,
        generation,
        people.get("X").astype(float),
        people.get("F").astype(float) * signs,
        people.get("G").astype(float)[:, 0],
    )


def _bounds(variables: Sequence[Variable]) -> tuple[Array, Array]:
    return np.array([v.low for v in variables]), np.array([v.high for v in variables])


def _candidate(crane: Crane, variables: Sequence[Variable], values: Array) -> Crane:
    return changes.changed(crane, {v.path: float(x) for v, x in zip(variables, values, strict=True)})


def _judged(crane: Crane, variables: Sequence[Variable], goals: Sequence[Goal], values: Array) -> tuple[Array, Array]:
    """Goals and violation of each candidate."""
    results, violations = np.empty((len(values), len(goals))), np.empty(len(values))
    for index, row in enumerate(values):
        candidate = _candidate(crane, variables, row)
        results[index] = judged(candidate, goals)
        violations[index] = violation(candidate)
    return results, violations


def judged(crane: Crane, goals: Sequence[Goal]) -> list[float]:
    """What a crane reaches in each goal, in SI."""
    postures = planar.grid(crane, _POSTURES.get(len(planar.plane_joints(crane)), 12))
    modes = {goal.mode for goal in goals if goal.kind == "capacity"}
    found = {name: chart.capacity(crane, postures, chart.mode(crane, name)) for name in modes}

    def one(goal: Goal) -> float:
        if goal.kind == "reach":
            return float(planar.Plane(crane, postures).tip()[0].max())
        if goal.kind == "weight":
            return sum(link.mass for link in crane.links) + sum(mass.of_cylinder(c) for c in crane.cylinders)
        loads = found[goal.mode]
        at_least = loads.radius >= goal.radius
        return float(loads.swl[at_least].max()) if at_least.any() else 0.0

    return [one(goal) for goal in goals]


def violation(crane: Crane) -> float:
    """By how much cylinders are too short to be built, in all [m]: closed, each needs its stroke and its bore."""
    total = 0.0
    for cylinder in crane.cylinders:
        closed = design.geometry.retracted_length(crane, cylinder)
        total += max(0.0, cylinder.stroke + cylinder.bore - closed)
    return total


# ---------------------------------------------------------------- checks
def _check(crane: Crane, variables: Sequence[Variable], goals: Sequence[Goal], population: int) -> None:
    problems = []
    if not variables:
        problems.append(Problem("variables", "there is nothing that may change", allowed=changes.PATHS))
    if len(goals) < 2:
        problems.append(Problem("goals", "a front needs two goals or more", len(goals), ", ".join(GOALS)))
    if not LEAST_POPULATION <= population <= 1000:
        allowed = f"{LEAST_POPULATION} to 1000"
        problems.append(Problem("population", "is out of range", population, allowed))
    for variable in variables:
        changes.value(crane, variable.path)
        if not variable.low < variable.high:
            problems.append(Problem(variable.path, "low must be below high [m]", (variable.low, variable.high)))
        elif variable.low <= 0 and variable.path.endswith(("length", "bore", "rod")):
            problems.append(Problem(variable.path, "must stay above 0 m", variable.low))
    known = [mode.name for mode in chart.modes(crane)]
    for goal in goals:
        if goal.kind == "capacity" and goal.mode not in known:
            problems.append(
                Problem(f"goals[{goal.name}].mode", "is not one of this crane", goal.mode, ", ".join(known))
            )
        if goal.kind == "capacity" and not goal.radius > 0:
            problems.append(Problem(f"goals[{goal.name}].radius", "must be above 0 m", goal.radius))
    if problems:
        raise ParameterError(problems)


def _list(data: Mapping[str, Any], key: str, problems: list[Problem]) -> list[Any]:
    value = data.get(key)
    if not isinstance(value, list):
        problems.append(Problem(key, "must be a list"))
        return []
    return value
