"""The system structure of the Open Simulation Platform: OspSystemStructure.xml, version 0.1.

Simulators are FMUs beside the file; functions (linear transformation, sum, vector sum) become transformations of the
signals that lead through them. Variable groups come from `<model name>_OspModelDescription.xml`, which lies beside the
FMU or the system structure: connected groups are connected variable by variable in their order. Where two ports of
power are joined, or connections have one name as their `powerBond`, they are bonds.

The platform itself passes numbers on as they stand. Here, a number whose unit is stated at both ends is converted.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final
from urllib.parse import unquote, urlsplit

from seacrane.cosim.documents import Document, as_written, collected, part_name
from seacrane.cosim.fmu import FmuSlave
from seacrane.cosim.slave import Slave
from seacrane.cosim.structure import Bond, Connection, Experiment, Transformation, is_power
from seacrane.cosim.system import System
from seacrane.errors import CosimError, Problem, nearest
from seacrane.fmi.xml import Element

FILE: Final = "OspSystemStructure.xml"
ALGORITHMS: Final = {"fixedStep": "jacobi"}
"""Our names of the platform's algorithms."""

EFFORTS: Final = ("Force", "Torque", "Pressure", "Voltage")
PORTS: Final = ("LinearMechanicalPort", "AngularMechanicalPort", "HydraulicPort", "ElectromagneticPort")
"""Groups of an effort and a flow whose product is power (OSP Interface Specification)."""


@dataclass
class Group:
    """A variable group: its kind, the variables it lists, and the groups in it."""

    kind: str
    variables: list[str] = field(default_factory=list)
    groups: dict[str, Group] = field(default_factory=dict)


def read_osp(path: str | Path) -> System:
    """The system in an OspSystemStructure.xml, or in a folder that holds one; `CosimError` with all that is wrong."""
    path = Path(path)
    return _Reader(path / FILE if path.is_dir() else path).system()


class _Reader:
    def __init__(self, path: Path) -> None:
        self.path = path
        self.problems: list[Problem] = []
        try:
            text = path.read_bytes()
        except OSError as error:
            raise CosimError.at(str(path), f"cannot be read: {error.strerror}") from None
        self.document = Document(text, path.name, "OspSystemStructure", self.problems)
        self.names: dict[str, str] = {}
        self.slaves: dict[str, Slave] = {}
        self.groups: dict[str, dict[str, Group]] = {}
        self.functions: dict[str, Element] = {}
        self.signals: dict[tuple[str, str], list[str]] = {}
        self.notes: list[str] = []
        self.connections: list[Connection | Transformation] = []
        self.bonds: dict[str, list[tuple[bool | None, Connection]]] = {}

    def system(self) -> System:
        document = self.document
        steps = dict(self._simulators())
        for element in self._under("Functions"):
            self.functions[document.text(element, "name")] = element
        self._connect()
        for name, element in self.functions.items():
            self.connections += self._function(name, element)
        bonds = [bond for name, pairs in self.bonds.items() for bond in self._bond(name, pairs)]
        base = document.content("BaseStepSize")
        experiment = Experiment(
            document.content("StartTime") or 0.0,
            document.content("EndTime"),
            base,
            self._algorithm(),
            {name: step for name, step in steps.items() if step and step != base},
        )
        if self.problems:
            raise CosimError(self.problems)
        with collected(self.problems):
            name = self.path.parent.resolve().name or self.path.stem
            return System(name, self.slaves, self.connections, bonds, experiment=experiment, notes=self.notes)

    def _algorithm(self) -> str:
        element = self.document.root.first("Algorithm")
        name = "fixedStep" if element is None else element.text.strip()
        if name not in ALGORITHMS:
            self.notes.append(f"{name}: is an algorithm of the platform that is not used here")
        return ALGORITHMS.get(name, "")

    def _under(self, tag: str) -> list[Element]:
        parent = self.document.root.first(tag)
        return [] if parent is None else parent.children

    # ------------------------------------------------------------ simulators and their groups
    def _simulators(self) -> Iterator[tuple[str, float]]:
        for element in self._under("Simulators"):
            given, source = self.document.text(element, "name"), self.document.text(element, "source")
            name = self.names[given] = part_name(given)
            if name in self.slaves:
                self.document.found(element, "there is a simulator of this name already", given)
                continue
            address = urlsplit(source)
            if address.scheme not in ("", "file") or address.netloc:
                self.document.found(element, "the source of a simulator must be a file", source)
                continue
            file = self.path.parent / unquote(address.path)
            try:
                with collected([]):
                    slave = FmuSlave(file, self._initial(element))
            except CosimError as error:
                self.problems += [Problem(f"{self.document.at(element)}: {p.path}", *_rest(p)) for p in error.problems]
                continue
            self.slaves[name] = slave
            model = f"{slave.description.model_name}_OspModelDescription.xml"
            places = [folder / model for folder in (file.parent, self.path.parent)]
            self.groups[name] = next((self._groups(place) for place in places if place.is_file()), {})
            yield name, self.document.number(element, "stepSize", 0.0)

    def _initial(self, element: Element) -> dict[str, float | str]:
        values: dict[str, float | str] = {}
        for parent in element.all("InitialValues"):
            for initial in parent.all("InitialValue"):
                for value in initial.children:
                    name = self.document.text(initial, "variable")
                    if value.tag == "String":
                        values[name] = self.document.text(value, "value")
                    elif value.tag == "Boolean":
                        values[name] = float(self.document.boolean(value, "value"))
                    else:
                        values[name] = self.document.number(value, "value")
        return values

    def _groups(self, file: Path) -> dict[str, Group]:
        document = Document(file.read_bytes(), file.name, "OspModelDescription", self.problems)

        def read(element: Element) -> Group:
            group = Group(element.tag)
            for child in element.children:
                if child.tag == "Variable":
                    group.variables.append(document.text(child, "ref"))
                else:
                    group.groups[document.text(child, "name")] = read(child)
            return group

        parents = document.root.all("VariableGroups")
        return {document.text(e, "name"): read(e) for parent in parents for e in parent.children}

    # ------------------------------------------------------------ connections
    def _connect(self) -> None:
        for element in self._under("Connections"):
            ends = element.children
            expected = {"Variable", "Signal"} if element.tag.startswith("S") else {"Variable"}
            kinds = {end.tag.removesuffix("Group") for end in ends}
            if len(ends) != 2 or kinds != expected:
                self.document.found(element, f"<{element.tag}> must join two ends", [end.tag for end in ends])
            elif element.tag == "VariableConnection":
                bond = element.attributes.get("powerBond")
                self._join(element, self._variable(ends[0]), self._variable(ends[1]), bond)
            elif element.tag == "VariableGroupConnection":
                first, second = (self._group(end) for end in ends)
                if first is not None and second is not None:
                    owners = [part_name(end.attributes["simulator"]) for end in ends]
                    self._join_groups(element, owners, (first, second), element.attributes.get("powerBond"))
            else:
                self._signal(element, ends)

    def _join_groups(
        self, element: Element, owners: list[str], groups: tuple[Group, Group], bond: str | None, effort: bool = False
    ) -> None:
        first, second = groups
        if len(first.groups) != len(second.groups) or len(first.variables) != len(second.variables):
            sizes = [len(g.groups) + len(g.variables) for g in groups]
            self.document.found(element, "joins groups of different size", sizes)
            return
        if first.kind in PORTS and bond is None:
            bond = "_".join(part_name(end.attributes[k]) for end in element.children[:1] for k in ("simulator", "name"))
        for inner in zip(first.groups.values(), second.groups.values(), strict=True):
            self._join_groups(element, owners, inner, bond, inner[0].kind in EFFORTS)
        for i, pair in enumerate(zip(first.variables, second.variables, strict=True)):
            name = bond if bond is None or len(first.variables) == 1 else f"{bond}_{i + 1}"
            self._join(element, f"{owners[0]}.{pair[0]}", f"{owners[1]}.{pair[1]}", name, effort)

    def _join(self, element: Element, a: str, b: str, bond: str | None = None, effort: bool | None = None) -> None:
        """Connect two variables, from the one that is an output."""
        ends = [self._known(element, name) for name in (a, b)]
        if None in ends:
            return
        if ends[0] != "output":
            a, b = b, a
        connection = as_written(Connection(a, b), *(self._units[name] for name in (a, b)))
        if bond is None:
            self.connections.append(connection)
        else:
            self.bonds.setdefault(part_name(bond), []).append((effort, connection))

    def _bond(self, name: str, pairs: list[tuple[bool | None, Connection]]) -> Iterator[Bond]:
        """The bond of two connections in opposite directions; others under one name stay connections."""
        if len(pairs) == 2:
            (first_effort, first), (_, second) = pairs
            units = [self._units[n] for n in (first.source, second.source)]
            owners = [{self._owner(c.source), self._owner(c.target)} for c in (first, second)]
            opposite = self._owner(first.source) == self._owner(second.target) and owners[0] == owners[1]
            if opposite and is_power(*units) and first.convert and second.convert:
                if first_effort is False or (first_effort is None and units[1] in ("N", "N.m", "Pa")):
                    first, second = second, first
                yield Bond(name, (first.source, first.target), (second.source, second.target))
                return
        self.connections += [connection for _, connection in pairs]
        self.notes.append(
            f"{name}: is no power bond, for that takes an effort and a flow back in their units; it is connected"
        )

    def _signal(self, element: Element, ends: list[Element]) -> None:
        """Remember what leads to or from a signal of a function."""
        signal, variable = (next(e for e in ends if e.tag.startswith(kind)) for kind in ("Signal", "Variable"))
        function, name = self.document.text(signal, "function"), self.document.text(signal, "name")
        if function not in self.functions:
            self.document.found(signal, "there is no such function", function, hint=nearest(function, self.functions))
            return
        if element.tag == "SignalConnection":
            names = [self._variable(variable)]
        else:
            group, owner = self._group(variable), part_name(variable.attributes.get("simulator", ""))
            names = [] if group is None else [f"{owner}.{v}" for v in group.variables]
        if all(self._known(element, n) is not None for n in names):
            self.signals.setdefault((function, name), []).extend(names)

    def _function(self, name: str, element: Element) -> Iterator[Transformation]:
        """What a function does to the signals that are connected to it."""
        gain, offset, inputs, dimension = 1.0, 0.0, ["in"], 1
        if element.tag == "LinearTransformation":
            gain, offset = (self.document.number(element, k, v) for k, v in (("factor", 1.0), ("offset", 0.0)))
        elif element.tag in ("Sum", "VectorSum"):
            inputs = [f"in[{i}]" for i in range(min(self.document.integer(element, "inputCount"), 10_000))]
            dimension = self.document.integer(element, "dimension", 1)
        else:
            self.document.found(
                element, f"<{element.tag}> is no function", None, "LinearTransformation, Sum, VectorSum"
            )
            return
        outputs = self.signals.get((name, "out"), [])
        given = [self.signals.get((name, i), []) for i in inputs]
        wrong = [i for i, signals in zip([*inputs, "out"], [*given, outputs], strict=True) if not signals]
        wrong += [i for i, signals in zip(inputs, given, strict=True) if signals and len(signals) != dimension]
        if wrong or len(outputs) % max(dimension, 1):
            message, allowed = f"function {name!r} is not connected as it must be", f"{dimension} signal at each"
            self.document.found(element, message, wrong or ["out"], allowed)
            return
        for i, target in enumerate(outputs):
            sources = [signals[i % dimension] for signals in given]
            same = {self._units[n] for n in (*sources, target)}
            yield Transformation.of(sources, [target], [[gain] * len(sources)], [offset], convert=len(same) == 1)

    # ------------------------------------------------------------ names
    @property
    def _units(self) -> Mapping[str, str]:
        if not hasattr(self, "_all"):
            self._all = {
                f"{name}.{v.name}": v.unit for name, s in self.slaves.items() for v in s.interface.names.values()
            }
        return self._all

    def _owner(self, variable: str) -> str:
        return next(name for name in self.slaves if variable.startswith(f"{name}."))

    def _variable(self, end: Element) -> str:
        return f"{part_name(self.document.text(end, 'simulator'))}.{self.document.text(end, 'name')}"

    def _known(self, element: Element, name: str) -> str | None:
        """Whether a variable is an input or an output; it is remembered as a problem if it is neither."""
        slave, _, variable = name.partition(".")
        if slave not in self.slaves:
            if slave not in self.names.values():
                self.document.found(element, f"there is no simulator {slave!r}", hint=nearest(slave, self.slaves))
            return None
        interface = self.slaves[slave].interface
        for causality, group in (("output", interface.outputs), ("input", interface.inputs)):
            if any(v.name == variable for v in group):
                return causality
        if variable in interface.names:
            self.document.found(element, f"{name!r} is neither an input nor an output")
        else:
            reason = interface.left_out.get(variable)
            names = [v.name for v in (*interface.inputs, *interface.outputs)]
            message = f"{slave!r} has no variable {variable!r}" if reason is None else f"{name!r}: {reason}"
            self.problems.append(Problem(self.document.at(element), message, hint=nearest(variable, names)))
        return None

    def _group(self, end: Element) -> Group | None:
        owner, name = part_name(self.document.text(end, "simulator")), self.document.text(end, "name")
        if owner not in self.groups:
            if owner not in self.names.values():
                self.document.found(end, f"there is no simulator {owner!r}", hint=nearest(owner, self.slaves))
            return None

        def everywhere(groups: Mapping[str, Group]) -> Iterator[tuple[str, Group]]:
            for key, group in groups.items():
                yield key, group
                yield from everywhere(group.groups)

        known = dict(everywhere(self.groups[owner]))
        if name not in known:
            self.problems.append(
                Problem(self.document.at(end), f"{owner!r} has no variable group {name!r}", hint=nearest(name, known))
            )
        return known.get(name)


def _rest(problem: Problem) -> tuple[str, object, str | None, str | None]:
    return problem.message, problem.value, problem.allowed, problem.hint
