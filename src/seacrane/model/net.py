"""What is joined to what in a diagram: its components by path and its nodes, for drawing and listing."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from .component import Component
from .diagram import Diagram, PortHandle
from .ports import Port


@dataclass(frozen=True)
class End:
    """A port where a node meets a component: port `key` of component `owner`."""

    owner: str
    key: str
    port: Port

    @property
    def path(self) -> str:
        return f"{self.owner}.{self.key}"


@dataclass(frozen=True)
class Node:
    """Ports that are joined, and the names under which the diagram exposes them.

    `within` has the names under which diagrams placed in it do so, by their path.
    """

    ends: tuple[End, ...]
    exposed: tuple[str, ...]
    within: Mapping[str, str]


@dataclass(frozen=True)
class Net:
    """Components by path, and nodes in order of appearance; a port joined to nothing is a node of its own.

    `shared` holds the values of shared parameters by scope: "" for the diagram itself, "drive" for one placed in it.
    `diagrams` are those placed in it that are not laid open.
    """

    name: str
    components: dict[str, Component]
    nodes: tuple[Node, ...]
    shared: dict[str, dict[str, float]]
    diagrams: dict[str, Diagram]


def net(diagram: Diagram, *, open_up: bool = True) -> Net:
    """The net of a diagram. It need not be one that can be compiled.

    `open_up`: whether the diagrams placed in it are laid open, or stay boxes with ports.
    """
    contents = _Contents(diagram, open_up)
    group = {path: path for path in contents.ends}

    def leader(path: str) -> str:
        while group[path] != path:
            group[path] = group[group[path]]
            path = group[path]
        return path

    for first, *others in contents.connections:
        for path in others:
            group[leader(path)] = leader(first)
    members: dict[str, list[End]] = {}
    for path, end in contents.ends.items():
        members.setdefault(leader(path), []).append(end)
    exposed: dict[str, list[str]] = {}
    for name, handle in diagram.exposed.items():
        path = innermost(diagram, handle) if open_up else handle.path
        exposed.setdefault(leader(path), []).append(name)
    within: dict[str, dict[str, str]] = {}
    for path, ports in contents.exposed.items():
        for name, end_path in ports.items():
            within.setdefault(leader(end_path), {}).setdefault(path, name)
    nodes = tuple(
        Node(tuple(joined), tuple(exposed.get(first, ())), within.get(first, {})) for first, joined in members.items()
    )
    return Net(diagram.name, contents.components, nodes, contents.shared, contents.diagrams)


def innermost(diagram: Diagram, handle: PortHandle, scope: str = "") -> str:
    """The path of the component's port behind a port of a part, which may be a diagram itself."""
    content = diagram.parts[handle.owner].content
    if isinstance(content, Diagram):
        return innermost(content, content.exposed[handle.name], f"{scope}{handle.owner}.")
    return f"{scope}{handle.path}"


class _Contents:
    """Everything in a diagram and in the diagrams in it, by path."""

    def __init__(self, diagram: Diagram, open_up: bool) -> None:
        self.components: dict[str, Component] = {}
        self.diagrams: dict[str, Diagram] = {}
        self._open_up = open_up
        self.ends: dict[str, End] = {}
        self.connections: list[list[str]] = []
        self.shared: dict[str, dict[str, float]] = {}
        self.exposed: dict[str, dict[str, str]] = {}
        """What diagrams placed in others expose: the path of the component's port by name, by path of the diagram."""
        self._add(diagram, "")

    def _add(self, diagram: Diagram, scope: str) -> None:
        self.shared[scope.rstrip(".")] = dict(diagram.shared)
        for name, part in diagram.parts.items():
            path = f"{scope}{name}"
            if isinstance(part.content, Diagram) and self._open_up:
                self._add(part.content, f"{path}.")
                inside = part.content
                self.exposed[path] = {n: innermost(inside, h, f"{path}.") for n, h in inside.exposed.items()}
                continue
            if isinstance(part.content, Diagram):
                self.diagrams[path] = part.content
            else:
                self.components[path] = part.content
            for handle in part:
                end = End(path, handle.name, handle.port)
                self.ends[end.path] = end
        for joined in diagram.connections:
            self.connections.append([innermost(diagram, h, scope) if self._open_up else h.path for h in joined])
