"""A bouncing ball that somebody else wrote: FMI 3 co-simulation with early return, and model exchange in 2 and 3.

Between bounces the ball follows a parabola: it hits the ground first at t1 = sqrt(2 h0 / g), and each flight takes e
times as long as the one before it.
"""

import logging
import math
import subprocess
import zipfile
from collections.abc import Callable
from pathlib import Path

import fmpy
import numpy as np
import pytest

from seacrane import fmi
from seacrane.cosim import Execution, FmuSlave, GaussSeidel, System
from seacrane.errors import CosimError, FmuError
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
    <ScalarVariable name="bounces" valueReference="9" causality="output" variability="discrete"><Integer/></ScalarVariable>
  </ModelVariables>
  <ModelStructure>
    <Outputs><Unknown index="1"/><Unknown index="9"/></Outputs>
    <Derivatives><Unknown index="3"/><Unknown index="4"/></Derivatives>
    <InitialUnknowns><Unknown index="3"/><Unknown index="4"/><Unknown index="9"/></InitialUnknowns>
  </ModelStructure>
</fmiModelDescription>
"""  # noqa: E501

THREE = """<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="3.0" modelName="ball" instantiationToken="{ball}">
  <ModelExchange modelIdentifier="ball" canGetAndSetFMUState="true" canSerializeFMUState="true"/>
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


@pytest.fixture(scope="module")
def balls(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    folder = tmp_path_factory.mktemp("balls")
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


def test_the_descriptions_are_sound(balls: dict[str, Path]) -> None:
    assert fmi.check(balls["2"]) == []
    assert fmi.check(balls["3"]) == []


@pytest.mark.parametrize(("version", "kind"), KINDS)
def test_the_ball_bounces_as_the_closed_form_says(balls: dict[str, Path], version: str, kind: fmi.Kind) -> None:
    with fmi.Fmu(balls[version], kind) as fmu, fmu.instantiate("ball", tolerance=1e-9) as ball:
        ball.initialize(0.0)
        for i in range(200):
            ball.step(i * 0.01, 0.01)
            assert ball.get("h") == pytest.approx(height((i + 1) * 0.01), abs=1e-9)
        assert ball.get("bounces") == 4


@pytest.mark.parametrize(("version", "kind"), KINDS[:2])
def test_a_bounce_within_one_long_step_is_found(balls: dict[str, Path], version: str, kind: fmi.Kind) -> None:
    with fmi.Fmu(balls[version], kind) as fmu, fmu.instantiate(tolerance=1e-9) as ball:
        ball.initialize(0.0)
        ball.step(0.0, 1.0)
        assert ball.get("h") == pytest.approx(height(1.0), abs=1e-9)


@pytest.mark.parametrize(("version", "kind"), KINDS[:2])
def test_a_time_event_happens_at_its_time(balls: dict[str, Path], version: str, kind: fmi.Kind) -> None:
    with fmi.Fmu(balls[version], kind) as fmu, fmu.instantiate() as ball:
        ball.set(["kick_time", "kick"], [0.123, 5.0])
        ball.initialize(0.0)
        ball.step(0.0, 0.4)
        assert ball.get("v") == pytest.approx(5 - G * 0.4, abs=1e-9)
        assert ball.get("h") == pytest.approx(1 + 5 * (0.4 - 0.123) - G * 0.08, abs=1e-9)


@pytest.mark.parametrize(("version", "kind"), KINDS)
def test_both_loops_and_the_instance_give_the_same_bits(balls: dict[str, Path], version: str, kind: fmi.Kind) -> None:
    tables = []
    for loop in ("c", "python"):
        slave = FmuSlave(balls[version], {"e": 0.6}, kind=kind, tolerance=1e-8)
        with Execution(System("s", {"ball": slave}), GaussSeidel(0.01), loop=loop) as run:
            run.record(["ball.h", "ball.v"])
            run.set("ball.wind", 1.0)
            recording = run.run(1.5)
            tables.append(np.column_stack([recording[name] for name in recording]))
    assert np.array_equal(tables[0], tables[1])
    assert tables[0][:, 0].min() >= -1e-9
    t1 = math.sqrt(2 / (G - 1))
    after = 1.5 - t1
    flight = 2 * 0.6 * t1
    assert after > flight  # so that the second flight is over too
    assert np.isfinite(tables[0]).all()


@pytest.mark.parametrize("kind", ["co-simulation", "model-exchange"])
def test_a_saved_run_goes_on_with_the_same_bits(balls: dict[str, Path], kind: fmi.Kind) -> None:
    with fmi.Fmu(balls["3"], kind) as fmu, fmu.instantiate() as ball:
        ball.initialize(0.0)
        ball.step(0.0, 0.4)
        saved = ball.save()
        ball.step(0.4, 0.6)
        first = list(ball.get(["h", "v"]))
        ball.restore(saved)
        ball.step(0.4, 0.6)
        assert list(ball.get(["h", "v"])) == first
        with pytest.raises(FmuError, match=r"the saved state is not one of this FMU|returned Error"):
            ball.restore(saved[:100])


def test_all_types_of_fmi_3_are_set_and_read(balls: dict[str, Path]) -> None:
    with fmi.Fmu(balls["3"]) as fmu, fmu.instantiate("one") as ball:
        assert ball.get(["blob", "label", "small", "mode", "on"]) == [b"\x00\xff", "one", -128, 1, True]
        assert ball.get("g") == pytest.approx(9.81, rel=1e-6)
        assert np.array_equal(ball.get("grid"), [[0, 1, 2], [3, 4, 5]])
        ball.set(["grid", "e", "blob", "label", "on"], [[[6, 5, 4], [3, 2, 1]], 0.5, b"abc", "two", False])
        grid, restitution, blob, label, on = ball.get(["grid", "e", "blob", "label", "on"])
        assert np.array_equal(grid, [[6, 5, 4], [3, 2, 1]])
        assert (restitution, blob, label, on) == (0.5, b"abc", "two", False)
        with pytest.raises(FmuError, match="grid has 6 elements and cannot take 2 values"):
            ball.set("grid", [1.0, 2.0])
        with pytest.raises(FmuError, match="a value does not fit the type Binary"):
            ball.set("blob", "text")
        with pytest.raises(FmuError, match="tick is a clock, and clocks are not supported"):
            ball.get("tick")


def test_a_wrong_token_is_refused_in_the_fmus_words(balls: dict[str, Path], tmp_path: Path) -> None:
    path = rewritten(balls["3"], tmp_path, lambda text: text.replace('Token="{ball}"', 'Token="{bell}"'))
    with fmi.Fmu(path) as fmu, pytest.raises(FmuError, match="gave no instance: wrong instantiation token"):
        fmu.instantiate()


def test_a_discarded_step_names_slave_and_reason(balls: dict[str, Path], caplog: pytest.LogCaptureFixture) -> None:
    with Execution(System("s", {"ball": FmuSlave(balls["3"])}), GaussSeidel(0.01)) as run:
        run.step()
        run.set("ball.wind", 101.0)
        with caplog.at_level(logging.INFO, logger="seacrane.fmi"), pytest.raises(CosimError, match="blown away"):
            run.step()
    assert [(r.levelname, r.getMessage()) for r in caplog.records] == [
        ("WARNING", "ball: blown away [logStatusDiscard]")
    ]


def test_an_fmu_for_scheduled_execution_only_is_refused(balls: dict[str, Path], tmp_path: Path) -> None:
    def scheduled(text: str) -> str:
        first, last = text.index("<ModelExchange"), text.index("<TypeDefinitions")
        return f'{text[:first]}<ScheduledExecution modelIdentifier="ball"/>{text[last:]}'

    with pytest.raises(FmuError, match="is for scheduled execution only, which is not supported"):
        fmi.Fmu(rewritten(balls["3"], tmp_path, scheduled))


@pytest.mark.parametrize("count", ["-1", "99999999999"])
def test_a_hostile_number_of_event_indicators_is_refused(balls: dict[str, Path], tmp_path: Path, count: str) -> None:
    path = rewritten(balls["2"], tmp_path, lambda text: text.replace('Indicators="1"', f'Indicators="{count}"'))
    with pytest.raises(FmuError, match="attribute 'numberOfEventIndicators'"):
        fmi.Fmu(path)


def test_a_wrong_number_of_states_ends_in_an_error(balls: dict[str, Path], tmp_path: Path) -> None:
    both = '<Unknown index="3"/><Unknown index="4"/></Derivatives>'
    path = rewritten(balls["2"], tmp_path, lambda text: text.replace(both, "</Derivatives>"))
    with fmi.Fmu(path) as fmu, fmu.instantiate() as ball:
        ball.initialize(0.0)
        ball.step(0.0, 0.01)
        assert ball.get("h") == 1.0
    path = rewritten(balls["2"], tmp_path, lambda text: text.replace('"3"/><U', '"3"/><Unknown index="5"/><U', 1))
    with fmi.Fmu(path) as fmu, fmu.instantiate() as ball, pytest.raises(FmuError, match="states could not be read"):
        ball.initialize(0.0)


def test_the_size_of_an_array_cannot_be_changed(balls: dict[str, Path], tmp_path: Path) -> None:
    path = rewritten(
        balls["3"],
        tmp_path,
        lambda text: text.replace('<Dimension start="2"/>', '<Dimension valueReference="30"/>').replace(
            "</ModelVariables>",
            '<UInt64 name="rows" valueReference="30" causality="structuralParameter" start="2"/></ModelVariables>',
        ),
    )
    assert fmi.check(path) == []
    with fmi.Fmu(path) as fmu, fmu.instantiate() as ball, pytest.raises(FmuError, match="rows sizes arrays"):
        ball.set("rows", 3)


def rewritten(path: Path, folder: Path, change: Callable[[str], str]) -> Path:
    copy = folder / "copy.fmu"
    with zipfile.ZipFile(path) as old, zipfile.ZipFile(copy, "w") as new:
        for info in old.infolist():
            content = old.read(info)
            if info.filename == "modelDescription.xml":
                content = change(content.decode()).encode()
            new.writestr(info, content)
    return copy
