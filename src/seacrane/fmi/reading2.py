"""modelDescription.xml of FMI 2.0 to `ModelDescription`."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Final

from seacrane.errors import Problem
from seacrane.fmi.attributes import (
    Reader,
    definition,
    enumeration_items,
    experiment,
    start_value,
    typed_element,
)
from seacrane.fmi.description import (
    CAUSALITIES,
    INITIALS,
    TYPES,
    VARIABILITIES,
    CoSimulation,
    Experiment,
    ModelDescription,
    ModelExchange,
    Unknown,
    Variable,
)
from seacrane.fmi.xml import FILE, Element

MOST_EVENT_INDICATORS: Final = 1_000_000
"""More are refused before memory is asked for."""


def read2(reader: Reader, root: Element) -> ModelDescription:
    """The model description of FMI 2.0 under this root; what is wrong with it is left in the reader."""
    types = {
        reader.text(simple, "name", None): simple.children[0]
        for group in root.all("TypeDefinitions")
        for simple in group.all("SimpleType")
        if simple.children
    }
    co_simulation = root.first("CoSimulation")
    model_exchange = root.first("ModelExchange")
    asked = root.first("DefaultExperiment")
    structure = root.first("ModelStructure")
    if structure is None:
        reader.problems.append(Problem(FILE, "has no <ModelStructure>"))
        structure = Element("ModelStructure", {}, 0)
    variables = root.first("ModelVariables")
    if variables is None:
        reader.problems.append(Problem(FILE, "has no <ModelVariables>"))
        variables = Element("ModelVariables", {}, 0)
    return ModelDescription(
        model_name=reader.text(root, "modelName", None),
        guid=reader.text(root, "guid", None),
        variables=tuple(_variable(reader, element, types) for element in variables.all("ScalarVariable")),
        co_simulation=_co_simulation(reader, co_simulation) if co_simulation else None,
        model_exchange=_model_exchange(reader, model_exchange) if model_exchange else None,
        description=reader.text(root, "description"),
        version=reader.text(root, "version"),
        generation_tool=reader.text(root, "generationTool"),
        naming=reader.choice(root, "variableNamingConvention", ("flat", "structured"), "flat"),
        units=tuple(definition(reader, u) for g in root.all("UnitDefinitions") for u in g.all("Unit")),
        types={name: typed.attributes.get("unit") for name, typed in types.items()},
        experiment=experiment(reader, asked) if asked else Experiment(),
        outputs=_unknowns(reader, structure, "Outputs"),
        derivatives=_unknowns(reader, structure, "Derivatives"),
        initial_unknowns=_unknowns(reader, structure, "InitialUnknowns"),
        event_indicators=_event_indicators(reader, root),
    )


def _event_indicators(reader: Reader, root: Element) -> int:
    count = reader.integer(root, "numberOfEventIndicators") or 0
    if not 0 <= count <= MOST_EVENT_INDICATORS:
        reader.found(root, "attribute 'numberOfEventIndicators'", count, f"0 to {MOST_EVENT_INDICATORS}")
    return count


def _co_simulation(reader: Reader, element: Element) -> CoSimulation:
    return CoSimulation(
        **_both(reader, element),
        variable_step=reader.boolean(element, "canHandleVariableCommunicationStepSize"),
        interpolates_inputs=reader.boolean(element, "canInterpolateInputs"),
        output_derivative_order=reader.integer(element, "maxOutputDerivativeOrder") or 0,
    )


def _model_exchange(reader: Reader, element: Element) -> ModelExchange:
    needless = reader.boolean(element, "completedIntegratorStepNotNeeded")
    return ModelExchange(**_both(reader, element), needs_completed_step=not needless)


def _both(reader: Reader, element: Element) -> dict[str, Any]:
    return {
        "model_identifier": reader.text(element, "modelIdentifier", None),
        "needs_execution_tool": reader.boolean(element, "needsExecutionTool"),
        "once_per_process": reader.boolean(element, "canBeInstantiatedOnlyOncePerProcess"),
        "saves_state": reader.boolean(element, "canGetAndSetFMUstate"),
        "serializes_state": reader.boolean(element, "canSerializeFMUstate"),
        "directional_derivative": reader.boolean(element, "providesDirectionalDerivative"),
    }


def _variable(reader: Reader, element: Element, types: Mapping[str, Element]) -> Variable:
    typed = typed_element(reader, element, TYPES, types)
    causality = reader.choice(element, "causality", CAUSALITIES, "local")
    variability = reader.choice(element, "variability", VARIABILITIES, "continuous")
    initial = element.attributes.get("initial")
    if initial is not None:
        initial = reader.choice(element, "initial", INITIALS, "exact")
    return Variable(
        name=reader.text(element, "name", None),
        value_reference=reader.reference(element),
        type=typed.tag,
        causality=causality,
        variability=variability,
        initial=initial or default_initial(causality, variability),
        start=start_value(reader, typed),
        unit=typed.attributes.get("unit"),
        display_unit=typed.attributes.get("displayUnit"),
        minimum=reader.number(typed, "min"),
        maximum=reader.number(typed, "max"),
        nominal=reader.number(typed, "nominal"),
        derivative=reader.integer(typed, "derivative"),
        declared_type=typed.attributes.get("declaredType"),
        description=element.attributes.get("description", ""),
        line=element.line,
        items=enumeration_items(reader, types.get(typed.attributes.get("declaredType", ""))),
    )


def default_initial(causality: str, variability: str) -> str | None:
    """What `initial` means if it is not given (FMI 2.0, section 2.2.7, table of causality and variability)."""
    if causality == "parameter" or variability == "constant":
        return "exact"
    if causality in ("calculatedParameter", "output", "local"):
        return "calculated"
    return None


def _unknowns(reader: Reader, structure: Element, group: str) -> tuple[Unknown, ...]:
    found = structure.first(group)
    unknowns = []
    for element in found.all("Unknown") if found else ():
        index = reader.integer(element, "index")
        if index is None:
            reader.text(element, "index", None)
        kinds = element.attributes.get("dependenciesKind")
        unknowns.append(
            Unknown(
                index or 0,
                reader.indices(element, "dependencies"),
                None if kinds is None else tuple(kinds.split()),
                element.line,
            )
        )
    return tuple(unknowns)
