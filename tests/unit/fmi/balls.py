"""FMUs of a bouncing ball that somebody else wrote: FMI 3 for co-simulation, and model exchange in 2 and 3.

Between bounces the ball follows a parabola: it hits the ground first at t1 = sqrt(2 h0 / g), and each flight takes e
times as long as the one before it.
"""

import math
import subprocess
import zipfile
from pathlib import Path

import fmpy

from seacrane.native import compiler

G, E = 9.81, 0.7
FIRST = math.sqrt(2 / G)

TWO = """<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="2.0" modelName="ball" guid="{ball}" numberOfEventIndicators="1">
  <ModelExchange modelIdentifier="ball"/>
  <ModelVariables>
    <ScalarVariable name="h" valueReference="1" causality="output" initial="exact"><Real start="1"/></ScalarVariable>
    <ScalarVariable name="v" valueReference="2" initial="exact"><Real start="0"/></ScalarVariable>
    <ScalarVariable name="der(h)" valueReference="2"><Real derivative="1"/></ScalarVariable>
    <ScalarVariable name="der(v)" valueReference="3"><Real derivative="2"/></ScalarVariable>
    <ScalarVariable name="e" valueReference="5" causality="parameter" variability="tunable"><Real start="0.7"/></ScalarVariable>
    <ScalarVariable name="kick_time" valueReference="6" causality="parameter" variability="fixed"><Real start="1e9"/></ScalarVariable>
    <ScalarVariable name="kick" valueReference="7" causality="parameter" variability="fixed"><Real start="0"/></ScalarVariable>
    <ScalarVariable name="wind" valueReference="8" causality="input"><Real start="0"/></ScalarVariable>
    <ScalarVariable name="ceiling" valueReference="10" causality="parameter" variability="fixed"><Real start="1e9"/></ScalarVariable>
    <ScalarVariable name="end" valueReference="11" causality="parameter" variability="fixed"><Real start="1e9"/></ScalarVariable>
    <ScalarVariable name="last" valueReference="12" variability="discrete"><Real/></ScalarVariable>
    <ScalarVariable name="caught" valueReference="13" variability="discrete"><Real/></ScalarVariable>
    <ScalarVariable name="bounces" valueReference="9" causality="output" variability="discrete"><Integer/></ScalarVariable>
  </ModelVariables>
  <ModelStructure>
    <Outputs><Unknown index="1"/><Unknown index="13"/></Outputs>
    <Derivatives><Unknown index="3"/><Unknown index="4"/></Derivatives>
    <InitialUnknowns><Unknown index="3"/><Unknown index="4"/><Unknown index="13"/></InitialUnknowns>
  </ModelStructure>
</fmiModelDescription>
"""  # noqa: E501

THREE = """<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="3.0" modelName="ball" instantiationToken="{ball}">
  <ModelExchange modelIdentifier="ball" canGetAndSetFMUState="true" canSerializeFMUState="true" needsCompletedIntegratorStep="true"/>
  <CoSimulation modelIdentifier="ball" canGetAndSetFMUState="true" canSerializeFMUState="true" hasEventMode="true" mightReturnEarlyFromDoStep="true"/>
  <TypeDefinitions><EnumerationType name="Mode"><Item name="off" value="0"/><Item name="on" value="1"/></EnumerationType></TypeDefinitions>
  <ModelVariables>
    <Float64 name="time" valueReference="0" causality="independent"/>
    <Float64 name="h" valueReference="1" causality="output" initial="exact" start="1"/>
    <Float64 name="v" valueReference="2" initial="exact" start="0"><Alias name="der(h)"/></Float64>
    <Float64 name="speed" valueReference="4" derivative="1"/>
    <Float64 name="der(v)" valueReference="3" derivative="2"/>
    <Float64 name="e" valueReference="5" causality="parameter" variability="tunable" start="0.7"/>
    <Float64 name="kick_time" valueReference="6" causality="parameter" start="1e9"/>
    <Float64 name="kick" valueReference="7" causality="parameter" start="0"/>
    <Float64 name="wind" valueReference="8" causality="input" start="0"/>
    <Float64 name="ceiling" valueReference="10" causality="parameter" start="1e9"/>
    <Float64 name="end" valueReference="11" causality="parameter" start="1e9"/>
    <Float64 name="last" valueReference="12" variability="discrete"/>
    <Float64 name="nap" valueReference="14" causality="parameter" variability="tunable" start="0"/>
    <Float64 name="steps" valueReference="15" variability="discrete"/>
    <Float64 name="caught" valueReference="13" variability="discrete"/>
    <Int32 name="bounces" valueReference="9" causality="output"/>
    <Float64 name="grid" valueReference="20" causality="parameter" start="0 1 2 3 4 5"><Dimension start="2"/><Dimension start="3"/></Float64>
    <Binary name="blob" valueReference="21" causality="parameter"><Start value="00ff"/></Binary>
    <String name="label" valueReference="22" causality="parameter"><Start value="ball"/></String>
    <Int8 name="small" valueReference="23" causality="parameter" start="-128"/>
    <Enumeration name="mode" valueReference="24" causality="parameter" declaredType="Mode" start="1"/>
    <Boolean name="on" valueReference="25" causality="parameter" start="true"/>
    <Float32 name="g" valueReference="26" causality="local"/>
    <Clock name="tick" valueReference="27" causality="local" intervalVariability="triggered"/>
  </ModelVariables>
  <ModelStructure>
    <Output valueReference="1"/><Output valueReference="9"/>
    <ContinuousStateDerivative valueReference="4"/><ContinuousStateDerivative valueReference="3"/>
    <InitialUnknown valueReference="4"/><InitialUnknown valueReference="3"/><InitialUnknown valueReference="9"/>
    <EventIndicator valueReference="1"/>
  </ModelStructure>
</fmiModelDescription>
"""  # noqa: E501


def build(folder: Path) -> dict[str, Path]:
    """FMUs of the ball by version of FMI."""
    headers = Path(fmpy.__file__).parent / "c-code"
    paths = {}
    for version, text, binaries in ((2, TWO, "linux64"), (3, THREE, "x86_64-linux")):
        library = folder / f"ball{version}.so"
        source = Path(__file__).parent / "ball.c"
        flags = [f"-DFMI={version}", "-Wall", "-Wextra", "-Werror", "-shared", "-fPIC", f"-I{headers}"]
        subprocess.run([*compiler(), *flags, source, "-o", library, "-lm"], check=True)
        paths[str(version)] = path = folder / f"ball{version}.fmu"
        with zipfile.ZipFile(path, "w") as archive:
            archive.writestr("modelDescription.xml", text)
            archive.write(library, f"binaries/{binaries}/ball.so")
    return paths


KINDS = [("2", "model-exchange"), ("3", "model-exchange"), ("3", "co-simulation")]


def height(t: float) -> float:
    """Of a ball dropped from 1 m, in closed form."""
    start, speed = -FIRST, G * FIRST
    while t - start > 2 * speed / G:
        start, speed = start + 2 * speed / G, E * speed
    return speed * (t - start) - G * (t - start) ** 2 / 2
