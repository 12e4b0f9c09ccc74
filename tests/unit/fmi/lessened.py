"""A description of a model, less one thing at a time."""

from collections.abc import Iterator
from xml.etree import ElementTree


def lessened(text: str) -> Iterator[tuple[str, str]]:
    """The document without each of its attributes and elements, and what is missing."""
    for i, whole in enumerate(ElementTree.fromstring(text).iter()):
        for attribute in whole.attrib:
            root = ElementTree.fromstring(text)
            del list(root.iter())[i].attrib[attribute]
            yield f"{attribute} of {whole.tag} {whole.attrib}", ElementTree.tostring(root, encoding="unicode")
        if i:
            root = ElementTree.fromstring(text)
            element = list(root.iter())[i]
            next(parent for parent in root.iter() if element in list(parent)).remove(element)
            yield f"{whole.tag} {whole.attrib}", ElementTree.tostring(root, encoding="unicode")
