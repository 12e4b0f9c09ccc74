"""Derivatives and continuous states of FMUs from Python."""

from pathlib import Path
from typing import Literal

import numpy as np
import pytest
from balls import G

from seacrane import fmi
from seacrane.errors import FmuError
from seacrane.model.dae import Dae

Version = Literal["2.0", "3.0"]
KNOWNS, UNKNOWNS = ["spool", "load"], ["force", "flow"]


@pytest.fixture(scope="module")
def pistons(cylinder: Dae, tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    folder = tmp_path_factory.mktemp("pistons")
    return {v: fmi.export(cylinder, folder / f"{v}.fmu", version=v) for v in ("2.0", "3.0")}


@pytest.mark.parametrize("version", ["2.0", "3.0"])
def test_directional_derivatives_are_the_differences_of_outputs(pistons: dict[str, Path], version: Version) -> None:
    with fmi.Fmu(pistons[version]) as fmu, fmu.instantiate() as piston:
        piston.initialize()
        piston.step(0.0, 0.1)
        spool = piston.get("spool")
        column = piston.directional_derivative(UNKNOWNS, KNOWNS, [1.0, 0.0])
        differences = []
        for delta in (1e-4, -1e-4):
            piston.set("spool", spool + delta)
            differences.append(np.array(piston.get(UNKNOWNS)))
        expected = (differences[0] - differences[1]) / 2e-4
        assert column == pytest.approx(expected, rel=1e-6, abs=1e-9)
        assert abs(column[1]) > 0
        with pytest.raises(FmuError, match="a seed of 1 values does not fit spool, load; allowed: 2 values"):
            piston.directional_derivative(UNKNOWNS, KNOWNS, [1.0])
        with pytest.raises(FmuError, match=r"has no variable 'spol'. Did you mean 'spool'"):
            piston.directional_derivative(UNKNOWNS, ["spol"], [1.0])


def test_adjoint_derivatives_are_those_of_fmi_3_transposed(pistons: dict[str, Path]) -> None:
    with fmi.Fmu(pistons["3.0"]) as fmu, fmu.instantiate() as piston:
        piston.initialize()
        piston.step(0.0, 0.1)
        forward = np.array([piston.directional_derivative(UNKNOWNS, KNOWNS, seed) for seed in np.eye(2)]).T
        backward = np.array([piston.adjoint_derivative(UNKNOWNS, KNOWNS, seed) for seed in np.eye(2)])
        assert backward == pytest.approx(forward, rel=1e-12)
    with (
        fmi.Fmu(pistons["2.0"]) as fmu,
        fmu.instantiate("one") as piston,
        pytest.raises(FmuError, match="one: the FMU provides no adjoint derivatives"),
    ):
        piston.adjoint_derivative(UNKNOWNS, KNOWNS, [1.0, 0.0])


@pytest.mark.parametrize("version", ["2.0", "3.0"])
def test_output_derivatives_are_the_slopes_of_outputs(pistons: dict[str, Path], version: Version) -> None:
    with fmi.Fmu(pistons[version]) as fmu, fmu.instantiate("one") as piston:
        piston.set("solver.tolerance", 1e-10)
        piston.initialize()
        piston.step(0.0, 0.1)
        before, slopes = np.array(piston.get(UNKNOWNS)), piston.output_derivatives(UNKNOWNS)
        piston.step(0.1, 1e-6)
        assert slopes == pytest.approx((np.array(piston.get(UNKNOWNS)) - before) / 1e-6, rel=1e-3)
        with pytest.raises(FmuError, match=r"one: the FMU gives derivatives of its outputs up to order 1 \(got 2\)"):
            piston.output_derivatives(UNKNOWNS, 2)


@pytest.mark.parametrize("version", ["2", "3"])
def test_continuous_states_are_read_and_set(balls: dict[str, Path], version: str) -> None:
    with fmi.Fmu(balls[version], "model-exchange") as fmu, fmu.instantiate("ball") as ball:
        with pytest.raises(FmuError, match="ball: only the continuous states of a running FMU"):
            ball.set_states([1.0, 0.0])
        ball.initialize()
        ball.step(0.0, 0.1)
        assert ball.states == pytest.approx([1 - G * 0.005, -G * 0.1])
        assert ball.derivatives == pytest.approx([-G * 0.1, -G])
        assert list(ball.nominals) == [1.0, 1.0]
        ball.set_states([3.0, 1.0])
        ball.step(0.1, 0.1)
        assert ball.states == pytest.approx([3 + 0.1 - G * 0.005, 1 - G * 0.1])
        with pytest.raises(FmuError, match=r"ball: states \(got \[1.0\]\); allowed: 2 numbers"):
            ball.set_states([1.0])
        ball.set_states([-1.0, 0.0])  # below the ground without a crossing on the way
        ball.step(0.2, 0.1)
        assert ball.states[0] < -1.0


def test_an_fmu_for_co_simulation_shows_no_states(balls: dict[str, Path]) -> None:
    with fmi.Fmu(balls["3"], "co-simulation") as fmu, fmu.instantiate("ball") as ball:
        ball.initialize()
        with pytest.raises(FmuError, match="ball: only FMUs for model exchange show their continuous states"):
            _ = ball.states
