"""The sources in an FMU build as the standard says, and run as the binary; the same model gives the same bytes."""

import os
import subprocess
import sys
import zipfile
from pathlib import Path
from xml.etree import ElementTree

import pytest
from fmpy.build import build_platform_binary

from seacrane import fmi
from seacrane.fmi.export import Version
from seacrane.fmi.platforms import binary_path
from seacrane.model.dae import Dae
from seacrane.native import compiler


def opened_without_binary(cylinder: Dae, folder: Path, version: Version) -> Path:
    """The FMU unpacked into a folder that then has nothing but what everybody can read."""
    path = fmi.export(cylinder, folder / "open.fmu", version=version, sources=True)
    with zipfile.ZipFile(path) as archive:
        archive.extractall(folder / "open")
    (folder / "open" / binary_path("piston_drive", version)).unlink()
    return folder / "open"


def packed(folder: Path, target: Path) -> Path:
    with zipfile.ZipFile(target, "w") as archive:
        for file in sorted(folder.rglob("*")):
            if file.is_file():
                archive.write(file, file.relative_to(folder))
    return target


def assert_runs_as(path: Path, original: Path) -> None:
    settings = {"values": {"spool": 0.5, "solver.tolerance": 1e-9}}
    for kind in ("co-simulation", "model-exchange"):
        first, second = (fmi.run(p, 0.3, 0.01, kind=kind, tolerance=1e-9, **settings) for p in (path, original))
        assert fmi.compare(first, second)[0].relative < 1e-9


def test_the_build_description_is_all_that_a_c_compiler_needs(cylinder: Dae, tmp_path: Path) -> None:
    folder = opened_without_binary(cylinder, tmp_path, "3.0")
    root = ElementTree.parse(folder / "sources" / "buildDescription.xml").getroot()
    (configuration,) = root.findall("BuildConfiguration")
    (files,) = configuration.findall("SourceFileSet")
    library = folder / binary_path(configuration.attrib["modelIdentifier"], "3.0")
    command = [
        *compiler(), f"-std={files.attrib['language'].lower()}", "-shared", "-fPIC", "-o", str(library),
        *(f"-D{d.attrib['name']}={d.get('value', '')}" for d in files.findall("PreprocessorDefinition")),
        *(f.attrib["name"] for f in files.findall("SourceFile")),
        *(f"-l{one.attrib['name']}" for one in configuration.findall("Library")),
    ]  # fmt: skip
    subprocess.run(command, cwd=folder / "sources", check=True)
    assert_runs_as(packed(folder, tmp_path / "built.fmu"), tmp_path / "open.fmu")


@pytest.mark.parametrize("version", ["2.0", "3.0"])
def test_another_tool_builds_the_sources(
    cylinder: Dae, tmp_path: Path, version: Version, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("PATH", f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}")  # where cmake is
    folder = opened_without_binary(cylinder, tmp_path, version)
    (tmp_path / "build").mkdir()
    build_platform_binary(folder, tmp_path / "build")
    assert_runs_as(packed(folder, tmp_path / "built.fmu"), tmp_path / "open.fmu")


WRITES_BOTH = """
from seacrane import fmi
from seacrane.library.hydraulics import Orifice, Tank
from seacrane.model import Diagram
drain = Diagram("drain")
edge, tank = drain.add("edge", Orifice(diameter=3e-3)), drain.add("tank", Tank())
drain.connect(edge.b, tank.p)
drain.expose(a=edge.a)
for version in ("2.0", "3.0"):
    fmi.export(drain, f"{version}.fmu", version=version, sources=True)
"""


def test_another_process_in_another_place_writes_the_same_bytes(tmp_path: Path) -> None:
    runs = []
    for seed, zone, language, mask in (("1", "Asia/Tokyo", "C", 0o077), ("2", "UTC", "C.UTF-8", 0o022)):
        place = tmp_path / f"place {seed}"
        place.mkdir()
        own = {"XDG_CACHE_HOME": str(place), "PYTHONHASHSEED": seed, "TZ": zone, "LC_ALL": language}
        command = [sys.executable, "-c", WRITES_BOTH]
        runs.append((place, subprocess.Popen(command, cwd=place, env=os.environ | own, umask=mask)))
    assert [run.wait() for _, run in runs] == [0, 0]
    for version in ("2.0", "3.0"):
        one, two = ((place / f"{version}.fmu").read_bytes() for place, _ in runs)
        assert one == two
