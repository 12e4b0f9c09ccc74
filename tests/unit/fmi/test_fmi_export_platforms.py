"""One archive with binaries for five platforms, from this machine.

Those of Linux on aarch64 and of Windows run in tests/conformance; those of macOS are only looked at, here.
"""

import ctypes
import importlib.util
import re
import struct
import zipfile
from collections.abc import Iterator
from pathlib import Path

import pytest

from seacrane import fmi
from seacrane.errors import CompileError, FmuError
from seacrane.model.dae import Dae

EXPORTED = (
    "fmi2Instantiate", "fmi2DoStep", "fmi2GetDerivatives", "fmi2SetFMUstate", "fmi3InstantiateCoSimulation",
    "fmi3InstantiateModelExchange", "fmi3DoStep", "fmi3GetContinuousStateDerivatives", "fmi3GetAdjointDerivative",
)  # fmt: skip

needs_zig = pytest.mark.skipif(
    importlib.util.find_spec("ziglang") is None, reason="the extra `export` (ziglang) is not installed"
)


def binaries(fmu: Path) -> dict[str, bytes]:
    """The libraries of an FMU by their folders."""
    with zipfile.ZipFile(fmu) as archive:
        return {n.split("/")[1]: archive.read(n) for n in archive.namelist() if n.startswith("binaries/")}


def load_commands(library: bytes) -> Iterator[tuple[int, bytes]]:
    """The load commands of a Mach-O file: number and content (mach-o/loader.h)."""
    (count,) = struct.unpack_from("<I", library, 16)
    at = 32
    for _ in range(count):
        command, size = struct.unpack_from("<II", library, at)
        yield command & 0x7FFFFFFF, library[at : at + size]
        at += size


def path_in(command: bytes) -> bytes:
    return command[struct.unpack_from("<I", command, 8)[0] :].rstrip(b"\0")


def exported_symbols(library: bytes, table: bytes) -> set[bytes]:
    """The names that are defined and external in the symbol table of a Mach-O file."""
    symbols, count, strings = struct.unpack_from("<III", table, 8)
    found = set()
    for i in range(count):
        name, kind = struct.unpack_from("<IB", library, symbols + 16 * i)
        if kind & 0x0F == 0x0F:
            found.add(library[strings + name : library.index(b"\0", strings + name)])
    return found


@pytest.fixture(scope="module")
def all3(cylinder: Dae, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return fmi.export(cylinder, tmp_path_factory.mktemp("all") / "all.fmu", version="3.0", platforms="all")


@needs_zig
def test_every_platform_gets_a_library_that_names_nothing_of_this_machine(all3: Path) -> None:
    found = binaries(all3)
    assert len(found) == 5
    for library in found.values():
        assert all(name in library for name in (b"fmi2Instantiate", b"fmi2DoStep", b"fmi3DoStep", b"fmi3SetTime"))
        assert str(Path.home()).encode() not in library
        assert b"/tmp" not in library


@needs_zig
def test_linux_libraries_ask_for_no_glibc_after_2_17_and_run_here(all3: Path, tmp_path: Path) -> None:
    found = binaries(all3)
    for machine, code in (("x86_64-linux", 62), ("aarch64-linux", 183)):
        assert found[machine][:4] == b"\x7fELF"
        assert struct.unpack_from("<H", found[machine], 18) == (code,)
        versions = [tuple(map(int, v.split(b"."))) for v in re.findall(rb"GLIBC_(\d[\d.]*)\0", found[machine])]
        assert versions
        assert max(versions) <= (2, 17)
    (tmp_path / "piston.so").write_bytes(found["x86_64-linux"])
    library = ctypes.CDLL(str(tmp_path / "piston.so"))
    library.fmi3GetVersion.restype = ctypes.c_char_p
    assert library.fmi3GetVersion() == b"3.0"


@needs_zig
def test_the_windows_library_asks_for_the_c_library_of_the_system_alone(all3: Path) -> None:
    windows = binaries(all3)["x86_64-windows"]
    at = struct.unpack_from("<I", windows, 60)[0]
    assert windows[:2] == b"MZ"
    assert windows[at : at + 6] == b"PE\0\0\x64\x86"
    wanted = {name.lower() for name in re.findall(rb"[\w.-]+\.dll\0", windows, re.IGNORECASE)}
    assert wanted == {b"ucrtbase.dll\0", b"piston_drive.dll\0"}  # the second is what it is called itself


@needs_zig
@pytest.mark.parametrize(("machine", "code"), [("x86_64-darwin", 0x01000007), ("aarch64-darwin", 0x0100000C)])
def test_macos_libraries_are_relocatable_signed_where_they_must_be_and_export_fmi(
    all3: Path, machine: str, code: int
) -> None:
    library = binaries(all3)[machine]
    dylib, id_of, needs, symbols, version, signature = 6, 0xD, 0xC, 0x2, 0x32, 0x1D
    assert struct.unpack_from("<III", library)[:2] == (0xFEEDFACF, code)
    assert struct.unpack_from("<I", library, 12) == (dylib,)
    commands = list(load_commands(library))
    content = dict(commands)
    assert path_in(content[id_of]) == b"@rpath/piston_drive.dylib"
    assert [path_in(c) for n, c in commands if n == needs] == [b"/usr/lib/libSystem.B.dylib"]
    macos, minimum = struct.unpack_from("<II", content[version], 8)
    assert (macos, minimum) == (1, 11 << 16)
    assert signature in content or machine == "x86_64-darwin"  # Apple's own processors run nothing unsigned
    functions = {f"_{name}".encode() for name in EXPORTED}
    assert functions <= exported_symbols(library, content[symbols])


@needs_zig
def test_fmi_2_has_both_kinds_of_macos_in_one_universal_binary_and_the_same_bytes_each_time(
    cylinder: Dae, all3: Path, tmp_path: Path, compiled_anew: None
) -> None:
    two = fmi.export(cylinder, tmp_path / "two.fmu", platforms="all")
    assert fmi.check(two) == []
    found, before = binaries(two), binaries(all3)
    assert found["linux64"] == before["x86_64-linux"]
    assert found["aarch64-linux"] == before["aarch64-linux"]
    assert found["win64"] == before["x86_64-windows"]
    both = found["darwin64"]
    assert struct.unpack_from(">II", both) == (0xCAFEBABE, 2)
    for i, name in enumerate(("x86_64-darwin", "aarch64-darwin")):
        machine, _, offset, size, _ = struct.unpack_from(">IIIII", both, 8 + 20 * i)
        assert struct.unpack_from("<II", both, offset) == (0xFEEDFACF, machine)
        assert both[offset : offset + size] == before[name]


def test_an_unknown_platform_is_refused(cylinder: Dae, tmp_path: Path) -> None:
    with pytest.raises(FmuError, match=r"platforms: is none that can be exported for.*riscv64-linux"):
        fmi.export(cylinder, tmp_path / "x.fmu", platforms=["riscv64-linux"])


def test_without_the_extra_the_error_says_what_to_install(
    cylinder: Dae, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(importlib.util, "find_spec", lambda _: None)
    with pytest.raises(CompileError, match=r"pip install seacrane\[export\]"):
        fmi.export(cylinder, tmp_path / "x.fmu", platforms="all")
