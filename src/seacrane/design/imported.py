"""Meshes of other programs as parts: glTF (y up) and STL (z up), in any unit of length."""

from __future__ import annotations

import io
import json
import math
import os
from pathlib import Path
from typing import Any, Final

import numpy as np

from seacrane import documents
from seacrane.design import mass
from seacrane.design.mesh import Mesh, encoded, open_edges
from seacrane.design.parts import STEEL, Imported
from seacrane.errors import DesignError
from seacrane.units import UNITS

KINDS: Final = (".stl", ".glb", ".gltf")

LARGEST: Final = 64 * 2**20
"""Largest file that is read [bytes]."""


MOST_TRIANGLES: Final = 100_000
"""Of one mesh: with more, its design would no longer be a file of a few MB."""

_MOST_NODES = 1000
_MOST_NUMBERS = 10_000_000


def read(path: str | os.PathLike[str], *, unit: str = "m", density: float = STEEL) -> Imported:
    """The part in a file. `unit`: of an STL, which has none; a glTF is in m. See `part` for errors."""
    name = os.fspath(path)
    content = documents.read(name, DesignError)
    return part(content, Path(name).name, unit=unit, density=density)


def part(content: bytes, name: str, *, unit: str = "m", density: float = STEEL) -> Imported:
    """The part in the bytes of a file of this name.

    Only what is in the file itself is read; a glTF that points to other files is refused. `DesignError` with the reason
    if it is no mesh, too large, or not closed. A surface that is inside out is turned.
    """
    kind = Path(name).suffix.lower()
    if kind not in KINDS:
        raise DesignError.at(name, "is not a mesh that can be read", value=kind, allowed=", ".join(KINDS))
    if unit not in UNITS or not UNITS[unit].same_dimension(UNITS["m"]):
        raise DesignError.at("unit", "is not a unit of length", value=unit, allowed="m, mm, cm, ft, in")
    if len(content) > LARGEST:
        raise DesignError.at(name, f"is larger than {LARGEST // 2**20} MiB")
    if kind != ".stl":
        _modest(content, name)
    shape = _mesh(content, name, kind)
    if kind == ".stl":
        shape = Mesh(shape.vertices * UNITS[unit].factor, shape.faces)
    else:
        shape = Mesh(shape.vertices @ np.array([[1.0, 0, 0], [0, 0, 1.0], [0, -1.0, 0]]), shape.faces)
    if not len(shape.faces):
        raise DesignError.at(name, "has no triangles")
    if len(shape.faces) > MOST_TRIANGLES:
        raise DesignError.at(
            name,
            "has too many triangles for a part",
            value=len(shape.faces),
            allowed=f"at most {MOST_TRIANGLES}",
            hint="Simplify it in the program that it comes from.",
        )
    if edges := open_edges(shape):
        raise DesignError.at(
            name,
            f"is not closed, so it has no mass: {edges} edges are open or turned the wrong way",
            hint="Close it in the program that it comes from.",
        )
    volume = mass.volume(shape)
    if volume < 0:
        shape, volume = Mesh(shape.vertices, shape.faces[:, ::-1]), -volume
    if not 0 < volume < math.inf:
        raise DesignError.at(name, "encloses no volume, so it has no mass", value=f"{volume:.3g} m3")
    return Imported(name=Path(name).stem, source=name, surface=encoded(shape), density=density)


def _modest(content: bytes, name: str) -> None:
    """Refuse a glTF that asks for more than it holds: nodes that repeat a mesh, numbers that stand nowhere."""
    text = content
    if content[:4] == b"glTF":
        text = content[20 : 20 + int.from_bytes(content[12:16], "little")]
    try:
        data = json.loads(text.rstrip(b"\0"))
    except (ValueError, RecursionError):
        return  # what it is instead is said when it is read
    nodes, accessors = (data.get(key, []) if isinstance(data, dict) else [] for key in ("nodes", "accessors"))
    if not (isinstance(nodes, list) and isinstance(accessors, list)):
        raise DesignError.at(name, "cannot be read as a mesh: its nodes and accessors are no lists")
    counts = [item.get("count") for item in accessors if isinstance(item, dict)]
    numbers = sum(count for count in counts if isinstance(count, int))
    if len(nodes) > _MOST_NODES or numbers > _MOST_NUMBERS:
        raise DesignError.at(
            name, "has too many nodes or numbers for a part", allowed=f"{_MOST_NODES} nodes, {_MOST_NUMBERS} numbers"
        )


def _mesh(content: bytes, name: str, kind: str) -> Mesh:
    import trimesh

    try:
        found: Any = trimesh.load(io.BytesIO(content), file_type=kind[1:], force="mesh", process=False)
        found.merge_vertices(merge_tex=True, merge_norm=True)
        return Mesh(np.asarray(found.vertices, float), np.asarray(found.faces, np.int32))
    except Exception as failure:  # what a reader of foreign files may raise is not told
        raise DesignError.at(name, f"cannot be read as a mesh: {failure}") from None
