"""What we export as FMI 3.0, and what both versions have beside the equations."""

import zipfile
from pathlib import Path
from xml.etree import ElementTree

import fmpy
import numpy as np
import pytest
from fmpy.validation import validate_fmu

from seacrane import fmi
from seacrane.errors import FmuError
from seacrane.fmi.export import Version
from seacrane.library.hydraulics import DoubleActingCylinder
from seacrane.library.mechanics import ForceInput, Mass, MotionInput, SpringDamper
from seacrane.model import Diagram
from seacrane.model.dae import Dae
from seacrane.model.native import build


@pytest.fixture(scope="module")
def piston3(cylinder: Dae, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return fmi.export(cylinder, tmp_path_factory.mktemp("fmu3") / "piston.fmu", version="3.0")


def slave_of(path: Path, kind: str) -> tuple[fmpy.fmi3.FMU3Slave, dict[str, int]]:
    description = fmpy.read_model_description(str(path))
    return fmpy.instantiate_fmu(fmpy.extract(str(path)), description, kind), {
        v.name: v.valueReference for v in description.modelVariables
    }


def test_another_validator_and_ours_find_nothing_in_fmi_3(piston3: Path) -> None:
    assert validate_fmu(str(piston3)) == []
    assert fmi.check(piston3) == []


@pytest.mark.parametrize("kind", ["CoSimulation", "ModelExchange"])
def test_another_importer_of_fmi_3_gets_the_numbers_that_we_get(piston3: Path, cylinder: Dae, kind: str) -> None:
    outputs = ["force", "flow", "piston.x", "power"]
    theirs = fmpy.simulate_fmu(
        str(piston3),
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
        assert ours[:, i] == pytest.approx(theirs[name], rel=1e-6, abs=1e-6 * np.abs(ours[:, i]).max()), name


def test_a_rollback_and_a_serialised_state_repeat_bit_for_bit_in_fmi_3(piston3: Path) -> None:
    slave, references = slave_of(piston3, "CoSimulation")
    watched = [references[n] for n in ("force", "flow", "piston.v", "time")]
    slave.enterInitializationMode(startTime=0.0)
    slave.exitInitializationMode()
    slave.doStep(0.0, 0.05)
    state = slave.getFMUState()
    saved = slave.serializeFMUState(state)
    slave.doStep(0.05, 0.1)
    first = list(slave.getFloat64(watched))
    slave.setFMUState(state)
    slave.doStep(0.05, 0.1)
    assert list(slave.getFloat64(watched)) == first
    slave.setFMUState(slave.deserializeFMUState(saved))
    slave.doStep(0.05, 0.1)
    assert list(slave.getFloat64(watched)) == first
    assert first[3] == 0.15000000000000002
    with pytest.raises(Exception, match="fmi3DeserializeFMUState"):
        slave.deserializeFMUState(bytes(len(saved)))
    slave.terminate()
    slave.freeInstance()


def test_adjoint_derivatives_are_the_directional_ones_transposed(piston3: Path) -> None:
    slave, references = slave_of(piston3, "CoSimulation")
    slave.enterInitializationMode(startTime=0.0)
    slave.exitInitializationMode()
    unknowns = [references[n] for n in ("force", "flow", "der(piston.v)", "der(chamber.p)")]
    knowns = [references[n] for n in ("time", "spool", "load", "piston.v", "chamber.p")]
    jacobian = np.array([slave.getDirectionalDerivative(unknowns, [known], [1.0]) for known in knowns])
    seed = [1.0, -2.0, 0.5, 3.0]
    found = slave.getAdjointDerivative(unknowns, knowns, seed, nSensitivity=5)
    assert found == pytest.approx(jacobian @ seed, rel=1e-12)
    assert jacobian[0, 0] == pytest.approx(1.0)  # d(force)/dt = cos(t)
    assert jacobian[1, 1] > 0
    slave.terminate()
    slave.freeInstance()


def test_output_derivatives_are_the_slopes_of_the_outputs(piston3: Path) -> None:
    slave, references = slave_of(piston3, "CoSimulation")
    wanted = [references["force"], references["flow"]]
    slave.enterInitializationMode(startTime=0.0)
    slave.exitInitializationMode()
    slave.setFloat64([references["solver.tolerance"]], [1e-10])
    slave.doStep(0.0, 0.2)
    before = np.array(slave.getFloat64(wanted))
    slave.doStep(0.2, 1e-4)
    slopes = np.array(slave.getOutputDerivatives(wanted, [1, 1]))
    slave.doStep(0.2001, 1e-4)
    after = np.array(slave.getFloat64(wanted))
    assert slopes == pytest.approx((after - before) / 2e-4, rel=1e-4)
    slave.terminate()
    slave.freeInstance()


@pytest.mark.parametrize("version", ["2.0", "3.0"])
def test_sources_are_inside_only_when_asked_for(cylinder: Dae, tmp_path: Path, version: Version) -> None:
    with zipfile.ZipFile(fmi.export(cylinder, tmp_path / "closed.fmu", version=version)) as archive:
        assert not [n for n in archive.namelist() if n.startswith("sources/")]
    path = fmi.export(cylinder, tmp_path / "open.fmu", version=version, sources=True)
    assert validate_fmu(str(path)) == [] == fmi.check(path)
    with zipfile.ZipFile(path) as archive:
        inside = {n.removeprefix("sources/") for n in archive.namelist() if n.startswith("sources/")}
        listed = archive.read("modelDescription.xml" if version == "2.0" else "sources/buildDescription.xml").decode()
    assert {"model_functions.c", "model_tables.c", "fmi2.c", "fmi3.c", "core.h"} <= inside
    assert all(f'name="{name}"' in listed for name in inside if name.endswith(".c"))


@pytest.mark.parametrize("version", ["2.0", "3.0"])
def test_the_same_model_gives_the_same_bytes_in_every_form(cylinder: Dae, tmp_path: Path, version: Version) -> None:
    one, two = (fmi.export(cylinder, tmp_path / f"{i}.fmu", version=version, sources=True) for i in range(2))
    assert one.read_bytes() == two.read_bytes()


def test_a_version_that_does_not_exist_is_refused(cylinder: Dae, tmp_path: Path) -> None:
    with pytest.raises(FmuError, match=r"version: is not a version of FMI .*1.0"):
        fmi.export(cylinder, tmp_path / "x.fmu", version="1.0")  # type: ignore[arg-type]


@pytest.mark.parametrize("version", ["2.0", "3.0"])
def test_signals_that_trade_power_with_a_partner_are_a_terminal_that_says_which_way(
    tmp_path: Path, version: Version
) -> None:
    diagram = Diagram("push")
    mass = diagram.add("mass", Mass(mass=100.0, level="horizontal"))
    held, moved = diagram.add("held", ForceInput()), diagram.add("moved", MotionInput())
    damper = diagram.add("damper", SpringDamper(damping=1e3, level="damper"))
    diagram.connect(held.flange, mass.flange, damper.a)
    diagram.connect(damper.b, moved.flange)
    diagram.expose(load_force=held.F, load_speed=held.v, speed=moved.v, push=moved.F, x=moved.x)
    path = fmi.export(diagram, tmp_path / "push.fmu", version=version)
    assert validate_fmu(str(path)) == [] == fmi.check(path)
    load, partner = fmi.read(path).terminals
    assert (load.name, load.members) == ("load", {"v": "load_speed", "F": "load_force"})
    assert (partner.name, partner.members) == ("moved", {"v": "speed", "F": "push"})
    with zipfile.ZipFile(path) as archive:
        root = ElementTree.fromstring(archive.read("terminalsAndIcons/terminalsAndIcons.xml"))
        page = archive.read("documentation/index.html").decode()
    assert [m.get("variableKind") for m in root.iter("TerminalMemberVariable")] == [
        "signal", "inflow", "signal", "outflow",
    ]  # fmt: skip
    assert "<td>into the model</td>" in page
    assert "<td>out of the model</td>" in page


def test_an_exposed_power_port_is_a_terminal_and_the_page_says_what_is_what(tmp_path: Path) -> None:
    diagram = Diagram("lift")
    cylinder = diagram.add("cylinder", DoubleActingCylinder(bore=0.28, rod=0.2, stroke=2.0))
    diagram.expose(a=cylinder.a, b=cylinder.b, rod=cylinder.rod)
    path = fmi.export(diagram, tmp_path / "lift.fmu", version="3.0")
    assert validate_fmu(str(path)) == [] == fmi.check(path)
    with zipfile.ZipFile(path) as archive:
        root = ElementTree.fromstring(archive.read("terminalsAndIcons/terminalsAndIcons.xml"))
        page = archive.read("documentation/index.html").decode()
        icon = archive.read("terminalsAndIcons/icon.png")
        ElementTree.fromstring(archive.read("terminalsAndIcons/icon.svg"))
        ElementTree.fromstring(archive.read("documentation/drawing.svg"))
    members = {
        t.get("name"): [(m.get("memberName"), m.get("variableName"), m.get("variableKind")) for m in t]
        for t in root.iter("Terminal")
    }
    assert members["rod"] == [("v", "rod.v", "signal"), ("F", "rod.F", "inflow")]
    assert members["a"] == [("p", "a.p", "signal"), ("q", "a.q", "inflow")]
    assert "<code>cylinder.bore</code>" in page
    assert '<td class="n">280</td><td>mm</td>' in page
    assert icon[:8] == b"\x89PNG\r\n\x1a\n"
