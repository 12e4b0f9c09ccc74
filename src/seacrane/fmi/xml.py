"""XML of strangers as a tree of elements with their lines, and nothing that an XML bomb could use."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Final
from xml.parsers import expat

from seacrane.errors import FmuError

FILE: Final = "modelDescription.xml"
LARGEST: Final = 32 * 1024 * 1024
DEEPEST: Final = 32
MOST_PARTS: Final = 2_000_000
"""Elements and attributes together: each takes some 200 bytes, so that a hostile file cannot fill the memory."""
LONGEST_NAME: Final = 256
_LONGEST_TEXT = 4096
EXPONENTS: Final = ("kg", "m", "s", "A", "K", "mol", "cd", "rad")


@dataclass(slots=True)
class Element:
    """An XML element with the line on which it starts, and the text in it."""

    tag: str
    attributes: dict[str, str]
    line: int
    children: list[Element] = field(default_factory=list)
    text: str = ""

    def all(self, tag: str) -> Iterator[Element]:
        return (child for child in self.children if child.tag == tag)

    def first(self, tag: str) -> Element | None:
        return next(self.all(tag), None)


def parse_xml(text: bytes, file: str = FILE, *, local: bool = False) -> Element:
    """The root element. Refuses document type declarations and entities, deep nesting, and texts above 32 MiB.

    `file` is its name in messages. With `local`, tags are given without the prefix of their name space.
    """
    if len(text) > LARGEST:
        raise FmuError.at(file, f"is larger than {LARGEST // 2**20} MiB", value=len(text))
    parser = expat.ParserCreate()
    root = Element("", {}, 0)
    stack = [root]
    parts = 0

    def here() -> str:
        return f"{file}:{parser.CurrentLineNumber}"

    def start(tag: str, attributes: dict[str, str]) -> None:
        if len(stack) > DEEPEST:
            raise FmuError.at(here(), f"elements are nested more than {DEEPEST} deep")
        if any(len(name) > LONGEST_NAME for name in (tag, *attributes)):
            raise FmuError.at(
                here(), f"has an element or attribute whose name is longer than {LONGEST_NAME} characters"
            )
        nonlocal parts
        parts += 1 + len(attributes)
        if parts > MOST_PARTS:
            raise FmuError.at(here(), f"has more than {MOST_PARTS} elements and attributes")
        element = Element(tag.rpartition(":")[2] if local else tag, attributes, parser.CurrentLineNumber)
        stack[-1].children.append(element)
        stack.append(element)

    def write(text: str) -> None:
        if len(stack[-1].text) < _LONGEST_TEXT and not text.isspace():
            stack[-1].text += text

    def refuse(*_: object) -> None:
        raise FmuError.at(here(), "has a document type declaration; entities are not accepted in an FMU")

    parser.StartElementHandler = start
    parser.EndElementHandler = lambda _: stack.pop()
    parser.CharacterDataHandler = write
    parser.StartDoctypeDeclHandler = refuse
    parser.EntityDeclHandler = refuse
    try:
        parser.Parse(text, True)
    except expat.ExpatError as error:
        raise FmuError.at(
            f"{file}:{error.lineno}", f"is not well-formed XML: {expat.ErrorString(error.code)}"
        ) from None
    except (LookupError, ValueError) as error:
        raise FmuError.at(file, f"has an encoding that cannot be read: {error}") from None
    return root.children[0]
