"""A system as an SSP archive, or as a system structure description with its FMUs beside it."""

from __future__ import annotations

import tempfile
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Final, Literal
from xml.etree import ElementTree

import seacrane
from seacrane import documents, fmi
from seacrane.cosim.fmu import FmuSlave
from seacrane.cosim.model import ModelSlave
from seacrane.cosim.slave import Slave
from seacrane.cosim.ssp.annotations import experiment_note, structure_note
from seacrane.cosim.ssp.schema import BUS, IMPLEMENTATIONS, MAIN, SPACES, VERSIONS
from seacrane.cosim.structure import Connection, Connector, Transformation
from seacrane.cosim.system import System
from seacrane.errors import CosimError, Problem, SeacraneError
from seacrane.fmi.export import archive_of
from seacrane.units import UNITS

Version = Literal["1.0", "2.0"]
Node = ElementTree.Element

_IMPLEMENTATION: Final = {ours: theirs for theirs, ours in IMPLEMENTATIONS.items()}


def write_ssp(system: System, path: str | Path, *, version: Version = "1.0") -> Path:
    """Writes a system of FMUs and compiled models as an .ssp, or as an .ssd with its FMUs in `resources` beside it.

    Compiled models are exported as FMUs. Parameters and start values that differ from those of the FMUs are bindings of
    the components. Power bonds are ordinary connections with a note for ourselves; a transformation of several signals,
    which the standard does not know, is in the note only, so that another tool finds its targets unconnected.

    The same system gives the same bytes. `CosimError` naming each slave that is no FMU and cannot become one.
    """
    path = Path(path)
    if version not in VERSIONS:
        raise CosimError.at("version", "is not a version of SSP", value=version, allowed=", ".join(VERSIONS))
    if path.suffix.lower() not in (".ssp", ".ssd"):
        raise CosimError.at(str(path), "is no file of this format", value=path.suffix, allowed=".ssp, .ssd")
    files = _Writer(version).files(system)
    try:
        if path.suffix.lower() == ".ssp":
            documents.write(archive_of(files), path)
        else:
            for name, content in files.items():
                target = path if name == MAIN else path.parent / name
                target.parent.mkdir(exist_ok=True)
                documents.write(content, target)
    except OSError as error:
        raise CosimError.at(str(path), f"cannot be written: {error.strerror}") from None
    return path


class _Writer:
    def __init__(self, version: Version) -> None:
        self.version = version
        self.real = "Real" if version == "1.0" else "Float64"
        self.resources: dict[str, bytes] = {}
        self.units: set[str] = set()

    def files(self, system: System) -> dict[str, bytes]:
        problems = [
            Problem(name, f"is neither an FMU nor a compiled model, but a {type(slave).__name__}")
            for name, slave in system.slaves.items()
            if not isinstance(slave, (FmuSlave, ModelSlave))
        ]
        if problems:
            raise CosimError(problems)
        spaces = {f"xmlns:{prefix}": space for prefix, space in SPACES.items()}
        about = {"version": self.version, "name": system.name, "generationTool": f"seacrane {seacrane.__version__}"}
        root = Node("ssd:SystemStructureDescription", spaces | about)
        root.append(self.system(system, system.name, {}))
        root.extend(self.unit_definitions("ssd", self.units))
        root.extend(experiment_note(system.experiment))
        return {MAIN: _text(root), **self.resources}

    # ------------------------------------------------------------ systems
    def system(self, system: System, name: str, further: Mapping[str, Connector]) -> Node:
        """A system element. `further` are connectors that connections from outside, which lead deeper, need: they are
        given by the name of what they stand for."""
        level = system.level
        connectors = {c.name: c for c in level.connectors.values()} | {c.name: c for c in further.values()}
        ports = _Ports(system)
        links = [c for c in level.connections if len(c.terms) == 1 or not isinstance(c, Transformation)]
        terms = [(t, ports.end(t.source), ports.end(t.target)) for link in links for t in link.terms]
        terms += [(t, ports.end(t.source), ports.end(t.target)) for b in level.bonds.values() for t in b.connections]
        for inner, connector in further.items():
            end, own = ports.end(inner), (None, connector.name)
            ends = (own, end) if connector.kind == "input" else (end, own)
            terms.append((Connection("", ""), *ends))
        sums = [c for c in level.connections if isinstance(c, Transformation) and c not in links]
        noted = structure_note(sums, level.bonds.values(), ports.name)
        node = Node("ssd:System", {"name": name} | ({"description": system.about} if system.about else {}))
        outside = [c for c in connectors.values() if c.kind != "signal"]
        node.extend(self.connectors(_Signal(c.name, c.kind, c.unit or system.unit_of(c.name)) for c in outside))
        elements = Node("ssd:Elements")
        for part_name, part in level.parts.items():
            if isinstance(part, System):
                elements.append(self.system(part, part_name, ports.deeper.get(part_name, {})))
            else:
                used = {end[1] for _, *ends in terms for end in ends if end[0] == part_name}
                elements.append(self.component(part_name, part, used))
        signals = [c for c in level.connectors.values() if c.kind == "signal"]
        buses = _buses(signals)
        for bus, entries in buses.items():
            reference = Node("ssd:SignalDictionaryReference", {"name": ports.bus(bus), "dictionary": bus})
            reference.extend(self.connectors(_Signal(e, "inout", system.unit_of(c.name)) for e, c in entries.items()))
            elements.append(reference)
        node.extend([elements] if len(elements) else [])
        connections = Node("ssd:Connections")
        arrays: dict[str | None, set[str]] = {n: _elements(part) for n, part in level.parts.items()}
        connections.extend([self.connection(term, source, target, arrays) for term, source, target in terms])
        node.extend([connections] if len(connections) else [])
        node.extend(self.dictionaries(system, buses))
        node.extend(noted)
        return node

    def component(self, name: str, slave: Slave, used: set[str]) -> Node:
        source = self.resource(name, slave)
        attributes = {"name": name, "source": source}
        if isinstance(slave, FmuSlave) and slave.kind is not None:
            attributes["implementation"] = _IMPLEMENTATION[slave.kind]
        node = Node("ssd:Component", attributes)
        # An input that nothing drives is left out: some tools take each connector of an input for a connected one.
        driven = {name for u in used for name in (u, _element(u)[0])}
        own = [s for s in _signals(slave) if s.kind == "output" or s.name in driven]
        if self.version == "1.0":
            own = [s for s in own if not s.shape]
        node.extend(self.connectors(own))
        if isinstance(slave, (FmuSlave, ModelSlave)) and slave.parameters:
            node.append(self.bindings(slave))
        return node

    def resource(self, name: str, slave: Slave) -> str:
        """The place of a slave's FMU in the archive; slaves of one FMU share it."""
        if isinstance(slave, FmuSlave):
            stem, content = slave.path.stem, slave.path.read_bytes()
        else:
            assert isinstance(slave, ModelSlave)
            with tempfile.TemporaryDirectory(prefix="seacrane-ssp-") as folder:
                try:
                    content = fmi.export(slave.dae, Path(folder) / "model.fmu").read_bytes()
                except SeacraneError as error:
                    raise CosimError.at(name, f"cannot be exported as an FMU: {error}") from error
            stem = slave.dae.name
        for i in range(1, len(self.resources) + 2):
            place = f"resources/{stem}{'' if i == 1 else f'_{i}'}.fmu"
            if self.resources.setdefault(place, content) == content:
                return place
        raise AssertionError("one of the places is free")

    # ------------------------------------------------------------ pieces
    def connectors(self, found: Iterable[_Signal]) -> list[Node]:
        node = Node("ssd:Connectors")
        for signal in found:
            connector = ElementTree.SubElement(node, "ssd:Connector", {"name": signal.name, "kind": signal.kind})
            held = self.real if signal.held == "Real" else signal.held
            unit = self.unit(signal.unit) if signal.held == "Real" else {}
            ElementTree.SubElement(connector, f"ssc:{held}", unit)
            for size in signal.shape:
                ElementTree.SubElement(connector, "ssc:Dimension", {"size": str(size)})
        return [node] if len(node) else []

    def unit(self, symbol: str) -> dict[str, str]:
        """The attribute for a unit; `1` is what a variable has that states none."""
        if symbol in ("", "1"):
            return {}
        self.units.add(symbol)
        return {"unit": symbol}

    def connection(
        self,
        term: Connection,
        source: tuple[str | None, str],
        target: tuple[str | None, str],
        arrays: Mapping[str | None, set[str]],
    ) -> Node:
        ends: dict[str, str] = {}
        for which, (element, connector) in (("start", source), ("end", target)):
            name, place = _element(connector) if element in arrays and connector in arrays[element] else (connector, "")
            if place and self.version == "1.0":
                raise CosimError.at(f"{element}.{connector}", "is an element of an array", hint="Write SSP 2.0.")
            ends |= {f"{which}Element": element} if element is not None else {}
            ends[f"{which}Connector"] = name
            ends |= {f"{which}Indices": place} if place else {}
        node = Node("ssd:Connection", ends | ({} if term.convert else {"suppressUnitConversion": "true"}))
        if (term.gain, term.bias) != (1.0, 0.0):
            numbers = {"factor": repr(term.gain), "offset": repr(term.bias)}
            ElementTree.SubElement(node, "ssc:LinearTransformation", numbers)
        return node

    def bindings(self, slave: FmuSlave | ModelSlave) -> Node:
        units = {name: v.unit for name, v in slave.interface.names.items()}
        if isinstance(slave, FmuSlave):
            units |= {v.name: v.unit for v in slave.settable}
            types = {v.name: v.type for v in slave.description.variables}
        else:
            types = {}
        values = Node("ssv:ParameterSet", {"version": self.version, "name": "parameters"})
        parameters, used = ElementTree.SubElement(values, "ssv:Parameters"), set()
        for name, value in slave.parameters.items():
            parameter = ElementTree.SubElement(parameters, "ssv:Parameter", {"name": name})
            kind, text = _typed(types.get(name, "Real"), value)
            unit = {"unit": units[name]} if kind == "Real" and units.get(name, "1") != "1" else {}
            used |= set(unit.values())
            kind = self.real if kind == "Real" else kind
            ElementTree.SubElement(parameter, f"ssv:{kind}", {"value": text} | unit)
        values.extend(self.unit_definitions("ssv", used))
        node = Node("ssd:ParameterBindings")
        binding = ElementTree.SubElement(node, "ssd:ParameterBinding")
        ElementTree.SubElement(binding, "ssd:ParameterValues").append(values)
        return node

    def unit_definitions(self, prefix: str, symbols: Iterable[str]) -> list[Node]:
        node = Node(f"{prefix}:Units")
        for symbol in sorted(symbols):
            unit = UNITS[symbol]
            exponents = dict(zip(("kg", "m", "s", "rad"), unit.dimension, strict=True)) | {"K": unit.kelvin}
            base = {key: str(n) for key, n in exponents.items() if n}
            if unit.factor != 1:
                base["factor"] = repr(unit.factor)
            definition = ElementTree.SubElement(node, "ssc:Unit", {"name": symbol})
            ElementTree.SubElement(definition, "ssc:BaseUnit", base)
        return [node] if len(node) else []

    def dictionaries(self, system: System, buses: Mapping[str, Mapping[str, Connector]]) -> list[Node]:
        node = Node("ssd:SignalDictionaries")
        for bus, entries in buses.items():
            holder = ElementTree.SubElement(node, "ssd:SignalDictionary", {"name": bus})
            content = ElementTree.SubElement(holder, "ssb:SignalDictionary", {"version": self.version})
            for entry, connector in entries.items():
                item = ElementTree.SubElement(content, "ssb:DictionaryEntry", {"name": entry})
                ElementTree.SubElement(item, f"ssc:{self.real}", self.unit(system.unit_of(connector.name)))
            content.extend(self.unit_definitions("ssb", {system.unit_of(c.name) for c in entries.values()} - {"", "1"}))
        return [node] if len(node) else []


@dataclass(frozen=True)
class _Signal:
    """What a connector is for; of an array, all its elements."""

    name: str
    kind: str
    unit: str = ""
    held: str = "Real"
    shape: tuple[int, ...] = ()


def _signals(slave: Slave) -> list[_Signal]:
    """The inputs and outputs of a slave."""
    found: dict[str, _Signal] = {}
    for kind, group in (("input", slave.interface.inputs), ("output", slave.interface.outputs)):
        for v in group:
            name, shape = v.name, tuple[int, ...]()
            if v.name in _elements(slave):
                assert isinstance(slave, FmuSlave)
                name = _element(v.name)[0]
                shape = slave.description.by_name[name].shape
            found.setdefault(name, _Signal(name, kind, v.unit, slave.interface.kinds.get(v.name, "Real"), shape))
    return list(found.values())


def _elements(part: Slave | System) -> set[str]:
    """The names of all elements of arrays of an FMU."""
    if not isinstance(part, FmuSlave):
        return set()
    arrays = {v.name for v in part.description.variables if v.dimensions}
    return {name for name in part.interface.names if arrays and _element(name)[0] in arrays}


def _element(name: str) -> tuple[str, str]:
    """The array of an element, and its indices as the standard writes them: `x[2,3]` is x at "2 3"."""
    array, _, place = name.rpartition("[")
    return (array, place.rstrip("]").replace(",", " ")) if array else (name, "")


class _Ports:
    """Ends of connections as the standard has them: an element of the system, and a connector of that element."""

    def __init__(self, system: System) -> None:
        self.system = system
        self.deeper: dict[str, dict[str, Connector]] = {}
        self.taken: dict[str, set[str]] = {}

    def bus(self, dictionary: str) -> str:
        """The name of the reference to a signal dictionary, which no part has."""
        return dictionary if dictionary not in self.system.level.parts else f"{dictionary}_signals"

    def end(self, name: str) -> tuple[str | None, str]:
        own = self.system.level.connectors.get(name)
        if own is not None:
            if own.kind != "signal":
                return None, name
            dictionary, entry = _bus_of(name)
            return self.bus(dictionary), entry
        part_name, _, inner = name.partition(".")
        part = self.system.level.parts[part_name]
        if isinstance(part, System) and inner not in part.level.connectors:
            return part_name, self._connector(part_name, part, inner).name
        return part_name, inner

    def name(self, name: str) -> str:
        """The name of an end of a connection once it goes through the connectors that the file has."""
        element, connector = self.end(name)
        return name if element is None or name in self.system.level.connectors else f"{element}.{connector}"

    def _connector(self, part_name: str, part: System, inner: str) -> Connector:
        """A connector of a sub-system for something deeper in it."""
        made = self.deeper.setdefault(part_name, {})
        if inner not in made:
            taken = self.taken.setdefault(part_name, set(part.level.connectors))
            name = inner.replace(".", "_")
            while name in taken:
                name += "_"
            taken.add(name)
            kind: Literal["input", "output"] = "input" if part.causality(inner) == "input" else "output"
            made[inner] = Connector(name, kind, part.unit_of(inner))
        return made[inner]


def _buses(signals: Iterable[Connector]) -> dict[str, dict[str, Connector]]:
    """Signals by dictionary and entry."""
    buses: dict[str, dict[str, Connector]] = {}
    for signal in signals:
        dictionary, entry = _bus_of(signal.name)
        buses.setdefault(dictionary, {})[entry] = signal
    return buses


def _bus_of(name: str) -> tuple[str, str]:
    dictionary, dot, entry = name.partition(".")
    return (dictionary, entry) if dot else (BUS, name)


def _typed(kind: str, value: float | str | bytes) -> tuple[str, str]:
    """The type and the text of a parameter's value, by the type of its variable in FMI 2.0 or 3.0."""
    if isinstance(value, bytes):
        return "Binary", value.hex()
    if isinstance(value, str):
        return "String", value
    if kind == "Boolean":
        return "Boolean", "true" if value else "false"
    if kind in ("Real", "Float64", "Float32"):
        return "Real", repr(float(value))
    return "Integer", str(int(value))


def _text(root: Node) -> bytes:
    ElementTree.indent(root)
    return f'<?xml version="1.0" encoding="UTF-8"?>\n{ElementTree.tostring(root, "unicode")}\n'.encode()
