"""modelDescription.xml of FMI 1.0 for co-simulation to `ModelDescription`, in the words of FMI 2.0.

FMI 1.0 knows no initialization mode and other causalities and variabilities. A `parameter` becomes a fixed parameter (a
calculated one if it has no start value), an internal variable is local, and `fixed="false"` means a start value that
is a guess.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

from seacrane.fmi.attributes import Reader, enumeration_items, experiment, start_value, typed_element
from seacrane.fmi.description import (
    TYPES,
    CoSimulation,
    Experiment,
    ModelDescription,
    ModelExchange,
    UnitDefinition,
    Unknown,
    Variable,
)
from seacrane.fmi.xml import Element

_CAUSALITIES: Final = ("input", "output", "internal", "none")
_VARIABILITIES: Final = ("constant", "parameter", "discrete", "continuous")
_ALIASES: Final = ("noAlias", "alias", "negatedAlias")


def read1(reader: Reader, root: Element) -> ModelDescription:
    """The model description of FMI 1.0 under this root; what is wrong with it is left in the reader."""
    types = {
        reader.text(given, "name", None): given.children[0]
        for group in root.all("TypeDefinitions")
        for given in group.all("Type")
        if given.children
    }
    listed = root.first("ModelVariables")
    elements = list(listed.all("ScalarVariable")) if listed else []
    variables = tuple(_variable(reader, element, types) for element in elements)
    asked = root.first("DefaultExperiment")
    identifier = reader.text(root, "modelIdentifier", None)
    implementation = root.first("Implementation")
    return ModelDescription(
        fmi_version="1.0",
        model_name=reader.text(root, "modelName", None),
        guid=reader.text(root, "guid", None),
        variables=variables,
        co_simulation=_co_simulation(reader, implementation, identifier) if implementation else None,
        model_exchange=None if implementation else ModelExchange(model_identifier=identifier),
        description=reader.text(root, "description"),
        version=reader.text(root, "version"),
        generation_tool=reader.text(root, "generationTool"),
        naming=reader.choice(root, "variableNamingConvention", ("flat", "structured"), "flat"),
        units=tuple(_unit(reader, unit) for group in root.all("UnitDefinitions") for unit in group.all("BaseUnit")),
        types={name: given.attributes.get("unit") for name, given in types.items()},
        experiment=experiment(reader, asked) if asked else Experiment(),
        outputs=_outputs(reader, elements, variables),
        event_indicators=reader.integer(root, "numberOfEventIndicators") or 0,
    )


def _co_simulation(reader: Reader, implementation: Element, identifier: str) -> CoSimulation:
    alone = implementation.first("CoSimulation_StandAlone")
    tool = implementation.first("CoSimulation_Tool")
    chosen = alone or tool
    if chosen is None:
        reader.found(implementation, "<Implementation> is of no kind", None, "CoSimulation_StandAlone")
    can = (chosen and chosen.first("Capabilities")) or Element("Capabilities", {}, implementation.line)
    return CoSimulation(
        model_identifier=identifier,
        needs_execution_tool=alone is None,
        once_per_process=reader.boolean(can, "canBeInstantiatedOnlyOncePerProcess"),
        variable_step=reader.boolean(can, "canHandleVariableCommunicationStepSize"),
        interpolates_inputs=reader.boolean(can, "canInterpolateInputs"),
        output_derivative_order=reader.integer(can, "maxOutputDerivativeOrder") or 0,
    )


def _variable(reader: Reader, element: Element, types: Mapping[str, Element]) -> Variable:
    typed = typed_element(reader, element, TYPES, types)
    causality = reader.choice(element, "causality", _CAUSALITIES, "internal")
    variability = reader.choice(element, "variability", _VARIABILITIES, "continuous")
    alias = reader.choice(element, "alias", _ALIASES, "noAlias")
    start = start_value(reader, typed)
    initial: str | None = "calculated"
    if start is not None:
        guess = "fixed" in typed.attributes and not reader.boolean(typed, "fixed")
        initial = "approx" if guess else "exact"
    if causality in ("internal", "none"):
        calculated = "calculatedParameter" if start is None else "parameter"
        causality = calculated if variability == "parameter" else "local"
    if causality == "input":
        initial = None
    return Variable(
        name=reader.text(element, "name", None),
        value_reference=reader.reference(element),
        type=typed.tag,
        causality=causality,
        variability="fixed" if variability == "parameter" else variability,
        initial=initial,
        start=start,
        unit=typed.attributes.get("unit"),
        display_unit=typed.attributes.get("displayUnit"),
        minimum=reader.number(typed, "min"),
        maximum=reader.number(typed, "max"),
        nominal=reader.number(typed, "nominal"),
        declared_type=typed.attributes.get("declaredType"),
        description=element.attributes.get("description", ""),
        line=element.line,
        items=enumeration_items(reader, types.get(typed.attributes.get("declaredType", ""))),
        negated=alias == "negatedAlias",
    )


def _unit(reader: Reader, element: Element) -> UnitDefinition:
    """FMI 1.0 says nothing of the dimension of a unit; only its name can be known."""
    display = {}
    for shown in element.all("DisplayUnitDefinition"):
        gain, offset = reader.number(shown, "gain"), reader.number(shown, "offset")
        display[reader.text(shown, "displayUnit", None)] = (1.0 if gain is None else gain, offset or 0.0)
    return UnitDefinition(reader.text(element, "unit", None), None, display=display)


def _outputs(reader: Reader, elements: list[Element], variables: tuple[Variable, ...]) -> tuple[Unknown, ...]:
    """The outputs, with the inputs on which they depend directly, if the file says so."""
    index = {v.name: i for i, v in enumerate(variables, start=1)}
    unknowns = []
    for element, v in zip(elements, variables, strict=True):
        if v.causality != "output":
            continue
        direct = element.first("DirectDependency")
        names = [name.text.strip() for name in direct.all("Name")] if direct else []
        missing = [name for name in names if name not in index]
        if missing:
            reader.found(element, f"{v.name}: depends on variables that do not exist", missing)
        known = tuple(index[name] for name in names if name in index)
        unknowns.append(Unknown(index[v.name], known if direct else None, line=element.line))
    return tuple(unknowns)
