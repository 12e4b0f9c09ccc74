"""The XML of an FMU as a tree of elements with their lines, and nothing that an XML bomb could use."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Final
from xml.parsers import expat

from seacrane.errors import FmuError

FILE: Final = "modelDescription.xml"
LARGEST: Final = 32 * 1024 * 1024
DEEPEST: Final = 32
EXPONENTS: Final = ("kg", "m", "s", "A", "K", "mol", "cd", "rad")


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
