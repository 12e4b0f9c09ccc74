"""A model as a WebAssembly module: what is in the file. What it computes is tested where it runs, in tests/e2e."""

import importlib.util
import json
import zlib
from pathlib import Path

import pytest

from seacrane import fmi, model
from seacrane.cli import main
from seacrane.errors import CompileError
from seacrane.model.dae import Dae

BOOM_DRIVE = Path(__file__).parents[3] / "examples" / "boom_drive.json"
IMPORT, CUSTOM = 2, 0


def number(data: bytes, at: int) -> tuple[int, int]:
    """A LEB128 number and the place after it."""
    value = shift = 0
    while True:
        byte = data[at]
        value |= (byte & 0x7F) << shift
        at, shift = at + 1, shift + 7
        if byte < 0x80:
            return value, at


def sections(module: bytes) -> list[tuple[int, bytes]]:
    assert module[:8] == b"\0asm\1\0\0\0"
    found, at = [], 8
    while at < len(module):
        size, start = number(module, at + 1)
        found.append((module[at], module[start : start + size]))
        at = start + size
    assert at == len(module)
    return found


@pytest.fixture(scope="module")
def exported(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return fmi.export_wasm(model.load(BOOM_DRIVE), tmp_path_factory.mktemp("wasm") / "boom_drive.wasm")


def test_the_boom_drive_is_a_module_below_64_kB_that_imports_nothing(exported: Path) -> None:
    assert exported.stat().st_size < 64_000
    assert IMPORT not in [kind for kind, _ in sections(exported.read_bytes())]


def test_the_module_describes_itself(cylinder: Dae, tmp_path: Path) -> None:
    module = fmi.export_wasm(cylinder, tmp_path / "piston.wasm").read_bytes()
    last = sections(module)[-1]
    length, start = number(last[1], 0)
    assert (last[0], last[1][start : start + length]) == (CUSTOM, b"seacrane")
    description = json.loads(zlib.decompress(last[1][start + length :]))
    fmu = fmi.read(fmi.export(cylinder, tmp_path / "piston.fmu"))
    assert [(v["name"], v["reference"]) for v in description["variables"]] == [
        (v.name, v.value_reference) for v in fmu.variables
    ]
    assert {key: description[key] for key in ("format", "name", "about", "guid")} == {
        "format": "seacrane-wasm/1",
        "name": "piston drive",
        "about": "a piston & its valve",
        "guid": fmu.guid,
    }
    by_name = {v.pop("name"): v for v in description["variables"]}
    del by_name["chamber.p"]["reference"], by_name["area"]["reference"], by_name["force"]["reference"]
    assert by_name["chamber.p"] == {
        "kind": "state",
        "unit": "Pa",
        "shown": "bar",
        "factor": pytest.approx(1e-5),
        "about": "pressure <behind> the piston & before the valve",
        "start": 5e6,
    }
    assert by_name["area"]["minimum"] == 1e-6
    assert "maximum" not in by_name["area"]
    assert "start" not in by_name["force"]


def test_the_same_model_gives_the_same_bytes(exported: Path, tmp_path: Path, compiled_anew: None) -> None:
    again = fmi.export_wasm(model.load(BOOM_DRIVE), tmp_path / "another name.wasm")
    assert again.read_bytes() == exported.read_bytes()


def test_the_command_writes_the_module_beside_the_fmu(
    exported: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["fmu", "export", str(BOOM_DRIVE), "--wasm", "--out", str(tmp_path / "boom.fmu")]) == 0
    assert (tmp_path / "boom.wasm").read_bytes() == exported.read_bytes()
    size = f"{exported.stat().st_size / 1024:.0f}"
    assert capsys.readouterr().out.endswith(f"{tmp_path / 'boom.wasm'}: WebAssembly; {size} kB\n")


def test_the_fmu_and_the_module_cannot_be_one_file(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["fmu", "export", str(BOOM_DRIVE), "--wasm", "--out", str(tmp_path / "boom.wasm")]) == 2
    assert "--out: is the name of the module beside it; the FMU needs another" in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []


def test_without_the_compiler_nothing_is_written_and_the_error_says_what_to_install(
    cylinder: Dae, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(importlib.util, "find_spec", lambda _: None)
    with pytest.raises(CompileError, match=r"wasm: .*pip install seacrane\[export\]"):
        fmi.export_wasm(cylinder, tmp_path / "x.wasm")
    assert not (tmp_path / "x.wasm").exists()


def test_a_file_that_cannot_be_written_is_an_error_of_the_export(cylinder: Dae, tmp_path: Path) -> None:
    with pytest.raises(fmi.FmuError, match=r"nowhere/x\.wasm: cannot be written: No such file or directory"):
        fmi.export_wasm(cylinder, tmp_path / "nowhere" / "x.wasm")
