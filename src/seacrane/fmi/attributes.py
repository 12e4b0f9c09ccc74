"""Attributes of XML elements as typed values, with every problem remembered; what both versions of FMI share."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Final, TypeVar

from seacrane.errors import FmuError, Problem
from seacrane.fmi.description import Experiment, Scalar, UnitDefinition
from seacrane.fmi.xml import EXPONENTS, FILE, Element

T = TypeVar("T")

_INHERITED: Final[tuple[str, ...]] = (
    "quantity",
    "unit",
    "displayUnit",
    "relativeQuantity",
    "unbounded",
    "min",
    "max",
    "nominal",
)
"""Attributes that a variable takes from its declared type if it does not give them itself."""


MOST_PROBLEMS: Final = 200
"""Problems of one description that are told; a file with more is given up."""
MOST_ITEMS: Final = 1_000_000
"""Items of a list in one attribute: start values, dependencies."""
LONGEST_SHOWN: Final = 200


def at(line: int) -> str:
    """Where a line of the model description is, for messages."""
    return f"{FILE}:{line}"


class Reader:
    """Reads attributes with their types and remembers what was wrong."""

    def __init__(self) -> None:
        self.problems: list[Problem] = []

    def text(self, element: Element, name: str, default: str | None = "") -> str:
        """The attribute; required if the default is None."""
        value = element.attributes.get(name, default)
        if value is None:
            self.found(element, f"<{element.tag}> lacks the attribute {name!r}")
            return ""
        return value

    def found(self, element: Element, message: str, value: object = None, allowed: str | None = None) -> None:
        """Remembers what is wrong with an element. Raises `FmuError` when that is too much to go on."""
        self.problems.append(Problem(at(element.line), shortened(message), _shown(value), allowed))
        if len(self.problems) >= MOST_PROBLEMS:
            raise FmuError([*self.problems, Problem(FILE, f"has more than {MOST_PROBLEMS} problems")])

    def choice(self, element: Element, name: str, allowed: tuple[str, ...], default: str) -> str:
        value = element.attributes.get(name, default)
        if value not in allowed:
            self.found(element, f"attribute {name!r} of <{element.tag}>", value, ", ".join(allowed))
            return default
        return value

    def number(self, element: Element, name: str) -> float | None:
        return self.convert(element, name, to_real, "a number")

    def boolean(self, element: Element, name: str) -> bool:
        return self.convert(element, name, to_boolean, "true or false") or False

    def integer(self, element: Element, name: str) -> int | None:
        return self.convert(element, name, to_integer, "an integer")

    def reference(self, element: Element) -> int:
        self.text(element, "valueReference", None)
        value = self.integer(element, "valueReference")
        if value is not None and not 0 <= value < 2**32:
            self.found(element, f"attribute 'valueReference' of <{element.tag}>", value, "0 to 4294967295")
        return value or 0

    def indices(self, element: Element, name: str) -> tuple[int, ...] | None:
        return self.convert(
            element, name, lambda s: tuple(to_integer(i) for i in items(s)), "a list of variable indices"
        )

    def convert(self, element: Element, name: str, convert: Callable[[str], T], allowed: str) -> T | None:
        text = element.attributes.get(name)
        if text is None:
            return None
        try:
            return convert(text)
        except ValueError:
            self.found(element, f"attribute {name!r} of <{element.tag}>", text, allowed)
            return None


def items(text: str) -> list[str]:
    """The items of a list in an attribute; `ValueError` if there are too many to be meant."""
    if len(text) > 2 * MOST_ITEMS and text.count(" ") >= MOST_ITEMS:
        raise ValueError(text)
    return text.split()


def shortened(text: str) -> str:
    """A text from a file as it is shown in a message."""
    return text if len(text) <= LONGEST_SHOWN else f"{text[: LONGEST_SHOWN - 3]}..."


def _shown(value: object) -> object:
    if isinstance(value, str):
        return shortened(value)
    return [*value[:10], "..."] if isinstance(value, list) and len(value) > 10 else value


def to_real(text: str) -> float:
    special = {"INF": math.inf, "-INF": -math.inf, "NaN": math.nan}
    return special[text] if text in special else float(_plain(text))


def to_integer(text: str) -> int:
    return int(_plain(text))


def _plain(text: str) -> str:
    """The text of a number, without what only Python reads as part of one."""
    if "_" in text:
        raise ValueError(text)
    return text


def to_boolean(text: str) -> bool:
    if text.strip() not in ("true", "1", "false", "0"):
        raise ValueError(text)
    return text.strip() in ("true", "1")


def inherited(element: Element, types: Mapping[str, Element]) -> Element:
    """The element of a variable's type with what its declared type says beside its own attributes."""
    declared = types.get(element.attributes.get("declaredType", ""))
    if declared is None:
        return element
    taken = {name: declared.attributes[name] for name in _INHERITED if name in declared.attributes}
    return Element(element.tag, {**taken, **element.attributes}, element.line, element.children)


def typed_element(reader: Reader, variable: Element, tags: tuple[str, ...], types: Mapping[str, Element]) -> Element:
    """The element below a <ScalarVariable> of FMI 1.0 and 2.0 that says of which type it is."""
    typed = next((child for child in variable.children if child.tag in tags), None)
    if typed is None:
        reader.found(variable, "<ScalarVariable> has no type", allowed=", ".join(tags))
        return Element("Real", {}, variable.line)
    return inherited(typed, types)


def start_value(reader: Reader, typed: Element) -> Scalar | None:
    """The start value of a scalar of FMI 1.0 or 2.0."""
    if typed.tag == "Real":
        return reader.number(typed, "start")
    if typed.tag == "Boolean":
        return reader.convert(typed, "start", to_boolean, "true or false")
    if typed.tag == "String":
        return typed.attributes.get("start")
    return reader.integer(typed, "start")


def enumeration_items(reader: Reader, declared: Element | None) -> Mapping[str, int]:
    """The items of an enumeration by name; in FMI 1.0 they have no value and count from 1."""
    items = {}
    for place, item in enumerate(declared.all("Item") if declared else (), start=1):
        value = reader.integer(item, "value")
        items[reader.text(item, "name", None)] = place if value is None else value
    return items


def definition(reader: Reader, element: Element) -> UnitDefinition:
    given = element.first("BaseUnit")
    base = given or Element("BaseUnit", {}, element.line)
    display = {}
    for shown in element.all("DisplayUnit"):
        factor, offset = reader.number(shown, "factor"), reader.number(shown, "offset")
        display[reader.text(shown, "name", None)] = (1.0 if factor is None else factor, offset or 0.0)
    factor = reader.number(base, "factor")
    return UnitDefinition(
        reader.text(element, "name", None),
        {key: value for key in EXPONENTS if (value := reader.integer(base, key))} if given else None,
        1.0 if factor is None else factor,
        reader.number(base, "offset") or 0.0,
        display,
    )


def experiment(reader: Reader, element: Element) -> Experiment:
    return Experiment(*(reader.number(element, name) for name in ("startTime", "stopTime", "tolerance", "stepSize")))
