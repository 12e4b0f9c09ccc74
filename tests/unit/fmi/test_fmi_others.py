"""An FMU for model exchange that another generates: CasADi's own export, run by our solver beside its closed form."""

import subprocess
import zipfile
from pathlib import Path

import casadi as ca
import fmpy
import numpy as np
import pytest

from seacrane import fmi
from seacrane.native import compiler


@pytest.fixture
def oscillator(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """x'' = u - x with x = 1, x' = 0 at the start, exported by CasADi as sources of FMI 3 and compiled."""
    monkeypatch.chdir(tmp_path)
    dae = ca.DaeBuilder("oscillator")
    dae.add("t", "independent")
    x = dae.add("x", "output", {"start": 1.0})
    v = dae.add("v", "local", {"start": 0.0})
    u = dae.add("u", "input", {"start": 0.0})
    dae.eq(dae.der(x), v)
    dae.eq(dae.der(v), u - x)
    dae.export_fmu()
    folders = [Path(fmpy.__file__).parent / "c-code", Path(ca.__file__).parent / "include", tmp_path]
    sources = ["oscillator.c", "oscillator_wrap.c"]
    flags = ["-O2", "-w", "-shared", "-fPIC", *(f"-I{folder}" for folder in folders)]
    subprocess.run([*compiler(), *flags, *sources, "-o", "oscillator.so", "-lm"], check=True)
    with zipfile.ZipFile("oscillator.fmu", "w") as archive:
        archive.write("modelDescription.xml")
        archive.write("oscillator.so", "binaries/x86_64-linux/oscillator.so")
    return tmp_path / "oscillator.fmu"


def test_casadis_fmu_swings_as_the_closed_form_says(oscillator: Path) -> None:
    d = fmi.read(oscillator)
    assert (d.co_simulation, d.generation_tool, d.model_exchange.directional_derivative) == (None, "CasADi", True)
    recording = fmi.run(oscillator, 10.0, 0.01, tolerance=1e-9)
    assert recording["x"] == pytest.approx(np.cos(recording.time), abs=1e-9)
    assert fmi.run(oscillator, 10.0, 10.0, tolerance=1e-9)["x"][-1] == pytest.approx(np.cos(10.0), abs=1e-7)


def test_flaws_of_casadis_description_are_found(oscillator: Path) -> None:
    messages = [str(problem) for problem in fmi.check(oscillator)]
    assert any("ModelStructure/InitialUnknowns: lacks v" in message for message in messages)
