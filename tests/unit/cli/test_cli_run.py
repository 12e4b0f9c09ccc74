"""`seacrane run`: what it writes, says and refuses."""

from __future__ import annotations

from pathlib import Path

import casadi as ca
import numpy as np
import pytest

from seacrane import cosim, fmi
from seacrane.cli import main
from seacrane.cli.run import settings_of
from seacrane.model.dae import Dae, Variable
from seacrane.results import Recording

FILE = """<OspSystemStructure version="0.1"><BaseStepSize>0.01</BaseStepSize>
<Simulators><Simulator name="spring" source="spring.fmu"/><Simulator name="mass" source="mass.fmu"/></Simulators>
<Connections>{}</Connections></OspSystemStructure>"""

LINK = (
    '<VariableConnection powerBond="rod"><Variable simulator="spring" name="{0}"/>'
    '<Variable simulator="mass" name="{0}"/></VariableConnection>'
)


def dae(name: str, state: Variable, inputs: list[Variable], output: Variable, law) -> Dae:
    """x' and y from x, u and the parameter p."""
    x, u, p, none = ca.SX.sym("x"), ca.SX.sym("u", len(inputs)), ca.SX.sym("p"), ca.SX(0, 1)
    ode, out = law(x, u, p)
    parameter = Variable("stiffness", "N/m", 40.0) if name == "spring" else Variable("mass", "kg", 2.0, minimum=0.1)
    return Dae(
        name, (state,), (), tuple(inputs), (parameter,), (output,), (), ca.SX.sym("t"),
        x, none, u, p, ode, none, out, none,
    )  # fmt: skip


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Mass on a spring: the mass starts at 1 m/s and may be pulled by a further force."""
    folder = tmp_path_factory.mktemp("oscillator")
    force, velocity = Variable("force", "N"), Variable("velocity", "m/s")
    spring = dae("spring", Variable("stretch", "m"), [velocity], force, lambda x, u, p: (u, -p * x))
    mass = dae(
        "mass", Variable("v", "m/s", 1.0), [force, Variable("pull", "N")], velocity,
        lambda x, u, p: ((u[0] + u[1]) / p, x),
    )  # fmt: skip
    for model in (spring, mass):
        fmi.export(model, folder / f"{model.name}.fmu")
    (folder / "OspSystemStructure.xml").write_text(FILE.format(LINK.format("force") + LINK.format("velocity")))
    return folder


def run(folder: Path, *options: str) -> int:
    return main(["run", str(folder), *options])


def test_a_system_runs_and_the_summary_says_how_fast_and_how_good_the_bonds_are(folder, capsys) -> None:
    assert run(folder, "--until", "2") == 0
    said = capsys.readouterr()
    lines = said.out.splitlines()
    assert lines[0].startswith(f"{folder.name}: 2 s simulated, jacobi, 200 macro steps of 0.01 s; ")
    assert "real-time factor" in lines[0]
    assert lines[1].startswith("bond rod: energy error ")
    assert [line.split()[0] for line in lines[2:4]] == ["spring.force", "mass.velocity"]
    assert lines[2].endswith(" N")
    assert said.err == "seacrane: 1 input is not connected and keeps its start value: mass.pull\n"


def test_what_is_asked_for_is_written_with_units_and_gauss_seidel_is_the_more_accurate(folder, tmp_path) -> None:
    errors = {}
    for algorithm in ("jacobi", "gauss-seidel"):
        file, picture = tmp_path / f"{algorithm}.csv", tmp_path / f"{algorithm}.png"
        options = ["--until", "2", "--algorithm", algorithm, "--csv", str(file), "--plot", str(picture)]
        assert run(folder, *options, "--signals", "mass.*,rod.power", "--every", "0.1", "--step", "0.001") == 0
        recording = Recording.read_csv(file)
        units = {name: signal.unit for name, signal in recording.signals.items()}
        assert (units["mass.pull"], units["mass.v"], units["rod.power"]) == ("N", "m/s", "W")
        assert all(name.startswith("mass.") or name == "rod.power" for name in units)
        assert len(recording) == 21
        exact = np.cos(np.sqrt(20.0) * recording.time)
        errors[algorithm] = np.abs(recording["mass.velocity"] - exact).max()
        assert picture.read_bytes().startswith(b"\x89PNG")
    assert errors["gauss-seidel"] < errors["jacobi"] < 0.1


def test_parameters_and_open_inputs_are_set_with_units(folder, tmp_path, capsys) -> None:
    file = tmp_path / "set.csv"
    options = ["--until", "0.5", "--step", "0.001", "--algorithm", "gauss-seidel", "--csv", str(file)]
    assert run(folder, *options, "--set", "mass.mass=0.02 t", "--set", "mass.pull=0.4 kN") == 0
    recording = Recording.read_csv(file)
    w, t = np.sqrt(2.0), recording.time
    np.testing.assert_allclose(recording["mass.velocity"], np.cos(w * t) + 20 / w * np.sin(w * t), atol=0.02)
    assert capsys.readouterr().err == ""


@pytest.mark.parametrize("pull", ["400", "0.4 kN", "4e2", "400 N"])
def test_a_bare_number_is_in_the_variables_own_unit_alone_and_coupled(folder, tmp_path, pull) -> None:
    file = tmp_path / "out.csv"
    assert (
        run(folder, "--until", "0.1", "--record", str(file), "--signals", "mass.pull", "--set", f"mass.pull={pull}")
        == 0
    )
    assert Recording.read_csv(file)["mass.pull"][-1] == 400.0
    alone = ["fmu", "run", str(folder / "mass.fmu"), "--until", "0.1", "--csv", str(file), "--signals", "pull"]
    assert main([*alone, "--set", f"pull={pull}"]) == 0
    assert Recording.read_csv(file)["pull"][-1] == 400.0


def test_a_bare_number_is_not_si_where_a_variable_is_not(capsys) -> None:
    pump = cosim.FunctionSlave(lambda t, h, u: u, [Variable("p", "bar")], [Variable("y", "bar")])
    system = cosim.System("hydraulics", {"pump": pump})
    for text in ("210", "210 bar", "21 MPa", "2.1e7 Pa"):
        assert settings_of(system, [f"pump.p={text}"])["pump.p"] == pytest.approx(210.0)


def test_progress_is_shown_on_request(folder, capsys) -> None:
    assert run(folder, "--until", "1", "--progress") == 0
    assert "     1.000 of 1 s, real-time factor " in capsys.readouterr().err


def test_connectors_of_a_system_are_set_and_recorded_by_their_own_names(folder, tmp_path, capsys) -> None:
    half = cosim.System("half", {"mass": cosim.FmuSlave(folder / "mass.fmu", {"v": 0.0})})
    half.expose("pull", "mass.pull")
    half.expose("speed", "mass.velocity")
    archive, file = cosim.write_ssp(half, tmp_path / "half.ssp"), tmp_path / "half.csv"
    options = [
        "--until",
        "1",
        "--step",
        "0.1",
        "--set",
        "pull=0.004 kN",
        "--signals",
        "speed,pull",
        "--record",
        str(file),
    ]
    assert main(["run", str(archive), *options]) == 0
    recording = Recording.read_csv(file)
    assert list(recording.signals) == ["mass.velocity", "mass.pull"]
    np.testing.assert_allclose(recording["mass.velocity"], 2.0 * recording.time, atol=1e-9)
    assert "mass.force" in capsys.readouterr().err


def test_the_steps_of_slaves_that_a_file_gives_are_used_where_an_algorithm_can(folder, tmp_path, capsys) -> None:
    text = (folder / "OspSystemStructure.xml").read_text().replace('"spring.fmu"', '"spring.fmu" stepSize="0.02"')
    for name in ("spring", "mass"):
        (tmp_path / f"{name}.fmu").symlink_to(folder / f"{name}.fmu")
    (tmp_path / "OspSystemStructure.xml").write_text(text)
    results = []
    for where, algorithm in ((folder, "jacobi"), (tmp_path, "jacobi"), (tmp_path, "newton")):
        file = tmp_path / "out.csv"
        assert run(where, "--until", "1", "--algorithm", algorithm, "--record", str(file)) == 0
        results.append(Recording.read_csv(file)["spring.force"])
    assert (np.diff(results[0])[1:] != 0).all()
    assert (np.diff(results[1])[2::2] == 0).all() or (np.diff(results[1])[1::2] == 0).all()
    assert "newton steps all slaves together, so the file's steps of slaves are not used" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--until", "1", "--algorithm", "jakobi"], "algorithm: there is no such algorithm (got 'jakobi'); allowed: "),
        ([], "--until: is not given, and the file does not say it"),
        (["--until", "0"], "--until: is not after the start (got 0.0); allowed: above 0 s"),
        (["--until", "1", "--step", "0"], "step: is not a duration (got 0.0)"),
        (["--until", "1", "--set", "mass.pul=3"], "mass.pul: no such variable. Did you mean 'mass.pull'"),
        (["--until", "1", "--set", "mass.pull=3 m"], "mass.pull: a quantity in 'm' cannot be given in 'N'"),
        (["--until", "1", "--set", "mass.mass=0"], "mass.mass: is out of its bounds (got 0.0); allowed: 0.1 to inf kg"),
        (["--until", "1", "--set", "mass.force=3"], "mass.force: is driven by 'spring.force' and cannot be set"),
        (["--until", "1", "--set", "mass.pull"], "--set: is not NAME=VALUE (got 'mass.pull')"),
        (["--until", "1", "--signals", "mas.*"], "mas.*: is no variable that can be recorded"),
    ],
)
def test_what_cannot_be_done_is_refused_in_one_line(folder, capsys, options, message) -> None:
    assert run(folder, *options) == 2
    assert message in capsys.readouterr().err


def test_a_file_of_another_kind_is_refused(tmp_path, capsys) -> None:
    file = tmp_path / "system.toml"
    file.write_text("")
    assert main(["run", str(file), "--until", "1"]) == 2
    assert "system.toml: is no file of a system (got '.toml')" in capsys.readouterr().err


# ---------------------------------------------------------------- recording, scenarios, states, speed
SCENARIO = """{"format": "seacrane-scenario/1", "name": "lost spring", "events": [
    {"at": "0.5 s", "do": "override", "variable": "mass.force", "to": "0 N"},
    {"at": "1.5 s", "do": "release", "variable": "mass.force"}]}"""


@pytest.mark.parametrize("suffix", [".csv", ".arrow", ".parquet"])
def test_a_scenario_is_carried_out_and_recorded_into_any_kind_of_file(folder, tmp_path, suffix, capsys) -> None:
    file, scenario = tmp_path / f"run{suffix}", tmp_path / "lost.json"
    scenario.write_text(SCENARIO)
    assert run(folder, "--until", "2", "--record", str(file), "--scenario", str(scenario)) == 0
    assert f"{file}: 9 signals, 201 rows" in capsys.readouterr().out
    recording = Recording.read(file)
    coasting = recording.between(0.51, 1.5)["mass.velocity"]
    assert np.ptp(coasting) == 0.0
    assert np.ptp(recording.between(1.52, 2.0)["mass.velocity"]) > 0.1


def test_a_run_in_two_parts_is_the_run_in_one(folder, tmp_path) -> None:
    whole, rest, state = tmp_path / "whole.arrow", tmp_path / "rest.arrow", tmp_path / "run.state"
    scenario = tmp_path / "lost.json"
    scenario.write_text(SCENARIO)
    assert run(folder, "--until", "2", "--record", str(whole), "--scenario", str(scenario)) == 0
    assert run(folder, "--until", "1", "--save", str(state), "--scenario", str(scenario)) == 0
    options = ["--resume", str(state), "--scenario", str(scenario)]
    assert run(folder, "--until", "2", "--record", str(rest), *options) == 0
    expected, resumed = Recording.read(whole).between(1.0, 2.0), Recording.read(rest)
    assert np.array_equal(resumed.time, expected.time)
    assert all(np.array_equal(resumed[name], expected[name]) for name in expected)


def test_a_state_of_another_run_is_refused(folder, tmp_path, capsys) -> None:
    state = tmp_path / "run.state"
    assert run(folder, "--until", "1", "--save", str(state)) == 0
    assert run(folder, "--until", "2", "--resume", str(state), "--step", "0.02") == 2
    assert "the algorithm: is not the same as in the saved run" in capsys.readouterr().err


def test_a_scenario_that_does_not_fit_is_refused_with_all_that_is_wrong(folder, tmp_path, capsys) -> None:
    scenario = tmp_path / "lost.json"
    scenario.write_text(SCENARIO.replace("mass.force", "mas.force").replace("0 N", "0 bar"))
    assert run(folder, "--until", "2", "--scenario", str(scenario)) == 2
    lines = capsys.readouterr().err.splitlines()
    assert [line.partition("events")[2][:12] for line in lines if "events" in line] == ["[0].variable", "[1].variable"]


def test_a_run_at_a_given_speed_says_how_well_it_was_kept(folder, capsys) -> None:
    assert run(folder, "--until", "1", "--speed", "5") == 0
    assert "5 times real time: " in capsys.readouterr().out


def test_a_recording_is_shown_and_converted(folder, tmp_path, capsys) -> None:
    file, target = tmp_path / "run.arrow", tmp_path / "run.parquet"
    assert run(folder, "--until", "1", "--record", str(file), "--signals", "mass.velocity,spring.force") == 0
    capsys.readouterr()
    assert main(["recording", "convert", str(file), str(target)]) == 0
    assert capsys.readouterr() == (f"{target}: 2 signals, 101 rows\n", "")
    assert main(["recording", "show", str(target)]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[0] == f"{target}: 2 signals, 101 rows from 0 to 1 s"
    assert lines[1].startswith("mass.velocity")
    assert (lines[1].endswith(" 1 m/s"), lines[2].endswith(" kN")) == (True, True)


def test_what_a_crash_has_left_is_recovered_and_said_to_be_cut_off(folder, tmp_path, capsys) -> None:
    file, target = tmp_path / "run.arrow", tmp_path / "run.csv"
    assert run(folder, "--until", "1", "--record", str(file)) == 0
    file.write_bytes(file.read_bytes()[:-8])
    capsys.readouterr()
    assert main(["recording", "convert", str(file), str(target)]) == 0
    said = capsys.readouterr()
    assert said.out == f"{target}: 9 signals, 101 rows\n"
    assert said.err == f"seacrane: {file} was cut off: these are all its complete rows\n"
    file.write_bytes(b"nothing of the kind\n")
    assert main(["recording", "convert", str(file), str(target)]) == 2
    assert "the first column is not the time" in capsys.readouterr().err


def test_a_run_goes_on_from_a_saved_state_to_a_later_time_only(folder, tmp_path, capsys) -> None:
    state = str(tmp_path / "half.state")
    assert run(folder, "--until", "1", "--save", state, "--set", "mass.pull=1") == 0
    assert "keeps its saved value" not in capsys.readouterr().err
    assert run(folder, "--until", "2", "--resume", state) == 0
    assert "1 input is not connected and keeps its saved value: mass.pull" in capsys.readouterr().err
    assert run(folder, "--until", "1", "--resume", state) == 2
    assert "--until: is not after the saved state (got 1.0); allowed: above 1 s" in capsys.readouterr().err


def test_what_is_drawn_is_named_and_that_there_is_more(folder, tmp_path, capsys) -> None:
    picture = tmp_path / "all.svg"
    assert run(folder, "--until", "0.1", "--plot", str(picture), "--signals", "spring.force,mass.velocity") == 0
    assert f"{picture}: spring.force, mass.velocity\n" in capsys.readouterr().out
    assert run(folder, "--until", "0.1", "--plot", str(picture), "--signals", "*") == 0
    said = capsys.readouterr()
    (line,) = [line for line in said.out.splitlines() if line.startswith(f"{picture}: ")]
    assert line.count(", ") == 11
    assert "more are not drawn; choose with --signals" in said.err
