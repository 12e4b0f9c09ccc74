"""FMI 1.0 for co-simulation: a slave that somebody else wrote, beside its closed form and another importer."""

import ctypes
import logging
import subprocess
import zipfile
from collections.abc import Callable
from pathlib import Path

import fmpy
import numpy as np
import pytest

from seacrane import fmi
from seacrane.cli import main
from seacrane.cosim import Execution, FmuSlave, GaussSeidel, System
from seacrane.errors import FmuError
from seacrane.native import compiler
from seacrane.results import Recording, Signal

T, GAIN = 0.5, 2.0

DESCRIPTION = """<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="1.0" modelName="Low pass" modelIdentifier="lowpass" guid="{8c4e810f-3df3-4a00-8276-176fa3c9f9e0}" generationTool="by hand" numberOfContinuousStates="0" numberOfEventIndicators="0">
  <UnitDefinitions><BaseUnit unit="V"><DisplayUnitDefinition displayUnit="mV" gain="1000"/></BaseUnit><BaseUnit unit="s"/><BaseUnit unit="m.of.rope"/></UnitDefinitions>
  <TypeDefinitions>
    <Type name="Duration"><RealType unit="s" min="0" nominal="1"/></Type>
    <Type name="Mode"><EnumerationType><Item name="slow"/><Item name="fast"/></EnumerationType></Type>
  </TypeDefinitions>
  <DefaultExperiment startTime="0" stopTime="1"/>
  <ModelVariables>
    <ScalarVariable name="u" valueReference="0" causality="input"><Real start="0"/></ScalarVariable>
    <ScalarVariable name="x" valueReference="1" causality="output"><Real/><DirectDependency><Name>u</Name></DirectDependency></ScalarVariable>
    <ScalarVariable name="minus x" valueReference="1" causality="output" alias="negatedAlias"><Real/></ScalarVariable>
    <ScalarVariable name="T" valueReference="2" variability="parameter"><Real declaredType="Duration" start="0.5"/></ScalarVariable>
    <ScalarVariable name="gain" valueReference="0" variability="parameter"><Integer start="2"/></ScalarVariable>
    <ScalarVariable name="mode" valueReference="1" variability="parameter"><Enumeration declaredType="Mode" start="1"/></ScalarVariable>
    <ScalarVariable name="on" valueReference="0" causality="input" variability="discrete"><Boolean start="true"/></ScalarVariable>
    <ScalarVariable name="label" valueReference="0" variability="parameter"><String start="filter"/></ScalarVariable>
  </ModelVariables>
  <Implementation><CoSimulation_StandAlone><Capabilities canInterpolateInputs="true" canHandleVariableCommunicationStepSize="true" maxOutputDerivativeOrder="1"/></CoSimulation_StandAlone></Implementation>
</fmiModelDescription>
"""  # noqa: E501


@pytest.fixture(scope="module")
def library(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("lowpass") / "lowpass.so"
    headers = Path(fmpy.__file__).parent / "c-code"
    flags = ["-Wall", "-Wextra", "-Werror", "-shared", "-fPIC", f"-I{headers}"]
    subprocess.run([*compiler(), *flags, Path(__file__).parent / "version1.c", "-o", path, "-lm"], check=True)
    return path


@pytest.fixture(scope="module")
def pack(library: Path) -> Callable[..., Path]:
    def packed(name: str, text: str = DESCRIPTION) -> Path:
        path = library.parent / f"{name}.fmu"
        with zipfile.ZipFile(path, "w") as archive:
            archive.writestr("modelDescription.xml", text)
            archive.write(library, "binaries/linux64/lowpass.so")
        return path

    return packed


@pytest.fixture(scope="module")
def lowpass(pack: Callable[..., Path]) -> Path:
    return pack("lowpass")


def test_the_description_keeps_the_standard_and_is_read_in_the_words_of_fmi_2(lowpass: Path) -> None:
    fmpy.read_model_description(str(lowpass), validate=True)
    assert fmi.check(lowpass) == []
    d = fmi.read(lowpass)
    assert (d.fmi_version, d.co_simulation.interpolates_inputs, d.model_exchange) == ("1.0", True, None)
    duration, mode = d.by_name["T"], d.by_name["mode"]
    assert (duration.causality, duration.variability, duration.initial) == ("parameter", "fixed", "exact")
    assert (duration.unit, duration.minimum, duration.nominal) == ("s", 0.0, 1.0)
    assert (mode.start, dict(mode.items)) == (1, {"slow": 1, "fast": 2})
    assert [(u.index, u.dependencies) for u in d.outputs] == [(2, (1,)), (3, None)]


def test_it_follows_the_closed_form_and_another_importer(lowpass: Path) -> None:
    times = np.linspace(0, 1, 11)
    inputs = Recording(times, {"u": Signal("1", "1", np.ones(11))})
    ours = fmi.run(lowpass, 1.0, 0.1, inputs=inputs, outputs=["x", "minus x"])
    assert ours["x"] == pytest.approx(GAIN * (1 - np.exp(-times / T)), abs=1e-12)
    assert np.array_equal(ours["minus x"], -ours["x"])
    table = np.array([(0.0, 1.0), (1.0, 1.0)], dtype=[("time", float), ("u", float)])
    theirs = fmpy.simulate_fmu(str(lowpass), stop_time=1.0, output_interval=0.1, input=table, output=["x"])
    assert ours["x"] == pytest.approx(theirs["x"], abs=1e-12)


def test_values_of_all_types_are_set_before_the_start_and_read(lowpass: Path) -> None:
    with fmi.Fmu(lowpass) as fmu, fmu.instantiate("f") as slave:
        slave.set(["gain", "mode", "label", "T"], [3, "fast", "rope", 0.25])
        slave.initialize()
        slave.set(["u", "on"], [1.0, False])
        slave.step(0.0, 0.1)
        assert slave.get("x") == 0.0
        slave.set("on", True)
        slave.step(0.1, 0.1)
        assert slave.get("x") == pytest.approx(3 * (1 - np.exp(-0.1 / 0.25)))
        assert slave.get(["gain", "mode", "on", "label"]) == [3, 2, True, "rope"]
        with pytest.raises(FmuError, match="f: gain is a fixed parameter and cannot be set while it runs; allowed: in"):
            slave.set("gain", 4)
        slave.reset()
        with pytest.raises(FmuError, match=r"mode: a value does not fit .*allowed: slow \(1\), fast \(2\)"):
            slave.set("mode", "medium")


def test_derivatives_of_inputs_and_outputs_are_exact_for_a_ramp(lowpass: Path) -> None:
    derive = ctypes.CFUNCTYPE(
        ctypes.c_int, ctypes.c_void_p, ctypes.c_void_p, ctypes.c_size_t, ctypes.c_void_p, ctypes.c_void_p
    )
    with fmi.Fmu(lowpass) as fmu, fmu.instantiate() as slave:
        slave.initialize()
        slave.set("u", 1.0)
        reference, order, slope = ctypes.c_uint32(0), ctypes.c_int32(1), ctypes.c_double(2.0)
        pointers = ctypes.byref(reference), 1, ctypes.byref(order), ctypes.byref(slope)
        assert derive(slave.calls.derive)(slave.handle, *pointers) == 0
        slave.step(0.0, 0.3)
        x = GAIN * (1 + 2 * 0.3 - 2 * T) - GAIN * (1 - 2 * T) * np.exp(-0.3 / T)
        assert slave.get("x") == pytest.approx(x)
        assert slave.output_derivatives(["x"]) == pytest.approx([(GAIN * 1.6 - x) / T])


def test_it_is_a_slave_of_a_system_in_both_loops(lowpass: Path) -> None:
    tables = []
    for loop in ("c", "python"):
        one, two = (FmuSlave(lowpass, {"T": t}) for t in (0.5, 0.1))
        system = System("filters", {"one": one, "two": two})
        system.connect("one.x", "two.u")
        with Execution(system, GaussSeidel(0.01), loop=loop) as run:
            run.set("one.u", 1.0)
            recording = run.run(1.0)
            tables.append([recording["one.x"], recording["two.x"]])
            assert np.array_equal(recording["two.minus x"], -recording["two.x"])
    assert np.array_equal(*tables)
    assert tables[0][0] == pytest.approx(GAIN * (1 - np.exp(-np.linspace(0, 1, 101) / T)), abs=1e-12)


def test_what_it_logs_comes_with_its_name_and_the_arguments_of_the_format(
    lowpass: Path, caplog: pytest.LogCaptureFixture
) -> None:
    with (
        caplog.at_level(logging.INFO, logger="seacrane.fmi"),
        fmi.Fmu(lowpass) as fmu,
        fmu.instantiate("fore") as slave,
    ):
        slave.set("T", 0.25)
        slave.initialize()
        slave.set("u", 123.0)
        with pytest.raises(FmuError, match=r"fore: lowpass_fmiDoStep returned Discard: fore: an input of 123.0 is too"):
            slave.step(0.0, 0.1)
    assert [r.getMessage() for r in caplog.records] == [
        "fore: fore starts with T = 0.25 s [filter]",
        "fore: fore: an input of 123.0 is too large [filter]",
        "fore: fore ends at x = 0.00 [filter]",
    ]


def test_what_fmi_1_has_not_is_refused_with_the_reason(lowpass: Path, pack: Callable[..., Path]) -> None:
    with fmi.Fmu(lowpass) as fmu, fmu.instantiate("f") as slave:
        with pytest.raises(FmuError, match=r"f: the FMU cannot save its state: FMI 1.0 has no functions for it"):
            slave.save()
        with pytest.raises(FmuError, match="f: the FMU provides no directional derivatives"):
            slave.directional_derivative(["x"], ["u"], [1.0])
    start, end = DESCRIPTION.index("  <Implementation>"), DESCRIPTION.index("</fmiModelDescription>")
    exchange = pack("exchange", DESCRIPTION[:start] + DESCRIPTION[end:])
    assert fmi.check(exchange) == []
    with pytest.raises(
        FmuError, match=r"exchange.fmu: is for model exchange of FMI 1.0, which is not supported; allowed"
    ):
        fmi.Fmu(exchange)
    tool = pack(
        "tool",
        DESCRIPTION.replace("StandAlone", "Tool").replace(
            "</CoSimulation_Tool>", '<Model entryPoint="fmu://m.mdl" type="application/x-tool"/></CoSimulation_Tool>'
        ),
    )
    assert fmi.check(tool) == []
    with pytest.raises(FmuError, match=r"tool.fmu: couples a tool that has to be installed \(CoSimulation_Tool"):
        fmi.Fmu(tool)


def test_a_wrong_guid_is_refused_in_the_fmus_words(pack: Callable[..., Path]) -> None:
    wrong = pack("wrong", DESCRIPTION.replace("{8c4e810f", "{0c4e810f"))
    refusal = r"f: lowpass_fmiInstantiateSlave gave no instance: the GUID is \{0c4e810f"
    with fmi.Fmu(wrong) as fmu, pytest.raises(FmuError, match=refusal):
        fmu.instantiate("f")


BROKEN = {
    "an unknown attribute": ('modelName="Low pass"', 'modelName="Low pass" token="1"', "unknown attribute 'token'"),
    "a dependency on nothing": ("<Name>u</Name>", "<Name>w</Name>", "x: depends on variables that do not exist"),
    "a unit that is not defined": ('unit="s" min', 'unit="h" min', "T: its unit is not defined"),
    "a start out of range": ('declaredType="Duration" start="0.5"', 'declaredType="Duration" start="-1"', "out of its"),
    "two variables of one name": ('name="minus x"', 'name="x"', "x: "),
    "an unknown causality": ('causality="input"><Real', 'causality="parameter"><Real', "attribute 'causality'"),
    "no capabilities": ('<Capabilities canInterpolateInputs="true" canHandleVariableCommunicationStepSize="true" '
                        'maxOutputDerivativeOrder="1"/>', "", "has no <Capabilities>"),
}  # fmt: skip


@pytest.mark.parametrize("rule", BROKEN)
def test_a_broken_rule_of_fmi_1_is_found(rule: str, pack: Callable[..., Path]) -> None:
    old, new, message = BROKEN[rule]
    assert old in DESCRIPTION
    problems = fmi.check(pack("broken", DESCRIPTION.replace(old, new)))
    assert any(message in str(problem) for problem in problems), problems
    assert all("section" not in str(problem) for problem in problems)


def test_the_command_line_shows_and_runs_it(lowpass: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["fmu", "check", str(lowpass)]) == 0
    assert main(["fmu", "info", str(lowpass)]) == 0
    assert "FMI        1.0, co-simulation" in capsys.readouterr().out
    assert main(["fmu", "run", str(lowpass), "--until", "1", "--set", "u=1", "--set", "mode=fast"]) == 0
    assert f"{GAIN * (1 - np.exp(-1 / T)):.6g}" in capsys.readouterr().out
