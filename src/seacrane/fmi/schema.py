"""Elements and attributes of modelDescription.xml in FMI 2.0: what may stand where (FMI 2.0.4, section 2.2)."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

from seacrane.errors import Problem, nearest
from seacrane.fmi.xml import EXPONENTS, FILE, Element


@dataclass(frozen=True)
class Rule:
    """An element: attributes it must and may have, and its children in their order (a `+` marks a required one).

    `choice` lets the children come in any order. `section` is where the standard defines it.
    """

    section: str
    required: str = ""
    optional: str = ""
    children: str = ""
    choice: bool = False


_SLAVE = (
    "needsExecutionTool canHandleVariableCommunicationStepSize canInterpolateInputs maxOutputDerivativeOrder "
    "canRunAsynchronuously canBeInstantiatedOnlyOncePerProcess canNotUseMemoryManagementFunctions "
    "canGetAndSetFMUstate canSerializeFMUstate providesDirectionalDerivative"
)
_MODEL = (
    "needsExecutionTool completedIntegratorStepNotNeeded canBeInstantiatedOnlyOncePerProcess "
    "canNotUseMemoryManagementFunctions canGetAndSetFMUstate canSerializeFMUstate providesDirectionalDerivative"
)
_REAL = "quantity unit displayUnit relativeQuantity min max nominal unbounded"
_UNKNOWNS = Rule("2.2.8", children="Unknown")

RULES: Final = {
    "fmiModelDescription": Rule(
        "2.2.1",
        "fmiVersion modelName guid",
        "description author version copyright license generationTool generationDateAndTime variableNamingConvention "
        "numberOfEventIndicators",
        "ModelExchange CoSimulation UnitDefinitions TypeDefinitions LogCategories DefaultExperiment VendorAnnotations "
        "ModelVariables+ ModelStructure+",
    ),
    "ModelExchange": Rule("3.3.1", "modelIdentifier", _MODEL, "SourceFiles"),
    "CoSimulation": Rule("4.3.1", "modelIdentifier", _SLAVE, "SourceFiles"),
    "SourceFiles": Rule("3.3.1", children="File+"),
    "File": Rule("3.3.1", "name"),
    "UnitDefinitions": Rule("2.2.2", children="Unit+"),
    "Unit": Rule("2.2.2", "name", children="BaseUnit DisplayUnit"),
    "BaseUnit": Rule("2.2.2", optional=" ".join((*EXPONENTS, "factor", "offset"))),
    "DisplayUnit": Rule("2.2.2", "name", "factor offset"),
    "TypeDefinitions": Rule("2.2.3", children="SimpleType+"),
    "SimpleType": Rule("2.2.3", "name", "description", "Real Integer Boolean String Enumeration", choice=True),
    "LogCategories": Rule("2.2.4", children="Category+"),
    "Category": Rule("2.2.4", "name", "description"),
    "DefaultExperiment": Rule("2.2.5", optional="startTime stopTime tolerance stepSize"),
    "ModelVariables": Rule("2.2.7", children="ScalarVariable+"),
    "ScalarVariable": Rule(
        "2.2.7",
        "name valueReference",
        "description causality variability initial canHandleMultipleSetPerTimeInstant previous clocked",
        "Real Integer Boolean String Enumeration Annotations",
        choice=True,
    ),
    "Real": Rule("2.2.7", optional=f"declaredType {_REAL} start derivative reinit"),
    "Integer": Rule("2.2.7", optional="declaredType quantity min max start"),
    "Boolean": Rule("2.2.7", optional="declaredType start"),
    "String": Rule("2.2.7", optional="declaredType start"),
    "Enumeration": Rule("2.2.7", optional="declaredType quantity min max start", children="Item"),
    "Item": Rule("2.2.3", "name value", "description"),
    "ModelStructure": Rule("2.2.8", children="Outputs Derivatives DiscreteStates InitialUnknowns"),
    "Outputs": _UNKNOWNS,
    "Derivatives": _UNKNOWNS,
    "DiscreteStates": _UNKNOWNS,
    "InitialUnknowns": _UNKNOWNS,
    "Unknown": Rule("2.2.8", "index", "dependencies dependenciesKind"),
}


def structure_problems(element: Element) -> Iterator[Problem]:
    """Elements and attributes that are missing, unknown or out of order, below and including this element."""
    rule = RULES.get(element.tag)
    if rule is None:
        return  # vendor annotations hold what the vendor likes
    where, section = f"{FILE}:{element.line}", f"FMI 2.0.4, section {rule.section}"
    required, optional = rule.required.split(), rule.optional.split()
    for name in required:
        if name not in element.attributes:
            yield Problem(where, f"<{element.tag}> lacks the attribute {name!r}", hint=section)
    for name in element.attributes:
        if name not in required + optional and ":" not in name:
            hint = f"{nearest(name, required + optional)} {section}"
            yield Problem(where, f"<{element.tag}> has an unknown attribute {name!r}", hint=hint)
    order = [child.rstrip("+") for child in rule.children.split()]
    latest = 0
    for child in element.children:
        if child.tag not in order:
            yield Problem(f"{FILE}:{child.line}", f"<{child.tag}> does not belong into <{element.tag}>", hint=section)
            continue
        place = order.index(child.tag)
        if place < latest and not rule.choice:
            yield Problem(f"{FILE}:{child.line}", f"<{child.tag}> stands after <{order[latest]}>", hint=section)
        latest = max(latest, place)
        yield from structure_problems(child)
    for tag in rule.children.split():
        if tag.endswith("+") and element.first(tag[:-1]) is None:
            yield Problem(where, f"<{element.tag}> has no <{tag[:-1]}>", hint=section)
