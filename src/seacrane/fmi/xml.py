"""modelDescription.xml to `ModelDescription`: every problem at once, and nothing that an XML bomb could use."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Final, TypeVar
from xml.parsers import expat

from seacrane.errors import FmuError, Problem
from seacrane.fmi.description import (
    CAUSALITIES,
    INITIALS,
    TYPES,
    VARIABILITIES,
    CoSimulation,
    Experiment,
    ModelDescription,
    ScalarVariable,
    UnitDefinition,
    Unknown,
    Value,
)

FILE: Final = "modelDescription.xml"
LARGEST: Final = 32 * 1024 * 1024
DEEPEST: Final = 32
SUPPORTED: Final = "2.0"
EXPONENTS: Final = ("kg", "m", "s", "A", "K", "mol", "cd", "rad")

T = TypeVar("T")


@dataclass
class Element:
    """An XML element with the line on which it starts."""

    tag: str
    attributes: dict[str, str]
    line: int
    children: list[Element] = field(default_factory=list)

    def all(self, tag: str) -> Iterator[Element]:
        return (child for child in self.children if child.tag == tag)

    def first(self, tag: str) -> Element | None:
        return next(self.all(tag), None)


def parse_xml(text: bytes) -> Element:
    """The root element. Refuses document type declarations and entities, deep nesting, and texts above 32 MiB."""
    if len(text) > LARGEST:
        raise FmuError.at(FILE, f"is larger than {LARGEST // 2**20} MiB", value=len(text))
    parser = expat.ParserCreate()
    root = Element("", {}, 0)
    stack = [root]

    def start(tag: str, attributes: dict[str, str]) -> None:
        if len(stack) > DEEPEST:
            raise FmuError.at(_at(parser.CurrentLineNumber), f"elements are nested more than {DEEPEST} deep")
        element = Element(tag, attributes, parser.CurrentLineNumber)
        stack[-1].children.append(element)
        stack.append(element)

    def refuse(*_: object) -> None:
        raise FmuError.at(
            _at(parser.CurrentLineNumber), "has a document type declaration; entities are not accepted in an FMU"
        )

    parser.StartElementHandler = start
    parser.EndElementHandler = lambda _: stack.pop()
    parser.StartDoctypeDeclHandler = refuse
    parser.EntityDeclHandler = refuse
    try:
        parser.Parse(text, True)
    except expat.ExpatError as error:
        raise FmuError.at(_at(error.lineno), f"is not well-formed XML: {expat.ErrorString(error.code)}") from None
    except (LookupError, ValueError) as error:
        raise FmuError.at(FILE, f"has an encoding that cannot be read: {error}") from None
    return root.children[0]


def _at(line: int) -> str:
    return f"{FILE}:{line}"


class _Reader:
    """Reads attributes with their types and remembers what was wrong."""

    def __init__(self) -> None:
        self.problems: list[Problem] = []

    def text(self, element: Element, name: str, default: str | None = "") -> str:
        """The attribute; required if the default is None."""
        value = element.attributes.get(name, default)
        if value is None:
            self.problems.append(Problem(_at(element.line), f"<{element.tag}> lacks the attribute {name!r}"))
            return ""
        return value

    def choice(self, element: Element, name: str, allowed: tuple[str, ...], default: str) -> str:
        value = element.attributes.get(name, default)
        if value not in allowed:
            message = f"attribute {name!r} of <{element.tag}>"
            self.problems.append(Problem(_at(element.line), message, value, ", ".join(allowed)))
            return default
        return value

    def number(self, element: Element, name: str) -> float | None:
        return self._convert(element, name, _real, "a number")

    def boolean(self, element: Element, name: str) -> bool:
        return self._convert(element, name, _boolean, "true or false") or False

    def integer(self, element: Element, name: str) -> int | None:
        return self._convert(element, name, _integer, "an integer")

    def reference(self, element: Element) -> int:
        self.text(element, "valueReference", None)
        value = self.integer(element, "valueReference")
        if value is not None and not 0 <= value < 2**32:
            message = f"attribute 'valueReference' of <{element.tag}>"
            self.problems.append(Problem(_at(element.line), message, value, "0 to 4294967295"))
        return value or 0

    def indices(self, element: Element, name: str) -> tuple[int, ...] | None:
        return self._convert(
            element, name, lambda s: tuple(_integer(i) for i in s.split()), "a list of variable indices"
        )

    def start(self, element: Element) -> Value | None:
        if element.tag == "Real":
            return self.number(element, "start")
        if element.tag == "Boolean":
            return self._convert(element, "start", _boolean, "true or false")
        if element.tag == "String":
            return element.attributes.get("start")
        return self.integer(element, "start")

    def _convert(self, element: Element, name: str, convert: Callable[[str], T], allowed: str) -> T | None:
        text = element.attributes.get(name)
        if text is None:
            return None
        try:
            return convert(text)
        except ValueError:
            self.problems.append(Problem(_at(element.line), f"attribute {name!r} of <{element.tag}>", text, allowed))
            return None


def _real(text: str) -> float:
    special = {"INF": math.inf, "-INF": -math.inf, "NaN": math.nan}
    return special[text] if text in special else float(_plain(text))


def _integer(text: str) -> int:
    return int(_plain(text))


def _plain(text: str) -> str:
    """The text of a number, without what only Python reads as part of one."""
    if "_" in text:
        raise ValueError(text)
    return text


def _boolean(text: str) -> bool:
    if text.strip() not in ("true", "1", "false", "0"):
        raise ValueError(text)
    return text.strip() in ("true", "1")


def read_description(root: Element) -> ModelDescription:
    """The model description under this root. Raises `FmuError` with all problems found."""
    if root.tag != "fmiModelDescription":
        raise FmuError.at(FILE, f"the root element is <{root.tag}>", allowed="<fmiModelDescription>")
    version = root.attributes.get("fmiVersion")
    if version != SUPPORTED:
        raise FmuError.at(FILE, "the FMU is of another version of FMI", value=version, allowed=SUPPORTED)
    reader = _Reader()
    types = {
        reader.text(simple, "name", None): next((_unit(child) for child in simple.children), None)
        for group in root.all("TypeDefinitions")
        for simple in group.all("SimpleType")
    }
    co_simulation = root.first("CoSimulation")
    experiment = root.first("DefaultExperiment")
    structure = root.first("ModelStructure")
    if structure is None:
        reader.problems.append(Problem(FILE, "has no <ModelStructure>"))
        structure = Element("ModelStructure", {}, 0)
    variables = root.first("ModelVariables")
    if variables is None:
        reader.problems.append(Problem(FILE, "has no <ModelVariables>"))
        variables = Element("ModelVariables", {}, 0)
    description = ModelDescription(
        model_name=reader.text(root, "modelName", None),
        guid=reader.text(root, "guid", None),
        variables=tuple(_variable(reader, element) for element in variables.all("ScalarVariable")),
        co_simulation=_co_simulation(reader, co_simulation) if co_simulation else None,
        model_exchange=root.first("ModelExchange") is not None,
        description=reader.text(root, "description"),
        version=reader.text(root, "version"),
        generation_tool=reader.text(root, "generationTool"),
        naming=reader.choice(root, "variableNamingConvention", ("flat", "structured"), "flat"),
        units=tuple(_definition(reader, u) for g in root.all("UnitDefinitions") for u in g.all("Unit")),
        types=types,
        experiment=_experiment(reader, experiment) if experiment else Experiment(),
        outputs=_unknowns(reader, structure, "Outputs"),
        derivatives=_unknowns(reader, structure, "Derivatives"),
        initial_unknowns=_unknowns(reader, structure, "InitialUnknowns"),
    )
    if reader.problems:
        raise FmuError(reader.problems)
    return description


def _unit(element: Element) -> str | None:
    return element.attributes.get("unit")


def _definition(reader: _Reader, element: Element) -> UnitDefinition:
    base = element.first("BaseUnit") or Element("BaseUnit", {}, element.line)
    display = {}
    for shown in element.all("DisplayUnit"):
        factor, offset = reader.number(shown, "factor"), reader.number(shown, "offset")
        display[reader.text(shown, "name", None)] = (1.0 if factor is None else factor, offset or 0.0)
    factor = reader.number(base, "factor")
    return UnitDefinition(
        reader.text(element, "name", None),
        {key: value for key in EXPONENTS if (value := reader.integer(base, key))},
        1.0 if factor is None else factor,
        reader.number(base, "offset") or 0.0,
        display,
    )


def _co_simulation(reader: _Reader, element: Element) -> CoSimulation:
    return CoSimulation(
        model_identifier=reader.text(element, "modelIdentifier", None),
        variable_step=reader.boolean(element, "canHandleVariableCommunicationStepSize"),
        interpolates_inputs=reader.boolean(element, "canInterpolateInputs"),
        needs_execution_tool=reader.boolean(element, "needsExecutionTool"),
        once_per_process=reader.boolean(element, "canBeInstantiatedOnlyOncePerProcess"),
        saves_state=reader.boolean(element, "canGetAndSetFMUstate"),
        serializes_state=reader.boolean(element, "canSerializeFMUstate"),
        directional_derivative=reader.boolean(element, "providesDirectionalDerivative"),
    )


def _experiment(reader: _Reader, element: Element) -> Experiment:
    return Experiment(*(reader.number(element, name) for name in ("startTime", "stopTime", "tolerance", "stepSize")))


def _variable(reader: _Reader, element: Element) -> ScalarVariable:
    typed = next((child for child in element.children if child.tag in TYPES), None)
    if typed is None:
        reader.problems.append(Problem(_at(element.line), "<ScalarVariable> has no type", allowed=", ".join(TYPES)))
        typed = Element("Real", {}, element.line)
    causality = reader.choice(element, "causality", CAUSALITIES, "local")
    variability = reader.choice(element, "variability", VARIABILITIES, "continuous")
    initial = element.attributes.get("initial")
    if initial is not None:
        initial = reader.choice(element, "initial", INITIALS, "exact")
    return ScalarVariable(
        name=reader.text(element, "name", None),
        value_reference=reader.reference(element),
        type=typed.tag,
        causality=causality,
        variability=variability,
        initial=initial or default_initial(causality, variability),
        start=reader.start(typed),
        unit=_unit(typed),
        display_unit=typed.attributes.get("displayUnit"),
        minimum=reader.number(typed, "min"),
        maximum=reader.number(typed, "max"),
        nominal=reader.number(typed, "nominal"),
        derivative=reader.integer(typed, "derivative"),
        declared_type=typed.attributes.get("declaredType"),
        description=element.attributes.get("description", ""),
        line=element.line,
    )


def default_initial(causality: str, variability: str) -> str | None:
    """What `initial` means if it is not given (FMI 2.0.4, section 2.2.7, table of causality and variability)."""
    if causality == "parameter" or variability == "constant":
        return "exact"
    if causality in ("calculatedParameter", "output", "local"):
        return "calculated"
    return None


def _unknowns(reader: _Reader, structure: Element, group: str) -> tuple[Unknown, ...]:
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
