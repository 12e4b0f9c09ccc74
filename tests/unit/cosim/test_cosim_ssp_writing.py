"""Systems written as SSP: they come back as they were, and other tools read and run them with the same results."""

import zipfile
from pathlib import Path

import casadi as ca
import numpy as np
import pytest
from fmpy.ssp.simulation import simulate_ssp
from fmpy.ssp.ssd import find_components, read_ssd
from libcosimpy.CosimExecution import CosimExecution
from libcosimpy.CosimLogging import CosimLogLevel, log_output_level
from libcosimpy.CosimObserver import CosimObserver

from seacrane.cosim import (
    Bond,
    Connection,
    Connector,
    Execution,
    Experiment,
    FmuSlave,
    FunctionSlave,
    Jacobi,
    ModelSlave,
    System,
    Transformation,
    load,
    read_ssp,
    write_ssp,
)
from seacrane.errors import CosimError
from seacrane.model.dae import Dae, Variable

STEP = 0.01


def oscillator(folder: Path, suffix: str = "", **parameters: float) -> System:
    """The spring at the top, the mass in a sub-system."""
    half = System("half", {"mass": FmuSlave(folder / f"mass{suffix}.fmu", parameters)}, about="what hangs")
    half.expose("force", "mass.force")
    system = System("oscillator", {"spring": FmuSlave(folder / f"spring{suffix}.fmu"), "half": half})
    system.bond("rod", effort=("spring.force", "half.force"), flow=("half.mass.velocity", "spring.velocity"))
    system.experiment = Experiment(stop=2.0, step=STEP, algorithm="jacobi", steps={"spring": 0.005})
    return system


def everything(folder: Path) -> System:
    """A system with each thing that a system can have."""
    mix = FmuSlave(folder / "mixer.fmu")
    inner = System(
        "inner", {"one": mix, "two": mix}, connectors=[Connector("bus", "signal"), Connector("can.v", "signal")]
    )
    inner.expose("push", "one.force", "two.force")
    inner.connect("one.plain_out", "bus")
    inner.connect("bus", "two.plain")
    inner.connect("one.speed_out", "can.v")
    inner.connect("can.v", "two.speed", gain=0.5, bias=2.0)
    inner.expose("answer", "two.force_out")
    system = System("everything", {"a": inner, "b": mix, "c": mix}, about="all <of> it & more")
    system.connect("a.answer", "b.force", gain=-1.5, bias=0.25)
    system.connect("b.force_out", "c.plain", convert=False)
    system.transform(
        ["b.force_out", "a.two.speed_out"], ["c.force", "c.speed"], [[0.6, -0.8], [0.8, 0.6]], convert=False
    )
    system.transform(["a.answer"], ["a.one.speed"], [[2.0]], [1.0], convert=False)
    system.expose("go", "a.push")
    return system


def described(system: System) -> object:
    """All that makes up a system, to be compared."""
    level = system.level
    parts = {}
    for name, part in level.parts.items():
        if isinstance(part, FmuSlave):
            parts[name] = (part.path.read_bytes(), part.parameters, part.kind)
        else:
            parts[name] = described(part)
    return system.name, system.about, system.experiment, level.connectors, level.connections, level.bonds, parts


def run(system: System, names: list[str], steps: int = 200) -> np.ndarray:
    with Execution(system, Jacobi(STEP)) as execution:
        recorder = execution.record(names)
        execution.start()
        execution.step(steps)
        execution.flush()
        recording = recorder.recording()
        return np.array([recording[name] for name in names]).T[1:]


@pytest.mark.parametrize("version", ["1.0", "2.0"])
@pytest.mark.parametrize("make", [oscillator, everything])
def test_what_is_written_is_read_as_the_same_and_written_as_the_same_bytes(
    coupled_fmus, tmp_path, make, version
) -> None:
    system = make(coupled_fmus)
    first = read_ssp(write_ssp(system, tmp_path / "first.ssp", version=version))
    assert set(first.connections) == set(system.connections)
    assert first.bonds == system.bonds
    assert first.experiment == system.experiment
    assert first.open_inputs == system.open_inputs
    second = read_ssp(write_ssp(first, tmp_path / "second.ssp", version=version))
    assert described(second) == described(first)
    assert (tmp_path / "first.ssp").read_bytes() == (tmp_path / "second.ssp").read_bytes()
    assert not first.notes


def test_connectors_signals_and_transformations_come_back_where_they_were(coupled_fmus, tmp_path) -> None:
    system = load(write_ssp(everything(coupled_fmus), tmp_path / "all.ssp"))
    inner = system.level.parts["a"]
    assert isinstance(inner, System)
    assert {c.name: (c.kind, c.unit) for c in inner.level.connectors.values()}.items() >= {
        "push": ("input", "N"), "answer": ("output", "kN"), "bus": ("signal", ""), "can.v": ("signal", "m/s"),
    }.items()  # fmt: skip
    assert [t for t in system.level.connections if isinstance(t, Transformation)] == [
        Transformation.of(
            ["b.force_out", "a.two_speed_out"], ["c.force", "c.speed"], [[0.6, -0.8], [0.8, 0.6]], convert=False
        )
    ]
    assert Connection("go", "a.push") in system.level.connections
    assert system.about == "all <of> it & more"


def test_fmpy_reads_the_archive_by_its_schema_and_simulates_it_alike(coupled_fmus, tmp_path) -> None:
    system = oscillator(coupled_fmus)
    path = write_ssp(system, tmp_path / "oscillator.ssp")
    description = read_ssd(str(path))
    assert sorted(c.name for c in find_components(description.system)) == ["mass", "spring"]
    assert {unit.name for unit in description.units} == {"N", "m/s"}
    result = simulate_ssp(str(path), stop_time=2.0 - STEP / 2, step_size=STEP)
    ours = run(system, ["spring.force", "half.mass.velocity"])
    assert np.ptp(ours[:, 0]) > 15
    np.testing.assert_allclose(result["spring.force"], ours[:, 0], rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(result["half.mass.velocity"], ours[:, 1], rtol=1e-9, atol=1e-9)


def test_everything_that_a_system_can_have_keeps_to_the_schema(coupled_fmus, tmp_path) -> None:
    description = read_ssd(str(write_ssp(everything(coupled_fmus), tmp_path / "all.ssp")))
    inner = next(e for e in description.system.elements if e.name == "a")
    assert [(d.name, [e.name for e in d.entries]) for d in inner.signalDictionaries] == [
        ("signals", ["bus"]),
        ("can", ["v"]),
    ]
    assert {e.name for e in inner.elements} == {"one", "two", "signals", "can"}


def test_libcosim_runs_the_archive_with_parameters_and_gains_alike(coupled_fmus, tmp_path) -> None:
    system = System(
        "flat",
        {
            "spring": FmuSlave(coupled_fmus / "spring.fmu", {"stiffness": 90.0}),
            "mass": FmuSlave(coupled_fmus / "mass.fmu", {"weight": 7.0, "force": 1.5}),
        },
    )
    system.connect("spring.force", "mass.force", gain=0.5, bias=1.5)
    system.connect("mass.velocity", "spring.velocity", gain=2.0)
    path = write_ssp(system, tmp_path / "flat.ssp")
    log_output_level(CosimLogLevel.ERROR)
    execution = CosimExecution.from_ssp_file(str(path), int(STEP * 1e9))
    observer = CosimObserver.create_last_value()
    assert execution.add_observer(observer=observer)
    index = next(s.index for s in execution.slave_infos() if s.name.decode() == "mass")
    reference = next(v.reference for v in execution.slave_variables(index) if v.name.decode() == "velocity")
    theirs = []
    for _ in range(100):
        assert execution.step()
        theirs.append(observer.last_real_values(index, [reference])[0])
    np.testing.assert_allclose(run(system, ["mass.velocity"], 100)[:, 0], theirs, rtol=1e-9, atol=1e-9)


def test_ssp_2_has_the_types_of_fmi_3_and_runs_its_fmus(coupled_fmus, tmp_path) -> None:
    path = write_ssp(oscillator(coupled_fmus, "3", mass=3.0), tmp_path / "three.ssp", version="2.0")
    with zipfile.ZipFile(path) as archive:
        text = archive.read("SystemStructure.ssd").decode()
    assert 'version="2.0"' in text
    assert '<ssc:Float64 unit="N" />' in text
    assert '<ssv:Float64 value="3.0" unit="kg" />' in text
    read = load(path)
    assert {s.description.fmi_version[0] for s in read.slaves.values()} == {"3"}
    names = ["spring.force", "half.mass.velocity"]
    np.testing.assert_array_equal(run(read, names), run(oscillator(coupled_fmus, "3", mass=3.0), names))


def test_an_fmu_that_is_used_twice_is_in_the_archive_once(coupled_fmus, tmp_path) -> None:
    path = write_ssp(everything(coupled_fmus), tmp_path / "all.ssp")
    with zipfile.ZipFile(path) as archive:
        assert archive.namelist() == ["SystemStructure.ssd", "resources/mixer.fmu"]


def test_an_ssd_has_its_fmus_beside_it(coupled_fmus, tmp_path) -> None:
    path = write_ssp(oscillator(coupled_fmus), tmp_path / "plain.ssd")
    assert sorted(p.name for p in (tmp_path / "resources").iterdir()) == ["mass.fmu", "spring.fmu"]
    assert load(path).bonds == oscillator(coupled_fmus).bonds


def test_compiled_models_become_fmus_and_python_functions_are_refused(tmp_path) -> None:
    x, u, none = ca.SX.sym("x"), ca.SX.sym("u"), ca.SX(0, 1)
    tank = Dae(
        "tank", (Variable("level", "m"),), (), (Variable("flow", "m3/s"),), (Variable("area", "m2", 2.0),),
        (Variable("head", "m"),), (), ca.SX.sym("t"), x, none, u, ca.SX.sym("a"), u / 2, none, x, none,
    )  # fmt: skip
    system = System("tanks", {"tank": ModelSlave(tank, {"level": 0.5, "area": 4.0})})
    read = read_ssp(write_ssp(system, tmp_path / "tanks.ssp"))
    slave = read.slaves["tank"]
    assert isinstance(slave, FmuSlave)
    assert slave.parameters == {"level": 0.5, "area": 4.0}
    system.add("control", FunctionSlave(lambda t, h, u: [0.0], outputs=[Variable("q", "m3/s")]))
    with pytest.raises(CosimError) as caught:
        write_ssp(system, tmp_path / "no.ssp")
    assert str(caught.value) == "control: is neither an FMU nor a compiled model, but a FunctionSlave"
    assert not (tmp_path / "no.ssp").exists()


def test_a_bond_whose_connections_were_changed_elsewhere_is_no_bond_any_more(coupled_fmus, tmp_path) -> None:
    path = write_ssp(oscillator(coupled_fmus), tmp_path / "x.ssd")
    assert load(path).bonds == {
        "rod": Bond("rod", ("spring.force", "half.mass.force"), ("half.mass.velocity", "spring.velocity"))
    }
    text = path.read_text()
    begin = text.index('<ssd:Connection startElement="spring"')
    path.write_text(text[:begin] + text[text.index("/>", begin) + 2 :])
    system = load(path)
    assert not system.bonds
    assert system.notes == ("rod: is no power bond any more, as its connections have been changed",)
    assert "half.mass.force" in system.open_inputs


@pytest.mark.parametrize(("name", "version", "message"), [
    ("x.zip", "1.0", "x.zip: is no file of this format (got '.zip'); allowed: .ssp, .ssd"),
    ("x.ssp", "3.0", "version: is not a version of SSP (got '3.0'); allowed: 1.0, 2.0"),
    ("gone/x.ssp", "1.0", "x.ssp: cannot be written: No such file or directory"),
])  # fmt: skip
def test_what_cannot_be_written_is_refused(coupled_fmus, tmp_path, name, version, message) -> None:
    with pytest.raises(CosimError) as caught:
        write_ssp(oscillator(coupled_fmus), tmp_path / name, version=version)
    assert str(caught.value).endswith(message)
