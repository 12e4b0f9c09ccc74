"""Export of a model as a WebAssembly module: the C of the FMU, for web pages and wherever else JavaScript runs."""

from __future__ import annotations

import json
import math
import zlib
from pathlib import Path
from typing import Any, Final

from seacrane.fmi.export import Compiles, write_whole
from seacrane.fmi.writing import model_identifier, starts
from seacrane.model.codegen import Entry, Generated, generate
from seacrane.model.dae import Dae
from seacrane.native.cross import build_module
from seacrane.units import UNITS

FORMAT: Final = "seacrane-wasm/1"
SECTION: Final = "seacrane"
"""The custom section of the module that holds its description: JSON in UTF-8, compressed (zlib, RFC 1950)."""

EXPORTS: Final = (
    "malloc", "free", "fmi2Instantiate", "fmi2FreeInstance", "fmi2SetupExperiment", "fmi2EnterInitializationMode",
    "fmi2ExitInitializationMode", "fmi2Reset", "fmi2SetReal", "fmi2GetReal", "fmi2DoStep", "seacrane_message",
    "seacrane_time", "seacrane_state_size", "seacrane_save", "seacrane_restore",
)  # fmt: skip
"""The functions of the module, which web/core/wasmModel.ts calls."""


def export_wasm(model: Dae | Compiles, path: str | Path) -> Path:
    """Writes the model as a WebAssembly module that contains its solver, and returns the path.

    The module imports nothing. It holds its own description in the custom section `seacrane`: name, kind, units, start,
    bounds and FMI value reference of each variable. `web/core/wasmModel.ts` loads and runs it. The file is complete or
    not there at all, and the same model gives the same bytes.

    Raises `CompileError` without the optional extra `export`, whose compiler makes it, and `FmuError` if the file
    cannot be written.
    """
    generated = generate(model if isinstance(model, Dae) else model.compile())
    module = build_module(model_identifier(generated.dae.name), generated.sources, EXPORTS, ["-w"]).read_bytes()
    text = json.dumps(description(generated), ensure_ascii=False)
    return write_whole(Path(path), module + custom_section(SECTION, zlib.compress(text.encode(), 9)))


def description(model: Generated) -> dict[str, Any]:
    """What a program that runs the module must know of the model."""
    return {
        "format": FORMAT,
        "name": model.dae.name,
        "about": model.dae.about,
        "guid": model.guid,
        "variables": [_variable(e) for e in model.entries],
    }


def _variable(entry: Entry) -> dict[str, Any]:
    """All numbers are SI; times `factor` they are in the unit `shown`. Without bound, there is none.

    The unit is empty for a derivative whose unit has no symbol.
    """
    v = entry.variable
    shown = v.display_unit
    numbers = {"start": v.start if starts(entry) else None, "minimum": v.minimum, "maximum": v.maximum}
    return {
        "name": v.name,
        "kind": entry.kind.lower(),
        "reference": entry.reference,
        "unit": v.unit,
        "shown": shown,
        "factor": UNITS[v.unit].factor / UNITS[shown].factor if v.unit else 1.0,
        "about": v.about,
        **{key: float(n) for key, n in numbers.items() if n is not None and math.isfinite(n)},
    }


def custom_section(name: str, content: bytes) -> bytes:
    """A custom section as it stands in a module (WebAssembly Core Specification, chapter "Binary Format")."""
    label = name.encode()
    payload = _leb128(len(label)) + label + content
    return b"\0" + _leb128(len(payload)) + payload


def _leb128(n: int) -> bytes:
    """A natural number in groups of seven bits, the lowest first, all but the last marked by the eighth."""
    groups = b""
    while n > 0x7F:
        groups += bytes([n & 0x7F | 0x80])
        n >>= 7
    return groups + bytes([n])
