"""What the readers of system structures share: XML documents of strangers, read with every problem remembered."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TypeVar

from seacrane.cosim.structure import Connection
from seacrane.errors import CosimError, FmuError, ParameterError, Problem
from seacrane.fmi.attributes import to_boolean, to_integer, to_real
from seacrane.fmi.xml import Element, parse_xml

T = TypeVar("T")


class Document:
    """One XML file: its root, its name in messages, and where its problems go."""

    def __init__(self, text: bytes, file: str, root: str, problems: list[Problem]) -> None:
        self.file, self.problems = file, problems
        with collected(problems):
            self.root = parse_xml(text, file, local=True)
            if self.root.tag != root:
                raise CosimError.at(file, f"the root element is <{self.root.tag}>", allowed=f"<{root}>")

    def at(self, element: Element) -> str:
        return f"{self.file}:{element.line}"

    def found(
        self,
        element: Element,
        message: str,
        value: object = None,
        allowed: str | None = None,
        hint: str | None = None,
    ) -> None:
        """Remember what is wrong with an element."""
        self.problems.append(Problem(self.at(element), message, value, allowed, hint))

    def text(self, element: Element, name: str) -> str:
        """An attribute that must be there."""
        value = element.attributes.get(name)
        if value is None:
            self.found(element, f"<{element.tag}> lacks the attribute {name!r}")
        return value or ""

    def choice(self, element: Element, name: str, allowed: tuple[str, ...], default: str | None = None) -> str:
        value = element.attributes.get(name, default)
        if value not in allowed:
            self.found(element, f"attribute {name!r} of <{element.tag}>", value, ", ".join(allowed))
        return value or ""

    def number(self, element: Element, name: str, default: float | None = None) -> float:
        """A number; required if there is no default."""
        if default is None:
            self.text(element, name)
        return self._read(element, name, to_real, "a number", default or 0.0)

    def integer(self, element: Element, name: str, default: int | None = None) -> int:
        if default is None:
            self.text(element, name)
        return self._read(element, name, to_integer, "a whole number", default or 0)

    def boolean(self, element: Element, name: str, default: bool = False) -> bool:
        return self._read(element, name, to_boolean, "true or false", default)

    def content(self, name: str) -> float | None:
        """The number that an element under the root holds as its text, if there is one."""
        element = self.root.first(name)
        if element is None:
            return None
        try:
            return to_real(element.text.strip())
        except ValueError:
            self.found(element, f"<{name}> holds no number", element.text)
            return None

    def _read(self, element: Element, name: str, convert: Callable[[str], T], allowed: str, default: T) -> T:
        text = element.attributes.get(name)
        if text is None:
            return default
        try:
            return convert(text)
        except ValueError:
            self.found(element, f"attribute {name!r} of <{element.tag}>", text, allowed)
            return default


@contextmanager
def collected(problems: list[Problem]) -> Iterator[None]:
    """Raises everything that went wrong in here as one `CosimError`, with the problems found before."""
    try:
        yield
    except (CosimError, FmuError, ParameterError) as error:
        raise CosimError((*problems, *error.problems)) from None


def part_name(name: str) -> str:
    """A name that a part of a system can have: of any other character becomes `_`."""
    plain = re.sub(r"[^A-Za-z0-9_-]", "_", name)
    return plain if re.match(r"[A-Za-z_]", plain) else f"_{plain}"


def as_written(connection: Connection, source_unit: str, target_unit: str) -> Connection:
    """The connection, without a conversion where one end states no unit: its number is taken as it stands."""
    if source_unit != target_unit and "1" in (source_unit, target_unit):
        return Connection(connection.source, connection.target, connection.gain, connection.bias, convert=False)
    return connection
