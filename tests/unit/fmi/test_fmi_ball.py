"""A bouncing ball that somebody else wrote, beside its closed form: events, saved states, values of all types."""

import logging
import math
import zipfile
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from balls import KINDS, G, height

from seacrane import fmi
from seacrane.cli import main
from seacrane.cosim import Execution, FmuSlave, GaussSeidel, System
from seacrane.errors import CosimError, FmuError


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


def test_a_step_that_returns_early_without_an_event_is_taken_up_again(balls: dict[str, Path]) -> None:
    with fmi.Fmu(balls["3"], "co-simulation") as fmu, fmu.instantiate("ball") as ball:
        ball.set("nap", 0.03)
        ball.initialize()
        ball.step(0.0, 0.1)
        assert ball.get(["h", "steps"]) == pytest.approx([height(0.1), 4])
        ball.set("nap", 0.0)  # tunable: set while it runs, in event mode
        ball.step(0.1, 0.1)
        assert ball.get(["h", "steps"]) == pytest.approx([height(0.2), 5])


def test_a_slave_that_asks_to_end_the_simulation_ends_it(balls: dict[str, Path]) -> None:
    with fmi.Fmu(balls["3"], "co-simulation") as fmu, fmu.instantiate("ball") as ball:
        ball.set("end", 0.15)
        ball.initialize()
        ball.step(0.0, 0.1)
        with pytest.raises(FmuError, match=r"ball: the step returned Discard: the FMU asked to end the simulation at"):
            ball.step(0.1, 0.1)


def test_input_clocks_are_refused_with_the_reason(balls: dict[str, Path], tmp_path: Path) -> None:
    ticked = (
        '<Clock name="tick" valueReference="27" causality="input" intervalVariability="constant" intervalDecimal="1"/>'
    )

    def clocked(text: str) -> str:
        first = text.index("<Clock")
        return text[:first] + ticked + text[text.index("/>", first) + 2 :]

    with pytest.raises(
        FmuError, match=r"copy.fmu: whoever runs it must tick its input clocks \(tick\), and clocks are"
    ):
        fmi.Fmu(rewritten(balls["3"], tmp_path, clocked))


@pytest.mark.parametrize("kind", ["co-simulation", "model-exchange"])
def test_a_state_of_another_fmu_or_kind_is_refused(balls: dict[str, Path], tmp_path: Path, kind: fmi.Kind) -> None:
    other: fmi.Kind = "model-exchange" if kind == "co-simulation" else "co-simulation"
    with fmi.Fmu(balls["3"], kind) as fmu, fmu.instantiate("one") as one, fmi.Fmu(balls["3"], other) as another:
        one.initialize()
        saved = one.save()
        with another.instantiate("two") as two:
            two.initialize()
            for wrong in (saved, b"", two.save()[:-200]):
                with pytest.raises(FmuError, match=r"two: (the saved state is not one of this FMU|fmi3Deserialize)"):
                    two.restore(wrong)
            two.step(0.0, 0.1)
            assert two.get("h") == pytest.approx(height(0.1))


def test_a_state_that_cannot_leave_the_fmu_says_so(balls: dict[str, Path], tmp_path: Path) -> None:
    path = rewritten(balls["3"], tmp_path, lambda text: text.replace('canSerializeFMUState="true"', ""))
    with fmi.Fmu(path) as fmu, fmu.instantiate("one") as one:
        one.initialize()
        with pytest.raises(FmuError, match="one: the FMU can keep its state, but not give it away as bytes"):
            one.save()


def test_elements_of_arrays_are_set_and_recorded_from_the_command_line(
    balls: dict[str, Path], capsys: pytest.CaptureFixture[str]
) -> None:
    settings = ["--until", "0.1", "--set", "grid[2,1]=7", "--output", "grid[1,2],grid[2,1],h"]
    assert main(["fmu", "run", str(balls["3"]), *settings]) == 0
    rows = [line.split() for line in capsys.readouterr().out.splitlines()[2:]]
    assert [row[:2] for row in rows] == [["grid[1,2]", "1"], ["grid[2,1]", "7"], ["h", f"{height(0.1):.6g}"]]
    assert main(["fmu", "run", str(balls["3"]), "--until", "0.1", "--output", "grid[3,1]"]) == 2
    assert "grid[3,1]: is no number that can be recorded" in capsys.readouterr().err
