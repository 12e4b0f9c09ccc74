"""Variables of all types of somebody else's FMU as signals of a system."""

import subprocess
import time
import zipfile
from pathlib import Path

import fmpy
import numpy as np
import pytest

from seacrane import fmi
from seacrane.cosim import Execution, FmuSlave, FunctionSlave, GaussSeidel, System
from seacrane.errors import CosimError, FmuError, ParameterError
from seacrane.model.dae import Variable
from seacrane.native import compiler

TYPES = ("Float32", "Int8", "UInt8", "Int16", "UInt16", "Int32", "UInt32", "Int64", "UInt64", "Boolean", "Enumeration")

DESCRIPTION = """<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="3.0" modelName="feedthrough" instantiationToken="{feedthrough}">
  <CoSimulation modelIdentifier="feedthrough" canGetAndSetFMUState="true" canSerializeFMUState="true"/>
  <UnitDefinitions><Unit name="bar"><BaseUnit kg="1" m="-1" s="-2" factor="1e5"/></Unit></UnitDefinitions>
  <TypeDefinitions>
    <Float64Type name="Pressure" unit="bar" min="0" max="400" nominal="100"/>
    <EnumerationType name="Mode"><Item name="lower" value="-1"/><Item name="stop" value="1"/><Item name="hoist" value="2"/></EnumerationType>
  </TypeDefinitions>
  <ModelVariables>
    <Float64 name="time" valueReference="0" causality="independent"/>
    <UInt64 name="n" valueReference="1" causality="structuralParameter" start="2"/>
    <UInt64 name="m" valueReference="2" causality="structuralParameter" start="3"/>
    <Float64 name="A" valueReference="3" causality="parameter" variability="tunable" start="1 2 3 4 5 6"><Dimension valueReference="1"/><Dimension valueReference="2"/></Float64>
    <Float64 name="u" valueReference="4" causality="input" start="0"><Dimension valueReference="2"/></Float64>
    <Float64 name="y" valueReference="5" causality="output"><Dimension valueReference="1"/></Float64>
    <Float64 name="p" valueReference="6" causality="input" declaredType="Pressure" start="10"/>
    <Float64 name="p out" valueReference="36" causality="output" declaredType="Pressure"/>
    <UInt32 name="sets" valueReference="60"/>
    <String name="label" valueReference="21" causality="parameter"><Start value="x"/></String>
    <Binary name="blob" valueReference="22" causality="parameter"><Start value="00"/></Binary>
    <Float64 name="huge" valueReference="70" causality="local"><Dimension start="5000"/></Float64>
{scalars}  </ModelVariables>
  <ModelStructure><Output valueReference="5"/><Output valueReference="36"/>{outputs}<InitialUnknown valueReference="5"/><InitialUnknown valueReference="36"/>{initial}</ModelStructure>
</fmiModelDescription>
"""  # noqa: E501


@pytest.fixture(scope="module")
def feedthrough(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("feedthrough")
    flags = ["-O2", "-Wall", "-Wextra", "-Werror", "-shared", "-fPIC", f"-I{Path(fmpy.__file__).parent / 'c-code'}"]
    library = folder / "feedthrough.so"
    subprocess.run([*compiler(), *flags, Path(__file__).parent / "feedthrough.c", "-o", library], check=True)
    scalars = ""
    for i, kind in enumerate(TYPES):
        declared, start = ' declaredType="Mode"' if kind == "Enumeration" else "", int(kind == "Enumeration")
        scalars += (
            f'    <{kind} name="{kind}" valueReference="{10 + i}" causality="input"{declared} start="{start}"/>\n'
        )
        scalars += f'    <{kind} name="{kind} out" valueReference="{40 + i}" causality="output"{declared}/>\n'
    listed = [f'valueReference="{40 + i}"/>' for i in range(len(TYPES))]
    text = DESCRIPTION.replace("{scalars}", scalars)
    text = text.replace("{outputs}", "".join(f"<Output {o}" for o in listed))
    path = folder / "feedthrough.fmu"
    with zipfile.ZipFile(path, "w") as archive:
        written = text.replace("{initial}", "".join(f"<InitialUnknown {o}" for o in listed))
        archive.writestr("modelDescription.xml", written)
        archive.write(library, "binaries/x86_64-linux/feedthrough.so")
    return path


VALUES = {
    "Float32": 0.5, "Int8": -128, "UInt8": 255, "Int16": -32768, "UInt16": 65535, "Int32": -(2**31),
    "UInt32": 2**32 - 1, "Int64": -(2**53), "UInt64": 2**53, "Boolean": 1, "Enumeration": -1,
}  # fmt: skip


@pytest.mark.parametrize("loop", ["c", "python"])
def test_values_of_all_types_and_elements_of_arrays_pass_through_both_loops(feedthrough: Path, loop: str) -> None:
    assert fmi.check(feedthrough) == []
    system = System("s", {"one": FmuSlave(feedthrough), "two": FmuSlave(feedthrough, {"A[2,3]": 10.0})})
    for kind in TYPES:
        system.connect(f"one.{kind} out", f"two.{kind}")
    for i in range(3):
        system.connect(f"one.y[{min(i, 1) + 1}]", f"two.u[{i + 1}]")
    with Execution(system, GaussSeidel(0.1), loop=loop) as run:
        for kind, value in VALUES.items():
            run.set(f"one.{kind}", value)
        for i, value in enumerate((1.0, 10.0, 100.0)):
            run.set(f"one.u[{i + 1}]", value)
        run.step(3)
        assert list(run.values([f"two.{kind} out" for kind in TYPES])) == list(VALUES.values())
        assert list(run.values(["one.y[1]", "one.y[2]"])) == [321.0, 654.0]
        assert list(run.values(["two.y[1]", "two.y[2]"])) == [
            321.0 + 2 * 654 + 3 * 654,
            4 * 321.0 + 5 * 654 + 10 * 654,
        ]


@pytest.mark.parametrize("loop", ["c", "python"])
def test_what_is_not_real_is_set_only_when_it_changes(feedthrough: Path, loop: str) -> None:
    with Execution(System("s", {"f": FmuSlave(feedthrough)}), GaussSeidel(0.1), loop=loop) as run:
        run.record(["f.sets", "f.Int8 out"])
        run.start()
        before = run.values(["f.sets"])[0]
        run.step(5)
        run.set("f.Int8", 7)
        run.step(5)
        assert run.values(["f.sets"])[0] - before == 2
        state = run.save()
        run.set("f.Int8", 8)
        run.step()
        run.restore(state)
        run.step()
        assert run.values(["f.Int8 out"])[0] == 7
        run.set("f.A[1,1]", 5.0)
        run.set("f.u[1]", 1.0)
        run.step()
        assert list(run.values(["f.y[1]", "f.y[2]"])) == [5.0, 4.0]


def test_the_interface_has_units_bounds_and_reasons_for_what_is_left_out(feedthrough: Path) -> None:
    slave = FmuSlave(feedthrough)
    known = slave.interface.names
    assert [n for n in known if n.startswith("A")] == ["A[1,1]", "A[1,2]", "A[1,3]", "A[2,1]", "A[2,2]", "A[2,3]"]
    assert [known[f"A[2,{i}]"].start for i in (1, 2, 3)] == [4.0, 5.0, 6.0]
    pressure, mode = known["p"], known["Enumeration"]
    assert (pressure.unit, pressure.minimum, pressure.maximum, pressure.nominal) == ("bar", 0.0, 400.0, 100.0)
    assert (mode.minimum, mode.maximum, mode.about) == (-1, 2, "-1 lower, 1 stop, 2 hoist")
    assert (known["Int8"].minimum, known["Int8"].maximum, known["Boolean"].maximum) == (-128, 127, 1)
    assert dict(slave.interface.left_out) == {
        "n": "it sizes arrays, and changing it is not supported",
        "m": "it sizes arrays, and changing it is not supported",
        "label": "it is String, which is no signal, and can be given as a parameter",
        "blob": "it is Binary, which is no signal, and can be given as a parameter",
        "huge": "it is an array of 5000 elements, more than 4096",
    }


def test_texts_bytes_and_items_of_enumerations_are_given_as_parameters(feedthrough: Path) -> None:
    slave = FmuSlave(feedthrough, {"label": "rope", "blob": b"\1\2", "Enumeration": "hoist"})
    with Execution(System("s", {"f": slave}), GaussSeidel(0.1)) as run:
        run.step()
        inner = run._plan.parts[0].instance.inner
        assert inner.get(["label", "blob", "Enumeration out"]) == ["rope", b"\1\2", 2]
    with pytest.raises(ParameterError) as caught:
        FmuSlave(feedthrough, {"lable": "rope", "blob": "text", "Enumeration": "up", "Int8": 200})
    assert [str(p) for p in caught.value.problems] == [
        "feedthrough.fmu.lable: no such variable of type String (got 'rope'). Did you mean 'label'?",
        "feedthrough.fmu.blob: no such variable of type String (got 'text'). Did you mean 'blob'?",
        "feedthrough.fmu.Enumeration: no such item (got 'up'); allowed: lower, stop, hoist",
    ]
    with pytest.raises(ParameterError, match=r"Int8: is out of its bounds \(got 200.0\); allowed: -128 to 127"):
        FmuSlave(feedthrough, {"Int8": 200})


@pytest.mark.parametrize("loop", ["c", "python"])
def test_a_value_that_an_integer_cannot_take_ends_the_run_with_its_name(feedthrough: Path, loop: str) -> None:
    ramp = FunctionSlave(lambda t, h, x, u: (x + h, x + h), [], [Variable("x")], [0.0])
    system = System("s", {"ramp": ramp, "f": FmuSlave(feedthrough)})
    system.connect("ramp.x", "f.Int16", gain=2.5)
    with (
        Execution(system, GaussSeidel(1.0), loop=loop) as run,
        pytest.raises(CosimError, match=r"Int16 cannot take 2.5; allowed: a whole number from -32768 to 32767"),
    ):
        run.step(1)


def test_elements_are_set_and_read_by_name_from_python(feedthrough: Path) -> None:
    with fmi.Fmu(feedthrough) as fmu, fmu.instantiate("f") as slave:
        slave.set(["A[1,2]", "A[2,1]"], [20.0, 40.0])
        slave.set("A[1,1]", 10.0)
        rows = [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]]
        slave.set(["A", "A[1,1]", "A[1,2]", "A[2,1]"], [rows, 10.0, 20.0, 40.0])
        assert rows[0][0] == 1.0
        slave.initialize()
        assert slave.get("A").tolist() == [[10.0, 20.0, 3.0], [40.0, 5.0, 6.0]]
        slave.set("u[3]", 1.0)
        assert list(slave.get(["y[1]", "y[2]", "p"])) == [3.0, 6.0, 0.0]
        for name in ("A[0,1]", "A[3,1]", "A[1]", "p[1]"):
            with pytest.raises(FmuError, match=rf"f: has no variable '{name[0]}\["):
                slave.get(name)


@pytest.mark.parametrize(
    ("name", "value", "kind"),
    [("Int8", 128, "Int8"), ("Int8", 0.5, "Int8"), ("UInt64", -1, "UInt64"), ("Boolean", 2, "Boolean"),
     ("label", 3, "String"), ("blob", "x", "Binary"), ("Enumeration", 3, "Enumeration"), ("p", "high", "Float64")],
)  # fmt: skip
def test_a_value_of_another_type_is_refused(feedthrough: Path, name: str, value: object, kind: str) -> None:
    refusal = f"{name}: a value does not fit the type {kind} .*allowed: "
    with fmi.Fmu(feedthrough) as fmu, fmu.instantiate("f") as slave, pytest.raises(FmuError, match=refusal):
        slave.set(name, value)


def test_one_exchange_of_typed_values_costs_little(feedthrough: Path) -> None:
    with Execution(System("s", {"f": FmuSlave(feedthrough)}), GaussSeidel(0.1), loop="c") as run:
        run.record(["f.p out"], every=100.0)
        run.step(1000)
        least = np.inf
        for _ in range(5):
            start = time.process_time()
            run.step(20_000)
            least = min(least, (time.process_time() - start) / 20_000)
    assert least < 5e-6  # 15 inputs and 14 outputs of 12 types
