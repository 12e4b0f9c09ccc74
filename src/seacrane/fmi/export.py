"""Export of a model as an FMI 2.0 FMU for co-simulation and model exchange on this platform."""

from __future__ import annotations

import math
import os
import re
import tempfile
import zipfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Final, Protocol
from xml.sax.saxutils import quoteattr

import seacrane
from seacrane.errors import FmuError
from seacrane.fmi.naming import is_structured
from seacrane.fmi.platforms import binary_path
from seacrane.fmi.xml import EXPONENTS, FILE
from seacrane.model.codegen import Entry
from seacrane.model.dae import Dae, Variable
from seacrane.model.dependencies import dependencies
from seacrane.model.native import NativeModel, build
from seacrane.units import UNITS

EPOCH: Final = (1980, 1, 1, 0, 0, 0)
"""The time stamp of every file in an FMU, so that the same model gives the same bytes."""

_KINDS: Final = {
    "INPUT": ("input", "continuous", None),
    "OUTPUT": ("output", "continuous", "calculated"),
    "PARAMETER": ("parameter", "tunable", "exact"),
    "SETTING": ("parameter", "tunable", "exact"),
    "STATE": ("local", "continuous", "exact"),
    "DERIVATIVE": ("local", "continuous", "calculated"),
    "ALGEBRAIC": ("local", "continuous", "approx"),
    "OBSERVABLE": ("local", "continuous", "calculated"),
}
"""Causality, variability and initial for each kind of variable."""


class Compiles(Protocol):
    """A diagram, or anything else that compiles to a DAE."""

    def compile(self) -> Dae: ...


def export(model: Dae | Compiles, path: str | Path) -> Path:
    """Writes the model as an FMU that contains its solver, and returns the path.

    Inputs, outputs, parameters, states, algebraic unknowns and observables keep their names. The file appears complete
    or not at all. Raises `CompileError` if there is no C compiler, `FmuError` if the file cannot be written.
    """
    native = build(model if isinstance(model, Dae) else model.compile())
    identifier = model_identifier(native.name)
    files = {
        FILE: describe(native, identifier).encode(),
        binary_path(identifier): native.path.read_bytes(),
    }
    target = Path(path)
    try:
        handle, partial = tempfile.mkstemp(prefix=f".{target.name}.", dir=target.parent)
    except OSError as error:
        raise FmuError.at(str(target), f"cannot be written: {error.strerror}") from None
    try:
        with os.fdopen(handle, "wb") as file:
            write_archive(file, files)
        Path(partial).chmod(0o644)
        Path(partial).replace(target)
    except BaseException as error:
        Path(partial).unlink(missing_ok=True)
        if isinstance(error, OSError):
            raise FmuError.at(str(target), f"cannot be written: {error.strerror}") from None
        raise
    return target


def write_archive(file: object, files: Mapping[str, bytes]) -> None:
    """A ZIP archive whose bytes depend on nothing but the files: fixed order, times and permissions."""
    with zipfile.ZipFile(file, "w", zipfile.ZIP_DEFLATED, compresslevel=9) as archive:  # type: ignore[call-overload]
        for name, content in files.items():
            entry = zipfile.ZipInfo(name, EPOCH)
            entry.create_system = 3  # Unix, whatever this machine is
            entry.external_attr = (0o100755 if name.startswith("binaries/") else 0o100644) << 16
            entry.compress_type = zipfile.ZIP_DEFLATED
            archive.writestr(entry, content)


def model_identifier(name: str) -> str:
    """The name as a C identifier, which names the binary."""
    identifier = re.sub(r"\W", "_", name, flags=re.ASCII)
    return f"m_{identifier}" if not identifier or identifier[0].isdigit() else identifier


def describe(native: NativeModel, identifier: str) -> str:
    """The text of modelDescription.xml."""
    entries = native.entries
    index = {e.variable.name: i for i, e in enumerate(entries, start=1)}
    naming = "structured" if all(is_structured(name) for name in index) else "flat"
    about = f" description={quoteattr(native.dae.about)}" if native.dae.about else ""
    able = (
        'canNotUseMemoryManagementFunctions="true" canGetAndSetFMUstate="true" canSerializeFMUstate="true"'
        ' providesDirectionalDerivative="true"'
    )
    lines = [
        '<?xml version="1.0" encoding="UTF-8"?>',
        f'<fmiModelDescription fmiVersion="2.0" modelName={quoteattr(native.name)} guid="{native.guid}"{about}'
        f' generationTool="seacrane {seacrane.__version__}" variableNamingConvention="{naming}"'
        ' numberOfEventIndicators="0">',
        f'  <ModelExchange modelIdentifier="{identifier}" completedIntegratorStepNotNeeded="true" {able}/>',
        f'  <CoSimulation modelIdentifier="{identifier}" canHandleVariableCommunicationStepSize="true"'
        f' canInterpolateInputs="true" maxOutputDerivativeOrder="1" {able}/>',
        *_units([e.variable for e in entries]),
        '  <DefaultExperiment startTime="0" stopTime="10" tolerance="1e-05"/>',
        "  <ModelVariables>",
        *(_scalar_variable(e, index) for e in entries),
        "  </ModelVariables>",
        *_structure(native.dae, entries, index),
        "</fmiModelDescription>",
    ]
    return "\n".join(lines) + "\n"


def _scalar_variable(entry: Entry, index: Mapping[str, int]) -> str:
    v = entry.variable
    causality, variability, initial = _KINDS[entry.kind]
    attributes = {
        "name": v.name,
        "valueReference": str(entry.reference),
        "description": v.about or None,
        "causality": causality,
        "variability": variability,
        "initial": initial,
    }
    real = {
        "unit": v.unit or None,
        "displayUnit": v.display_unit if v.display_unit != v.unit else None,
        "min": _bound(v.minimum),
        "max": _bound(v.maximum),
        "nominal": repr(float(v.nominal)) if v.nominal != 1 and entry.kind != "SETTING" else None,
        "start": repr(float(v.start)) if initial != "calculated" else None,
        "derivative": str(index[v.name[len("der(") : -1]]) if entry.kind == "DERIVATIVE" else None,
    }
    return f"    <ScalarVariable{_attributes(attributes)}><Real{_attributes(real)}/></ScalarVariable>"


def _attributes(values: Mapping[str, str | None]) -> str:
    return "".join(f" {key}={quoteattr(value)}" for key, value in values.items() if value is not None)


def _bound(value: float) -> str | None:
    return None if math.isinf(value) else repr(float(value))


def _units(variables: Sequence[Variable]) -> list[str]:
    shown: dict[str, set[str]] = {}
    for v in variables:
        if v.unit:
            shown.setdefault(v.unit, set()).update({v.display_unit} - {v.unit})
    lines = ["  <UnitDefinitions>"]
    for symbol in sorted(shown):
        unit = UNITS[symbol]
        base = {e: str(n) for e, n in zip(("kg", "m", "s", "rad"), unit.dimension, strict=True) if n}
        if unit.kelvin:
            base["K"] = str(unit.kelvin)
        assert base.keys() <= set(EXPONENTS)
        if unit.factor != 1:
            base["factor"] = repr(unit.factor)
        lines.append(f'    <Unit name="{symbol}"><BaseUnit{_attributes(base)}/>')
        for display in sorted(shown[symbol]):
            factor = unit.factor / UNITS[display].factor
            lines.append(f'      <DisplayUnit name="{display}" factor="{factor!r}"/>')
        lines.append("    </Unit>")
    return [*lines, "  </UnitDefinitions>"]


def _structure(dae: Dae, entries: Sequence[Entry], index: Mapping[str, int]) -> list[str]:
    known = dependencies(dae)

    def names(kind: str) -> list[str]:
        return [e.variable.name for e in entries if e.kind == kind]

    def unknown(name: str) -> str:
        depends = " ".join(str(i) for i in sorted(index[n] for n in known[name]))
        return f'      <Unknown index="{index[name]}" dependencies="{depends}"/>'

    lines = ["  <ModelStructure>"]
    for tag, kind in (("Outputs", "OUTPUT"), ("Derivatives", "DERIVATIVE")):
        if names(kind):
            lines += [f"    <{tag}>", *map(unknown, names(kind)), f"    </{tag}>"]
    initial = sorted(index[name] for kind in ("OUTPUT", "DERIVATIVE") for name in names(kind))
    if initial:
        entries_of = (f'      <Unknown index="{i}"/>' for i in initial)
        lines += ["    <InitialUnknowns>", *entries_of, "    </InitialUnknowns>"]
    return [*lines, "  </ModelStructure>"]
