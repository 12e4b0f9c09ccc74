"""Whether an FMU keeps FMI 1.0, 2.0 or 3.0: all findings at once, each with the section of the standard."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator
from itertools import islice
from pathlib import Path
from typing import Final
from zipfile import ZipFile

from seacrane.errors import FmuError, Problem
from seacrane.fmi.archive import description_text, opened, text_of
from seacrane.fmi.attributes import MOST_PROBLEMS, shortened
from seacrane.fmi.binaries import binary_problems
from seacrane.fmi.description import REALS, Capabilities, ModelDescription, Unknown, Variable
from seacrane.fmi.naming import is_flat, is_structured
from seacrane.fmi.platforms import binary_path, has_sources, host, platforms
from seacrane.fmi.reading import TERMINALS, read_description, read_terminals
from seacrane.fmi.schema import cited, structure_problems
from seacrane.fmi.xml import FILE, Element, parse_xml

_ALLOWED: Final = {
    "parameter": {"fixed": "exact", "tunable": "exact"},
    "calculatedParameter": {"fixed": "calculated approx", "tunable": "calculated approx"},
    "input": {"discrete": "", "continuous": ""},
    "output": {
        "constant": "exact",
        "discrete": "calculated exact approx",
        "continuous": "calculated exact approx",
    },
    "local": {
        "constant": "exact",
        "fixed": "calculated approx",
        "tunable": "calculated approx",
        "discrete": "calculated exact approx",
        "continuous": "calculated exact approx",
    },
    "independent": {"continuous": ""},
}
"""Variability and initial that go with each causality (FMI 2.0, section 2.2.7)."""

_ALLOWED3: Final = _ALLOWED | {
    "structuralParameter": {"fixed": "exact", "tunable": "exact"},
    "input": {"discrete": "exact", "continuous": "exact"},
}
"""The same in FMI 3.0 (FMI 3.0, section 2.4.7); clocks have no initial."""

_KINDS: Final = ("dependent", "constant", "fixed", "tunable", "discrete")


def check(path: str | Path) -> list[Problem]:
    """All that is wrong with an FMU; an empty list if nothing was found. A file that is no FMU is a finding too.

    Binaries must be libraries of their platform. That for this machine is made an instance of, in a process of its own,
    where it does not hold the GUID as a text.
    """
    try:
        with opened(Path(path)) as archive:
            names = archive.namelist()
            root = parse_xml(description_text(archive))
            terminals = parse_xml(text_of(archive, TERMINALS)) if TERMINALS in names else None
            found = list(islice(_findings(Path(path), archive, root, terminals), MOST_PROBLEMS + 1))
    except FmuError as error:
        return list(error.problems)
    if len(found) > MOST_PROBLEMS:
        found[-1] = Problem(FILE, f"has more than {MOST_PROBLEMS} problems; these are the first")
    return found


def _findings(path: Path, archive: ZipFile, root: Element, terminals: Element | None) -> Iterator[Problem]:
    seen = set()
    if root.tag == "fmiModelDescription":
        for problem in structure_problems(root, root.attributes.get("fmiVersion", "")):
            seen.add((problem.path, problem.message))
            yield problem
    try:
        description = read_description(root)
    except FmuError as error:
        yield from (p for p in error.problems if (p.path, p.message) not in seen)
        return
    if terminals is not None:
        try:
            read_terminals(terminals, description)
        except FmuError as error:
            yield from error.problems
    yield from _files(description, archive.namelist())
    yield from binary_problems(path, archive, description)
    yield from _variables(description)
    yield from _aliases(description)
    yield from _units(description)
    yield from _structure(description)


def _problem(
    d: ModelDescription, path: str, message: str, section: str, value: object = None, allowed: str | None = None
) -> Problem:
    """A finding with the section of FMI 2.0, or the one of FMI 3.0 that takes its place."""
    shown = shortened(value) if isinstance(value, str) else value
    return Problem(shortened(path), shortened(message), shown, allowed, cited(section, d.fmi_version))


def _files(d: ModelDescription, names: list[str]) -> Iterator[Problem]:
    kinds: list[Capabilities] = [kind for kind in (d.co_simulation, d.model_exchange) if kind is not None]
    if not kinds and not d.scheduled_execution:
        yield _problem(d, FILE, "has neither <CoSimulation> nor <ModelExchange>", "2.2.1")
    if not d.guid:
        yield _problem(d, FILE, f"the {'instantiationToken' if d.fmi_version == '3.0' else 'guid'} is empty", "2.2.1")
    present = platforms(names)
    if kinds and not present and not has_sources(names):
        yield _problem(d, "binaries", "there is neither a binary nor a source file", "2.3")
    for identifier in dict.fromkeys(kind.model_identifier for kind in kinds):
        if not re.fullmatch(r"[A-Za-z_]\w*", identifier, re.ASCII):
            yield _problem(d, FILE, "the model identifier is not a C identifier", "4.3.1", identifier)
        path = binary_path(identifier, d.fmi_version)
        if present and path not in names:
            message = f"there is no {path}, so the FMU does not run here"
            yield _problem(d, "binaries", message, "2.3", ", ".join(present), host(d.fmi_version)[0])


def _variables(d: ModelDescription) -> Iterator[Problem]:
    fits = is_structured if d.naming == "structured" else is_flat
    counts = Counter(v.name for v in d.variables)
    for name, count in counts.items():
        if count > 1:
            yield _problem(d, name, f"is the name of {count} variables", "2.2.7")
    for v in d.variables:
        if not fits(v.name):
            yield _problem(d, v.name, f"the name does not keep the {d.naming} naming convention", "2.2.9")
        if d.fmi_version != "1.0":  # which has other causalities and variabilities, and no `initial`
            yield from _attributes(d, v)
        yield from _limits(d, v)
        if v.derivative is not None and not 1 <= v.derivative <= len(d.variables):
            yield _problem(d, v.name, "is the derivative of a variable that does not exist", "2.2.7", v.derivative)
        if v.declared_type is not None and v.declared_type not in d.types:
            yield _problem(d, v.name, "its declared type is not defined", "2.2.7", v.declared_type, ", ".join(d.types))
    independent = [v.name for v in d.variables if v.causality == "independent"]
    if len(independent) > 1:
        yield _problem(d, ", ".join(independent), "only one variable may be independent", "2.2.7")
    if not independent and d.fmi_version == "3.0":
        yield _problem(d, "ModelVariables", "there must be an independent variable", "2.2.7")


def _attributes(d: ModelDescription, v: Variable) -> Iterator[Problem]:
    allowed = (_ALLOWED3 if d.fmi_version == "3.0" else _ALLOWED)[v.causality]
    if v.type == "Clock":
        return
    if v.variability not in allowed:
        yield _problem(d, v.name, f"causality {v.causality} does not go with this variability", "2.2.7", v.variability,
                       ", ".join(allowed))  # fmt: skip
    elif (v.initial or "") not in allowed[v.variability].split(" "):
        message = f"causality {v.causality} and variability {v.variability} do not go with this initial"
        yield _problem(d, v.name, message, "2.2.7", v.initial, allowed[v.variability].replace(" ", ", ") or "none")
    if v.variability == "continuous" and v.type not in REALS:
        yield _problem(d, v.name, f"is {v.type}, which cannot be continuous", "2.2.7")
    needed = v.initial in ("exact", "approx") or v.causality == "input"
    if needed and v.start is None:
        yield _problem(d, v.name, "has no start value", "2.2.7")


def _limits(d: ModelDescription, v: Variable) -> Iterator[Problem]:
    if v.minimum is not None and v.maximum is not None and v.minimum > v.maximum:
        yield _problem(d, v.name, f"its minimum {v.minimum:g} is above its maximum {v.maximum:g}", "2.2.7")
    if v.nominal is not None and not v.nominal > 0:
        yield _problem(d, v.name, "its nominal value is not positive", "2.2.7", v.nominal)
    if v.start is not None and (v.initial == "calculated" or v.causality == "independent"):
        yield _problem(d, v.name, f"is {v.initial or v.causality} and must not have a start value", "2.2.7", v.start)
    if isinstance(v.start, (int, float)) and not isinstance(v.start, bool):
        low = v.minimum is not None and v.start < v.minimum
        high = v.maximum is not None and v.start > v.maximum
        if low or high:
            yield _problem(d, v.name, "its start value is out of its range", "2.2.7", v.start,
                           f"{v.minimum if v.minimum is not None else ''} to "
                           f"{v.maximum if v.maximum is not None else ''}".strip())  # fmt: skip


def _aliases(d: ModelDescription) -> Iterator[Problem]:
    if d.fmi_version == "3.0":
        yield from _unique_references(d)
        return
    groups: dict[tuple[str, int], list[Variable]] = {}
    for v in d.variables:
        kind = "Integer" if v.type == "Enumeration" else v.type
        groups.setdefault((kind, v.value_reference), []).append(v)
    for (_, reference), group in groups.items():
        if len(group) == 1:
            continue
        names = ", ".join(v.name for v in group)
        settable = [v for v in group if v.causality in ("input", "parameter") or v.initial in ("exact", "approx")]
        if len([v for v in settable if v.variability != "constant"]) > 1:
            yield _problem(
                d, names, "share a value reference, and more than one of them can be set", "2.2.7", reference
            )
        if len({v.unit for v in group}) > 1:
            yield _problem(d, names, "share a value reference, but not their unit", "2.2.7", reference)


def _unique_references(d: ModelDescription) -> Iterator[Problem]:
    groups: dict[int, list[str]] = {}
    for v in d.variables:
        if v.alias_of is None:
            groups.setdefault(v.value_reference, []).append(v.name)
    for reference, group in groups.items():
        if len(group) > 1:
            message = "share a value reference; an alias must be an <Alias>"
            yield _problem(d, ", ".join(group), message, "2.2.7", reference)


def _units(d: ModelDescription) -> Iterator[Problem]:
    units = {u.name: u for u in d.units}
    for name, count in Counter(u.name for u in d.units).items():
        if count > 1:
            yield _problem(d, name, f"is defined as a unit {count} times", "2.2.2")
    for v in d.variables:
        unit = v.unit or (d.types.get(v.declared_type) if v.declared_type else None)
        if unit is not None and unit not in units:
            yield _problem(d, v.name, "its unit is not defined", "2.2.7", unit, ", ".join(sorted(units)))
        elif v.display_unit is not None and (unit is None or v.display_unit not in units[unit].display):
            allowed = ", ".join(sorted(units[unit].display)) if unit else "a unit first"
            yield _problem(d, v.name, "its display unit is not defined for its unit", "2.2.7", v.display_unit, allowed)


def _structure(d: ModelDescription) -> Iterator[Problem]:
    count = len(d.variables)
    groups = (("Outputs", d.outputs), ("Derivatives", d.derivatives), ("InitialUnknowns", d.initial_unknowns))
    sound = True
    for group, unknowns in groups:
        for unknown in unknowns:
            found = list(_unknown(d, group, unknown))
            sound = sound and not found
            yield from found
        for index, times in Counter(u.index for u in unknowns).items():
            if times > 1:
                yield _problem(
                    d, f"ModelStructure/{group}", f"lists the variable of index {index} {times} times", "2.2.8"
                )
    if not sound:
        return
    outputs = {i for i, v in enumerate(d.variables, start=1) if v.causality == "output" and v.alias_of is None}
    yield from _same(d, "Outputs", outputs, {u.index for u in d.outputs}, "the variables of causality output")
    if d.fmi_version == "1.0":
        return  # it lists no derivatives and no unknowns of the initialization
    for unknown in d.derivatives:
        v = d.variables[unknown.index - 1]
        if v.derivative is None:
            yield _problem(d, v.name, "is listed as a derivative, but does not say of which variable", "2.2.8")
    initial = {
        i
        for i, v in enumerate(d.variables, start=1)
        if v.alias_of is None
        and (
            (v.causality == "output" and v.initial in ("approx", "calculated")) or v.causality == "calculatedParameter"
        )
    }
    for unknown in d.derivatives:
        state = d.variables[unknown.index - 1].derivative
        for i in (unknown.index, state):
            if i is not None and 1 <= i <= count and d.variables[i - 1].initial in ("approx", "calculated"):
                initial.add(i)
    meaning = "outputs, states, their derivatives and calculated parameters that are approx or calculated"
    yield from _same(d, "InitialUnknowns", initial, {u.index for u in d.initial_unknowns}, meaning)


def _unknown(d: ModelDescription, group: str, unknown: Unknown) -> Iterator[Problem]:
    where, count = f"{FILE}:{unknown.line}", len(d.variables)
    if not 1 <= unknown.index <= count:
        yield _problem(
            d, where, f"{group} lists a variable that does not exist", "2.2.8", unknown.index, f"1 to {count}"
        )
    wrong = [i for i in unknown.dependencies or () if not 1 <= i <= count]
    if wrong:
        yield _problem(d, where, "depends on variables that do not exist", "2.2.8", wrong, f"1 to {count}")
    if unknown.kinds is not None:
        if unknown.dependencies is None:
            yield _problem(d, where, "has dependenciesKind without dependencies", "2.2.8")
        elif len(unknown.kinds) != len(unknown.dependencies):
            yield _problem(d, where, "has not as many entries in dependenciesKind as in dependencies", "2.2.8")
        strange = [kind for kind in unknown.kinds if kind not in _KINDS]
        if strange:
            yield _problem(d, where, "has an unknown dependenciesKind", "2.2.8", strange[0], ", ".join(_KINDS))


def _same(d: ModelDescription, group: str, expected: set[int], found: set[int], meaning: str) -> Iterator[Problem]:
    for index in sorted(expected - found):
        yield _problem(
            d, f"ModelStructure/{group}", f"lacks {d.variables[index - 1].name}; it must list {meaning}", "2.2.8"
        )
    for index in sorted(found - expected):
        name = d.variables[index - 1].name
        yield _problem(d, f"ModelStructure/{group}", f"lists {name}; it must only list {meaning}", "2.2.8")
