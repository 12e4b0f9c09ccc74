"""A system from an SSP archive or a system structure description."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Literal
from urllib.parse import urldefrag

import numpy as np

from seacrane.cosim.documents import Document, collected, part_name
from seacrane.cosim.fmu import FmuSlave, kind_of
from seacrane.cosim.slave import Slave
from seacrane.cosim.ssp.annotations import read_experiment, read_structure
from seacrane.cosim.ssp.room import DEEPEST, Findings, Room
from seacrane.cosim.ssp.schema import (
    BUS,
    DEFINITION,
    FMU,
    IMPLEMENTATIONS,
    INTEGERS,
    KINDS,
    NUMBERS,
    PACKAGE,
    REALS,
)
from seacrane.cosim.ssp.values import Units, Value, below, linear, mapped, read_set, read_units, symbol, transformed
from seacrane.cosim.structure import Connection, Connector, Transformation, factor
from seacrane.cosim.system import System
from seacrane.errors import CosimError, FmuError, ParameterError, nearest
from seacrane.fmi.xml import Element
from seacrane.units import compatible

_PARAMETERS = ("parameter", "calculatedParameter", "structuralParameter", "constant")


def read_ssp(path: str | Path) -> System:
    """The system in an .ssp, or in an .ssd with the files beside it. `CosimError` with all that is wrong with it.

    Names of elements keep letters, digits, `_` and `-`; of any other character becomes `_`. An input that no FMU in the
    file drives keeps its start value. Parameters of a binding that no component has are passed over, as the standard
    wants it. Geometry and the annotations of other tools are not kept.
    """
    path = Path(path)
    findings = Findings()
    with collected(findings.problems):
        room = Room.of(path)
        if not (room.folder / room.main).is_file():
            missing = "holds no SystemStructure.ssd, so it is not an SSP" if room.kept else "is not there"
            raise CosimError.at(str(path), missing)
        structure = _Structure(room, findings)
        system = structure.system(structure.root, {})
        system.name = structure.name or system.name
        system.experiment = read_experiment(structure.document)
        system.notes = tuple(dict.fromkeys(findings.notes))
        if findings.problems:
            raise CosimError(())
    return system


@dataclass
class _Level:
    """A system while it is read: what its connections and those of the systems in it have brought together."""

    element: Element
    parent: _Level | None
    key: str
    names: dict[str, str] = field(default_factory=dict)
    parts: dict[str, Slave | System] = field(default_factory=dict)
    connectors: dict[str, Connector] = field(default_factory=dict)
    kinds: dict[str, str] = field(default_factory=dict)
    units: dict[str, str] = field(default_factory=dict)
    """Units of the variables of components, by `<part>.<variable>`."""
    stated: dict[str, str] = field(default_factory=dict)
    """Units that connectors of components state, by `<part>.<connector>`."""
    connections: list[Connection | Transformation] = field(default_factory=list)
    dictionaries: dict[str, dict[str, str]] = field(default_factory=dict)
    references: dict[str, str] = field(default_factory=dict)
    buses: dict[tuple[str, str], list[bool]] = field(default_factory=dict)
    """Signals of dictionaries that are used here: for each use, whether it drives the signal."""


class _Structure:
    """One system structure description: its document, its units, and where its files are."""

    def __init__(self, room: Room, findings: Findings) -> None:
        self.room, self.findings = room, findings
        self.problems, self.notes = findings.problems, findings.notes
        self.document = Document(room.text(room.main), room.main, "SystemStructureDescription", self.problems)
        top = self.document.root
        self.name = top.attributes.get("name", "")
        version = top.attributes.get("version", "")
        if version.partition(".")[0] not in ("1", "2"):
            self.document.found(top, "is of another version of SSP", version, "1.0, 2.0")
        self.units: Units = read_units(self.document, top)
        systems = list(top.all("System"))
        if len(systems) != 1:
            raise CosimError.at(room.main, "must hold one <System>", value=len(systems))
        self.root = systems[0]
        self._using: list[str] = []

    # ------------------------------------------------------------ systems
    def system(
        self, element: Element, outer: Mapping[str, Value], parent: _Level | None = None, key: str = ""
    ) -> System:
        """A system element with everything in it; `outer` are values of its parameters that come from above.

        `key` is its name as a part of `parent`.
        """
        document = self.document
        level = _Level(element, parent, key)
        values = {**self._bindings(element), **outer}
        for entry in self._children(element, "SignalDictionaries", "SignalDictionary"):
            level.dictionaries[document.text(entry, "name")] = self._dictionary(entry)
        self._connectors(level)
        elements = element.first("Elements")
        children = elements.children if elements is not None else []
        self._pass_on(level, values)
        for child in children:
            name = document.text(child, "name")
            key = level.names[name] = part_name(name)
            if key in level.parts or key in level.references:
                document.found(child, f"there is an element {key!r} already", name)
            elif child.tag == "SignalDictionaryReference":
                level.references[key] = document.text(child, "dictionary")
            elif child.tag in ("System", "Component"):
                self._part(level, child, key, below(values, name))
        for link in self._children(element, "Connections", "Connection"):
            self._connect(level, link)
        self._close_buses(level)
        bonds = read_structure(document, element, level.connections, self.notes)
        about = element.attributes.get("description", "")
        name = document.text(element, "name")
        return System(name, level.parts, level.connections, bonds, level.connectors.values(), about=about)

    def _part(self, level: _Level, child: Element, key: str, values: Mapping[str, Value]) -> None:
        try:
            self.findings.count()
            if child.tag == "System":
                level.parts[key] = self.system(child, values, level, key)
            else:
                part = self._component(level, child, key, {**self._bindings(child), **values})
                if part is not None:
                    level.parts[key] = part
                    if isinstance(part, FmuSlave):
                        level.units |= {f"{key}.{n}": v.unit for n, v in part.interface.names.items()}
                    self._check_connectors(level, child, key)
        except (CosimError, FmuError, ParameterError) as error:
            where = self.document.at(child)
            self.problems += [
                p if p.path.startswith(self.document.file) else replace(p, path=f"{where}: {key}.{p.path}".rstrip("."))
                for p in error.problems
            ]

    def _component(self, level: _Level, child: Element, key: str, values: Mapping[str, Value]) -> Slave | System | None:
        document = self.document
        source, fragment = urldefrag(document.text(child, "source"))
        if not source and fragment:
            return self._embedded(level, fragment, key, values)
        kind = child.attributes.get("type", FMU)
        if kind == FMU:
            return self._fmu(child, self.room.file(source), values)
        if kind in (DEFINITION, PACKAGE):
            self.findings.count(archive=True)
            room = Room.of(self.room.file(source), fragment, self.room.depth + 1)
            room.kept = room.kept or self.room.kept
            inner = _Structure(room, self.findings)
            return inner.system(inner.root, values)
        document.found(child, f"is a component of a type that does not run here: {kind}", None, f"{FMU}, {PACKAGE}")
        return None

    def _embedded(self, level: _Level, identity: str, key: str, values: Mapping[str, Value]) -> System:
        """A system element of this document, used once more."""
        if identity in self._using or len(self._using) > DEEPEST:
            raise CosimError.at("", "a system refers to itself", value=identity)
        waiting = [self.root]
        while waiting:
            element = waiting.pop()
            if element.tag == "System" and element.attributes.get("id") == identity:
                self._using.append(identity)
                try:
                    return self.system(element, values, level, key)
                finally:
                    self._using.pop()
            waiting += element.children
        raise CosimError.at("", "there is no system of this id", value=f"#{identity}")

    def _fmu(self, child: Element, path: Path, values: Mapping[str, Value]) -> FmuSlave:
        implementation = self.document.choice(child, "implementation", ("any", *IMPLEMENTATIONS), "any")
        kind: Literal["co-simulation", "model-exchange"] | None = None
        if implementation == "ModelExchange":
            kind = "model-exchange"
        elif implementation == "CoSimulation":
            kind = "co-simulation"
        bare = FmuSlave(path, kind=kind)
        settable = {v.name: v for v in bare.settable}
        texts = {v.name for v in bare.description.variables if v.type == "String"}
        given: dict[str, float | str] = {}
        for name, value in values.items():
            if name in settable and not isinstance(value.value, str):
                unit = settable[name].unit
                if not value.fits(unit):
                    raise CosimError.at(name, f"is in {unit!r} and cannot take a value in {value.unit!r}")
                given[name] = value.within(unit)
            elif name in texts and isinstance(value.value, str):
                given[name] = value.value
            elif name in bare.description.by_name:
                self.notes.append(f"{path.name}: {name!r} cannot be set to {value.value!r} and is left as it is")
        try:
            slave = FmuSlave(path, given, kind=kind) if given else bare
        except ParameterError as error:
            file = f"{path.name}."
            raise CosimError(replace(p, path=p.path.removeprefix(file)) for p in error.problems) from None
        slave.folder = self.room.kept
        return slave

    # ------------------------------------------------------------ parameters
    def _bindings(self, element: Element) -> dict[str, Value]:
        """The values that an element's own bindings give, by the names of its parameters."""
        values: dict[str, Value] = {}
        for binding in self._children(element, "ParameterBindings", "ParameterBinding"):
            found = self._values(binding, element)
            if found is None:
                continue
            prefix = binding.attributes.get("prefix", "")
            named = {prefix + name: value for name, value in found.items()}
            for mapping in binding.all("ParameterMapping"):
                document, root = self._inline(mapping, mapping, "ParameterMapping", element)
                if document is not None and root is not None:
                    named = mapped(document, root, named)
            values |= named
        return values

    def _values(self, binding: Element, owner: Element) -> dict[str, Value] | None:
        content = binding.first("ParameterValues") or Element("ParameterValues", {}, binding.line)
        document, root = self._inline(binding, content, "ParameterSet", owner)
        if document is None or root is None:
            return None
        return read_set(document, root, self.units if document is self.document else {})

    def _inline(
        self, holder: Element, content: Element, tag: str, owner: Element
    ) -> tuple[Document | None, Element | None]:
        """The element that is given inside another one, or in the file that an attribute names."""
        source = holder.attributes.get("source")
        if source is None:
            found = content.first(tag)
            if found is None:
                self.document.found(holder, f"<{holder.tag}> has neither a source nor a <{tag}> in it")
            return self.document, found
        try:
            if holder.attributes.get("sourceBase", "SSD") == "component":
                text = self.room.text_in(owner.attributes.get("source", ""), source)
            else:
                text = self.room.text(source)
            document = Document(text, source, tag, self.problems)
        except (CosimError, FmuError) as error:
            self.problems += [replace(p, path=p.path or self.document.at(holder)) for p in error.problems]
            return None, None
        return document, document.root

    def _pass_on(self, level: _Level, values: dict[str, Value]) -> None:
        """Values of a system's own connectors become those of what is connected to them inside."""
        for link in self._children(level.element, "Connections", "Connection"):
            ends = [(link.attributes.get(f"{end}Element"), link.attributes.get(f"{end}Connector", ""))
                    for end in ("start", "end")]  # fmt: skip
            for (inside, name), (element, connector) in (ends, ends[::-1]):
                if inside is None and element is not None and name in values:
                    value = transformed(self.document, link, values[name])
                    if self.document.boolean(link, "suppressUnitConversion"):
                        value = replace(value, unit="")
                    values.setdefault(f"{element}.{connector}", value)

    # ------------------------------------------------------------ connectors
    def _connectors(self, level: _Level) -> None:
        for connector in self._children(level.element, "Connectors", "Connector"):
            name, kind = self.document.text(connector, "name"), self.document.choice(connector, "kind", KINDS)
            level.kinds[name] = kind
            held, unit = self._typed(connector)
            if kind in ("input", "output", "inout") and held in (*NUMBERS, ""):
                level.connectors[name] = Connector(name, "input" if kind == "input" else "output", unit)

    def _typed(self, connector: Element) -> tuple[str, str]:
        """What a connector holds (Real, Integer, Boolean, or what else it says), and the unit it states."""
        for child in connector.children:
            if child.tag in REALS:
                return "Real", symbol(self.document, child, self.units)
            if child.tag in (*INTEGERS, "Enumeration"):
                return "Integer", ""
            if child.tag in ("Boolean", "String", "Binary", "Clock"):
                return child.tag, ""
        return "", ""

    def _check_connectors(self, level: _Level, child: Element, key: str) -> None:
        """What a component says of its connectors must be so in the FMU."""
        part = level.parts[key]
        if not isinstance(part, FmuSlave):
            return
        for connector in self._children(child, "Connectors", "Connector"):
            name, kind = self.document.text(connector, "name"), self.document.choice(connector, "kind", KINDS)
            held, unit = self._typed(connector)
            variable = part.description.by_name.get(name)
            if variable is None:
                hint = nearest(name, part.description.by_name)
                self.document.found(connector, f"{key!r} has no variable {name!r}", hint=hint)
                continue
            named, own = f"connector {name!r} of {key!r}", level.units.get(f"{key}.{name}", "")
            if kind in ("input", "output") and variable.causality != kind:
                message = f"{named} is of kind {kind!r}, and its variable is of causality {variable.causality!r}"
                self.document.found(connector, message)
            if held and held != kind_of(variable):
                self.document.found(connector, f"{named} is of type {held}, and its variable of {variable.type}")
            if unit and own:
                level.stated[f"{key}.{name}"] = unit
                if not (own == "1" or compatible(own, unit)):
                    self.document.found(connector, f"{named} is in {unit!r}, and its variable in {own!r}")

    # ------------------------------------------------------------ connections
    def _connect(self, level: _Level, link: Element) -> None:
        document = self.document
        ends = []
        for end in ("start", "end"):
            element, connector = link.attributes.get(f"{end}Element"), document.text(link, f"{end}Connector")
            if element is not None and element not in level.names:
                hint = nearest(element, level.names)
                document.found(link, f"there is no element {element!r}", hint=hint)
                return
            ends.append((element, connector))
        kinds = {level.kinds.get(connector) for element, connector in ends if element is None}
        if kinds & set(_PARAMETERS):
            return  # the value has been passed on when the components were made
        if any(element is not None and not self._there(level, element) for element, _ in ends):
            return
        roles = [self._role(level, *end) for end in ends]
        turned = roles[0] in ("in", "none") and roles[1] in ("out", "both")
        if turned:
            ends, roles = ends[::-1], roles[::-1]
        if set(roles) <= {"parameter"}:
            self.notes.append(f"{ends[0][1]}: the parameter of one component is not passed on to another")
            return
        source, target = (self._point(level, *end, drives=i == 1) for i, end in enumerate(ends))
        gain, bias = 1.0, 0.0
        for child in link.children:
            if child.tag == "LinearTransformation":
                gain, bias = linear(document, child)
            elif child.tag.endswith("MappingTransformation"):
                document.found(link, f"<{child.tag}> is not supported on a connection")
        plain = document.boolean(link, "suppressUnitConversion")
        indices = [link.attributes.get(f"{end}Indices", "") for end in ("start", "end")]
        places = [self._places(level, *end, at) for end, at in zip(ends, indices[:: -1 if turned else 1], strict=True)]
        if len(places[0]) != len(places[1]) or (len(places[0]) > 1 and places[0] != places[1]):
            shapes = [len(found) for found in places]
            document.found(link, f"connects {source!r} and {target!r}, which have different shapes", shapes)
            return
        for start, end in zip(*places, strict=True):
            one = Connection(source + start, target + end, gain, bias, not plain)
            level.connections.append(self._converting(level, one))

    def _places(self, level: _Level, element: str | None, connector: str, indices: str) -> list[str]:
        """What follows the name of each element of an array, or of the one at these indices; of a scalar, nothing."""
        if indices:
            return [f"[{','.join(indices.split())}]"]
        part = None if element is None else level.parts.get(level.names[element])
        variable = part.description.by_name.get(connector) if isinstance(part, FmuSlave) else None
        if variable is None or not variable.dimensions:
            return [""]
        return [f"[{','.join(str(n + 1) for n in place)}]" for place in np.ndindex(*variable.shape)]

    def _there(self, level: _Level, element: str) -> bool:
        """Whether a part could be made; if not, that has been told, and its connections are no further news."""
        key = level.names[element]
        return key in level.parts or key in level.references

    def _role(self, level: _Level, element: str | None, connector: str) -> str:
        """Whether a connector can give a value (out), take one (in), both, or neither."""
        if element is None:
            return {"input": "out", "output": "in", "inout": "in"}.get(level.kinds.get(connector, ""), "none")
        key = level.names[element]
        if key in level.references:
            return "both"
        part = level.parts[key]
        if isinstance(part, System):
            kind = part.level.connectors[connector].kind if connector in part.level.connectors else ""
            return {"input": "in", "output": "out"}.get(kind, "none")
        variable = part.description.by_name.get(connector) if isinstance(part, FmuSlave) else None
        roles = {"input": "in", "output": "out", "parameter": "parameter"}
        return "none" if variable is None else roles.get(variable.causality, "none")

    def _point(self, level: _Level, element: str | None, connector: str, *, drives: bool) -> str:
        """The name in our system of an end of a connection."""
        if element is None:
            return connector
        key = level.names[element]
        if key not in level.references:
            return f"{key}.{connector}"
        bus = (level.references[key], connector)
        level.buses.setdefault(bus, []).append(drives)
        return _bus_name(*bus)

    def _converting(self, level: _Level, connection: Connection) -> Connection:
        """The connection with the conversion that the standard wants: by the units that its two ends state.

        Where an end states none, the number is taken as it stands. A unit that the connector of a component states
        otherwise than its FMU holds, and is brought into the factor.
        """
        if not connection.convert:
            return connection
        ends = (connection.source, connection.target)
        own = [self._unit(level, name) for name in ends]
        stated = [level.stated.get(name, unit) for name, unit in zip(ends, own, strict=True)]
        if "1" in stated and stated[0] != stated[1] and "" not in stated:
            return replace(connection, convert=False)
        if own == stated or not all(stated) or not compatible(*stated):
            return connection
        return replace(connection, gain=connection.gain * factor(*stated), convert=False)

    def _unit(self, level: _Level, name: str) -> str:
        if name in level.connectors:
            return level.connectors[name].unit
        if name in level.units:
            return level.units[name]
        key, _, rest = name.partition(".")
        part = level.parts.get(key)
        return part.unit_of(rest) if isinstance(part, System) else ""

    # ------------------------------------------------------------ signal dictionaries
    def _dictionary(self, entry: Element) -> dict[str, str]:
        document, root = self._inline(entry, entry, "SignalDictionary", entry)
        if document is None or root is None:
            return {}
        units = {**(self.units if document is self.document else {}), **read_units(document, root)}
        return {
            document.text(e, "name"): next((symbol(document, t, units) for t in e.children if t.tag in REALS), "")
            for e in root.all("DictionaryEntry")
        }

    def _close_buses(self, level: _Level) -> None:
        """Make the signals that are used here: in the system that has the dictionary, or on the way up to it."""
        for (dictionary, entry), uses in level.buses.items():
            name = _bus_name(dictionary, entry)
            if dictionary in level.dictionaries:
                if entry not in level.dictionaries[dictionary]:
                    hint = nearest(entry, level.dictionaries[dictionary])
                    message = f"signal dictionary {dictionary!r} has no entry {entry!r}"
                    self.document.found(level.element, message, hint=hint)
                unit = level.dictionaries[dictionary].get(entry, "")
                level.connectors[name] = Connector(name, "signal", unit)
            elif level.parent is None:
                self.document.found(level.element, f"there is no signal dictionary {dictionary!r}")
                level.connectors[name] = Connector(name, "signal")
            else:
                self._upwards(level, level.parent, (dictionary, entry), any(uses))

    def _upwards(self, level: _Level, parent: _Level, bus: tuple[str, str], driven: bool) -> None:
        name = _bus_name(*bus)
        outside = f"{level.key}.{name}"
        parent.buses.setdefault(bus, []).append(driven)
        if driven:
            level.connectors[name] = Connector(name, "signal")
            level.connectors[f"{name}_out"] = Connector(f"{name}_out", "output")
            level.connections.append(Connection(name, f"{name}_out"))
            parent.connections.append(Connection(f"{outside}_out", name))
        else:
            level.connectors[name] = Connector(name, "input")
            parent.connections.append(Connection(name, outside))

    def _children(self, element: Element, group: str, tag: str) -> list[Element]:
        return [child for parent in element.all(group) for child in parent.all(tag)]


def _bus_name(dictionary: str, entry: str) -> str:
    return entry if dictionary == BUS else f"{dictionary}.{entry}"
