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
from seacrane.design import Crane, buckling, changes, chart, mass, planar
from seacrane.errors import ParameterError, Problem, UnitError, nearest
from seacrane.units import parse

Array = NDArray[np.float64]

FORMAT: Final = "seacrane-optimisation/1"

GOALS: Final = ("reach", "weight", "capacity")

LEAST_POPULATION: Final = 4
"""Fewer candidates do not make a generation."""

_POSTURES: Final = {1: 400, 2: 160, 3: 40}
"""Postures per joint for the loads of a candidate, by the number of joints in the plane."""

_BAND: Final = 0.01
"""Share of a radius by which a posture may fall short of it; its load is then scaled by the moment."""

BUCKLING: Final = 2.3
"""Least safety of a cylinder against buckling in a candidate (see `design.buckling`); an assumption."""

THICKEST_ROD: Final = 0.95
"""Largest share of the bore that a rod takes in a candidate: the annulus has to draw it in again. An assumption."""


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

    values (n, variables) [m]; goals (n, goals) in SI; violation (n,): 0 for a crane that can be built, see
    `shortfalls`; best (n,): those that no other beats in every goal.
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

    @property
    def nearest(self) -> int:
        """The candidate that misses least of being buildable."""
        return int(np.argmin(self.violation))

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

    `{"variables": [{"path", "low", "high"}], "goals": [{"kind", "radius", "mode"}]}`; lengths are numbers in m or texts
    with a unit. Without bounds a variable varies by a quarter of its value to both sides, a pin by 0.2 m at least.
    """
    if not isinstance(data, Mapping):
        raise ParameterError.at("optimisation", "must be an object with variables and goals")
    problems: list[Problem] = []
    variables, goals = [], []
    for at, item in _items(data, "variables", ("path", "low", "high"), problems):
        path = item.get("path")
        if not isinstance(path, str):
            problems.append(Problem(f"{at}.path", "must be the path of a size", path, changes.PATHS))
            continue
        now = changes.value(crane, path)
        span = max(0.25 * abs(now), 0.2 if ("base" in path or "eye" in path) else 0.0)
        low = _length(item.get("low", now - span), f"{at}.low", problems)
        high = _length(item.get("high", now + span), f"{at}.high", problems)
        variables.append(Variable(path, low, high))
    for at, item in _items(data, "goals", ("kind", "radius", "mode", "name"), problems):
        kind = item.get("kind")
        if kind not in GOALS:
            problems.append(Problem(f"{at}.kind", "is not a goal", kind, ", ".join(GOALS)))
            continue
        radius = _length(item.get("radius", 0.0), f"{at}.radius", problems)
        goals.append(Goal(kind, radius, str(item.get("mode", "harbour"))))
    if problems:
        raise ParameterError(problems)
    return tuple(variables), tuple(goals)


def _items(
    data: Mapping[str, Any], key: str, fields: Sequence[str], problems: list[Problem]
) -> Iterator[tuple[str, Mapping[str, Any]]]:
    """The objects in a list of the specification, each with its path; what is none, or has a strange field, is told."""
    items = data.get(key)
    if not isinstance(items, list):
        problems.append(Problem(key, "must be a list"))
        return
    for index, item in enumerate(items):
        at = f"{key}[{index}]"
        if not isinstance(item, Mapping):
            problems.append(Problem(at, "must be an object", item, ", ".join(fields)))
            continue
        for strange in sorted(item.keys() - fields):
            problems.append(Problem(f"{at}.{strange}", "is not a field here", hint=nearest(strange, fields)))
        yield at, item


def _length(given: object, path: str, problems: list[Problem]) -> float:
    """A length [m] of a number or of a text with a unit."""
    if isinstance(given, str):
        try:
            return parse(given, "m", path)
        except UnitError as error:
            problems.extend(error.problems)
            return 0.0
    if isinstance(given, int | float) and not isinstance(given, bool) and math.isfinite(given):
        return float(given)
    problems.append(Problem(path, "must be a length", given, 'a finite number in m, or a text such as "350 mm"'))
    return 0.0


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
        if loads.radius.max() < goal.radius:
            return 0.0
        # as in `chart.curve`: what is lifted a little nearer is scaled to the radius by the moment
        near = loads.radius >= (1.0 - _BAND) * goal.radius
        return float((loads.swl[near] * np.minimum(1.0, loads.radius[near] / goal.radius)).max())

    return [one(goal) for goal in goals]


def violation(crane: Crane) -> float:
    """By how much a crane cannot be built, as a share: 0 if `shortfalls` and `design.check` find nothing."""
    return sum(share for _, share in shortfalls(crane)) or float(len(design.check(crane)))


def why_not(crane: Crane) -> list[str]:
    """What keeps a crane from being built, in words; nothing where `violation` is 0."""
    return [words for words, _ in shortfalls(crane)] or [str(problem) for problem in design.check(crane)]


def shortfalls(crane: Crane) -> list[tuple[str, float]]:
    """What keeps the cylinders of a crane from being built, in words, each with the share by which it misses.

    Closed, a cylinder needs its stroke and its bore between the pins; the rod must leave an annulus; the joint must not
    pass a dead point; and out, at working pressure, it must be `BUCKLING` times safe against buckling.
    """
    found = []
    for cylinder in crane.cylinders:
        closed, needed = design.geometry.retracted_length(crane, cylinder), cylinder.stroke + cylinder.bore
        if closed < needed:
            words = f"its pins are {closed:.4g} m apart when it is closed; a stroke and a bore take {needed:.4g} m"
            found.append((cylinder, words, needed / max(closed, 1e-3) - 1))
        if cylinder.rod > THICKEST_ROD * cylinder.bore:
            words = f"its rod of {cylinder.rod:.4g} m leaves no annulus in a bore of {cylinder.bore:.4g} m"
            found.append((cylinder, words, cylinder.rod / (THICKEST_ROD * cylinder.bore) - 1))
        if design.geometry.extends_upward(crane, cylinder) is None:
            found.append((cylinder, f"it passes a dead point within the limits of {cylinder.moves}", 1.0))
        safe = buckling.safety(crane, cylinder)
        if safe < BUCKLING:
            found.append((cylinder, f"it is only {safe:.3g} times safe against buckling", BUCKLING / safe - 1))
    return [(f"{cylinder.name}: {words}", share) for cylinder, words, share in found]


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
    problems += _twice("variables", [variable.path for variable in variables])
    problems += _twice("goals", [goal.name for goal in goals])
    for variable in variables:
        now = changes.value(crane, variable.path)
        if not variable.low < variable.high:
            shown = f"{variable.low:g} to {variable.high:g} m"
            problems.append(Problem(variable.path, "low must be below high", shown, hint="Are they reversed?"))
        elif variable.path.endswith("length") and not now > 0:
            problems.append(Problem(variable.path, "the link has no length along its x that could change", now))
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
    _check_reach(crane, variables, goals)


def _twice(group: str, names: Sequence[str]) -> Iterator[Problem]:
    for name in sorted({name for name in names if names.count(name) > 1}):
        yield Problem(group, f"{name} is there twice")


def _check_reach(crane: Crane, variables: Sequence[Variable], goals: Sequence[Goal]) -> None:
    """Refuse a load at a radius that no candidate comes to."""
    longest = {v.path: v.high for v in variables if v.path.endswith("length")}
    reach = judged(changes.changed(crane, longest), [Goal("reach")])[0]
    if problems := [
        Problem(f"goals[{goal.name}].radius", "is out of reach of every candidate", goal.radius, f"up to {reach:.4g} m")
        for goal in goals
        if goal.kind == "capacity" and goal.radius > reach
    ]:
        raise ParameterError(problems)
