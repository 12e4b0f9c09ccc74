"""Models with events as FMUs: for model exchange the importer is shown where they happen, for co-simulation they happen
inside."""

import itertools
from pathlib import Path

import casadi as ca
import fmpy
import numpy as np
import pytest
from fmpy.validation import validate_fmu

from seacrane import fmi
from seacrane.model.dae import Dae, Event, Variable, column
from seacrane.model.native import build

GRAVITY, RESTITUTION, HEIGHT = 9.81, 0.7, 1.0
FIRST = np.sqrt(2 * HEIGHT / GRAVITY)
BOUNCES = FIRST * (1 + 2 * np.cumsum(np.concatenate([[0.0], RESTITUTION ** np.arange(1, 4)])))
UNTIL = 2.0


def ball() -> Dae:
    """A ball that falls and bounces; an input lifts the floor."""
    t, x, u, p = ca.SX.sym("t"), ca.SX.sym("x", 2), ca.SX.sym("u"), ca.SX.sym("p", 2)
    none, bounces = ca.SX(0, 1), p[1]
    return Dae(
        "ball",
        (Variable("h", "m", HEIGHT), Variable("v", "m/s")),
        (),
        (Variable("floor", "m"),),
        (Variable("restitution", "1", RESTITUTION, minimum=0.0, maximum=1.0),),
        (Variable("height", "m"),),
        (Variable("energy", "J"),),
        t, x, none, u, p,
        column(x[1], -GRAVITY), none, column(x[0]), column(GRAVITY * x[0] + x[1] ** 2 / 2),
        modes=(Variable("bounces"),),
        events=(Event("bounce", u - x[0], {"h": u, "v": -p[0] * x[1], "bounces": bounces + 1}, "meets the floor"),),
    )  # fmt: skip


def height(time: np.ndarray) -> np.ndarray:
    """The closed form, floor at zero."""
    start = np.concatenate([[-FIRST], BOUNCES])
    speed = GRAVITY * FIRST * RESTITUTION ** np.arange(start.size)
    k = np.searchsorted(start, time, side="right") - 1
    since = time - start[k]
    return speed[k] * since - GRAVITY / 2 * since**2


@pytest.fixture(scope="module", params=["2.0", "3.0"])
def fmu(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return fmi.export(ball(), tmp_path_factory.mktemp("ball") / "ball.fmu", version=request.param)


def test_the_fmu_is_valid_and_tells_its_indicator(fmu: Path) -> None:
    assert validate_fmu(str(fmu)) == []
    assert fmi.check(fmu) == []
    bounces = fmi.read(fmu).by_name["bounces"]
    assert (bounces.causality, bounces.variability, bounces.start) == ("local", "discrete", 0.0)


@pytest.mark.parametrize("kind", ["ModelExchange", "CoSimulation"])
def test_another_importer_sees_the_ball_bounce_in_time(fmu: Path, kind: str) -> None:
    theirs = fmpy.simulate_fmu(
        str(fmu), fmi_type=kind, stop_time=UNTIL, output_interval=0.01, output=["height", "bounces"],
        relative_tolerance=1e-9, start_values={"restitution": RESTITUTION},
    )  # fmt: skip
    assert theirs["bounces"][-1] == BOUNCES.size
    assert theirs["height"] == pytest.approx(height(theirs["time"]), abs=1e-6)


@pytest.mark.parametrize("exchange", [True, False], ids=["exchange", "co-simulation"])
def test_our_importer_sees_the_ball_bounce_in_time(fmu: Path, exchange: bool) -> None:
    with fmi.Fmu(fmu, kind="model-exchange" if exchange else "co-simulation") as unit, unit.instantiate() as run:
        run.initialize(0.0)
        grid = np.linspace(0.0, UNTIL, 21)
        found = [run.get("height")]
        for start, end in itertools.pairwise(grid):
            run.step(start, end - start)
            found.append(run.get("height"))
        assert found == pytest.approx(height(grid), abs=1e-8)
        assert run.get("bounces") == BOUNCES.size


def test_a_rollback_takes_back_a_bounce_bit_for_bit(fmu: Path) -> None:
    with fmi.Fmu(fmu) as unit, unit.instantiate() as run:
        run.initialize(0.0)
        run.step(0.0, 0.4)
        saved = run.save()
        run.step(0.4, 0.4)
        first = [run.get(n) for n in ("h", "v", "bounces")]
        run.restore(saved)
        assert run.get("bounces") == 0.0
        run.step(0.4, 0.4)
        assert [run.get(n) for n in ("h", "v", "bounces")] == first
        assert first[2] == 1.0


def test_a_floor_that_jumps_up_meets_the_ball_at_once(fmu: Path) -> None:
    with fmi.Fmu(fmu) as unit, unit.instantiate() as run, build(ball()).instantiate() as ours:
        for model in (run, ours):
            model.initialize(0.0)
            model.step(0.0, 0.1)
            model.set("floor", 1.5)
            model.step(0.1, 1e-3)
            assert model.get("bounces") == 1.0
            assert model.get("height") == pytest.approx(1.5 + RESTITUTION * GRAVITY * 0.1 * 1e-3, abs=1e-5)
