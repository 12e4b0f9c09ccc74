"""The binaries for other platforms, run by emulators: aarch64 Linux by QEMU, Windows by Wine.

`make foreign-platforms` installs both on Debian and runs this; where one is missing, its test is skipped.
"""

import importlib.util
import os
import shutil
import subprocess
import sys
import zipfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from seacrane import fmi, model
from seacrane.errors import SolveError
from seacrane.model.native import build
from seacrane.native.cross import TARGETS

RUNNER = Path(__file__).with_name("runner.c")
BOOM_DRIVE = Path(__file__).parents[2] / "examples" / "boom_drive.json"
SYSROOT = Path("/usr/aarch64-linux-gnu")
STEPS = 300

needs_zig = pytest.mark.skipif(
    importlib.util.find_spec("ziglang") is None, reason="the extra `export` (ziglang) is not installed"
)
needs_qemu = pytest.mark.skipif(
    not (shutil.which("qemu-aarch64") and SYSROOT.is_dir()),
    reason="needs qemu-aarch64 and an aarch64 C library (Debian: qemu-user, libc6-arm64-cross)",
)
needs_wine = pytest.mark.skipif(not shutil.which("wine"), reason="needs wine (Debian: wine, wine64)")


@dataclass(frozen=True)
class Case:
    """A drive from rest with an open valve: its FMU, what it gives on this machine, and what it says to mistakes."""

    fmu: Path
    defines: tuple[str, ...]
    wanted: np.ndarray
    refusals: list[str]


@pytest.fixture(scope="module")
def case(tmp_path_factory: pytest.TempPathFactory) -> Case:
    diagram = model.load(BOOM_DRIVE)
    native = build(diagram.compile())
    names = [e.variable.name for e in native.entries if e.kind in ("STATE", "OUTPUT", "OBSERVABLE")]
    rows = []
    with native.instantiate("drive") as drive:
        drive.initialize()
        with pytest.raises(SolveError) as refused:
            drive.step(0.0625, 0.25)
        drive.set("spool", 0.7)
        for i in range(STEPS):
            drive.step(i * 0.01, 0.01)
            rows.append(drive.get(names))
    path = tmp_path_factory.mktemp("foreign") / "drive.fmu"
    fmi.export(diagram, path, version="3.0", platforms=["aarch64-linux", "x86_64-windows"])
    references = ",".join(f"{native.value_reference(name)}u" for name in names)
    defines = (
        f'-DGUID="{native.guid}"',
        f"-DINPUT={native.value_reference('spool')}u",
        f"-DOUTPUTS={references}",
        f"-DSTEPS={STEPS}",
    )
    refusals = [
        "spool cannot be set to inf: it is not a finite number",
        str(refused.value).removeprefix("drive: "),
    ]
    return Case(path, defines, np.array(rows), refusals)


def zig(*arguments: str, cwd: Path) -> None:
    done = subprocess.run(
        [sys.executable, "-m", "ziglang", *arguments], check=False, cwd=cwd, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr


def check(case: Case, command: list[str], folder: Path, **environment: str) -> None:
    """Runs the program beside the library, which must give what the drive gives on this machine."""
    done = subprocess.run(
        command,
        check=False,
        cwd=folder,
        env=os.environ | environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
        timeout=240,
    )
    assert done.returncode == 0, f"{command[-1]} ended with {done.returncode}: {done.stdout[-2000:]}"
    lines = done.stdout.splitlines()
    assert lines[: len(case.refusals)] == case.refusals
    bits = np.array([[int(word, 16) for word in line.split()] for line in lines[len(case.refusals) :]], dtype=np.uint64)
    found = bits.view(np.float64)
    assert found.shape == case.wanted.shape
    assert np.ptp(found, axis=0).max() > 0
    assert np.all(np.abs(found - case.wanted) <= 1e-12 * np.abs(case.wanted).max(axis=0))


def library(case: Case, platform: str, folder: Path) -> str:
    """Takes the binary for a platform out of the FMU; its file name."""
    with zipfile.ZipFile(case.fmu) as archive:
        name = f"binaries/{platform}/boom_drive.{TARGETS[platform].suffix}"
        (folder / Path(name).name).write_bytes(archive.read(name))
    return Path(name).name


@needs_zig
@needs_qemu
def test_the_binary_for_aarch64_gives_the_results_of_this_machine(case: Case, tmp_path: Path) -> None:
    file = library(case, "aarch64-linux", tmp_path)
    target = TARGETS["aarch64-linux"].triple
    zig("cc", "-target", target, "-O1", *case.defines, f'-DLIBRARY="./{file}"', "-o", "run", str(RUNNER), cwd=tmp_path)
    check(case, ["qemu-aarch64", "-L", str(SYSROOT), "./run"], tmp_path)


@pytest.fixture
def wine_prefix(tmp_path: Path) -> Iterator[Path]:
    """A folder in which Wine has its Windows; its server ends with the test."""
    prefix = tmp_path / "wine"
    yield prefix
    subprocess.run(["wineserver", "-w"], check=False, env=os.environ | {"WINEPREFIX": str(prefix)}, timeout=60)


@needs_zig
@needs_wine
def test_the_binary_for_windows_gives_the_results_of_this_machine(
    case: Case, tmp_path: Path, wine_prefix: Path
) -> None:
    file = library(case, "x86_64-windows", tmp_path)
    functions = ("LoadLibraryA", "GetProcAddress", "GetStdHandle", "WriteFile", "ExitProcess")
    (tmp_path / "system.def").write_text("LIBRARY kernel32.dll\nEXPORTS\n" + "\n".join(functions) + "\n")
    zig("dlltool", "-m", "i386:x86-64", "-d", "system.def", "-D", "kernel32.dll", "-l", "system.a", cwd=tmp_path)
    flags = ("-O1", "-nostdlib", "-fno-builtin", "-fno-stack-protector", "-Wl,--entry=mainCRTStartup")
    target = TARGETS["x86_64-windows"].triple
    defines = (*case.defines, f'-DLIBRARY="{file}"')
    zig("cc", "-target", target, *flags, *defines, "-o", "run.exe", str(RUNNER), "system.a", cwd=tmp_path)
    check(case, ["wine", "run.exe"], tmp_path, WINEPREFIX=str(wine_prefix), WINEDEBUG="-all", WINEARCH="win64")
