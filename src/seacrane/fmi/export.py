"""Export of a model as an FMU of FMI 2.0 or 3.0, for co-simulation and model exchange in one archive."""

from __future__ import annotations

import hashlib
import io
import struct
import zipfile
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path, PurePosixPath
from typing import Final, Literal, Protocol

from seacrane import documents
from seacrane.errors import FmuError, Problem
from seacrane.fmi import writing2, writing3
from seacrane.fmi.documentation import DRAWING, icon_png, icon_svg, page
from seacrane.fmi.platforms import binary_path
from seacrane.fmi.terminals import power_terminals
from seacrane.fmi.writing import model_identifier
from seacrane.model import Diagram
from seacrane.model.codegen import Generated, generate
from seacrane.model.dae import Dae
from seacrane.native import build_library, cache_folder
from seacrane.native.cross import TARGETS, build_all

EPOCH: Final = (1980, 1, 1, 0, 0, 0)
"""The time stamp of every file in an FMU, so that the same model gives the same bytes."""

VERSIONS: Final = ("2.0", "3.0")
Version = Literal["2.0", "3.0"]


_MACHINES: Final = {"x86_64-darwin": (0x01000007, 3), "aarch64-darwin": (0x0100000C, 0)}
"""Type and subtype of the processor in the table of a universal binary."""


class Compiles(Protocol):
    """A diagram, or anything else that compiles to a DAE."""

    def compile(self) -> Dae: ...


def export(
    model: Dae | Compiles,
    path: str | Path,
    *,
    version: Version = "2.0",
    sources: bool = False,
    platforms: str | Iterable[str] = "host",
    progress: Callable[[str], None] = lambda stage: None,
) -> Path:
    """Writes the model as an FMU that contains its solver, and returns the path.

    Inputs, outputs, parameters, states, algebraic unknowns and observables keep their names. The FMU runs for
    co-simulation and for model exchange; it has documentation, an icon and a terminal for each power bond. Events
    happen within a step of co-simulation, and are event indicators for model exchange. In FMI 2.0 inputs follow the
    derivatives that a master gives for a step; FMI 3.0 would have them set in intermediate updates, which are not
    offered: there inputs are held over a step.
    With `sources` its C is inside as well; without, nothing of the equations can be read. The file appears complete or
    not at all, and the same model gives the same bytes.

    `platforms` is "host" (this machine, by its C compiler), "all", or some of x86_64-linux, aarch64-linux,
    x86_64-windows, x86_64-darwin and aarch64-darwin; these are compiled by the optional extra `export`, offline.

    `progress` is told each stage as it begins: long exports compile for a minute.

    Raises `CompileError` if there is no C compiler, or no extra `export` when it is needed, `FmuError` if the version
    or a platform is none of ours or the file cannot be written.
    """
    if version not in VERSIONS:
        allowed = ", ".join(VERSIONS)
        raise FmuError.at("version", "is not a version of FMI that can be exported", value=version, allowed=allowed)
    return write_whole(Path(path), archive_of(_files(model, version, sources, platforms, progress)))


def cached(model: Dae | Compiles, *, version: Version = "2.0") -> Path:
    """The model as an FMU for this machine in the cache of compiled models, written if it is not there yet.

    Its name is made from everything inside: a file that is there is the one that would be written. The drawing of a
    diagram, which takes longer than all the rest, is left out. Raises like `export`.
    """
    dae = model if isinstance(model, Dae) else model.compile()
    files = _files(dae, version, False, "host", lambda stage: None)
    (identifier,) = (PurePosixPath(name).stem for name in files if name.startswith("binaries/"))
    digest = hashlib.sha256(repr(sorted(files.items())).encode()).hexdigest()
    path = cache_folder() / "fmu" / f"{identifier}-{digest[:32]}.fmu"
    if not path.exists():
        path.parent.mkdir(parents=True, exist_ok=True)
        write_whole(path, archive_of(files))
    return path


def _files(
    model: Dae | Compiles,
    version: Version,
    sources: bool,
    platforms: str | Iterable[str],
    progress: Callable[[str], None],
) -> dict[str, bytes]:
    """Everything in the archive, compiled for the platforms."""
    targets = _targets(platforms)
    progress("writing the equations as C")
    dae = model if isinstance(model, Dae) else model.compile()
    drawing = model.icons_svg() if isinstance(model, Diagram) else None
    generated = generate(dae)
    identifier = model_identifier(dae.name)
    files = contents(generated, identifier, version, sources, drawing)
    if platforms == "host":
        progress("compiling for this machine")
        files[binary_path(identifier, version)] = build_library("model", generated.sources, ["-w"]).read_bytes()
    else:
        progress(f"compiling for {', '.join(targets)}")
        files |= binaries(build_all(targets, identifier, generated.sources, ["-w"]), identifier, version)
    return files


def _targets(platforms: str | Iterable[str]) -> tuple[str, ...]:
    if platforms in ("host", "all"):
        return tuple(TARGETS)
    wanted = tuple(dict.fromkeys([platforms] if isinstance(platforms, str) else platforms))
    allowed = f"host, all, or some of {', '.join(TARGETS)}"
    unknown = [Problem("platforms", "is none that can be exported for", p, allowed) for p in wanted if p not in TARGETS]
    if unknown or not wanted:
        raise FmuError(unknown or [Problem("platforms", "are none", allowed=allowed)])
    return wanted


def binaries(built: Mapping[str, Path], identifier: str, version: str) -> dict[str, bytes]:
    """The libraries by their places in the archive. In FMI 2.0 both of macOS share a place and become one file."""
    places: dict[str, list[tuple[str, bytes]]] = {}
    for platform, path in built.items():
        places.setdefault(binary_path(identifier, version, platform), []).append((platform, path.read_bytes()))
    return {place: found[0][1] if len(found) == 1 else universal(dict(found)) for place, found in places.items()}


def universal(libraries: Mapping[str, bytes]) -> bytes:
    """A universal binary of macOS: a big-endian table of machine, offset and size, and libraries on 16 KiB pages."""
    page = 0x4000
    table = struct.pack(">II", 0xCAFEBABE, len(libraries))
    body = b""
    for platform, library in libraries.items():
        table += struct.pack(">IIIII", *_MACHINES[platform], page + len(body), len(library), 14)
        body += library + bytes(-len(library) % page)
    return table.ljust(page, b"\0") + body


def contents(model: Generated, identifier: str, version: str, sources: bool, drawing: str | None) -> dict[str, bytes]:
    """Everything in the archive but the binaries."""
    dae = model.dae
    terminals = power_terminals(dae)
    code = model.sources if sources else {}
    units = sorted(name for name in code if name.endswith(".c"))
    if version == "2.0":
        texts = {"modelDescription.xml": writing2.describe(model, identifier, units)}
    else:
        texts = {"modelDescription.xml": writing3.describe(model, identifier)}
        if sources:
            texts["sources/buildDescription.xml"] = writing3.build_description(identifier, units)
    texts["terminalsAndIcons/terminalsAndIcons.xml"] = writing3.terminals_and_icons(terminals)
    texts["terminalsAndIcons/icon.svg"] = icon_svg(dae, terminals)
    texts["documentation/index.html"] = page(dae, terminals, drawing is not None)
    if drawing is not None:
        texts[f"documentation/{DRAWING}"] = drawing
    texts |= {f"sources/{name}": code[name] for name in sorted(code)}
    icon = icon_png(dae, terminals)
    icons = {"terminalsAndIcons/icon.png": icon} | ({"model.png": icon} if version == "2.0" else {})
    return {name: text.encode() for name, text in texts.items()} | icons


def write_whole(target: Path, content: bytes) -> Path:
    """Writes a file that appears complete or not at all. `FmuError` if it cannot be written."""
    try:
        documents.write(content, target)
    except OSError as error:
        raise FmuError.at(str(target), f"cannot be written: {error.strerror}") from None
    return target


def archive_of(files: Mapping[str, bytes]) -> bytes:
    """A ZIP archive whose bytes depend on nothing but the files: fixed order, times and permissions."""
    written = io.BytesIO()
    with zipfile.ZipFile(written, "w", zipfile.ZIP_DEFLATED, compresslevel=9) as archive:
        for name, content in files.items():
            entry = zipfile.ZipInfo(name, EPOCH)
            entry.create_system = 3  # Unix, whatever this machine is
            entry.external_attr = (0o100755 if name.startswith("binaries/") else 0o100644) << 16
            entry.compress_type = zipfile.ZIP_DEFLATED
            archive.writestr(entry, content)
    return written.getvalue()
