"""Our declarations of the functions that we call, held against the headers of the standard."""

import ctypes
import re
import subprocess
from pathlib import Path
from typing import Any

import fmpy
import pytest

from seacrane.fmi import api, foreign, typed
from seacrane.native import FOLDER, compiler

HEADERS = Path(fmpy.__file__).parent / "c-code"
FILES = {"fmi": "fmi1Functions.h", "fmi2": "fmi2FunctionTypes.h", "fmi3": "fmi3FunctionTypes.h"}
INTEGER, POINTER, REAL, RECORD = "integer", "pointer", "real", "record"


def declared(prefix: str) -> dict[str, list[str]]:
    """The arguments of each function of a header, without their names."""
    text = re.sub(r"/\*.*?\*/", "", (HEADERS / FILES[prefix]).read_text(), flags=re.DOTALL)
    name = "fmi1" if prefix == "fmi" else prefix
    found = re.findall(rf"typedef\s+\w+\s*\*?\s+{name}(\w+)TYPE\s*\(([^;]*)\);", text)
    return {function: [a.strip() for a in arguments.split(",") if a.strip()] for function, arguments in found}


def classes(prefix: str, types: set[str], folder: Path) -> dict[str, tuple[str, int]]:
    """What the C compiler says of each type: its class and size."""
    lines = "".join(
        f'    printf("{t} %d %zu\\n", __builtin_classify_type(*({t} *)memory), sizeof({t}));\n' for t in sorted(types)
    )
    text = f'#include <stdio.h>\n#include <stddef.h>\n#include "{FILES[prefix]}"\nstatic char memory[256];\n'
    (folder / "types.c").write_text(f"{text}int main(void)\n{{\n{lines}    return 0;\n}}\n")
    subprocess.run([*compiler(), "-w", f"-I{HEADERS}", folder / "types.c", "-o", folder / "types"], check=True)
    said = subprocess.run([folder / "types"], check=True, capture_output=True, text=True).stdout
    kinds = {5: POINTER, 8: REAL, 12: RECORD}
    rows = [line.rsplit(" ", 2) for line in said.splitlines()]
    return {name: (kinds.get(int(kind), INTEGER), int(size)) for name, kind, size in rows}


def ours(argument: Any) -> tuple[str, int]:
    if issubclass(argument, ctypes.Structure):
        return RECORD, ctypes.sizeof(argument)
    if argument in (ctypes.c_void_p, ctypes.c_char_p) or issubclass(argument, ctypes._Pointer):
        return POINTER, ctypes.sizeof(ctypes.c_void_p)
    return REAL if argument in (ctypes.c_double, ctypes.c_float) else INTEGER, ctypes.sizeof(argument)


CREATORS = {
    "fmi": {"InstantiateSlave": api._CREATE1},
    "fmi2": {"Instantiate": api._CREATE2},
    "fmi3": {"InstantiateModelExchange": [*api._CREATE3, ctypes.c_void_p, ctypes.c_void_p]},
}


@pytest.mark.parametrize("version", ["1.0", "2.0", "3.0"])
def test_every_function_takes_what_the_standard_says(version: str, tmp_path: Path) -> None:
    one = api.BY_VERSION[version]
    functions = {**one.common, **one.slave, **one.model, **one.state, **one.derivatives, **CREATORS[one.prefix]}
    theirs = declared(one.prefix)
    assert set(functions) <= set(theirs)
    plain: dict[str, list[str | None]] = {}
    for name in functions:
        plain[name] = []
        for argument in theirs[name]:
            pointer = "*" in argument or "[" in argument
            words = re.sub(r"\bconst\b", "", argument).split()
            plain[name].append(None if pointer else words[0])
    kinds = classes(one.prefix, {t for types in plain.values() for t in types if t}, tmp_path)
    for name, arguments in functions.items():
        expected = [kinds[t] if t else (POINTER, ctypes.sizeof(ctypes.c_void_p)) for t in plain[name]]
        assert [ours(argument) for argument in arguments] == expected, name
    sizes = classes(one.prefix, {f"{'fmi1' if one.prefix == 'fmi' else one.prefix}{t}" for t in one.types}, tmp_path)
    for kind, c_type in one.types.items():
        assert sizes[f"{'fmi1' if one.prefix == 'fmi' else one.prefix}{kind}"][1] == ctypes.sizeof(c_type), kind


def test_structures_have_the_layout_that_c_gives_them(tmp_path: Path) -> None:
    library = foreign.adapter()
    library.seacrane_foreign_size.restype = library.seacrane_typed_size.restype = ctypes.c_size_t
    assert ctypes.sizeof(foreign.State) == library.seacrane_foreign_size()
    assert ctypes.sizeof(typed._Typed) == library.seacrane_typed_size()
    assert classes("fmi", {"fmi1CallbackFunctions"}, tmp_path)["fmi1CallbackFunctions"] == (
        RECORD,
        ctypes.sizeof(api.Callbacks1),
    )
    assert classes("fmi2", {"fmi2CallbackFunctions"}, tmp_path)["fmi2CallbackFunctions"] == (
        RECORD,
        ctypes.sizeof(api.Callbacks2),
    )
    fields = {
        "update": "newDiscreteStatesNeeded", "terminate": "terminateSimulation",
        "nominals": "nominalsOfContinuousStatesChanged", "values": "valuesOfContinuousStatesChanged",
        "defined": "nextEventTimeDefined", "next": "nextEventTime",
    }  # fmt: skip
    checks = "".join(
        f'_Static_assert(offsetof(event_info_t, {a}) == offsetof(fmi2EventInfo, {b}), "{a}");\n'
        for a, b in fields.items()
    )
    (tmp_path / "info.c").write_text(f'#include "foreign.h"\n#include "fmi2FunctionTypes.h"\n{checks}')
    command = [*compiler(), "-w", "-c", f"-I{HEADERS}", f"-I{FOLDER}", tmp_path / "info.c", "-o", tmp_path / "info.o"]
    subprocess.run(command, check=True)
