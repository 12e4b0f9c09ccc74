"""Slaves from equations: diagrams and DAEs, compiled to C."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from functools import cached_property

from seacrane.cosim.compiled import CompiledInstance, started
from seacrane.cosim.slave import Instance, Interface, Slave, check_values
from seacrane.errors import SolveError
from seacrane.model.codegen import SETTINGS
from seacrane.model.dae import Dae
from seacrane.model.dependencies import dependencies
from seacrane.model.diagram import Diagram
from seacrane.model.native import DISCARD, NativeInstance, NativeModel, build


class ModelSlave(Slave):
    """A model as a slave; it is compiled when it is first instantiated.

    `parameters` gives values of parameters (and of `solver.tolerance` and `solver.fixed_step`), and start values of
    states, algebraic unknowns and inputs, by name, in SI. Inputs and outputs are those of the model; states, algebraic
    unknowns and observables can be recorded as well. `ParameterError` names every value that does not fit.
    """

    def __init__(self, model: Dae | Diagram, parameters: Mapping[str, float] | None = None) -> None:
        self.dae = model.compile() if isinstance(model, Diagram) else model
        self.parameters = dict(parameters or {})
        dae = self.dae
        own = (*dae.parameters, *SETTINGS)
        check_values(self.parameters, (*own, *dae.states, *dae.algebraics, *dae.modes, *dae.inputs), dae.name)
        self._interface = Interface(
            inputs=started(dae.inputs, self.parameters),
            outputs=dae.outputs,
            parameters=started(own, self.parameters),
            watchable=(*dae.states, *dae.algebraics, *dae.modes, *dae.observables),
        )

    @property
    def interface(self) -> Interface:
        return self._interface

    @property
    def about(self) -> str:
        return self.dae.about or f"compiled model {self.dae.name!r}"

    @property
    def fingerprint(self) -> str:
        return f"{self.native.guid} {sorted(self.parameters.items())}"

    @cached_property
    def feedthrough(self) -> Mapping[str, Collection[str]]:
        """From the structure of the equations: it may name too many inputs, never too few."""
        found, inputs = dependencies(self.dae), {v.name for v in self.dae.inputs}
        return {v.name: inputs.intersection(found[v.name]) for v in self.dae.outputs}

    @cached_property
    def native(self) -> NativeModel:
        """The compiled model."""
        return build(self.dae)

    def instantiate(self, name: str) -> Instance:
        inner = self.native.instantiate(name)
        references = {n: entry.reference for n, entry in self.native.variables.items()}
        instance = ModelInstance(name, inner, self._interface, references)
        instance.set(self.parameters)
        return instance


class ModelInstance(CompiledInstance):
    """An instance of a compiled model, with its own words for what went wrong."""

    inner: NativeInstance

    _findings = ""

    def failed(self, status: int) -> None:
        self._findings = ""
        if status == DISCARD:
            told = self.message
            problems = self.inner.explained(SolveError.at(self.inner.name, told)).problems[1:]
            self._findings = ". ".join([told, *map(str, problems)])

    @property
    def message(self) -> str:
        return self._findings or str(self.inner.model.library.seacrane_message(self.inner.handle).decode())
