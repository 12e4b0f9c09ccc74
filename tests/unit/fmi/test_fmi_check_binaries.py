"""Findings about the binaries of an FMU: each is a file that was put in the place of a sound one."""

import subprocess
import zipfile
from collections.abc import Callable
from pathlib import Path

import pytest

from seacrane import fmi
from seacrane.native import compiler

BINARY = "binaries/linux64/{}.so"


@pytest.fixture
def changed(piston_fmu: Path, tmp_path: Path) -> Callable[..., Path]:
    """The sound FMU with other bytes for its library, or its GUID changed in the description alone."""

    def write(library: Callable[[bytes], bytes] = bytes, guid: str = "") -> Path:
        path = tmp_path / "changed.fmu"
        known = fmi.read(piston_fmu)
        binary = BINARY.format(known.co_simulation.model_identifier)
        with zipfile.ZipFile(piston_fmu) as source, zipfile.ZipFile(path, "w") as target:
            for name in source.namelist():
                data = source.read(name)
                if name == binary:
                    data = library(data)
                if name == "modelDescription.xml" and guid:
                    data = data.replace(known.guid.encode(), guid.encode())
                target.writestr(name, data)
        return path

    return write


def compiled(folder: Path, source: str) -> bytes:
    (folder / "library.c").write_text(source)
    command = [*compiler(), "-shared", "-fPIC", str(folder / "library.c"), "-o", str(folder / "library.so")]
    subprocess.run(command, check=True)
    return (folder / "library.so").read_bytes()


def test_a_sound_fmu_has_no_findings(changed: Callable[..., Path]) -> None:
    assert fmi.check(changed()) == []


def test_a_library_that_belongs_to_another_description_is_found_by_its_guid(changed: Callable[..., Path]) -> None:
    (found,) = fmi.check(changed(guid="{00000000-1111-2222-3333-444444444444}"))
    assert found.path == BINARY.format("piston_drive")
    assert found.message.startswith("does not hold the GUID of changed.fmu, and ")
    assert "fmi2Instantiate" in found.message or "GUID" in found.message.removeprefix("does not hold the GUID")


@pytest.mark.parametrize(
    ("library", "message"),
    [
        (lambda data: b"", "is not an ELF library"),
        (lambda data: b"not a library", "is not an ELF library"),
        (lambda data: b"MZ" + data[2:], "is not an ELF library"),
        (
            lambda data: data[:18] + b"\xb7\x00" + data[20:],
            "is made for aarch64, and lies where one for x86_64 is looked for",
        ),
    ],
    ids=["empty", "text", "windows", "arm"],
)
def test_a_file_that_is_no_library_for_its_place_is_found(changed, library, message) -> None:
    (found,) = fmi.check(changed(library))
    assert (found.path, found.message) == (BINARY.format("piston_drive"), message)


def test_a_library_without_the_functions_of_fmi_is_found(changed, tmp_path) -> None:
    strange = compiled(tmp_path, "int nothing(void) { return 0; }")
    (found,) = fmi.check(changed(lambda data: strange))
    assert "fmi2" in found.message


def test_a_library_that_ends_its_process_is_found_and_the_check_survives(changed, tmp_path) -> None:
    deadly = compiled(tmp_path, "#include <stdlib.h>\n__attribute__((constructor)) void begin(void) { abort(); }")
    (found,) = fmi.check(changed(lambda data: deadly))
    assert found.message.startswith("ends the process in which an instance is made (exit code ")
