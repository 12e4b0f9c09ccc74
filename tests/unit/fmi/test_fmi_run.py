"""FMUs run by themselves and compared, from Python and from the command line."""

import zipfile
from pathlib import Path
from typing import Literal

import fmpy
import numpy as np
import pytest

from seacrane import fmi
from seacrane.cli import main
from seacrane.cosim import Execution, FmuSlave, GaussSeidel, System
from seacrane.errors import FmuError, ParameterError
from seacrane.model import load
from seacrane.model.dae import Dae
from seacrane.results import Recording, Signal

INTEGRATOR = """
from pythonfmu import Fmi2Causality, Fmi2Slave, Fmi2Variability, Integer, Real, Boolean, String

class Tank(Fmi2Slave):
    description = "a tank that fills"

    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.inflow, self.level, self.area, self.steps, self.open, self.label = 0.0, 0.5, 2.0, 0, True, "tank"
        self.register_variable(Real("inflow", causality=Fmi2Causality.input))
        self.register_variable(Real("level", causality=Fmi2Causality.output))
        self.register_variable(Integer("steps", causality=Fmi2Causality.output, variability=Fmi2Variability.discrete))
        self.register_variable(
            Real("area", causality=Fmi2Causality.parameter, variability=Fmi2Variability.tunable)
        )
        self.register_variable(
            Boolean("open", causality=Fmi2Causality.parameter, variability=Fmi2Variability.tunable)
        )
        self.register_variable(
            String("label", causality=Fmi2Causality.parameter, variability=Fmi2Variability.tunable)
        )

    def do_step(self, current_time, step_size):
        if self.open:
            self.level += step_size * self.inflow / self.area
        self.steps += 1
        return True
"""


@pytest.fixture(scope="module")
def tank(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """An FMU of Python code, made by pythonfmu."""
    builder = pytest.importorskip("pythonfmu.builder")
    folder = tmp_path_factory.mktemp("tank")
    (folder / "tank.py").write_text(INTEGRATOR)
    return Path(builder.FmuBuilder.build_FMU(folder / "tank.py", dest=folder))


def test_anothers_fmu_gives_what_anothers_importer_gets(tank: Path) -> None:
    times = np.linspace(0, 1, 11)
    inputs = Recording(times, {"inflow": Signal("1", "1", times**2)})
    ours = fmi.run(tank, 1.0, 0.1, inputs=inputs, values={"area": 4.0}, outputs=["level", "steps"])
    table = np.array(list(zip(times, times**2, strict=True)), dtype=[("time", float), ("inflow", float)])
    theirs = fmpy.simulate_fmu(
        str(tank), stop_time=1.0, output_interval=0.1, input=table, start_values={"area": 4.0}, output=["level"]
    )
    assert ours["level"] == pytest.approx(theirs["level"], abs=1e-12)
    assert ours["steps"][-1] == 10


def test_types_of_anothers_fmu_are_set_and_read(tank: Path) -> None:
    with fmi.Fmu(tank) as fmu, fmu.instantiate("one") as slave:
        slave.set(["label", "open"], ["barrel", False])
        slave.initialize()
        slave.set("inflow", 1.0)
        slave.step(0.0, 0.1)
        assert slave.get(["label", "open", "level", "steps"]) == ["barrel", False, 0.5, 1]


@pytest.mark.parametrize("loop", ["c", "python"])
def test_numbers_of_all_types_of_anothers_fmu_are_signals(tank: Path, loop: Literal["c", "python"]) -> None:
    slave = FmuSlave(tank, {"label": "barrel", "open": True})
    with Execution(System("s", {"tank": slave}), GaussSeidel(0.1), loop=loop) as run:
        run.set("tank.inflow", 1.0)
        recording = run.run(1.0)
        assert list(recording["tank.steps"]) == list(range(11))
        assert recording["tank.level"][-1] == pytest.approx(0.5 + 1.0 / 2)
        run.set("tank.open", 0.0)
        run.step()
        assert run.values(["tank.level"])[0] == recording["tank.level"][-1]


def test_two_runs_are_compared_with_the_worst_first(piston_fmu: Path) -> None:
    first = fmi.run(piston_fmu, 0.1, 0.01)
    second = fmi.run(piston_fmu, 0.1, 0.01, values={"supply": 2.1e7})
    same = fmi.compare(first, first)
    assert [d.largest for d in same] == [0.0, 0.0]
    worst = fmi.compare(first, second)[0]
    assert worst.relative == max(d.relative for d in fmi.compare(first, second)) > 0
    assert worst.largest == np.abs(first[worst.name] - second[worst.name]).max()


def test_names_that_do_not_fit_are_told_at_once(piston_fmu: Path) -> None:
    with pytest.raises(ParameterError) as caught:
        fmi.run(piston_fmu, 1.0, 0.1, outputs=["forse", "pour"])
    assert [str(p) for p in caught.value.problems] == [
        "forse: is no number that can be recorded. Did you mean 'force'?",
        "pour: is no number that can be recorded. Did you mean 'power'?",
    ]
    with pytest.raises(ParameterError, match="force: is no input of real numbers"):
        fmi.run(piston_fmu, 1.0, 0.1, inputs=Recording(np.zeros(1), {"force": Signal("N", "N", np.zeros(1))}))
    with pytest.raises(ParameterError, match="must be at least a step after the start"):
        fmi.run(piston_fmu, 0.0, 0.1)
    with pytest.raises(ParameterError, match="step: must be a positive number of seconds"):
        fmi.run(piston_fmu, 1.0, 0.0)
    with pytest.raises(ParameterError, match="until: must be a finite number of seconds"):
        fmi.run(piston_fmu, float("nan"), 0.1)
    area = fmi.read(piston_fmu).by_name["area"]
    with pytest.raises(FmuError, match="area: is Real and cannot take this value"):
        fmi.parse(area, "wide")


def test_the_command_line_shows_runs_and_compares(
    piston_fmu: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["fmu", "info", str(piston_fmu)]) == 0
    shown = capsys.readouterr().out
    assert "piston drive" in shown
    assert "co-simulation" in shown
    assert any(line.split()[:2] == ["spool", "input"] for line in shown.splitlines())
    Recording(np.array([0.0, 0.1]), {"load": Signal("N", "N", np.array([1e4, 2e4]))}).to_csv(tmp_path / "in.csv")
    settings = ["--until", "0.1", "--step", "0.01", "--set", "supply=2.1e7", "--input", str(tmp_path / "in.csv")]
    files = ["--csv", str(tmp_path / "out.csv"), "--plot", str(tmp_path / "out.svg")]
    assert main(["fmu", "run", str(piston_fmu), *settings, "--output", "force", *files]) == 0
    recording = Recording.read_csv(tmp_path / "out.csv")
    assert (recording.names, len(recording)) == (("force",), 11)
    assert (tmp_path / "out.svg").read_text().startswith("<?xml")
    assert main(["fmu", "compare", str(piston_fmu), str(piston_fmu), *settings, "--within", "1e-9"]) == 0
    assert "no output deviates by more than 1e-09" in capsys.readouterr().out
    assert main(["fmu", "run", str(piston_fmu), "--until", "1", "--set", "suply=1", "--set", "area"]) == 2
    error = capsys.readouterr().err
    assert "seacrane: parameter: suply: no such variable. Did you mean 'supply'" in error
    assert "--set: is not NAME=VALUE (got 'area')" in error
    with zipfile.ZipFile(tmp_path / "x.fmu", "w") as archive:
        archive.writestr("a", "b")
    assert main(["fmu", "info", str(tmp_path / "x.fmu")]) == 2


@pytest.mark.parametrize(("version", "kind"), [("2.0", "model-exchange"), ("3.0", "model-exchange"), ("3.0", None)])
def test_our_exports_give_the_same_in_every_version_and_kind(
    cylinder: Dae, piston_fmu: Path, tmp_path: Path, version: Literal["2.0", "3.0"], kind: fmi.Kind | None
) -> None:
    settings = {"values": {"solver.tolerance": 1e-9}, "outputs": ["force", "flow", "piston.x"]}
    expected = fmi.run(piston_fmu, 0.5, 0.01, **settings)
    other = fmi.export(cylinder, tmp_path / "other.fmu", version=version)
    deviations = fmi.compare(expected, fmi.run(other, 0.5, 0.01, kind=kind, tolerance=1e-9, **settings))
    assert deviations[0].relative < 1e-6, deviations


def test_terminals_and_icons_are_read_and_shown(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    diagram = load(Path(__file__).parents[3] / "examples" / "boom_drive.json")
    path = fmi.export(diagram, tmp_path / "drive.fmu", version="3.0")
    d, pictures = fmi.read(path), fmi.icons(path)
    assert d.terminals
    assert pictures["terminalsAndIcons/icon.png"].startswith(b"\x89PNG")
    assert b"<svg" in pictures["terminalsAndIcons/icon.svg"]
    assert main(["fmu", "info", str(path)]) == 0
    shown = capsys.readouterr().out
    assert "terminalsAndIcons/icon.svg (" in shown
    terminal = d.terminals[0]
    row = next(line for line in shown.splitlines() if line.startswith(f"{terminal.name} ") and terminal.kind in line)
    assert all(f"{member} = {variable}" in row for member, variable in terminal.members.items())
