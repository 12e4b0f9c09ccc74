"""An FMU that somebody else wrote in C: run, logged, failing, and freed."""

import ctypes
import logging
import subprocess
import zipfile
from pathlib import Path

import fmpy
import pytest

from seacrane import fmi
from seacrane.errors import FmuError
from seacrane.native import compiler

DESCRIPTION = """<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="2.0" modelName="Foreign Tank" guid="{1}">
  <CoSimulation modelIdentifier="foreign"/>
  <ModelVariables>
    <ScalarVariable name="u" valueReference="0" causality="input"><Real start="0"/></ScalarVariable>
    <ScalarVariable name="x" valueReference="1" causality="output"><Real/></ScalarVariable>
    <ScalarVariable name="gain" valueReference="0" causality="parameter" variability="fixed"><Integer start="2"/></ScalarVariable>
    <ScalarVariable name="enabled" valueReference="0" causality="input" variability="discrete"><Boolean start="true"/></ScalarVariable>
    <ScalarVariable name="label" valueReference="0" causality="parameter" variability="fixed"><String start="tank"/></ScalarVariable>
  </ModelVariables>
  <ModelStructure><Outputs><Unknown index="2"/></Outputs><InitialUnknowns><Unknown index="2"/></InitialUnknowns></ModelStructure>
</fmiModelDescription>
"""  # noqa: E501


@pytest.fixture(scope="module")
def foreign(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("foreign")
    headers = Path(fmpy.__file__).parent / "c-code"
    source = Path(__file__).parent / "foreign.c"
    command = [*compiler(), "-shared", "-fPIC", f"-I{headers}", source, "-o", folder / "foreign.so"]
    subprocess.run(command, check=True)
    path = folder / "foreign.fmu"
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("modelDescription.xml", DESCRIPTION)
        archive.write(folder / "foreign.so", "binaries/linux64/foreign.so")
    return path


def test_variables_of_all_types_are_set_and_read(foreign: Path) -> None:
    assert fmi.check(foreign) == []
    with fmi.Fmu(foreign) as fmu, fmu.instantiate("one") as slave:
        assert slave.get(["x", "gain", "enabled", "label"]) == [0.0, 2, True, "tank"]
        slave.set(["gain", "label", "u"], [3, "barrel", 1.5])
        slave.initialize(0.0)
        slave.step(0.0, 0.1)
        assert slave.get("x") == pytest.approx(0.1 * 3 * 1.5)
        assert list(slave.get(["u", "x"])) == [1.5, slave.get("x")]
        slave.set("enabled", False)
        slave.step(0.1, 0.1)
        assert slave.get(["x", "enabled", "label"]) == [pytest.approx(0.45), False, "barrel"]


def test_the_addresses_are_those_of_the_functions(foreign: Path) -> None:
    with fmi.Fmu(foreign) as fmu, fmu.instantiate() as slave:
        slave.initialize(0.0)
        get = ctypes.CFUNCTYPE(
            ctypes.c_int, ctypes.c_void_p, ctypes.c_void_p, ctypes.c_size_t, ctypes.c_void_p
        )(slave.calls.get)  # fmt: skip
        slave.set("u", 7.0)
        reference, value = ctypes.c_uint32(0), ctypes.c_double()
        assert get(slave.handle, ctypes.byref(reference), 1, ctypes.byref(value)) == 0
        assert value.value == 7.0
        assert slave.calls.derive == 0


def test_an_fmu_that_interpolates_its_inputs_takes_their_derivatives(foreign: Path, tmp_path: Path) -> None:
    path = tmp_path / "ramped.fmu"
    with zipfile.ZipFile(foreign) as old, zipfile.ZipFile(path, "w") as new:
        told = DESCRIPTION.replace('Identifier="foreign"', 'Identifier="foreign" canInterpolateInputs="true"')
        new.writestr("modelDescription.xml", told)
        new.writestr("binaries/linux64/foreign.so", old.read("binaries/linux64/foreign.so"))
    with fmi.Fmu(path) as fmu, fmu.instantiate() as slave:
        slave.initialize(0.0)
        slave.set("u", 1.0)
        derive = ctypes.CFUNCTYPE(
            ctypes.c_int, ctypes.c_void_p, ctypes.c_void_p, ctypes.c_size_t, ctypes.c_void_p, ctypes.c_void_p
        )(slave.calls.derive)  # fmt: skip
        reference, order, slope = ctypes.c_uint32(0), ctypes.c_int32(1), ctypes.c_double(10.0)
        arguments = ctypes.byref(reference), 1, ctypes.byref(order), ctypes.byref(slope)
        assert derive(slave.handle, *arguments) == 0
        slave.step(0.0, 0.1)
        assert slave.get("x") == pytest.approx(2 * (0.1 * 1.0 + 0.1**2 / 2 * 10.0))


def test_a_discarded_step_carries_function_status_and_the_fmus_own_words(foreign: Path) -> None:
    with fmi.Fmu(foreign) as fmu, fmu.instantiate("tank1") as slave:
        slave.initialize(0.0)
        slave.set("u", 101.0)
        with pytest.raises(FmuError) as caught:
            slave.step(0.0, 0.1)
    assert str(caught.value) == "tank1: fmi2DoStep returned Discard: overflow of the tank"
    assert (caught.value.function, caught.value.status) == ("fmi2DoStep", 2)


def test_an_instance_that_is_refused_says_why(foreign: Path) -> None:
    with fmi.Fmu(foreign) as fmu:
        with pytest.raises(FmuError, match=r"refuse me: fmi2Instantiate gave no instance: no licence for refuse me"):
            fmu.instantiate("refuse me")
        folder = fmu.folder
    assert not folder.exists()


def test_messages_go_to_the_log_with_the_instances_name(foreign: Path, caplog: pytest.LogCaptureFixture) -> None:
    with caplog.at_level(logging.INFO, logger="seacrane.fmi"), fmi.Fmu(foreign) as fmu:
        fmu.instantiate("tank7").close()
    assert [(r.levelname, r.getMessage()) for r in caplog.records] == [("INFO", "tank7: freed [logAll]")]


def test_every_instance_is_freed_also_if_it_failed_or_was_forgotten(
    foreign: Path, caplog: pytest.LogCaptureFixture
) -> None:
    with caplog.at_level(logging.INFO, logger="seacrane.fmi"), fmi.Fmu(foreign) as fmu:
        failed = fmu.instantiate("failed")
        failed.initialize(0.0)
        with pytest.raises(FmuError, match="failed: fmi2SetReal returned Error"):
            failed.set(1, 1.0)
        failed.close()
        failed.close()
        forgotten = fmu.instantiate("forgotten")
        del forgotten
    assert [r.getMessage() for r in caplog.records] == ["failed: freed [logAll]", "forgotten: freed [logAll]"]


def test_wrong_names_values_and_uses_are_clear(foreign: Path) -> None:
    with fmi.Fmu(foreign) as fmu:
        slave = fmu.instantiate("one")
        with pytest.raises(FmuError, match=r"one: has no variable 'gian'. Did you mean 'gain'"):
            slave.set("gian", 1)
        with pytest.raises(FmuError, match="a value does not fit the type Integer"):
            slave.set("gain", "much")
        with pytest.raises(FmuError, match="2 variables cannot take 1 values"):
            slave.set(["u", "gain"], [1.0])
        with pytest.raises(FmuError, match="one: the FMU cannot save its state; allowed: canGetAndSetFMUstate"):
            slave.save()
        slave.close()
        with pytest.raises(FmuError, match="one: the instance is closed"):
            slave.get("u")


def test_a_library_that_lacks_functions_names_them(foreign: Path, tmp_path: Path) -> None:
    (tmp_path / "empty.c").write_text("int nothing;\n")
    subprocess.run([*compiler(), "-shared", "-fPIC", tmp_path / "empty.c", "-o", tmp_path / "e.so"], check=True)
    with zipfile.ZipFile(tmp_path / "a.fmu", "w") as archive:
        archive.writestr("modelDescription.xml", DESCRIPTION)
        archive.write(tmp_path / "e.so", "binaries/linux64/foreign.so")
    with pytest.raises(FmuError, match=r"a.fmu: its library lacks the function fmi2Instantiate"):
        fmi.Fmu(tmp_path / "a.fmu")
