"""What the standard has no word for, as annotations of ours: bonds, sums of signals, macro step and algorithm."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Final
from xml.etree import ElementTree

from seacrane.cosim.documents import Document
from seacrane.cosim.structure import Bond, Connection, Experiment, Transformation
from seacrane.errors import CosimError
from seacrane.fmi.xml import Element

STRUCTURE: Final = "seacrane.structure"
EXPERIMENT: Final = "seacrane.experiment"
"""Types of our annotations."""

_ENDS: Final = ("effortSource", "effortTarget", "flowSource", "flowTarget")

Node = ElementTree.Element


# ---------------------------------------------------------------- reading
def read_structure(
    document: Document, system: Element, connections: list[Connection | Transformation], notes: list[str]
) -> list[Bond]:
    """Adds the transformations of a system element to its connections, and gives its bonds.

    A bond's two connections are in the file as any others and are taken out. If one is not there any more, another tool
    has changed it: then there is no bond, and a note.
    """
    bonds = []
    for ours in _annotations(system, STRUCTURE):
        connections += [_transformation(document, element) for element in ours.all("Transformation")]
        for element in ours.all("Bond"):
            a, b, c, d = (document.text(element, end) for end in _ENDS)
            bond = Bond(document.text(element, "name"), (a, b), (c, d), document.number(element, "gain", 1.0))
            if all(connection in connections for connection in bond.connections):
                for connection in bond.connections:
                    connections.remove(connection)
                bonds.append(bond)
            else:
                notes.append(f"{bond.name}: is no power bond any more, as its connections have been changed")
    return bonds


def read_experiment(document: Document) -> Experiment:
    """The default experiment of a file, with what we have noted in it."""
    element = document.root.first("DefaultExperiment")
    if element is None:
        return Experiment()
    ours = next(iter(_annotations(element, EXPERIMENT)), Element("", {}, 0))
    return Experiment(
        document.number(element, "startTime", 0.0),
        document.number(element, "stopTime") if "stopTime" in element.attributes else None,
        document.number(ours, "step") if "step" in ours.attributes else None,
        ours.attributes.get("algorithm", ""),
        {document.text(s, "slave"): document.number(s, "step") for s in ours.all("Slave")},
    )


def _transformation(document: Document, element: Element) -> Transformation:
    sources = [document.text(e, "name") for e in element.all("Source")]
    targets, rows, bias = [], [], []
    for target in element.all("Target"):
        targets.append(document.text(target, "name"))
        rows.append([document.number(e, "gain") for e in target.all("Term")])
        bias.append(document.number(target, "bias", 0.0))
    if not targets or any(len(row) != len(sources) for row in rows):
        raise CosimError.at(document.at(element), "is no transformation: each target needs a term for each source")
    return Transformation.of(sources, targets, rows, bias, document.boolean(element, "convert", True))


def _annotations(element: Element, kind: str) -> list[Element]:
    """What the annotations of one type hold."""
    return [
        content
        for group in element.all("Annotations")
        for annotation in group.all("Annotation")
        if annotation.attributes.get("type") == kind
        for content in annotation.children
    ]


# ---------------------------------------------------------------- writing
def structure_note(
    transformations: Iterable[Transformation], bonds: Iterable[Bond], named: Callable[[str], str]
) -> list[Node]:
    """The annotation of a system element, if it needs one; `named` gives the names of ends in the file."""
    node = Node("Structure")
    for made in transformations:
        element = ElementTree.SubElement(node, "Transformation", {} if made.convert else {"convert": "false"})
        for source in made.sources:
            ElementTree.SubElement(element, "Source", {"name": named(source)})
        for i, name in enumerate(made.targets):
            target = ElementTree.SubElement(element, "Target", {"name": named(name)})
            if made.bias and made.bias[i]:
                target.set("bias", repr(made.bias[i]))
            for gain in made.matrix[i]:
                ElementTree.SubElement(target, "Term", {"gain": repr(gain)})
    for bond in bonds:
        ends = {key: named(name) for key, name in zip(_ENDS, (*bond.effort, *bond.flow), strict=True)}
        ends |= {} if bond.gain == 1 else {"gain": repr(bond.gain)}
        ElementTree.SubElement(node, "Bond", {"name": bond.name} | ends)
    return [_annotation(STRUCTURE, node)] if len(node) else []


def experiment_note(experiment: Experiment) -> list[Node]:
    """The default experiment, if there is something to say of it."""
    e = experiment
    if e == Experiment():
        return []
    node = Node("ssd:DefaultExperiment", {"startTime": repr(e.start)})
    if e.stop is not None:
        node.set("stopTime", repr(e.stop))
    ours = Node("Experiment", {"algorithm": e.algorithm} if e.algorithm else {})
    if e.step is not None:
        ours.set("step", repr(e.step))
    for name, step in e.steps.items():
        ElementTree.SubElement(ours, "Slave", {"slave": name, "step": repr(step)})
    if ours.attrib or len(ours):
        node.append(_annotation(EXPERIMENT, ours))
    return [node]


def _annotation(kind: str, content: Node) -> Node:
    node = Node("ssd:Annotations")
    ElementTree.SubElement(node, "ssc:Annotation", {"type": kind}).append(content)
    return node
