"""Elements and attributes of modelDescription.xml: what may stand where.

From the schemas of FMI 1.0 for Co-Simulation, FMI 2.0 (section 2.2) and FMI 3.0 (section 2.4).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
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


CHAPTER1: Final = "FMI 1.0, chapter Model Description Schema"

_LIMITS1 = "quantity min max"
_REAL1 = f"{_LIMITS1} unit displayUnit relativeQuantity nominal"
_CAN1 = (
    "canHandleVariableCommunicationStepSize canHandleEvents canRejectSteps canInterpolateInputs "
    "maxOutputDerivativeOrder canRunAsynchronuously canSignalEvents canBeInstantiatedOnlyOncePerProcess "
    "canNotUseMemoryManagementFunctions"
)

RULES1: Final = {
    "fmiModelDescription": Rule(
        "",
        "fmiVersion modelName modelIdentifier guid numberOfContinuousStates numberOfEventIndicators",
        "description author version generationTool generationDateAndTime variableNamingConvention",
        "UnitDefinitions TypeDefinitions DefaultExperiment VendorAnnotations ModelVariables Implementation",
    ),
    "UnitDefinitions": Rule("", children="BaseUnit"),
    "BaseUnit": Rule("", "unit", children="DisplayUnitDefinition"),
    "DisplayUnitDefinition": Rule("", "displayUnit", "gain offset"),
    "TypeDefinitions": Rule("", children="Type"),
    "Type": Rule("", "name", "description", "RealType IntegerType BooleanType StringType EnumerationType", choice=True),
    "RealType": Rule("", optional=_REAL1),
    "IntegerType": Rule("", optional=_LIMITS1),
    "BooleanType": Rule(""),
    "StringType": Rule(""),
    "EnumerationType": Rule("", optional=_LIMITS1, children="Item"),
    "Item": Rule("", "name", "description"),
    "DefaultExperiment": Rule("", optional="startTime stopTime tolerance"),
    "ModelVariables": Rule("", children="ScalarVariable"),
    "ScalarVariable": Rule(
        "",
        "name valueReference",
        "description variability causality alias",
        "Real Integer Boolean String Enumeration DirectDependency",
        choice=True,
    ),
    "Real": Rule("", optional=f"declaredType {_REAL1} start fixed"),
    "Integer": Rule("", optional=f"declaredType {_LIMITS1} start fixed"),
    "Boolean": Rule("", optional="declaredType start fixed"),
    "String": Rule("", optional="declaredType start fixed"),
    "Enumeration": Rule("", "declaredType", f"{_LIMITS1} start fixed"),
    "DirectDependency": Rule("", children="Name"),
    "Name": Rule(""),
    "Implementation": Rule("", children="CoSimulation_StandAlone CoSimulation_Tool", choice=True),
    "CoSimulation_StandAlone": Rule("", children="Capabilities+"),
    "CoSimulation_Tool": Rule("", children="Capabilities+ Model+"),
    "Capabilities": Rule("", optional=_CAN1),
    "Model": Rule("", "entryPoint type", "manualStart", "File"),
    "File": Rule("", "file"),
}

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


_INTERFACE3 = (
    "needsExecutionTool canBeInstantiatedOnlyOncePerProcess canGetAndSetFMUState canSerializeFMUState "
    "providesDirectionalDerivatives providesAdjointDerivatives providesPerElementDependencies"
)
_SLAVE3 = (
    "canHandleVariableCommunicationStepSize fixedInternalStepSize maxOutputDerivativeOrder "
    "recommendedIntermediateInputSmoothness providesIntermediateUpdate mightReturnEarlyFromDoStep "
    "canReturnEarlyAfterIntermediateUpdate hasEventMode providesEvaluateDiscreteStates"
)
_VARIABLE3 = "description causality variability canHandleMultipleSetPerTimeInstant clocks"
_ARRAY3 = f"{_VARIABLE3} intermediateUpdate previous declaredType initial"
_REAL3 = "quantity unit displayUnit relativeQuantity unbounded min max nominal"
_CLOCK3 = (
    "canBeDeactivated priority intervalDecimal shiftDecimal supportsFraction resolution intervalCounter shiftCounter"
)
_INTEGERS3 = ("Int8", "UInt8", "Int16", "UInt16", "Int32", "UInt32", "Int64", "UInt64")
_UNKNOWN3 = Rule("2.4.8", "valueReference", "dependencies dependenciesKind", "Annotations")
_TYPES3 = (
    *(f"{tag}Type" for tag in ("Float32", "Float64", *_INTEGERS3)), "BooleanType", "StringType", "BinaryType",
    "EnumerationType", "ClockType",
)  # fmt: skip

RULES3: Final = {
    "fmiModelDescription": Rule(
        "2.4.1",
        "fmiVersion modelName instantiationToken",
        "description author version copyright license generationTool generationDateAndTime variableNamingConvention",
        "ModelExchange CoSimulation ScheduledExecution UnitDefinitions TypeDefinitions LogCategories "
        "DefaultExperiment ModelVariables+ ModelStructure+ Annotations",
    ),
    "ModelExchange": Rule(
        "3.4",
        "modelIdentifier",
        f"{_INTERFACE3} needsCompletedIntegratorStep providesEvaluateDiscreteStates",
        "Annotations",
    ),
    "CoSimulation": Rule("4.4", "modelIdentifier", f"{_INTERFACE3} {_SLAVE3}", "Annotations"),
    "ScheduledExecution": Rule("5.4", "modelIdentifier", _INTERFACE3, "Annotations"),
    "UnitDefinitions": Rule("2.4.3", children="Unit+"),
    "Unit": Rule("2.4.3", "name", children="BaseUnit DisplayUnit Annotations"),
    "BaseUnit": Rule("2.4.3", optional=" ".join((*EXPONENTS, "factor", "offset"))),
    "DisplayUnit": Rule("2.4.3", "name", "factor offset inverse", "Annotations"),
    "TypeDefinitions": Rule("2.4.4", children=" ".join(_TYPES3), choice=True),
    "Float32Type": Rule("2.4.4", "name", f"description {_REAL3}", "Annotations"),
    "Float64Type": Rule("2.4.4", "name", f"description {_REAL3}", "Annotations"),
    **{f"{tag}Type": Rule("2.4.4", "name", "description quantity min max", "Annotations") for tag in _INTEGERS3},
    "BooleanType": Rule("2.4.4", "name", "description", "Annotations"),
    "StringType": Rule("2.4.4", "name", "description", "Annotations"),
    "BinaryType": Rule("2.4.4", "name", "description mimeType maxSize", "Annotations"),
    "EnumerationType": Rule("2.4.4", "name", "description quantity min max", "Annotations Item+"),
    "Item": Rule("2.4.4", "name value", "description", "Annotations"),
    "ClockType": Rule("2.4.4", "name intervalVariability", f"description {_CLOCK3}", "Annotations"),
    "LogCategories": Rule("2.4.5", children="Category+"),
    "Category": Rule("2.4.5", "name", "description", "Annotations"),
    "DefaultExperiment": Rule("2.4.6", optional="startTime stopTime tolerance stepSize", children="Annotations"),
    "ModelVariables": Rule(
        "2.4.7",
        children=" ".join(("Float32", "Float64", *_INTEGERS3, "Boolean", "String", "Binary", "Enumeration", "Clock")),
        choice=True,
    ),
    **{
        tag: Rule(
            "2.4.7",
            "name valueReference",
            f"{_ARRAY3} {_REAL3} start derivative reinit",
            "Annotations Dimension Alias",
        )
        for tag in ("Float32", "Float64")
    },
    **{
        tag: Rule("2.4.7", "name valueReference", f"{_ARRAY3} quantity min max start", "Annotations Dimension Alias")
        for tag in _INTEGERS3
    },
    "Enumeration": Rule(
        "2.4.7",
        "name valueReference declaredType",
        f"{_ARRAY3} quantity min max start",
        "Annotations Dimension Alias",
    ),
    "Boolean": Rule("2.4.7", "name valueReference", f"{_ARRAY3} start", "Annotations Dimension Alias"),
    "String": Rule("2.4.7", "name valueReference", _ARRAY3, "Annotations Dimension Start Alias"),
    "Binary": Rule("2.4.7", "name valueReference", f"{_ARRAY3} mimeType maxSize", "Annotations Dimension Start Alias"),
    "Clock": Rule(
        "2.4.7", "name valueReference intervalVariability", f"{_VARIABLE3} declaredType {_CLOCK3}", "Annotations Alias"
    ),
    "Dimension": Rule("2.4.7", optional="start valueReference"),
    "Start": Rule("2.4.7", "value"),
    "Alias": Rule("2.4.7", "name", "description displayUnit", "Annotations"),
    "ModelStructure": Rule(
        "2.4.8", children="Output ContinuousStateDerivative ClockedState InitialUnknown EventIndicator"
    ),
    "Output": _UNKNOWN3,
    "ContinuousStateDerivative": _UNKNOWN3,
    "ClockedState": _UNKNOWN3,
    "InitialUnknown": _UNKNOWN3,
    "EventIndicator": _UNKNOWN3,
}

_SECTIONS3: Final = {
    "2.2.1": "2.4.1", "2.2.2": "2.4.3", "2.2.7": "2.4.7", "2.2.8": "2.4.8", "2.2.9": "2.4.7", "2.3": "2.5",
    "4.3.1": "4.4",
}  # fmt: skip
"""Where FMI 3.0 has what is in this section of FMI 2.0."""


def cited(section: str, version: str) -> str:
    """A section of FMI 2.0, or the one that takes its place in another version, as it is cited."""
    if version == "1.0":
        return CHAPTER1
    if version == "2.0":
        return f"FMI 2.0, section {section}"
    return f"FMI 3.0, section {_SECTIONS3[section]}"


def structure_problems(element: Element, version: str) -> Iterator[Problem]:
    """Elements and attributes that are missing, unknown or out of order, below and including this element."""
    if version == "1.0":
        yield from _problems(element, RULES1, CHAPTER1)
    elif version == "2.0":
        yield from _problems(element, RULES, "FMI 2.0")
    elif version.startswith("3."):
        yield from _problems(element, RULES3, "FMI 3.0")


def _problems(element: Element, rules: Mapping[str, Rule], standard: str) -> Iterator[Problem]:
    rule = rules.get(element.tag)
    if rule is None:
        return  # vendor annotations hold what the vendor likes
    where = f"{FILE}:{element.line}"
    section = f"{standard}, section {rule.section}" if rule.section else standard
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
        yield from _problems(child, rules, standard)
    for tag in rule.children.split():
        if tag.endswith("+") and element.first(tag[:-1]) is None:
            yield Problem(where, f"<{element.tag}> has no <{tag[:-1]}>", hint=section)
