"""A design for others: one ZIP with the design file, meshes, masses, load chart, robot models and a data sheet.

    design.json               the design file; all else follows from it
    meshes/<link>.glb         each link in its own frame, glTF 2.0 with y up as glTF wants it; and .stl, z up
    mass_properties.json      of each link: as the design gives them, and of its parts
    load_chart.csv, .json     by mode: radius, load, what governs, posture
    <name>.xml, <name>.urdf   MJCF and URDF, which name the meshes
    sheet.pdf                 data sheet
    provenance.json           by what it was written, from what: the hash of design.json

A name that no file can have everywhere is written with - for what it cannot have. The same design gives the same
bytes. Reading takes a ZIP for what a stranger sent: bounded, and only the design is read; the rest is made again from
it.
"""

from __future__ import annotations

import hashlib
import io
import json
import os
import re
import zipfile
import zlib
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any, Final

import numpy as np

from seacrane import __version__, documents
from seacrane.design import chart, mass, robot, standard
from seacrane.design.crane import Crane
from seacrane.design.mesh import Mesh, joined, mesh
from seacrane.design.reader import loads, to_json
from seacrane.design.sheet import sheet
from seacrane.errors import DesignError

DESIGN: Final = "design.json"
NOTICE: Final = "Computed from a design. Not a certified load chart, not approved by any class."

LARGEST: Final = 256 * 2**20
"""Largest archive that is read [bytes]."""

_LARGEST_DESIGN = 16 * 2**20
_MOST_ENTRIES = 1000
_LARGEST_DIRECTORY = 2**20
"""Of the list of files at the end of an archive [bytes], which is read whole before the files can be counted."""

_DEVICE = re.compile(r"(con|prn|aux|nul|com\d|lpt\d)([ .].*)?", re.IGNORECASE)
"""Names that Windows keeps for itself."""

_EPOCH = (1980, 1, 1, 0, 0, 0)
_Y_UP = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]])


def provenance(crane: Crane) -> str:
    """The SHA-256 hash of the crane's design file."""
    return hashlib.sha256(to_json(crane).encode()).hexdigest()


def export(crane: Crane, path: str | os.PathLike[str]) -> None:
    """Write the archive of a crane. `DesignError` with all that is wrong with it; nothing is written then."""
    documents.write(packed(crane), path)


def packed(crane: Crane) -> bytes:
    """The archive of a crane. `DesignError` with all that is wrong with it."""
    content = io.BytesIO()
    with zipfile.ZipFile(content, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in _files(crane):
            entry = zipfile.ZipInfo(name, _EPOCH)
            entry.compress_type = zipfile.ZIP_DEFLATED
            entry.external_attr = 0o644 << 16
            archive.writestr(entry, data)
    return content.getvalue()


def file_names(names: Iterable[str]) -> dict[str, str]:
    """For each name, what its files are called before the dot: no two alike, on any system, even without their case."""
    found: dict[str, str] = {}
    for name in names:
        stem = re.sub(r"[^\w .+()-]", "-", name).strip(" .")[:80] or "-"
        if _DEVICE.fullmatch(stem):
            stem = f"-{stem}"
        taken, number, plain = {other.casefold() for other in found.values()}, 1, stem
        while stem.casefold() in taken:
            number += 1
            stem = f"{plain} {number}"
        found[name] = stem
    return found


def load_archive(path: str | os.PathLike[str]) -> Crane:
    """The crane of an archive that `export`, or the page, has written. `DesignError` with the reason if it is none."""
    name = os.fspath(path)
    try:
        if Path(path).stat().st_size > LARGEST:
            raise DesignError.at(name, f"is larger than {LARGEST // 2**20} MiB")
    except OSError as failure:
        raise DesignError.at(name, f"cannot be read: {failure.strerror or failure}") from None
    return unpacked(documents.read(path, DesignError), name)


def unpacked(content: bytes, name: str) -> Crane:
    """The crane in the bytes of an archive; `name` stands for it in errors. `DesignError` if none is."""
    _bounded(content, name)
    try:
        with zipfile.ZipFile(io.BytesIO(content)) as archive:
            return loads(_design_in(archive, name), origin=f"{name}: {DESIGN}")
    except (zipfile.BadZipFile, zlib.error, EOFError, RuntimeError, ValueError, OSError) as failure:
        raise DesignError.at(name, f"is not a whole ZIP archive: {failure}") from None


def _bounded(content: bytes, name: str) -> None:
    """Refuse an archive by the record at its end, before its list of files is made into as many objects."""
    mark = b"PK\x05\x06"
    last = len(content) - 22 if content[-22:-18] == mark else -1  # without a comment behind it, or with one
    for end in (last, content.rfind(mark, -(22 + 0xFFFF))):
        if end < 0:
            continue  # if there is none at all, that is said when the archive is opened
        size = int.from_bytes(content[end + 12 : end + 16], "little")
        large = content[max(0, end - 20) : end].startswith(b"PK\x06\x07")  # the record is in another, for 64 bits
        if large or size > _LARGEST_DIRECTORY:
            raise DesignError.at(name, "has too many files for a design", allowed=f"{_MOST_ENTRIES}")


def _design_in(archive: zipfile.ZipFile, name: str) -> bytes:
    entries = archive.infolist()
    if len(entries) > _MOST_ENTRIES:
        raise DesignError.at(name, "has too many files for a design", value=len(entries), allowed=f"{_MOST_ENTRIES}")
    found = [entry for entry in entries if entry.filename == DESIGN]
    if len(found) != 1:
        what = "is in the archive twice" if found else "is not in the archive, so it is not a crane"
        raise DesignError.at(f"{name}: {DESIGN}", what)
    if found[0].compress_type not in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED):
        raise DesignError.at(f"{name}: {DESIGN}", "is packed in another way than seacrane packs", allowed="deflated")
    if found[0].file_size > _LARGEST_DESIGN:
        size = f"{found[0].file_size / 2**20:.4g} MiB"
        raise DesignError.at(f"{name}: {DESIGN}", f"is larger than {_LARGEST_DESIGN // 2**20} MiB", value=size)
    with archive.open(found[0]) as file:
        content = file.read(_LARGEST_DESIGN + 1)
    if len(content) > _LARGEST_DESIGN:
        raise DesignError.at(f"{name}: {DESIGN}", f"unpacks to more than {_LARGEST_DESIGN // 2**20} MiB")
    return content


def _files(crane: Crane) -> Iterator[tuple[str, bytes]]:
    text = to_json(crane)
    whole = standard.furnished(crane)
    shapes = {link.name: joined([mesh(part) for part in link.parts]) for link in whole.links}
    rows = [row for mode in chart.modes(crane) for row in chart.curve(crane, mode)]
    stems = file_names(shapes)
    stl = {link: f"meshes/{stem}.stl" for link, stem in stems.items()}
    stem = file_names([crane.name])[crane.name]
    yield DESIGN, text.encode()
    for link, shape in shapes.items():
        yield f"meshes/{stems[link]}.glb", gltf(shape, link)
        yield stl[link], stereolithography(shape)
    yield "mass_properties.json", _json(_masses(crane, whole))
    yield "load_chart.csv", chart.to_csv(rows).encode()
    yield (
        "load_chart.json",
        _json({"notice": NOTICE, "conditions": chart.conditions(crane), "rows": [_row(row) for row in rows]}),
    )
    yield f"{stem}.xml", robot.mjcf(crane, stl).encode()
    yield f"{stem}.urdf", robot.urdf(crane, stl).encode()
    yield "sheet.pdf", sheet(crane, provenance(crane))
    yield (
        "provenance.json",
        _json({"notice": NOTICE, "written_by": f"seacrane {__version__}", "design_sha256": provenance(crane)}),
    )


def gltf(shape: Mesh, name: str) -> bytes:
    """A mesh as binary glTF 2.0, with y up."""
    import trimesh

    scene = trimesh.Scene({name: _trimesh(Mesh(shape.vertices @ _Y_UP.T, shape.faces))})
    content: bytes = scene.export(file_type="glb")  # type: ignore[no-untyped-call]
    return content


def stereolithography(shape: Mesh) -> bytes:
    """A mesh as binary STL, with z up."""
    content: bytes = _trimesh(shape).export(file_type="stl")
    return content


def _trimesh(shape: Mesh) -> Any:
    import trimesh

    return trimesh.Trimesh(shape.vertices, shape.faces, process=False)


def _masses(crane: Crane, whole: Crane) -> dict[str, Any]:
    """Of each link as the design has it, and of its parts in the `whole` crane, where every link has some."""
    result = {}
    for link in whole.links:
        body = mass.of_link(link)
        result[link.name] = {
            "design": {"mass_kg": link.mass, "centre_m": link.com, "inertia_kg_m2": link.inertia},
            "parts": {
                "from": "the design" if crane.link(link.name).parts else "standard parts, the link has none of its own",
                "mass_kg": body.mass,
                "centre_m": body.centre.tolist(),
                "inertia_kg_m2": body.inertia.tolist(),
                "each_kg": {part.name: mass.of_part(part).mass for part in link.parts},
            },
        }
    return {"axes": "of the link; inertia about the centre of mass", "links": result}


def _row(row: chart.Row) -> dict[str, Any]:
    return {
        "mode": row.mode,
        "radius_m": row.radius,
        "swl_t": row.swl / 1e3,
        "governs": row.governs,
        "posture": row.posture,
    }


def _json(value: Any) -> bytes:
    return (json.dumps(value, indent=2, ensure_ascii=False, allow_nan=False) + "\n").encode()
