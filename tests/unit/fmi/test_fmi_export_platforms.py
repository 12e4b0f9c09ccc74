"""One archive with binaries for five platforms, from this machine."""

import ctypes
import importlib.util
import struct
import zipfile
from pathlib import Path

import pytest

from seacrane import fmi
from seacrane.errors import CompileError, FmuError
from seacrane.model.dae import Dae

needs_zig = pytest.mark.skipif(
    importlib.util.find_spec("ziglang") is None, reason="the extra `export` (ziglang) is not installed"
)


@needs_zig
def test_every_platform_gets_a_library_of_its_own_format(cylinder: Dae, tmp_path: Path) -> None:
    path = fmi.export(cylinder, tmp_path / "all.fmu", version="3.0", platforms="all")
    with zipfile.ZipFile(path) as archive:
        found = {n.split("/")[1]: archive.read(n) for n in archive.namelist() if n.startswith("binaries/")}
    for machine, code in (("x86_64-linux", 62), ("aarch64-linux", 183)):
        assert found[machine][:4] == b"\x7fELF"
        assert struct.unpack_from("<H", found[machine], 18) == (code,)
        assert b"GLIBC_2.34" not in found[machine]
    windows = found["x86_64-windows"]
    at = struct.unpack_from("<I", windows, 60)[0]
    assert windows[:2] == b"MZ"
    assert windows[at : at + 6] == b"PE\0\0\x64\x86"
    assert b"ucrtbase.dll" in windows
    assert b"api-ms-win" not in windows
    for machine, code in (("x86_64-darwin", 0x01000007), ("aarch64-darwin", 0x0100000C)):
        assert struct.unpack_from("<II", found[machine]) == (0xFEEDFACF, code)
        assert b"@rpath/piston_drive.dylib" in found[machine]
    for library in found.values():
        assert all(name in library for name in (b"fmi2Instantiate", b"fmi2DoStep", b"fmi3DoStep", b"fmi3SetTime"))
        assert str(Path.home()).encode() not in library
    (tmp_path / "piston.so").write_bytes(found["x86_64-linux"])
    library = ctypes.CDLL(str(tmp_path / "piston.so"))
    library.fmi3GetVersion.restype = ctypes.c_char_p
    assert library.fmi3GetVersion() == b"3.0"
    two = fmi.export(cylinder, tmp_path / "two.fmu", platforms="all")
    assert fmi.check(two) == []
    with zipfile.ZipFile(two) as archive:
        both = archive.read("binaries/darwin64/piston_drive.dylib")
    assert struct.unpack_from(">II", both) == (0xCAFEBABE, 2)
    for i in range(2):
        machine, _, offset, size, _ = struct.unpack_from(">IIIII", both, 8 + 20 * i)
        assert struct.unpack_from("<II", both, offset) == (0xFEEDFACF, machine)
        assert both[offset : offset + size] in found.values()


def test_an_unknown_platform_is_refused(cylinder: Dae, tmp_path: Path) -> None:
    with pytest.raises(FmuError, match=r"platforms: is none that can be exported for.*riscv64-linux"):
        fmi.export(cylinder, tmp_path / "x.fmu", platforms=["riscv64-linux"])


def test_without_the_extra_the_error_says_what_to_install(
    cylinder: Dae, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(importlib.util, "find_spec", lambda _: None)
    with pytest.raises(CompileError, match=r"pip install seacrane\[export\]"):
        fmi.export(cylinder, tmp_path / "x.fmu", platforms="all")
