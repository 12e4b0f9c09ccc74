"""Model files: a diagram as versioned JSON.

    {
      "format": "seacrane-model/1",
      "name": "filling",
      "shared": {"density": "860 kg/m3"},
      "parts": {
        "pump": {
          "component": "hydraulics.Pump", "level": "constant-pressure", "parameters": {"pressure": "210 bar"}
        },
        "edge": {"component": "hydraulics.Orifice", "parameters": {"diameter": "3 mm"}},
        "volume": {"component": "hydraulics.Volume", "parameters": {"volume": "5 l"}}
      },
      "connections": [["pump.p", "edge.a"], ["edge.b", "volume.a"]],
      "exposed": {}
    }

A quantity is a text with a unit or a number in SI. A component is named by its room in the library and its interface,
`hydraulics.DoubleActingCylinder`, with its `level` if it has several; one of your own by its module and name. A part
that is a diagram itself is written as {"diagram": {...}}, with the same fields but the format. A file written by
`save` gives every value, in engineering units where that loses nothing, and reads back equal.
"""

from __future__ import annotations

import importlib
import json
import os
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import Any, Final

import msgspec

from seacrane import documents
from seacrane.errors import ModelFileError, ParameterError, Problem, SeacraneError, StructureError, UnitError, nearest
from seacrane.units import Quantity, display, parse, unit

from .component import REGISTRY, Component, Declaration, check_value, interface_of, shared_default
from .diagram import Diagram, PortHandle

FORMAT: Final = "seacrane-model/1"

Migration = Callable[[dict[str, Any]], dict[str, Any]]
MIGRATIONS: Final[Mapping[str, Migration]] = {}
"""For each older format, what makes the data of the next format from data of that one (its `format` included)."""

ROOMS: Final[Mapping[str, str]] = {room: f"seacrane.library.{room}" for room in ("hydraulics", "mechanics", "signals")}
"""Modules whose components a file names by room; they are loaded when the first file is read."""


_CONNECTION: Final = re.compile(r'\[\n\s+("[^"\n]*"(?:,\n\s+"[^"\n]*")*)\n\s+\]')
"""A list of texts spread over lines: connections are put on one line each."""


class PartRecord(msgspec.Struct, frozen=True, kw_only=True, omit_defaults=True):
    """A part in a model file: a component with its level and parameters, or a diagram."""

    component: str | None = None
    level: str | None = None
    parameters: dict[str, Any] = {}
    diagram: ModelRecord | None = None


class ModelRecord(msgspec.Struct, frozen=True, kw_only=True, omit_defaults=True):
    """The content of a model file, as it stands there. A diagram inside another has no format of its own."""

    format: str | None = None
    name: str
    shared: dict[str, Any]
    parts: dict[str, PartRecord]
    connections: tuple[tuple[str, ...], ...]
    exposed: dict[str, str]


# ---------------------------------------------------------------- names of components
def public_name(component: type[Component]) -> str:
    """The name of a component's interface in files: `hydraulics.DoubleActingCylinder`."""
    interface = interface_of(component)
    module = interface.__module__
    room = next((r for r, path in ROOMS.items() if module == path or module.startswith(path + ".")), module)
    return f"{room}.{interface.__name__}"


def interfaces() -> dict[str, type[Component]]:
    """All interfaces that a model file may name."""
    for module in ROOMS.values():
        importlib.import_module(module)
    found: dict[str, type[Component]] = {}
    for component in REGISTRY:
        found[public_name(component)] = interface_of(component)
    return found


# ---------------------------------------------------------------- writing
def save(diagram: Diagram, path: str | os.PathLike[str]) -> None:
    """Write a diagram as a model file; an existing file is replaced only once the new one is complete."""
    documents.write(to_json(diagram), path)


def to_json(diagram: Diagram) -> str:
    """The model file of a diagram, which `loads` reads back equal."""
    plain = msgspec.to_builtins(record(diagram))
    text = json.dumps(plain, indent=2, ensure_ascii=False, allow_nan=False)
    return _CONNECTION.sub(lambda found: "[" + re.sub(r"\n\s+", " ", found[1]) + "]", text) + "\n"


def record(diagram: Diagram, form: str | None = FORMAT) -> ModelRecord:
    """The content of the model file of a diagram."""
    declared = _shared_declarations()
    return ModelRecord(
        format=form,
        name=diagram.name,
        shared={name: _text(value, declared.get(name, (None, None))[1]) for name, value in diagram.shared.items()},
        parts={name: _part_record(part.content) for name, part in diagram.parts.items()},
        connections=tuple(tuple(handle.path for handle in joined) for joined in diagram.connections),
        exposed={name: handle.path for name, handle in diagram.exposed.items()},
    )


def _part_record(component: Component | Diagram) -> PartRecord:
    if isinstance(component, Diagram):
        return PartRecord(diagram=record(component, None))
    values = {}
    for name, (declaration, quantity) in type(component).declarations.items():
        if declaration.role == "shared" and shared_default(component, name) is not None:
            continue
        value = getattr(component, name)
        values[name] = value if declaration.role == "option" else _text(value, quantity)
    return PartRecord(component=public_name(type(component)), level=component.level, parameters=values)


def _text(value: float, quantity: Quantity | None) -> str | float:
    """The shortest text that reads back exactly, the engineering unit before the SI unit."""
    number = float(value)
    if quantity is None or quantity.unit == "1":
        return number
    shown = quantity.display
    scaled = number / unit(shown).factor
    texts = (f"{scaled:.12g} {shown}", f"{scaled!r} {shown}", f"{number!r} {quantity.unit}")
    return min((text for text in texts if parse(text, quantity.unit) == number), key=len)


# ---------------------------------------------------------------- reading
def load(path: str | os.PathLike[str]) -> Diagram:
    """The diagram of a model file. `ModelFileError` lists everything that is wrong."""
    return loads(documents.read(path, ModelFileError), origin=os.fspath(path))


def loads(content: bytes | str, origin: str = "model") -> Diagram:
    """The diagram in the JSON text of a model file; `origin` names it in errors."""
    data = documents.parsed(content, origin, ModelFileError)
    if not isinstance(data, dict):
        raise ModelFileError.at(origin, "does not hold a model: the file must be a JSON object")
    try:
        reading = _Reading(migrated(data, MIGRATIONS))
    except ModelFileError as error:
        raise ModelFileError(_placed(error.problems, f"{origin}: ")) from None
    try:
        diagram = reading.diagram()
    except RecursionError:
        raise ModelFileError.at(origin, "cannot be read: diagrams in diagrams are nested too deeply") from None
    if reading.problems or diagram is None:
        raise ModelFileError(_placed(reading.problems, f"{origin}: "))
    return diagram


def migrated(data: dict[str, Any], migrations: Mapping[str, Migration]) -> dict[str, Any]:
    """Data of the present format from data of any format that there is a migration for."""
    seen: set[str] = set()
    while (written := data.get("format")) != FORMAT:
        if not isinstance(written, str) or written not in migrations or written in seen:
            what = "is missing" if written is None else "is of a format that this version cannot read"
            allowed = ", ".join(map(repr, (FORMAT, *migrations)))
            raise ModelFileError.at("format", what, value=written, allowed=allowed)
        seen.add(written)
        data = migrations[written](data)
    return data


def _placed(problems: Sequence[Problem], prefix: str) -> Iterator[Problem]:
    for p in problems:
        yield Problem(f"{prefix}{p.path}", p.message, p.value, p.allowed, p.hint)


class _Reading:
    """One pass over the data, which notes every problem and goes on."""

    FIELDS: Final = ("format", "name", "shared", "parts", "connections", "exposed")

    def __init__(self, data: dict[str, Any]) -> None:
        self.data = data
        self.problems: list[Problem] = []

    def note(self, path: str, message: str, **more: Any) -> None:
        self.problems.append(Problem(path, message, **more))

    def diagram(self) -> Diagram | None:
        """The diagram, as far as it could be read."""
        for name in self.data:
            if name not in self.FIELDS:
                self.note(name, "is not a field of a model", hint=nearest(name, self.FIELDS))
        title = self.data.get("name")
        if not isinstance(title, str) or not title.strip():
            self.note("name", "must be a text that is not empty", value=title)
            title = "model"
        known = interfaces()
        read = {n: self.part(f"parts.{n}", raw, known) for n, raw in self.object("parts").items()}
        contents = {n: content for n, (_, content) in read.items() if content is not None}
        diagram = Diagram(title, **self.shared())
        for part_name, content in contents.items():
            try:
                diagram.add(part_name, content)
            except StructureError as error:
                self.problems += error.problems
        ports = {n: known_ports for n, (known_ports, _) in read.items()}
        self.connections(diagram, ports)
        self.exposed(diagram, ports)
        return diagram

    def object(self, field: str) -> dict[str, Any]:
        raw = self.data.get(field, {})
        if not isinstance(raw, dict):
            self.note(field, "must be an object", value=raw)
            return {}
        return raw

    # ------------------------------------------------------------ parts
    def part(
        self, path: str, raw: Any, known: Mapping[str, type[Component]]
    ) -> tuple[Iterable[str], Component | Diagram | None]:
        """The names of the ports of a part, and what it is; nothing and None if that could not be read."""
        if not isinstance(raw, dict):
            self.note(path, "must be an object with a component and its parameters", value=raw)
            return (), None
        for field in raw:
            if field not in PartRecord.__struct_fields__:
                hint = nearest(field, PartRecord.__struct_fields__)
                self.note(f"{path}.{field}", "is not a field of a part", hint=hint)
        if "diagram" in raw:
            return self.inner(f"{path}.diagram", raw)
        called = raw.get("component")
        interface = known.get(called) if isinstance(called, str) else None
        if interface is None:
            what = "is missing" if called is None else "is not a component"
            meant = _nearest_component(str(called), known) if called is not None else None
            self.note(f"{path}.component", what, value=called, hint=meant)
            return (), None
        level = raw.get("level")
        if level is not None and level not in interface.levels:
            allowed = ", ".join(interface.levels) or "none: it has one law"
            close = nearest(str(level), interface.levels) if interface.levels else None
            self.note(f"{path}.level", f"{called} has no level {level!r}", allowed=allowed, hint=close)
            return interface.ports, None
        cls = interface.levels[level or next(iter(interface.levels))] if interface.levels else interface
        given = raw.get("parameters", {})
        if not isinstance(given, dict):
            self.note(f"{path}.parameters", "must be an object", value=given)
            return interface.ports, None
        before = len(self.problems)
        values = {n: self.parameter(f"{path}.parameters.{n}", v, cls, n) for n, v in given.items()}
        refused = {n for n, v in values.items() if v is None}
        try:
            component = cls(**{n: v for n, v in values.items() if n not in refused})
        except ParameterError as error:
            for p in error.problems:
                own = p.path.rpartition(".")[2]
                if own not in refused:
                    self.note(f"{path}.parameters.{own}", p.message, value=p.value, allowed=p.allowed, hint=p.hint)
            return interface.ports, None
        return interface.ports, component if len(self.problems) == before else None

    def inner(self, path: str, raw: dict[str, Any]) -> tuple[Iterable[str], Diagram | None]:
        """As `part`, for a part that is a diagram."""
        for field in set(raw) - {"diagram"}:
            self.note(path.replace(".diagram", f".{field}"), "cannot be given for a part that is a diagram")
        data = raw["diagram"]
        if not isinstance(data, dict):
            self.note(path, "must be an object with the fields of a model", value=data)
            return (), None
        reading = _Reading(data)
        diagram = reading.diagram()
        self.problems += _placed(reading.problems, f"{path}.")
        return list(reading.object("exposed")), None if reading.problems else diagram

    def parameter(self, path: str, raw: Any, cls: type[Component], name: str) -> Any:
        """The value of a parameter in SI; None if it could not be read (a null is none either)."""
        if name not in cls.declarations:
            return raw  # the component itself says that it does not know it
        declaration, quantity = cls.declarations[name]
        if declaration.role == "option":
            return _tuples(raw)
        return self.quantity(path, raw, quantity, declaration.about)

    def quantity(self, path: str, raw: Any, quantity: Quantity | None, about: str) -> float | None:
        """A number in SI or a text with a unit."""
        symbol = quantity.unit if quantity else "1"
        if isinstance(raw, str):
            try:
                return parse(raw, symbol, path)
            except UnitError as error:
                p = error.problems[0]
                self.note(p.path, f"{p.message}: {about}", value=raw, allowed=p.allowed, hint=p.hint)
                return None
        if isinstance(raw, bool) or not isinstance(raw, int | float):
            example = "a number" if symbol == "1" else f"a number in {symbol}, or a text such as '5 {display(symbol)}'"
            self.note(path, f"must be {example}: {about}", value=raw)
            return None
        try:
            return float(raw)
        except OverflowError:
            self.note(path, f"must be a finite number in {symbol}: {about}", value=str(raw)[:24])
            return None

    def shared(self) -> dict[str, float]:
        """Values of shared parameters: of any that some component shares, be it of another level than those here."""
        quantities = _shared_declarations()
        values = {}
        for name, raw in self.object("shared").items():
            path = f"shared.{name}"
            if name not in quantities:
                self.note(path, "is no shared parameter of any component", hint=nearest(name, quantities))
                continue
            declaration, quantity = quantities[name]
            value = self.quantity(path, raw, quantity, declaration.about)
            if value is None:
                continue
            problem = check_value(path, value, declaration, quantity)
            if problem is not None:
                self.problems.append(problem)
            values[name] = value
        return values

    # ------------------------------------------------------------ ports
    def connections(self, diagram: Diagram, ports: Mapping[str, Iterable[str]]) -> None:
        raw = self.data.get("connections", [])
        if not isinstance(raw, list):
            self.note("connections", "must be a list", value=raw)
            return
        for i, listed in enumerate(raw):
            path = f"connections[{i}]"
            if not isinstance(listed, list):
                self.note(path, "must be a list of ports, such as ['pump.p', 'valve.p']", value=listed)
                continue
            handles = [self.port(path, text, diagram, ports) for text in listed]
            if None in handles:
                continue
            try:
                diagram.connect(*(handle for handle in handles if handle is not None))
            except StructureError as error:
                for p in error.problems:
                    self.note(path, p.message if p.path == diagram.name else f"{p.path} {p.message}", value=p.value)

    def exposed(self, diagram: Diagram, ports: Mapping[str, Iterable[str]]) -> None:
        for name, text in self.object("exposed").items():
            handle = self.port(f"exposed.{name}", text, diagram, ports)
            if handle is not None:
                diagram.expose(**{name: handle})

    def port(self, path: str, text: Any, diagram: Diagram, ports: Mapping[str, Iterable[str]]) -> PortHandle | None:
        """The port called `part.port`. Of a part that could not be read nothing more is said than that once."""
        part, dot, key = text.rpartition(".") if isinstance(text, str) else ("", "", "")
        if not dot:
            self.note(path, "must name a port, such as 'pump.p'", value=text)
            return None
        placed = diagram.parts.get(part)
        if placed is not None:
            found = {handle.name: handle for handle in placed}
            if key not in found:
                self.note(path, f"{part} has no port {key!r}", hint=nearest(key, found))
            return found.get(key)
        if part in ports:
            known = list(ports[part])
            if known and key not in known:
                self.note(path, f"{part} has no port {key!r}", hint=nearest(key, known))
        elif part not in self.object("parts"):
            self.note(path, f"there is no part {part!r}", hint=nearest(part, self.object("parts")))
        return None


def _nearest_component(called: str, known: Mapping[str, type[Component]]) -> str:
    """What was probably meant: the interface in another room or other capitals, that of a level, or near names."""
    own = called.rpartition(".")[2].lower()
    full = [repr(name) for name in known if name.rpartition(".")[2].lower() == own]
    full += [
        f"{public_name(component)!r} with level {component.level!r}"
        for component in REGISTRY
        if component.level is not None and component.__name__.lower() == own
    ]
    return f"Did you mean {' or '.join(full)}?" if full else nearest(called, known)


def _shared_declarations() -> dict[str, tuple[Declaration, Quantity | None]]:
    """All parameters that components share, by name."""
    return {
        name: declared
        for component in REGISTRY
        for name, declared in component.declarations.items()
        if declared[0].role == "shared"
    }


def _tuples(value: Any) -> Any:
    """Lists as tuples, all the way down: what a component holds never changes."""
    return tuple(_tuples(item) for item in value) if isinstance(value, list) else value


def check(path: str | os.PathLike[str]) -> list[Problem]:
    """All that is wrong with a model file: with what stands in it, or else with the equations it leads to."""
    try:
        load(path).compile()
    except SeacraneError as error:
        return list(error.problems)
    return []
