"""What we export: a valid FMU that is the model, for anybody's importer."""

import hashlib
import re
import subprocess
import zipfile
from dataclasses import replace
from pathlib import Path

import casadi as ca
import fmpy
import numpy as np
import pytest
from fmpy.validation import validate_fmu

from seacrane import fmi
from seacrane.errors import FmuError
from seacrane.library.signals import Sine
from seacrane.model import Diagram
from seacrane.model.codegen import generate
from seacrane.model.dae import Dae, Variable
from seacrane.model.native import build
from seacrane.native import FLAGS, compiler


def test_another_validator_and_ours_find_nothing(piston_fmu: Path) -> None:
    assert validate_fmu(str(piston_fmu)) == []
    assert fmi.check(piston_fmu) == []


def test_the_fmu_of_a_model_without_states_or_inputs_is_valid(tmp_path: Path) -> None:
    t, none = ca.SX.sym("t"), ca.SX(0, 1)
    ship = Dae(
        "ship", (), (), (), (), (Variable("z", "m"),), (), t, none, none, none, none, none, none, ca.sin(t), none
    )
    path = fmi.export(ship, tmp_path / "ship.fmu")
    assert validate_fmu(str(path)) == [] == fmi.check(path)


@pytest.mark.parametrize("kind", ["CoSimulation", "ModelExchange"])
def test_another_importer_gets_the_numbers_that_we_get(piston_fmu: Path, cylinder: Dae, kind: str) -> None:
    outputs = ["force", "flow", "piston.x", "power"]
    theirs = fmpy.simulate_fmu(
        str(piston_fmu),
        fmi_type=kind,
        stop_time=1.0,
        output_interval=0.01,
        start_values={"spool": 0.5, "mass": 800.0},
        output=outputs,
        relative_tolerance=1e-9,
    )
    with build(cylinder).instantiate() as run:
        run.set(["spool", "mass", "solver.tolerance"], [0.5, 800.0, 1e-9])
        run.initialize(0.0)
        ours = run.simulate(theirs["time"], outputs)
    for i, name in enumerate(outputs):
        largest = np.abs(ours[:, i]).max()
        assert ours[:, i] == pytest.approx(theirs[name], rel=1e-6, abs=1e-6 * largest), name
    assert np.ptp(ours[:, 2]) > 1e-3


def test_our_importer_runs_our_fmu_bit_for_bit_as_the_model(piston_fmu: Path, cylinder: Dae) -> None:
    names = ["force", "flow", "chamber.p"]
    with build(cylinder).instantiate() as model, fmi.Fmu(piston_fmu) as fmu, fmu.instantiate() as slave:
        model.initialize(0.0)
        slave.initialize(0.0)
        for k in range(50):
            for run in (model, slave):
                run.set(["spool", "load"], [np.sin(0.1 * k), 1e4 + 100 * k])
                run.step(k * 0.01, 0.01)
            assert list(model.get(names)) == list(slave.get(names))


def test_a_rollback_repeats_bit_for_bit_through_another_importer(piston_fmu: Path) -> None:
    description = fmpy.read_model_description(str(piston_fmu))
    references = {v.name: v.valueReference for v in description.modelVariables}
    slave = fmpy.instantiate_fmu(fmpy.extract(str(piston_fmu)), description, "CoSimulation")
    watched = [references[n] for n in ("force", "flow", "piston.v")]
    slave.setupExperiment(startTime=0.0)
    slave.enterInitializationMode()
    slave.exitInitializationMode()
    slave.doStep(0.0, 0.05)
    state = slave.getFMUstate()
    saved = slave.serializeFMUstate(state)
    slave.doStep(0.05, 0.1)
    first = list(slave.getReal(watched))
    slave.setFMUstate(state)
    slave.doStep(0.05, 0.1)
    assert list(slave.getReal(watched)) == first
    again = slave.deSerializeFMUstate(saved)
    slave.setFMUstate(again)
    slave.doStep(0.05, 0.1)
    assert list(slave.getReal(watched)) == first
    slave.freeFMUstate(state)
    slave.freeFMUstate(again)
    slave.terminate()
    slave.freeInstance()


def test_directional_derivatives_look_through_the_algebraic_unknowns(piston_fmu: Path, cylinder: Dae) -> None:
    description = fmpy.read_model_description(str(piston_fmu))
    references = {v.name: v.valueReference for v in description.modelVariables}
    slave = fmpy.instantiate_fmu(fmpy.extract(str(piston_fmu)), description, "CoSimulation")
    slave.setupExperiment(startTime=0.0)
    slave.enterInitializationMode()
    slave.exitInitializationMode()
    unknowns = [references[n] for n in ("flow", "der(chamber.p)", "der(piston.v)")]
    found = slave.getDirectionalDerivative(unknowns, [references["spool"]], [1.0])

    def values(spool: float) -> np.ndarray:
        with build(cylinder).instantiate() as run:
            run.set("spool", spool)
            run.initialize(0.0)
            return run.get(["flow", "der(chamber.p)", "der(piston.v)"])

    slope = (values(0.2 + 1e-4) - values(0.2 - 1e-4)) / 2e-4
    assert list(found) == pytest.approx(slope, rel=1e-6)
    slave.terminate()
    slave.freeInstance()


def test_the_same_model_gives_the_same_bytes(cylinder: Dae, tmp_path: Path) -> None:
    one, two = (fmi.export(cylinder, tmp_path / name).read_bytes() for name in ("one.fmu", "two.fmu"))
    assert hashlib.sha256(one).digest() == hashlib.sha256(two).digest()


def test_the_description_carries_units_bounds_and_dependencies(piston_fmu: Path) -> None:
    description = fmi.read(piston_fmu)
    pressure, area = description.by_name["chamber.p"], description.by_name["area"]
    assert (pressure.unit, pressure.display_unit, pressure.start, pressure.nominal) == ("Pa", "bar", 5e6, 1e6)
    assert pressure.description == "pressure <behind> the piston & before the valve"
    assert (area.causality, area.variability, area.minimum, area.maximum) == ("parameter", "tunable", 1e-6, None)
    pascal = next(u for u in description.units if u.name == "Pa")
    assert dict(pascal.exponents) == {"kg": 1, "m": -1, "s": -2}
    assert pascal.display["bar"] == (pytest.approx(1e-5), 0.0)
    names = [v.name for v in description.variables]
    flow = next(u for u in description.outputs if names[u.index - 1] == "flow")
    assert {names[i - 1] for i in flow.dependencies or ()} == {"spool", "chamber.p"}


def test_a_failed_export_leaves_nothing(cylinder: Dae, tmp_path: Path) -> None:
    (tmp_path / "taken.fmu").mkdir()
    with pytest.raises(FmuError, match=r"taken.fmu: cannot be written: Is a directory"):
        fmi.export(cylinder, tmp_path / "taken.fmu")
    with pytest.raises(FmuError, match=r"cannot be written: No such file or directory"):
        fmi.export(cylinder, tmp_path / "nowhere" / "x.fmu")
    assert [p.name for p in tmp_path.iterdir()] == ["taken.fmu"]


def test_the_library_shows_nothing_but_the_interface(piston_fmu: Path, tmp_path: Path) -> None:
    with zipfile.ZipFile(piston_fmu) as archive:
        binary = next(n for n in archive.namelist() if n.startswith("binaries/"))
        archive.extract(binary, tmp_path)
    shown = subprocess.run(
        ["nm", "-D", "--defined-only", tmp_path / binary], capture_output=True, text=True, check=True
    )
    symbols = {line.split()[-1] for line in shown.stdout.splitlines()}
    assert {s for s in symbols if not s.startswith(("fmi2", "fmi3", "seacrane_"))} == set()
    assert {"fmi2DoStep", "fmi2Instantiate", "fmi2GetReal", "fmi3DoStep"} <= symbols


@pytest.fixture(scope="module")
def sources(cylinder: Dae, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("sources")
    for name, text in generate(cylinder).sources.items():
        (folder / name).write_text(text)
    return folder


STRICT = ("-Wall", "-Wextra", "-Wpedantic", "-Wstrict-prototypes", "-Wshadow", "-Werror", "-c", "-o", "/dev/null")


def test_the_core_compiles_without_a_warning(sources: Path) -> None:
    for unit in sorted(sources.glob("*.c")):
        if unit.name != "model_functions.c":  # written by CasADi
            done = subprocess.run([*compiler(), *FLAGS, *STRICT, unit], capture_output=True, text=True, check=False)
            assert done.returncode == 0, done.stderr


NO_VARIABLES = (
    "Float32",
    "Int8",
    "UInt8",
    "Int16",
    "UInt16",
    "Int32",
    "UInt32",
    "Int64",
    "UInt64",
    "Boolean",
    "String",
)
"""Types for which fmi3.c makes its functions by a macro."""


def test_our_declarations_agree_with_the_headers_of_the_standard(sources: Path) -> None:
    official = Path(fmpy.__file__).parent / "c-code"
    command = [*compiler(), *FLAGS, *STRICT, "-DSEACRANE_OFFICIAL_FMI_HEADERS", f"-I{official}"]
    for version in ("2", "3"):
        unit = sources / f"fmi{version}.c"
        strict = [flag for flag in command if version == "2" or flag != "-Wstrict-prototypes"]  # theirs has a bare ()
        done = subprocess.run([*strict, unit], capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr
        declared = [line.split() for line in (official / f"fmi{version}Functions.h").read_text().splitlines()]
        names = {words[2].rstrip(";") for words in declared if words[:1] == [f"FMI{version}_Export"]}
        ours = set(re.findall(rf"\b(fmi{version}\w+)\(", unit.read_text()))
        ours |= {f"fmi3{verb}{kind}" for verb in ("Get", "Set") for kind in NO_VARIABLES if version == "3"}
        assert len(names) > 40
        assert names - ours == set()


def test_a_diagram_is_exported_with_its_exposed_names(tmp_path: Path) -> None:
    diagram = Diagram("swell")
    diagram.expose(heave=diagram.add("wave", Sine(amplitude=1.5, period=4.0, unit="m")).y)
    path = fmi.export(diagram, tmp_path / "swell.fmu")
    assert validate_fmu(str(path)) == [] == fmi.check(path)
    with fmi.Fmu(path) as fmu, fmu.instantiate() as slave:
        slave.set("wave.amplitude", 2.0)
        slave.initialize(0.0)
        slave.step(0.0, 1.0)
        assert slave.get("heave") == pytest.approx(2.0)
    assert fmi.read(path).by_name["heave"].unit == "m"


def test_the_cache_finds_what_is_the_same_and_nothing_else(
    cylinder: Dae, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    first = fmi.cached(cylinder)
    written = first.stat().st_mtime_ns
    assert first == fmi.cached(cylinder)
    assert first.stat().st_mtime_ns == written
    assert first.read_bytes() == fmi.export(cylinder, tmp_path / "piston.fmu").read_bytes()
    described = replace(cylinder, about="the same equations, described otherwise")
    assert build(described).guid == build(cylinder).guid
    assert fmi.cached(described) != first
    assert fmi.read(fmi.cached(described)).description == "the same equations, described otherwise"
    assert fmi.read(fmi.cached(cylinder, version="3.0")).fmi_version == "3.0"
