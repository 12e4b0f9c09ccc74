"""`seacrane simulate` and `seacrane model`: what they print, write and refuse."""

from __future__ import annotations

import json
import subprocess
import sys
import xml.etree.ElementTree as ET
from pathlib import Path

import pytest

from seacrane.cli import main
from seacrane.library import hydraulics as hyd
from seacrane.model import Diagram, save
from seacrane.results import Recording
from seacrane.units import l, l_min, mm

BOOM_DRIVE = Path(__file__).parents[3] / "examples" / "boom_drive.json"


@pytest.fixture
def model(tmp_path: Path) -> Path:
    """A tank line filled through an orifice from a flow that is given from outside."""
    diagram = Diagram("filling")
    source = diagram.add("source", hyd.FlowInput())
    edge = diagram.add("edge", hyd.Orifice(diameter=3 * mm))
    volume = diagram.add("volume", hyd.ControlVolume(volume=5 * l))
    tank = diagram.add("tank", hyd.Tank())
    diagram.connect(source.p, volume.a, edge.a)
    diagram.connect(edge.b, tank.p)
    diagram.expose(flow=source.set)
    save(diagram, tmp_path / "filling.json")
    return tmp_path / "filling.json"


@pytest.mark.parametrize(("flow", "diameter"), [("6 l/min", "2 mm"), ("1e-4", "0.002"), ("1e-4 m3/s", "2e-3")])
def test_a_bare_number_is_in_the_variables_own_unit(model: Path, tmp_path: Path, flow: str, diameter: str) -> None:
    csv = tmp_path / "out.csv"
    settings = ["--set", f"flow={flow}", "--set", f"edge.diameter={diameter}"]
    assert main(["simulate", str(model), "--until", "0.1", "--csv", str(csv), *settings]) == 0
    recording = Recording.read_csv(csv)
    assert recording["flow"][-1] == pytest.approx(6 * l_min)
    assert recording["edge.diameter"][0] == pytest.approx(2e-3)


def test_a_run_is_written_with_units(model: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    csv, plot = tmp_path / "out.csv", tmp_path / "out.svg"
    command = ["simulate", str(model), "--until", "2", "--every", "0.1", "--csv", str(csv), "--plot", str(plot)]
    assert main([*command, "--set", "flow=6 l/min", "--set", "edge.diameter=2 mm"]) == 0
    recording = Recording.read_csv(csv)
    assert recording.time[-1] == 2.0
    assert recording["flow"][-1] == pytest.approx(6 * l_min)
    assert recording["edge.diameter"][0] == pytest.approx(2e-3)
    assert ET.fromstring(plot.read_text()).tag.endswith("svg")
    said = capsys.readouterr().out
    assert "filling: 2 s simulated" in said
    assert f"{plot}: flow, volume.pressure\n" in said
    assert sorted(p.name for p in tmp_path.iterdir()) == ["filling.json", "out.csv", "out.svg"]


def test_only_the_signals_wanted_are_written(model: Path, tmp_path: Path) -> None:
    csv = tmp_path / "out.csv"
    assert main(["simulate", str(model), "--until", "1", "--csv", str(csv), "--signals", "volume.pressure,flow"]) == 0
    assert csv.read_text().splitlines()[0] == "time [s],volume.pressure [Pa],flow [m3/s]"


def test_all_settings_that_are_wrong_are_told_and_nothing_is_written(
    model: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    wrong = ["edge.diametr=2 mm", "edge.diameter=2 bar", "volume.volume=-1", "density=nan", "volume.pressure=280"]
    settings = [word for text in wrong for word in ("--set", text)]
    csv = tmp_path / "out.csv"
    assert main(["simulate", str(model), "--until", "1", "--csv", str(csv), *settings]) == 2
    said = capsys.readouterr().err.splitlines()
    assert len(said) == 5
    assert "Did you mean 'edge.diameter'" in said[0]
    assert "cannot be given in 'm'" in said[1]
    assert "volume.volume: -1 m3" in said[2]
    assert "must be a finite number" in said[3]
    assert "did you mean 280 bar?" in said[4]
    assert not csv.exists()


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--until", "0"], "cannot run until 0 s"),
        (["--until", "1", "--signals", "volume.presure"], "Did you mean 'volume.pressure'"),
        (["--until", "1", "--solver", "rodas5"], "rodas4"),
    ],
)
def test_a_run_that_cannot_be_is_refused(
    model: Path, arguments: list[str], said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["simulate", str(model), *arguments]) == 2
    assert said in capsys.readouterr().err


def test_a_setting_is_a_name_and_a_value(model: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for text in ("flow", "=3", "flow="):
        assert main(["simulate", str(model), "--until", "1", "--set", text]) == 2
        assert f"--set: is not NAME=VALUE (got {text!r})" in capsys.readouterr().err


def test_show_prints_parameters_with_units_equations_bond_graph_and_sources(
    model: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["model", "show", str(model)]) == 0
    shown = capsys.readouterr().out
    for expected in (
        "edge.diameter             3 mm  bore of the orifice",
        "density              870 kg/m3  density of the oil",
        "flow: source.set",
        "der(pressure) = bulk_modulus / volume * a.q",
        "volume.oil",
        "H. E. Merritt, Hydraulic Control Systems, 1967",
    ):
        assert expected in shown, shown


def test_show_draws_both_pictures(model: Path, tmp_path: Path) -> None:
    assert main(["model", "show", str(model), "--svg", str(tmp_path / "drawing.svg")]) == 0
    for name, title in (("drawing.svg", "Diagram of filling"), ("drawing.bonds.svg", "Bond graph of filling")):
        assert ET.fromstring((tmp_path / name).read_text(encoding="utf-8"))[0].text == title


def test_check_finds_the_shipped_model_sound(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["model", "check", str(BOOM_DRIVE)]) == 0
    assert capsys.readouterr().out.endswith("boom_drive.json: no problems\n")


def test_check_lists_every_problem(model: Path, capsys: pytest.CaptureFixture[str]) -> None:
    data = json.loads(model.read_text())
    data["parts"]["edge"]["parameters"]["diameter"] = "3 bar"
    data["connections"][0][0] = "sourc.p"
    model.write_text(json.dumps(data))
    assert main(["model", "check", str(model)]) == 1
    shown = capsys.readouterr().out
    assert "Did you mean 'source'?" in shown
    assert shown.endswith("filling.json: 2 problems\n")


def test_a_reader_that_has_seen_enough_is_no_error(model: Path) -> None:
    show = [sys.executable, "-m", "seacrane.cli", "model", "show", str(model)]
    with subprocess.Popen(show, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
        assert process.stdout is not None
        assert process.stderr is not None
        process.stdout.close()
        assert process.stderr.read() == b""


@pytest.mark.parametrize("room", ["model", "design", "fmu"])
def test_every_check_exits_with_1_if_it_finds_a_problem_and_with_2_if_it_was_not_told_what_to_check(
    room: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "bad").write_text("{")
    assert main([room, "check", str(tmp_path / "bad")]) == 1
    assert main([room, "check", str(tmp_path / "none")]) == 1
    assert "none: cannot be read" in capsys.readouterr().out
    with pytest.raises(SystemExit) as left:
        main([room, "check"])
    assert left.value.code == 2


@pytest.mark.parametrize(
    "command",
    [
        ["simulate", str(BOOM_DRIVE), "--until", "1"],
        ["fmu", "run", "any.fmu", "--until", "1"],
        ["run", "any.ssp"],
        ["design", "chart", "gunnerus-pk65"],
    ],
    ids=lambda command: command[0],
)
def test_a_picture_of_an_unknown_kind_is_refused_before_anything_is_computed(
    command: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit) as left:
        main([*command, "--plot", str(tmp_path / "picture.foo")])
    assert left.value.code == 2
    assert "is of no kind of picture; give a name in .svg, .png or .pdf" in capsys.readouterr().err


def test_the_file_of_a_simulation_has_no_parameters_but_those_set_or_asked_for(model: Path, tmp_path: Path) -> None:
    everything, some = tmp_path / "everything.csv", tmp_path / "some.csv"
    assert main(["simulate", str(model), "--until", "0.1", "--csv", str(everything)]) == 0
    assert "volume.volume [m3]" not in everything.read_text().splitlines()[0]
    asked = ["--signals", "volume.volume", "--csv", str(some)]
    assert main(["simulate", str(model), "--until", "0.1", *asked]) == 0
    assert some.read_text().startswith("time [s],volume.volume [m3]\n")
