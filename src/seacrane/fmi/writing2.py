"""modelDescription.xml of FMI 2.0."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from seacrane.fmi.writing import (
    EXPERIMENT,
    HEAD,
    KINDS,
    LOG_CATEGORIES,
    about,
    attributes,
    names,
    number,
    state_of,
    units,
)
from seacrane.model.codegen import Entry, Generated
from seacrane.model.dependencies import TIME, dependencies


def describe(model: Generated, identifier: str, sources: Sequence[str] = ()) -> str:
    """The text of modelDescription.xml for co-simulation and model exchange, with the C files to be compiled if any."""
    index = {e.variable.name: i for i, e in enumerate(model.entries, start=1)}
    root = {"fmiVersion": "2.0", "modelName": model.dae.name, "guid": model.guid, **about(model)}
    able = {
        "canNotUseMemoryManagementFunctions": "true",
        "canGetAndSetFMUstate": "true",
        "canSerializeFMUstate": "true",
        "providesDirectionalDerivative": "true",
    }
    exchange = {"modelIdentifier": identifier, "completedIntegratorStepNotNeeded": "true", **able}
    simulation = {
        "modelIdentifier": identifier,
        "canHandleVariableCommunicationStepSize": "true",
        "canInterpolateInputs": "true",
        "maxOutputDerivativeOrder": "1",
        **able,
    }
    lines = [
        HEAD,
        f'<fmiModelDescription{attributes(root)} numberOfEventIndicators="{len(model.dae.events)}">',
        *_interface("ModelExchange", exchange, sources),
        *_interface("CoSimulation", simulation, sources),
        *units(model.entries),
        *LOG_CATEGORIES,
        EXPERIMENT,
        "  <ModelVariables>",
        *(_variable(e, index) for e in model.entries),
        "  </ModelVariables>",
        *_structure(model, index),
        "</fmiModelDescription>",
    ]
    return "\n".join(lines) + "\n"


def _interface(tag: str, values: Mapping[str, str], sources: Sequence[str]) -> list[str]:
    if not sources:
        return [f"  <{tag}{attributes(values)}/>"]
    files = (f'      <File name="{name}"/>' for name in sources)
    return [f"  <{tag}{attributes(values)}>", "    <SourceFiles>", *files, "    </SourceFiles>", f"  </{tag}>"]


def _variable(entry: Entry, index: Mapping[str, int]) -> str:
    v = entry.variable
    causality, variability, initial = KINDS[entry.kind]
    scalar = {
        "name": v.name,
        "valueReference": str(entry.reference),
        "description": v.about or None,
        "causality": causality,
        "variability": variability,
        "initial": initial,
    }
    derivative = str(index[state_of(entry)]) if entry.kind == "DERIVATIVE" else None
    real = attributes({**number(entry), "derivative": derivative})
    return f"    <ScalarVariable{attributes(scalar)}><Real{real}/></ScalarVariable>"


def _structure(model: Generated, index: Mapping[str, int]) -> list[str]:
    known = dependencies(model.dae)

    def unknown(name: str) -> str:
        depends = " ".join(str(i) for i in sorted(index[n] for n in known[name] if n != TIME))
        return f'      <Unknown index="{index[name]}" dependencies="{depends}"/>'

    lines = ["  <ModelStructure>"]
    for tag, kind in (("Outputs", "OUTPUT"), ("Derivatives", "DERIVATIVE")):
        group = names(model.entries, kind)
        if group:
            lines += [f"    <{tag}>", *map(unknown, group), f"    </{tag}>"]
    initial = sorted(index[name] for name in names(model.entries, "OUTPUT", "DERIVATIVE"))
    if initial:
        unknowns = (f'      <Unknown index="{i}"/>' for i in initial)
        lines += ["    <InitialUnknowns>", *unknowns, "    </InitialUnknowns>"]
    return [*lines, "  </ModelStructure>"]
