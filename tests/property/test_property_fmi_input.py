"""Whatever bytes arrive as an FMU, the answer is a result or an `FmuError`, never another exception."""

import contextlib
import io
import tempfile
import zipfile
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from seacrane import fmi
from seacrane.errors import FmuError
from seacrane.fmi.archive import opened, unpack
from seacrane.fmi.reading import read_description
from seacrane.fmi.xml import parse_xml

SOUND = b"""<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="2.0" modelName="m" guid="g" variableNamingConvention="structured">
  <CoSimulation modelIdentifier="m" canInterpolateInputs="true"/>
  <UnitDefinitions><Unit name="m"><BaseUnit m="1"/><DisplayUnit name="mm" factor="1000"/></Unit></UnitDefinitions>
  <DefaultExperiment startTime="0" stopTime="1"/>
  <ModelVariables>
    <ScalarVariable name="u" valueReference="1" causality="input"><Real unit="m" start="0"/></ScalarVariable>
    <ScalarVariable name="y" valueReference="2" causality="output"><Real/></ScalarVariable>
  </ModelVariables>
  <ModelStructure>
    <Outputs><Unknown index="2" dependencies="1" dependenciesKind="dependent"/></Outputs>
    <InitialUnknowns><Unknown index="2"/></InitialUnknowns>
  </ModelStructure>
</fmiModelDescription>
"""

THREE = b"""<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="3.0" modelName="m" instantiationToken="g" variableNamingConvention="structured">
  <CoSimulation modelIdentifier="m" hasEventMode="true"/>
  <UnitDefinitions><Unit name="m"><BaseUnit m="1"/><DisplayUnit name="mm" factor="1000"/></Unit></UnitDefinitions>
  <ModelVariables>
    <Float64 name="time" valueReference="0" causality="independent"/>
    <Float64 name="u" valueReference="1" causality="input" unit="m" start="0"/>
    <UInt64 name="n" valueReference="2" causality="structuralParameter" start="2"/>
    <Float64 name="k" valueReference="3" causality="parameter" start="1 2"><Dimension valueReference="2"/></Float64>
    <Binary name="b" valueReference="4" causality="parameter"><Start value="00ff"/></Binary>
    <Float64 name="y" valueReference="5" causality="output"><Alias name="z"/></Float64>
  </ModelVariables>
  <ModelStructure>
    <Output valueReference="5" dependencies="1" dependenciesKind="dependent"/><InitialUnknown valueReference="5"/>
  </ModelStructure>
</fmiModelDescription>
"""

ONE = b"""<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="1.0" modelName="m" modelIdentifier="m" guid="g" numberOfContinuousStates="0" numberOfEventIndicators="0">
  <UnitDefinitions><BaseUnit unit="m"><DisplayUnitDefinition displayUnit="mm" gain="1000"/></BaseUnit></UnitDefinitions>
  <TypeDefinitions><Type name="T"><EnumerationType><Item name="a"/></EnumerationType></Type></TypeDefinitions>
  <ModelVariables>
    <ScalarVariable name="u" valueReference="1" causality="input"><Real unit="m" start="0"/></ScalarVariable>
    <ScalarVariable name="y" valueReference="2" causality="output"><Real/><DirectDependency><Name>u</Name></DirectDependency></ScalarVariable>
    <ScalarVariable name="e" valueReference="3" variability="parameter"><Enumeration declaredType="T" start="1"/></ScalarVariable>
  </ModelVariables>
  <Implementation><CoSimulation_StandAlone><Capabilities/></CoSimulation_StandAlone></Implementation>
</fmiModelDescription>
"""  # noqa: E501

QUICK = settings(
    max_examples=150, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture], derandomize=True
)


LIBRARY = b"\x7fELF" + bytes(14) + b"\x3e\x00" + b"g"
"""What a library begins with, and the GUID."""


def archive_of(text: bytes, library: bytes = b"x" * 100) -> bytes:
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr(zipfile.ZipInfo("modelDescription.xml"), text)
        for platform in ("linux64", "x86_64-linux"):
            archive.writestr(zipfile.ZipInfo(f"binaries/{platform}/m.so"), library)
    return buffer.getvalue()


def spliced(content: bytes, place: float, length: int, piece: bytes) -> bytes:
    start = int(place * len(content))
    return content[:start] + piece + content[start + length :]


splices = {
    "place": st.floats(0, 1),
    "length": st.integers(0, 12),
    "piece": st.binary(max_size=12) | st.sampled_from([b"-1", b"1e999", b"NaN", b'"', b"<", b"&a;", b"99999999999"]),
}


@pytest.mark.parametrize("sound", [ONE, SOUND, THREE], ids=["1.0", "2.0", "3.0"])
@QUICK
@given(**splices)
def test_a_description_with_a_piece_replaced(
    sound: bytes, place: float, length: int, piece: bytes, tmp_path: Path
) -> None:
    text = spliced(sound, place, length, piece)
    with contextlib.suppress(FmuError):
        read_description(parse_xml(text))
    path = tmp_path / "m.fmu"
    path.write_bytes(archive_of(text))
    assert all(str(problem) for problem in fmi.check(path))


@QUICK
@given(**splices)
def test_an_archive_with_a_piece_replaced(place: float, length: int, piece: bytes, tmp_path: Path) -> None:
    path = tmp_path / "m.fmu"
    path.write_bytes(spliced(archive_of(SOUND), place, length, piece))
    with tempfile.TemporaryDirectory(dir=tmp_path) as folder, contextlib.suppress(FmuError), opened(path) as archive:
        unpack(archive, Path(folder))
    assert [p.name for p in tmp_path.iterdir()] == ["m.fmu"]


@pytest.mark.parametrize("sound", [ONE, SOUND, THREE], ids=["1.0", "2.0", "3.0"])
def test_the_sound_one_passes(sound: bytes, tmp_path: Path) -> None:
    path = tmp_path / "m.fmu"
    path.write_bytes(archive_of(sound, LIBRARY))
    assert fmi.check(path) == []
    with pytest.raises(FmuError, match="cannot be loaded"):
        fmi.Fmu(path)
