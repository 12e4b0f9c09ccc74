"""modelDescription.xml of FMI 3.0 to `ModelDescription`, value references turned into 1-based indices."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any, Final

from seacrane.fmi.attributes import (
    Reader,
    definition,
    enumeration_items,
    experiment,
    inherited,
    items,
    to_boolean,
    to_integer,
    to_real,
)
from seacrane.fmi.description import (
    CAUSALITIES3,
    INITIALS,
    REALS,
    TYPES3,
    VARIABILITIES,
    CoSimulation,
    Dimension,
    Experiment,
    ModelDescription,
    ModelExchange,
    Scalar,
    Unknown,
    Value,
    Variable,
)
from seacrane.fmi.xml import Element

MOST_ELEMENTS: Final = 10_000_000
"""Elements of one array; larger ones are refused before memory is asked for."""

_UNSIGNED: Final = {"UInt8": 8, "UInt16": 16, "UInt32": 32, "UInt64": 64}
_SIGNED: Final = {"Int8": 8, "Int16": 16, "Int32": 32, "Int64": 64, "Enumeration": 64}


def read3(reader: Reader, root: Element) -> ModelDescription:
    """The model description of FMI 3.0 under this root; what is wrong with it is left in the reader."""
    co_simulation, model_exchange = root.first("CoSimulation"), root.first("ModelExchange")
    asked = root.first("DefaultExperiment")
    parts = {}
    for tag in ("ModelVariables", "ModelStructure"):
        part = root.first(tag)
        if part is None:
            reader.found(root, f"has no <{tag}>")
        parts[tag] = part or Element(tag, {}, 0)
    elements = [e for e in parts["ModelVariables"].children if e.tag in TYPES3]
    for strange in (e for e in parts["ModelVariables"].children if e.tag not in TYPES3):
        reader.found(strange, f"<{strange.tag}> is no type of variable", allowed=", ".join(TYPES3))
    types = {
        reader.text(simple, "name", None): simple for group in root.all("TypeDefinitions") for simple in group.children
    }
    variables = _shaped(reader, elements, [_variable(reader, inherited(e, types), types) for e in elements])
    index = {v.value_reference: i for i, v in reversed(list(enumerate(variables, start=1)))}
    variables = [_derivative(reader, e, v, index) for e, v in zip(elements, variables, strict=True)]
    structure = parts["ModelStructure"]
    aliases = [
        alias for e, v in zip(elements, variables, strict=True) for alias in _aliases(reader, e, v)
    ]  # after all others, so that indices stay those of the value references
    return ModelDescription(
        fmi_version="3.0",
        model_name=reader.text(root, "modelName", None),
        guid=reader.text(root, "instantiationToken", None),
        variables=(*variables, *aliases),
        co_simulation=_co_simulation(reader, co_simulation) if co_simulation else None,
        model_exchange=_model_exchange(reader, model_exchange) if model_exchange else None,
        scheduled_execution=root.first("ScheduledExecution") is not None,
        description=reader.text(root, "description"),
        version=reader.text(root, "version"),
        generation_tool=reader.text(root, "generationTool"),
        naming=reader.choice(root, "variableNamingConvention", ("flat", "structured"), "flat"),
        units=tuple(definition(reader, u) for g in root.all("UnitDefinitions") for u in g.all("Unit")),
        types={name: simple.attributes.get("unit") for name, simple in types.items()},
        experiment=experiment(reader, asked) if asked else Experiment(),
        outputs=_unknowns(reader, structure, "Output", index),
        derivatives=_unknowns(reader, structure, "ContinuousStateDerivative", index),
        initial_unknowns=_unknowns(reader, structure, "InitialUnknown", index),
        event_indicators=len(list(structure.all("EventIndicator"))),
    )


def _co_simulation(reader: Reader, element: Element) -> CoSimulation:
    return CoSimulation(
        **_both(reader, element),
        variable_step=reader.boolean(element, "canHandleVariableCommunicationStepSize"),
        output_derivative_order=reader.integer(element, "maxOutputDerivativeOrder") or 0,
        event_mode=reader.boolean(element, "hasEventMode"),
        returns_early=reader.boolean(element, "mightReturnEarlyFromDoStep"),
        fixed_step=reader.number(element, "fixedInternalStepSize"),
    )


def _model_exchange(reader: Reader, element: Element) -> ModelExchange:
    return ModelExchange(
        **_both(reader, element), needs_completed_step=reader.boolean(element, "needsCompletedIntegratorStep")
    )


def _both(reader: Reader, element: Element) -> dict[str, Any]:
    return {
        "model_identifier": reader.text(element, "modelIdentifier", None),
        "needs_execution_tool": reader.boolean(element, "needsExecutionTool"),
        "once_per_process": reader.boolean(element, "canBeInstantiatedOnlyOncePerProcess"),
        "saves_state": reader.boolean(element, "canGetAndSetFMUState"),
        "serializes_state": reader.boolean(element, "canSerializeFMUState"),
        "directional_derivative": reader.boolean(element, "providesDirectionalDerivatives"),
        "adjoint_derivative": reader.boolean(element, "providesAdjointDerivatives"),
    }


def _variable(reader: Reader, element: Element, types: Mapping[str, Element]) -> Variable:
    kind = element.tag
    causality = reader.choice(element, "causality", CAUSALITIES3, "local")
    fixed = causality in ("parameter", "calculatedParameter", "structuralParameter")
    usual = "fixed" if fixed else "continuous" if kind in REALS else "discrete"
    variability = reader.choice(element, "variability", VARIABILITIES, usual)
    initial = element.attributes.get("initial")
    if initial is not None:
        initial = reader.choice(element, "initial", INITIALS, "exact")
    return Variable(
        name=reader.text(element, "name", None),
        value_reference=reader.reference(element),
        type=kind,
        causality=causality,
        variability=variability,
        initial=initial or default_initial3(kind, causality, variability),
        start=None if kind == "Clock" else _start(reader, element),
        unit=element.attributes.get("unit"),
        display_unit=element.attributes.get("displayUnit"),
        minimum=reader.number(element, "min"),
        maximum=reader.number(element, "max"),
        nominal=reader.number(element, "nominal"),
        declared_type=element.attributes.get("declaredType"),
        description=element.attributes.get("description", ""),
        line=element.line,
        dimensions=tuple(_dimension(reader, d) for d in element.all("Dimension")),
        items=enumeration_items(reader, types.get(element.attributes.get("declaredType", "")))
        if kind == "Enumeration"
        else {},
    )


def default_initial3(kind: str, causality: str, variability: str) -> str | None:
    """What `initial` means if it is not given (FMI 3.0, section 2.4.7, table of causality and variability)."""
    if kind == "Clock" or causality == "independent":
        return None
    if causality in ("parameter", "structuralParameter", "input") or variability == "constant":
        return "exact"
    return "calculated"


def _dimension(reader: Reader, element: Element) -> Dimension:
    size, reference = reader.integer(element, "start"), reader.integer(element, "valueReference")
    if (size is None) == (reference is None):
        reader.found(element, "<Dimension> needs one of 'start' and 'valueReference'")
    elif size is not None and not 0 <= size < 2**64:
        reader.found(element, "attribute 'start' of <Dimension>", size, "a size")
    return Dimension(size, reference)


def _start(reader: Reader, element: Element) -> Value | None:
    kind = element.tag
    if kind in ("String", "Binary"):
        texts = [reader.text(start, "value") for start in element.all("Start")]
        found: list[Scalar] = []
        for text in texts:
            try:
                found.append(text if kind == "String" else bytes.fromhex(text))
            except ValueError:
                reader.found(element, "start value of a <Binary>", text, "hexadecimal digits")
        return tuple(found) if len(found) > 1 or element.first("Dimension") else (found[0] if found else None)
    convert: Callable[[str], Scalar] = to_integer
    allowed = "an integer in its range"
    if kind in REALS:
        convert, allowed = to_real, "a number"
    elif kind == "Boolean":
        convert, allowed = to_boolean, "true or false"
    else:
        low = -(2 ** (_SIGNED[kind] - 1)) if kind in _SIGNED else 0
        high = 2 ** (_SIGNED[kind] - 1) if kind in _SIGNED else 2 ** _UNSIGNED[kind]

        def convert(text: str) -> int:
            if not low <= (value := to_integer(text)) < high:
                raise ValueError(text)
            return value

    values = reader.convert(element, "start", lambda text: tuple(convert(item) for item in items(text)), allowed)
    if values is None or (not values and not element.first("Dimension")):
        return None
    return values[0] if len(values) == 1 and not element.first("Dimension") else values


def _shaped(reader: Reader, elements: Sequence[Element], variables: Sequence[Variable]) -> list[Variable]:
    """With the shapes of arrays at the start values of their structural parameters."""
    sizes = {v.value_reference: v for v in variables if v.causality == "structuralParameter"}
    shaped = []
    for element, v in zip(elements, variables, strict=True):
        shape = []
        for d in v.dimensions:
            given = sizes.get(d.reference) if d.reference is not None else None
            if d.reference is not None and given is None:
                reader.found(element, f"{v.name}: a dimension refers to no structural parameter", d.reference)
            start = given.start if given is not None else d.size
            shape.append(start if isinstance(start, int) and start >= 0 else 1)
        count = math.prod(shape)
        if count > MOST_ELEMENTS:
            reader.found(element, f"{v.name}: the array has {count} elements", allowed=f"at most {MOST_ELEMENTS}")
            shape = [0]
        elif isinstance(v.start, tuple) and len(v.start) not in (1, count):
            reader.found(element, f"{v.name}: has {len(v.start)} start values", allowed=f"1 or {count}")
        shaped.append(replace(v, shape=tuple(shape)))
    return shaped


def _derivative(reader: Reader, element: Element, v: Variable, index: Mapping[int, int]) -> Variable:
    reference = reader.integer(element, "derivative")
    if reference is None:
        return v
    if reference not in index:
        reader.found(element, f"{v.name}: is the derivative of a variable that does not exist", reference)
        return v
    return replace(v, derivative=index[reference])


def _aliases(reader: Reader, element: Element, v: Variable) -> list[Variable]:
    return [
        replace(
            v,
            name=reader.text(alias, "name", None),
            description=alias.attributes.get("description", ""),
            display_unit=alias.attributes.get("displayUnit"),
            derivative=None,
            alias_of=v.name,
            line=alias.line,
        )
        for alias in element.all("Alias")
    ]


def _unknowns(reader: Reader, structure: Element, tag: str, index: Mapping[int, int]) -> tuple[Unknown, ...]:
    unknowns = []
    for element in structure.all(tag):
        reference = reader.reference(element)
        depends = reader.indices(element, "dependencies")
        missing = [r for r in (reference, *(depends or ())) if r not in index]
        if missing:
            reader.found(element, f"<{tag}> has value references of no variable", missing)
            continue
        kinds = element.attributes.get("dependenciesKind")
        unknowns.append(
            Unknown(
                index[reference],
                None if depends is None else tuple(index[r] for r in depends),
                None if kinds is None else tuple(kinds.split()),
                element.line,
            )
        )
    return tuple(unknowns)
