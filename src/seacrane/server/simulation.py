"""What the server needs of a simulation, and how one is named so that another process can build it."""

from __future__ import annotations

import importlib
from collections.abc import Callable, Mapping
from typing import Any, Protocol, cast

import msgspec

from seacrane.cosim.execution import Execution
from seacrane.errors import ServerError, nearest


class Simulation(Protocol):
    """A prepared simulation: an execution, what it is, and how it is driven.

    `describe()` returns the content of `model.describe`. The server itself reads two of its members: `variables`, a
    list of objects with at least the `name` and `unit` of a variable that the execution can read, and `axes`, the
    names of the command axes.
    """

    @property
    def execution(self) -> Execution:
        """The execution, which the server starts, steps and closes."""

    def describe(self) -> dict[str, Any]:
        """The content of `model.describe`, of plain JSON types."""

    def command(self, axes: Mapping[str, float], deadman: bool) -> None:
        """Set every command axis, in [-1, 1]; called between macro steps."""


class Factory(msgspec.Struct, frozen=True):
    """A function that builds a `Simulation`, by name: `package.module:function` and its keyword arguments."""

    target: str
    arguments: dict[str, Any] = {}

    def build(self) -> Simulation:
        """Import the function and call it; `ServerError` if there is no such function."""
        return self._function()(**self.arguments)

    def _function(self) -> Callable[..., Simulation]:
        module_name, separator, function_name = self.target.partition(":")
        if not (separator and module_name and function_name):
            raise ServerError.at(
                "factory", "is not the name of a function", value=self.target, allowed="module:function"
            )
        try:
            module = importlib.import_module(module_name)
        except ModuleNotFoundError as error:
            if error.name is not None and (module_name == error.name or module_name.startswith(error.name + ".")):
                raise ServerError.at("factory", f"there is no module {module_name!r}", value=self.target) from None
            raise
        function = getattr(module, function_name, None)
        if not callable(function):
            known = [name for name, value in vars(module).items() if callable(value) and not name.startswith("_")]
            raise ServerError.at(
                "factory",
                f"module {module_name!r} has no function {function_name!r}",
                hint=nearest(function_name, known),
            )
        return cast(Callable[..., Simulation], function)


class VariableInfo(msgspec.Struct, frozen=True):
    """What the server reads of one entry of `variables`."""

    name: str
    unit: str


class Description(msgspec.Struct, frozen=True):
    """What the server reads of `model.describe`."""

    variables: tuple[VariableInfo, ...]
    axes: tuple[str, ...]
