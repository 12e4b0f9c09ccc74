"""Export of a model as an FMU of FMI 2.0 or 3.0, for co-simulation and model exchange in one archive."""

from __future__ import annotations

import os
import tempfile
import zipfile
from collections.abc import Mapping
from pathlib import Path
from typing import Final, Literal, Protocol

from seacrane.errors import FmuError
from seacrane.fmi import writing2, writing3
from seacrane.fmi.documentation import icon_png, icon_svg, page
from seacrane.fmi.platforms import binary_path
from seacrane.fmi.terminals import power_terminals
from seacrane.fmi.writing import model_identifier
from seacrane.model import Diagram
from seacrane.model.dae import Dae
from seacrane.model.native import NativeModel, build

EPOCH: Final = (1980, 1, 1, 0, 0, 0)
"""The time stamp of every file in an FMU, so that the same model gives the same bytes."""

VERSIONS: Final = ("2.0", "3.0")
Version = Literal["2.0", "3.0"]


class Compiles(Protocol):
    """A diagram, or anything else that compiles to a DAE."""

    def compile(self) -> Dae: ...


def export(model: Dae | Compiles, path: str | Path, *, version: Version = "2.0", sources: bool = False) -> Path:
    """Writes the model as an FMU that contains its solver, and returns the path.

    Inputs, outputs, parameters, states, algebraic unknowns and observables keep their names. The FMU runs for
    co-simulation and for model exchange; it has documentation, an icon and, in FMI 3.0, a terminal for each power bond.
    With `sources` its C is inside as well; without, nothing of the equations can be read. The file appears complete or
    not at all, and the same model gives the same bytes.

    Raises `CompileError` if there is no C compiler, `FmuError` if the version is none of ours or the file cannot be
    written.
    """
    if version not in VERSIONS:
        allowed = ", ".join(VERSIONS)
        raise FmuError.at("version", "is not a version of FMI that can be exported", value=version, allowed=allowed)
    dae = model if isinstance(model, Dae) else model.compile()
    drawing = model.icons_svg() if isinstance(model, Diagram) else None
    native = build(dae)
    identifier = model_identifier(native.name)
    files = contents(native, identifier, version, sources, drawing)
    files[binary_path(identifier, version)] = native.path.read_bytes()
    return _write(Path(path), files)


def contents(
    native: NativeModel, identifier: str, version: str, sources: bool, drawing: str | None
) -> dict[str, bytes]:
    """Everything in the archive but the binaries."""
    dae = native.dae
    terminals = power_terminals(dae)
    code = native.sources if sources else {}
    units = sorted(name for name in code if name.endswith(".c"))
    if version == "2.0":
        texts = {"modelDescription.xml": writing2.describe(native, identifier, units)}
        icon = "model.png"
    else:
        texts = {"modelDescription.xml": writing3.describe(native, identifier)}
        texts["terminalsAndIcons/terminalsAndIcons.xml"] = writing3.terminals_and_icons(terminals)
        texts["terminalsAndIcons/icon.svg"] = icon_svg(dae, terminals)
        if sources:
            texts["sources/buildDescription.xml"] = writing3.build_description(identifier, units)
        icon = "terminalsAndIcons/icon.png"
    texts["documentation/index.html"] = page(dae, terminals, drawing is not None)
    if drawing is not None:
        texts["documentation/diagram.svg"] = drawing
    texts |= {f"sources/{name}": code[name] for name in sorted(code)}
    return {name: text.encode() for name, text in texts.items()} | {icon: icon_png(dae, terminals)}


def _write(target: Path, files: Mapping[str, bytes]) -> Path:
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
