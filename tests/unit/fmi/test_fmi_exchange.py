"""FMUs for model exchange, integrated here: accuracy, the times of events, and inputs that vary within a step."""

import math
from pathlib import Path
from typing import Literal

import casadi as ca
import numpy as np
import pytest
from balls import FIRST, KINDS, E, G

from seacrane import fmi
from seacrane.errors import FmuError
from seacrane.model.dae import Dae, Variable, column
from seacrane.results import Recording, Signal

Version = Literal["2.0", "3.0"]
VERSIONS: tuple[Version, ...] = ("2.0", "3.0")
EXCHANGE = [version for version, kind in KINDS if kind == "model-exchange"]


@pytest.mark.parametrize("version", EXCHANGE)
def test_the_times_of_bounces_are_those_of_the_closed_form(balls: dict[str, Path], version: str) -> None:
    with fmi.Fmu(balls[version], "model-exchange") as fmu, fmu.instantiate(tolerance=1e-10) as ball:
        ball.initialize()
        seen = []
        for i in range(47):
            ball.step(i * 0.05, 0.05)
            if ball.get("bounces") > len(seen):
                seen.append(ball.get("last"))
    flights = np.array([FIRST * (1 + 2 * sum(E**i for i in range(1, n + 1))) for n in range(len(seen))])
    assert len(seen) == 7
    assert np.array(seen) == pytest.approx(flights, abs=1e-9)


@pytest.mark.parametrize("version", EXCHANGE)
def test_events_iterate_until_they_are_settled(balls: dict[str, Path], version: str) -> None:
    with fmi.Fmu(balls[version], "model-exchange") as fmu, fmu.instantiate() as ball:
        ball.set(["kick_time", "kick"], [0.2, 3.0])  # a third in each of three iterations
        ball.initialize()
        ball.step(0.0, 0.25)
        assert ball.get("v") == pytest.approx(3.0 - G * 0.25, abs=1e-9)


@pytest.mark.parametrize("version", EXCHANGE)
def test_a_step_event_is_handled_after_the_step_that_asks_for_it(balls: dict[str, Path], version: str) -> None:
    with fmi.Fmu(balls[version], "model-exchange") as fmu, fmu.instantiate() as ball:
        ball.set(["h", "v", "ceiling"], [1.0, 5.0, 2.0])
        ball.initialize()
        for i in range(10):
            ball.step(i * 0.05, 0.05)
        crossing = (5.0 - math.sqrt(25.0 - 2 * G)) / G
        caught = ball.get("caught")
        assert crossing <= caught <= crossing + 0.05
        top = 1.0 + 5.0 * caught - G * caught**2 / 2
        assert ball.get("h") == pytest.approx(top - G * (0.5 - caught) ** 2 / 2, abs=1e-9)


@pytest.mark.parametrize("version", EXCHANGE)
def test_an_fmu_that_asks_to_end_the_simulation_ends_it_at_its_time(balls: dict[str, Path], version: str) -> None:
    with fmi.Fmu(balls[version], "model-exchange") as fmu, fmu.instantiate("ball") as ball:
        ball.set("end", 0.123)
        ball.initialize()
        ball.step(0.0, 0.1)
        with pytest.raises(FmuError, match=r"ball: the step returned Discard: the FMU asked to end .* at t = 0.123 s"):
            ball.step(0.1, 0.1)


@pytest.mark.parametrize("version", EXCHANGE)
def test_a_ramp_of_an_input_is_followed_within_the_step(balls: dict[str, Path], version: str) -> None:
    times = np.array([0.0, 0.1, 0.1, 0.4])
    wind = np.array([0.0, 0.0, 2.0, 8.0])  # nothing, a jump, a ramp of 20 m/s3
    inputs = Recording(times, {"wind": Signal("1", "1", wind)})
    found = fmi.run(balls[version], 0.4, 0.1, inputs=inputs, outputs=["h", "v"], kind="model-exchange", tolerance=1e-9)
    after = np.maximum(found.time - 0.1, 0)
    exact = 1 - G * found.time**2 / 2 + 2 * after**2 / 2 + 20 * after**3 / 6
    assert found["h"] == pytest.approx(exact, abs=1e-10)
    with fmi.Fmu(balls[version], "model-exchange") as fmu, fmu.instantiate("ball") as ball:
        ball.initialize()
        ball.set("wind", 1.0)
        ball.set_derivatives(["wind"], [10.0])
        ball.step(0.0, 0.2)
        ball.step(0.2, 0.1)  # held, where no slope is given
        v = 1.0 * 0.2 + 10 * 0.2**2 / 2 + 3.0 * 0.1 - G * 0.3
        assert ball.get(["v", "wind"]) == pytest.approx([v, 3.0], abs=1e-10)
        with pytest.raises(FmuError, match="e: one slope for each continuous scalar input"):
            ball.set_derivatives(["e"], [1.0])


def test_an_fmu_that_holds_its_inputs_takes_no_slopes(balls: dict[str, Path]) -> None:
    with fmi.Fmu(balls["3"], "co-simulation") as fmu, fmu.instantiate("ball") as ball:
        assert not ball.interpolates
        with pytest.raises(FmuError, match="ball: the FMU provides no input that varies within a step"):
            ball.set_derivatives(["wind"], [1.0])


def closed_form(stiffness: float) -> Dae:
    """x' = -2 t x^2 with x = 1 / (1 + t^2), and the stiff y' = -stiffness (y - x) + x' with y = x."""
    t, s = ca.SX.sym("t"), ca.SX.sym("s", 2)
    none, x = ca.SX(0, 1), 1 / (1 + t**2)
    slopes = column(-2 * t * s[0] ** 2, -stiffness * (s[1] - x) - 2 * t * x**2)
    states, outputs = (Variable("x", start=1.0), Variable("y", start=1.0)), (Variable("out x"), Variable("out y"))
    return Dae("closed form", states, (), (), (), outputs, (), t, s, none, none, none, slopes, none, s, none)


@pytest.fixture(scope="module")
def closed(tmp_path_factory: pytest.TempPathFactory) -> dict[tuple[Version, float], Path]:
    folder = tmp_path_factory.mktemp("closed")
    return {
        (version, stiffness): fmi.export(closed_form(stiffness), folder / f"{version}-{stiffness}.fmu", version=version)
        for version in VERSIONS
        for stiffness in (1.0, 1e4)
    }


def integrated(path: Path, tolerance: float, directional: bool) -> tuple[float, int]:
    """The error at 2 s and the steps to there."""
    with fmi.Fmu(path, "model-exchange") as fmu, fmu.instantiate(tolerance=tolerance) as model:
        state = model._foreign.state
        if not directional:
            state.directional = None  # then the Jacobian is one of differences
        model.initialize()
        model.step(0.0, 2.0)
        return float(np.abs(model.get(["out x", "out y"]) - 1 / 5).max()), state.steps


@pytest.mark.parametrize("version", VERSIONS)
@pytest.mark.parametrize("directional", [True, False])
def test_the_method_is_of_order_four(
    closed: dict[tuple[Version, float], Path], version: Version, directional: bool
) -> None:
    (first, few), (last, many) = (integrated(closed[version, 1.0], t, directional) for t in (1e-4, 1e-8))
    order = math.log(first / last) / math.log(many / few)
    assert 3.5 < order < 5.0, (first, few, last, many)


@pytest.mark.parametrize("version", VERSIONS)
@pytest.mark.parametrize("directional", [True, False])
@pytest.mark.parametrize("stiffness", [1.0, 1e4])
def test_the_error_keeps_the_tolerance_also_of_a_stiff_model(
    closed: dict[tuple[Version, float], Path], version: Version, directional: bool, stiffness: float
) -> None:
    for tolerance in (1e-4, 1e-6, 1e-8):
        error, steps = integrated(closed[version, stiffness], tolerance, directional)
        assert error < tolerance
        assert steps < 2000
