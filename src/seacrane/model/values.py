"""The parameters of a diagram with their values, and values given by a user as texts: `valve.flow=400 l/min`."""

from __future__ import annotations

from collections.abc import Mapping

from seacrane.errors import ParameterError, Problem, UnitError, nearest
from seacrane.units import Quantity, value_of

from .component import Declaration, check_value
from .dae import Dae, Variable
from .diagram import Diagram
from .flatten import Flat, parameter_symbols
from .net import net


def parameters(diagram: Diagram) -> tuple[Variable, ...]:
    """The parameters of a diagram as they are in the compiled model; `start` is the value."""
    flat, whole = Flat(), net(diagram)
    for path, component in whole.components.items():
        parameter_symbols(flat, whole, path, component)
    return tuple(variable for variable, _ in flat.parameters.values())


def settings(diagram: Diagram, dae: Dae, texts: Mapping[str, str]) -> dict[str, float]:
    """SI values for parameters, inputs and start values of states of a diagram, given as texts by name.

    A bare number is in the variable's own unit, which is SI here. `ParameterError` names every unknown name, wrong unit
    and value out of bounds.
    """
    declared = _declarations(diagram)
    variables = {v.name: v for v in dae.constants + dae.inputs + dae.states}
    values: dict[str, float] = {}
    problems: list[Problem] = []
    for name, text in texts.items():
        variable = variables.get(name)
        if variable is None:
            what = "is no parameter, input or state that can be set"
            problems.append(Problem(name, what, hint=nearest(name, variables)))
            continue
        try:
            value = value_of(text, variable.unit, name)
        except UnitError as error:
            problems += error.problems
            continue
        if name in declared:
            problem = check_value(name, value, *declared[name])
        else:
            bounds = Declaration("input", variable.about or "value", least=variable.minimum, most=variable.maximum)
            problem = check_value(name, value, bounds, Quantity(variable.unit))
        if problem is not None:
            problems.append(problem)
        values[name] = value
    if problems:
        raise ParameterError(problems)
    return values


def unsound(diagram: Diagram, values: Mapping[str, float]) -> list[Problem]:
    """What is wrong with SI values for parameters and start values of a diagram, as its components declare them."""
    declared = _declarations(diagram)
    found = (check_value(name, value, *declared[name]) for name, value in values.items() if name in declared)
    return [problem for problem in found if problem is not None]


def _declarations(diagram: Diagram) -> dict[str, tuple[Declaration, Quantity | None]]:
    """How parameters and start values are declared, by the names that they have in the compiled model."""
    found: dict[str, tuple[Declaration, Quantity | None]] = {}
    for path, component in net(diagram).components.items():
        for name, declared in type(component).declarations.items():
            if declared[0].role != "option":
                found[f"{path}.{name}"] = declared
            if declared[0].role == "shared":
                found.setdefault(name, declared)
    return found
