"""OspSystemStructure.xml: what is read, what is refused, and the platform's own results."""

import zipfile
from pathlib import Path

import casadi as ca
import numpy as np
import oscillators
import pytest
from libcosimpy.CosimExecution import CosimExecution
from libcosimpy.CosimLogging import CosimLogLevel, log_output_level
from libcosimpy.CosimObserver import CosimObserver

from seacrane import fmi
from seacrane.cosim import Bond, Connection, Execution, Jacobi, load, read_osp
from seacrane.errors import CosimError
from seacrane.model.dae import Dae, Variable

NS = "http://opensimulationplatform.com/MSMI/OSPSystemStructure"
STEP = 0.01


def adder(name: str) -> Dae:
    """Three outputs that follow three inputs at once, and a state that sums them up over time."""
    x, u = ca.SX.sym("x"), ca.SX.sym("u", 3)
    reals = [tuple(Variable(f"{letter}{i}", "N") for i in range(3)) for letter in "uy"]
    none = ca.SX(0, 1)
    return Dae(
        name, (Variable("x", "N.s/m"),), (), reals[0], (), reals[1], (), ca.SX.sym("t"),
        x, none, u, none, ca.sum1(u), none, ca.vertcat(u[0] + 1, u[1] + 2, u[2] + x), none,
    )  # fmt: skip


@pytest.fixture(scope="session")
def fmus(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("fmus")
    for slave in oscillators.models():
        fmi.export(slave.dae, folder / f"{slave.dae.name}.fmu")
    fmi.export(adder("adder"), folder / "adder.fmu")
    for name, (first, second) in {"one": ("force", "velocity"), "two": ("force", "velocity")}.items():
        (folder / f"{name}_OspModelDescription.xml").write_text(
            '<OspModelDescription xmlns="https://open-simulation-platform.com/OspModelDescription/1.0.0" version="1.0">'
            '<VariableGroups><LinearMechanicalPort name="rod port">'
            f'<Force name="rod force"><Variable ref="{first}" unit="N"/></Force>'
            f'<LinearVelocity name="rod velocity"><Variable ref="{second}" unit="m/s"/></LinearVelocity>'
            "</LinearMechanicalPort></VariableGroups></OspModelDescription>"
        )
    groups = "".join(
        f'<Force name="{name}">{"".join(f"<Variable ref={letter}{i}/>" for i in range(3))}</Force>'
        for name, letter in (("in", '"u'), ("out", '"y'))
    ).replace("/>", '"/>')
    (folder / "adder_OspModelDescription.xml").write_text(
        f'<OspModelDescription version="1.0"><VariableGroups>{groups}</VariableGroups></OspModelDescription>'
    )
    return folder


def structure(folder: Path, simulators: str, connections: str, functions: str = "", name: str = "x") -> Path:
    file = folder / name / "OspSystemStructure.xml"
    file.parent.mkdir(exist_ok=True)
    file.write_text(
        f'<?xml version="1.0" encoding="UTF-8"?>\n<OspSystemStructure xmlns="{NS}" version="0.1">\n'
        f"<StartTime>0.0</StartTime><BaseStepSize>{STEP}</BaseStepSize><Algorithm>fixedStep</Algorithm>\n"
        f"<Simulators>{simulators}</Simulators>\n{functions and f'<Functions>{functions}</Functions>'}\n"
        f"<Connections>{connections}</Connections>\n</OspSystemStructure>\n"
    )
    return file


PAIR = """
  <Simulator name="one" source="../one.fmu"><InitialValues>
    <InitialValue variable="solver.tolerance"><Real value="1e-9"/></InitialValue></InitialValues></Simulator>
  <Simulator name="two" source="../two.fmu"/>"""

PORTS = """<VariableGroupConnection>
  <VariableGroup simulator="one" name="rod port"/><VariableGroup simulator="two" name="rod port"/>
</VariableGroupConnection>"""

FUNCTIONS = """
  <LinearTransformation name="half" factor="0.5" offset="3"/><Sum name="plus" inputCount="2"/>
  <VectorSum name="both" inputCount="2" dimension="3"/>"""

THREE = "".join(
    f'<Simulator name="{name}" source="../adder.fmu"><InitialValues>'
    f'<InitialValue variable="x"><Real value="{start}"/></InitialValue>'
    f'<InitialValue variable="u0"><Real value="{start}"/></InitialValue></InitialValues></Simulator>'
    for name, start in (("a", 1.0), ("b", 2.0), ("c", 0.0), ("d", 0.0))
)


def signal(variable: str, function: str, name: str, group: bool = False) -> str:
    kind = "Group" if group else ""
    simulator, _, own = variable.partition(".")
    ends = [
        f'<Variable{kind} simulator="{simulator}" name="{own}"/>',
        f'<Signal{kind} function="{function}" name="{name}"/>',
    ]
    return f"<Signal{kind}Connection>{''.join(ends)}</Signal{kind}Connection>"


LINKS = (
    signal("a.out", "both", "in[0]", True)
    + signal("b.out", "both", "in[1]", True)
    + signal("c.in", "both", "out", True)
    + signal("c.y2", "half", "in")
    + signal("d.u0", "half", "out")
    + signal("a.y0", "plus", "in[0]")
    + signal("b.y1", "plus", "in[1]")
    + signal("d.u1", "plus", "out")
)


def of_the_platform(file: Path, names: list[str], steps: int) -> np.ndarray:
    """What libcosim computes from the same file, shape (steps, names)."""
    log_output_level(CosimLogLevel.ERROR)
    execution = CosimExecution.from_osp_config_file(str(file.parent))
    observer = CosimObserver.create_last_value()
    assert execution.add_observer(observer=observer)
    infos = execution.slave_infos()
    places = []
    for name in names:
        simulator, _, variable = name.partition(".")
        index = next(s.index for s in infos if s.name.decode() == simulator)
        found = next(v for v in execution.slave_variables(index) if v.name.decode() == variable)
        places.append((index, found.reference))
    rows = []
    for _ in range(steps):
        assert execution.step()
        rows.append([observer.last_real_values(index, [reference])[0] for index, reference in places])
    return np.array(rows)


def ours(system, names: list[str], steps: int) -> np.ndarray:
    with Execution(system, Jacobi(STEP)) as run:
        recorder = run.record(names)
        run.step(steps)
        run.flush()
        recording = recorder.recording()
        return np.array([recording[name] for name in names]).T[1:]


def test_joined_ports_are_a_power_bond_and_run_as_on_the_platform(fmus: Path) -> None:
    file = structure(fmus, PAIR, PORTS)
    system = load(file.parent)
    assert system.bonds == {
        "one_rod_port": Bond("one_rod_port", ("two.force", "one.force"), ("one.velocity", "two.velocity"))
    }
    assert (system.experiment.step, system.experiment.algorithm) == (STEP, "jacobi")
    names = ["one.position", "one.velocity", "two.force"]
    platform = of_the_platform(file, names, 300)
    assert np.ptp(platform[:, 0]) > 0.5
    np.testing.assert_allclose(ours(system, names, 300), platform, rtol=1e-9, atol=1e-9)


def test_functions_are_transformations_and_give_the_numbers_of_the_platform(fmus: Path) -> None:
    file = structure(fmus, THREE, LINKS, FUNCTIONS)
    system = read_osp(file)
    assert Connection("c.y2", "d.u0", 0.5, 3.0) in system.connections
    assert [c.source for c in system.connections if c.target == "c.u1"] == ["a.y1", "b.y1"]
    names = [f"{s}.y{i}" for s in "abcd" for i in range(3)]
    np.testing.assert_allclose(ours(system, names, 50), of_the_platform(file, names, 50), rtol=1e-9, atol=1e-9)


def test_connections_of_one_power_bond_name_are_a_bond(fmus: Path) -> None:
    links = "".join(
        f'<VariableConnection powerBond="rod"><Variable simulator="{a}" name="{v}"/>'
        f'<Variable simulator="{b}" name="{v}"/></VariableConnection>'
        for a, b, v in (("one", "two", "velocity"), ("one", "two", "force"))
    )
    system = read_osp(structure(fmus, PAIR, links))
    assert system.bonds["rod"] == Bond("rod", ("two.force", "one.force"), ("one.velocity", "two.velocity"))
    lone = f'<VariableConnection powerBond="rod">{links.partition(">")[2].partition("</VariableC")[0]}'
    system = read_osp(structure(fmus, PAIR, lone + "</VariableConnection>"))
    assert not system.bonds
    assert system.source_of("two.velocity") == "one.velocity"
    assert system.notes == (
        "rod: is no power bond, for that takes an effort and a flow back in their units; it is connected",
    )


def test_a_port_of_several_directions_is_a_bond_in_each(tmp_path: Path) -> None:
    def variables(causality: str, *names: str) -> str:
        start = ' start="0"' if causality == "input" else ""
        unit = {"f": "N", "v": "m/s"}
        return "".join(
            f'<ScalarVariable name="{n}" valueReference="{ord(n[0]) * 10 + int(n[1])}" causality="{causality}">'
            f'<Real unit="{unit[n[0]]}"{start}/></ScalarVariable>'
            for n in names
        )

    units = '<Unit name="N"><BaseUnit kg="1" m="1" s="-2"/></Unit><Unit name="m/s"><BaseUnit m="1" s="-1"/></Unit>'
    for name, effort, flow in (("push", "output", "input"), ("pull", "input", "output")):
        with zipfile.ZipFile(tmp_path / f"{name}.fmu", "w") as archive:
            archive.writestr(
                "modelDescription.xml",
                f'<fmiModelDescription fmiVersion="2.0" modelName="{name}" guid="1">'
                f'<CoSimulation modelIdentifier="{name}"/><UnitDefinitions>{units}</UnitDefinitions><ModelVariables>'
                f"{variables(effort, 'f1', 'f2')}{variables(flow, 'v1', 'v2')}</ModelVariables><ModelStructure/>"
                "</fmiModelDescription>",
            )
        (tmp_path / f"{name}_OspModelDescription.xml").write_text(
            '<OspModelDescription version="1.0"><VariableGroups><LinearMechanicalPort name="end">'
            '<LinearVelocity name="ve"><Variable ref="v1"/><Variable ref="v2"/></LinearVelocity>'
            '<Force name="fo"><Variable ref="f1"/><Variable ref="f2"/></Force>'
            "</LinearMechanicalPort></VariableGroups></OspModelDescription>"
        )
    simulators = "".join(f'<Simulator name="{n}" source="../{n}.fmu"/>' for n in ("push", "pull"))
    file = structure(
        tmp_path, simulators, PORTS.replace("one", "push").replace("two", "pull").replace("rod port", "end")
    )
    assert read_osp(file).bonds == {
        f"push_end_{i}": Bond(f"push_end_{i}", (f"push.f{i}", f"pull.f{i}"), (f"pull.v{i}", f"push.v{i}"))
        for i in (1, 2)
    }


def test_steps_of_simulators_and_unknown_algorithms_are_kept_for_who_runs_it(fmus: Path) -> None:
    file = structure(fmus, PAIR.replace('source="../two.fmu"', 'source="../two.fmu" stepSize="0.02"'), PORTS)
    file.write_text(file.read_text().replace("fixedStep", "ecko"))
    system = read_osp(file)
    assert system.experiment.steps == {"two": 0.02}
    assert system.experiment.algorithm == ""
    assert system.notes == ("ecko: is an algorithm of the platform that is not used here",)


def test_everything_that_is_wrong_is_told_at_once_with_its_line(fmus: Path) -> None:
    links = """
<VariableConnection>
  <Variable simulator="one" name="velosity"/><Variable simulator="to" name="velocity"/>
</VariableConnection>
<VariableConnection><Variable simulator="one" name="velocity"/></VariableConnection>
"""
    links += PORTS.replace("rod port", "rot port", 1)
    simulators = PAIR + '<Simulator name="gone" source="gone.fmu"/><Simulator name="one" source="fmu-proxy://x"/>'
    functions = '<Sum name="plus" inputCount="2"/>'
    file = structure(fmus, simulators, links + signal("one.velocity", "plus", "in[0]"), functions)
    with pytest.raises(CosimError) as caught:
        read_osp(file)
    found = [str(problem) for problem in caught.value.problems]
    assert [message.partition(": ")[2] for message in found] == [
        f"{file.parent / 'gone.fmu'}: cannot be read: No such file or directory",
        "there is a simulator of this name already (got 'one')",
        "'one' has no variable 'velosity'. Did you mean 'velocity' or 'position'?",
        "there is no simulator 'to'. Did you mean 'two'?",
        "<VariableConnection> must join two ends (got ['Variable'])",
        "'one' has no variable group 'rot port'. Did you mean 'rod port' or 'rod force' or 'rod velocity'?",
        "function 'plus' is not connected as it must be (got ['in[1]', 'out']); allowed: 1 signal at each",
    ]
    assert all(message.startswith("OspSystemStructure.xml:") for message in found)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("<OspSystemStructure", "OspSystemStructure.xml:1: is not well-formed XML"),
        ("<!DOCTYPE x [<!ENTITY a 'b'>]><x/>", "OspSystemStructure.xml:1: has a document type declaration"),
        ("<simulators/>", "OspSystemStructure.xml: the root element is <simulators>; allowed: <OspSystemStructure>"),
    ],
)
def test_a_file_of_a_stranger_is_refused_without_harm(tmp_path: Path, text: str, message: str) -> None:
    file = tmp_path / "OspSystemStructure.xml"
    file.write_text(text)
    with pytest.raises(CosimError) as caught:
        load(file)
    assert str(caught.value).startswith(message)
