"""What is joined to what in a diagram: its components by path and its nodes, for drawing and listing."""

from __future__ import annotations

from dataclasses import dataclass

from .component import Component
from .diagram import Diagram
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
    """Components by path, and nodes in order of appearance; a port joined to nothing is a node of its own."""

    name: str
    components: dict[str, Component]
    nodes: tuple[Node, ...]


def net(diagram: Diagram) -> Net:
    """The net of a diagram. It need not be one that can be compiled."""
    ends = {
        handle.path: End(handle.owner, handle.name, handle.port) for part in diagram.parts.values() for handle in part
    }
    group = {path: path for path in ends}

    def leader(path: str) -> str:
        while group[path] != path:
            group[path] = group[group[path]]
            path = group[path]
        return path

    for connection in diagram.connections:
        for handle in connection[1:]:
            group[leader(handle.path)] = leader(connection[0].path)
    members: dict[str, list[End]] = {}
    for path, end in ends.items():
        members.setdefault(leader(path), []).append(end)
    exposed: dict[str, list[str]] = {}
    for name, handle in diagram.exposed.items():
        exposed.setdefault(leader(handle.path), []).append(name)
    nodes = tuple(Node(tuple(joined), tuple(exposed.get(first, ()))) for first, joined in members.items())
    return Net(diagram.name, {name: part.component for name, part in diagram.parts.items()}, nodes)
