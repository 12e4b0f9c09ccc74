"""What an FMU says of itself, in whichever version of FMI: the model description, and the terminals of FMI 3.0."""

from __future__ import annotations

import re
import zipfile
from dataclasses import replace
from typing import Final

from seacrane.errors import FmuError, Problem
from seacrane.fmi.archive import description_text, text_of
from seacrane.fmi.attributes import MOST_PROBLEMS, Reader, shortened
from seacrane.fmi.description import ModelDescription, Terminal
from seacrane.fmi.platforms import has_sources, platforms
from seacrane.fmi.reading1 import read1
from seacrane.fmi.reading2 import read2
from seacrane.fmi.reading3 import read3
from seacrane.fmi.xml import FILE, Element, parse_xml

SUPPORTED: Final = "1.0, 2.0, 3.0"
TERMINALS: Final = "terminalsAndIcons/terminalsAndIcons.xml"


def read_archive(archive: zipfile.ZipFile) -> ModelDescription:
    """The model description in an FMU, with what else it holds: terminals, binaries, sources.

    Raises `FmuError` with all problems.
    """
    names = archive.namelist()
    description = read_description(parse_xml(description_text(archive)))
    description = replace(description, platforms=tuple(platforms(names)), has_sources=has_sources(names))
    if TERMINALS not in names:
        return description
    return replace(description, terminals=read_terminals(parse_xml(text_of(archive, TERMINALS)), description))


def read_description(root: Element) -> ModelDescription:
    """The model description under this root. Raises `FmuError` with all problems found."""
    if root.tag != "fmiModelDescription":
        raise FmuError.at(FILE, f"the root element is <{root.tag}>", allowed="<fmiModelDescription>")
    version = root.attributes.get("fmiVersion")
    reader = Reader()
    if version == "1.0":
        description = read1(reader, root)
    elif version == "2.0":
        description = read2(reader, root)
    elif version is not None and is_version_3(version):
        description = read3(reader, root)
    else:
        raise FmuError.at(FILE, "the FMU is of another version of FMI", value=version, allowed=SUPPORTED)
    if reader.problems:
        raise FmuError(reader.problems)
    return description


def is_version_3(version: str) -> bool:
    """Whether this is FMI 3.0 or a version that is compatible with it (FMI 3.0, section 2.6)."""
    return re.fullmatch(r"3\.[0-9]+(\.[0-9]+)?(-.+)?", version, re.ASCII) is not None


def read_terminals(root: Element, description: ModelDescription) -> tuple[Terminal, ...]:
    """The terminals under this root of terminalsAndIcons.xml. Raises `FmuError` for variables that do not exist."""
    problems, terminals = [], []
    for group in root.all("Terminals"):
        for element in group.all("Terminal"):
            name = element.attributes.get("name", "")
            members = {}
            for member in element.all("TerminalMemberVariable"):
                variable = member.attributes.get("variableName", "")
                if variable not in description.by_name:
                    where = f"{TERMINALS}:{member.line}"
                    problems.append(Problem(where, "there is no such variable", shortened(variable)))
                    if len(problems) == MOST_PROBLEMS:
                        raise FmuError(problems)
                members[member.attributes.get("memberName", variable)] = variable
            terminals.append(
                Terminal(
                    name,
                    members,
                    element.attributes.get("terminalKind", ""),
                    element.attributes.get("matchingRule", ""),
                    element.attributes.get("description", ""),
                )
            )
    if problems:
        raise FmuError(problems)
    return tuple(terminals)
