"""What is joined to what in a diagram: its components by path and its nodes, for drawing and listing."""

from __future__ import annotations

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
    """Ports that are joined, and the names under which the diagram exposes them."""

    ends: tuple[End, ...]
    exposed: tuple[str, ...]


@dataclass(frozen=True)
class Net:
    """Components by path, and nodes in order of appearance; a port joined to nothing is a node of its own.

    `shared` holds the values of shared parameters by scope: "" for the diagram itself, "drive" for one placed in it.
    """

    name: str
    components: dict[str, Component]
    nodes: tuple[Node, ...]
    shared: dict[str, dict[str, float]]


def net(diagram: Diagram) -> Net:
    """The net of a diagram, the diagrams placed in it laid open. It need not be one that can be compiled."""
    contents = _Contents(diagram)
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
        exposed.setdefault(leader(innermost(diagram, handle)), []).append(name)
    nodes = tuple(Node(tuple(joined), tuple(exposed.get(first, ()))) for first, joined in members.items())
    return Net(diagram.name, contents.components, nodes, contents.shared)


def innermost(diagram: Diagram, handle: PortHandle, scope: str = "") -> str:
    """The path of the component's port behind a port of a part, which may be a diagram itself."""
    content = diagram.parts[handle.owner].content
    if isinstance(content, Diagram):
        return innermost(content, content.exposed[handle.name], f"{scope}{handle.owner}.")
    return f"{scope}{handle.path}"


class _Contents:
    """Everything in a diagram and in the diagrams in it, by path."""

    def __init__(self, diagram: Diagram) -> None:
        self.components: dict[str, Component] = {}
        self.ends: dict[str, End] = {}
        self.connections: list[list[str]] = []
        self.shared: dict[str, dict[str, float]] = {}
        self._add(diagram, "")

    def _add(self, diagram: Diagram, scope: str) -> None:
        self.shared[scope.rstrip(".")] = dict(diagram.shared)
        for name, part in diagram.parts.items():
            path = f"{scope}{name}"
            if isinstance(part.content, Diagram):
                self._add(part.content, f"{path}.")
                continue
            self.components[path] = part.content
            for handle in part:
                end = End(path, handle.name, handle.port)
                self.ends[end.path] = end
        self.connections += [[innermost(diagram, h, scope) for h in c] for c in diagram.connections]
