import time

import pytest

from seacrane.cosim import Above, Execution, FunctionSlave, GaussSeidel, RealTime, System
from seacrane.errors import CosimError
from seacrane.model.dae import Variable


class Wall:
    """A clock that only sleeping and working move."""

    def __init__(self) -> None:
        self.now = 1000.0

    def clock(self) -> float:
        return self.now

    def sleep(self, duration: float) -> None:
        self.now += duration


def paced(cost, **more) -> tuple[Execution, RealTime, Wall]:
    """A run whose macro steps of 0.125 s take cost(t) s of wall time each."""
    wall = Wall()

    def work(t, h, u):
        wall.now += cost(t) if h else 0.0
        return [t]

    run = Execution(System("s", {"f": FunctionSlave(work, outputs=[Variable("t", "s")])}), GaussSeidel(0.125))
    return run, RealTime(run, clock=wall.clock, sleep=wall.sleep, **more), wall


def test_a_fast_run_takes_as_long_as_the_time_it_simulates():
    run, pacing, wall = paced(lambda t: 0.03125)
    pacing.advance(2.0)
    # The last step began when it was due, at 1.875 s, and took 0.03125 s.
    assert (run.time, wall.now) == (2.0, 1000.0 + 1.875 + 0.03125)
    assert pacing.pace.macro_steps == 16
    assert pacing.pace.overruns == 0
    assert pacing.pace.lateness_max == 0.0
    assert pacing.pace.real_time_factor == 0.25


def test_at_double_speed_it_takes_half_as_long():
    _, pacing, wall = paced(lambda t: 0.03125, speed=2.0)
    pacing.advance(2.0)
    assert wall.now == 1000.0 + 1.875 / 2 + 0.03125
    pacing.speed = 0.5
    pacing.advance(3.0)
    assert wall.now == 1000.0 + 1.875 / 2 + 0.03125 + 1.75 + 0.03125


def test_a_short_delay_is_caught_up_with():
    _, pacing, wall = paced(lambda t: 0.25 if t == 0.5 else 0.03125, catch_up=0.25)
    pacing.advance(2.0)
    assert wall.now == 1000.0 + 1.875 + 0.03125
    pace = pacing.pace
    assert (pace.overruns, pace.shifts) == (2, 0)
    assert pace.lateness_max == 0.125
    assert pace.lateness_p50 == 0.0


def test_a_long_delay_shifts_the_origin_and_is_counted():
    _, pacing, wall = paced(lambda t: 1.125 if t == 0.5 else 0.03125, catch_up=0.25)
    pacing.advance(2.0)
    # The step due at 0.625 s began at 1.625 s, and all later ones a second late.
    assert wall.now == 1000.0 + 1.875 + 1.0 + 0.03125
    pace = pacing.pace
    assert (pace.overruns, pace.shifts, pace.lost_s) == (1, 1, 1.0)


def test_a_run_that_is_too_slow_overruns_at_every_step():
    _, pacing, _ = paced(lambda t: 0.25, catch_up=0.25)
    pacing.advance(1.0)
    # Lateness grows by 0.125 s a step, so every third step would begin 0.375 s late and is shifted instead.
    assert (pacing.pace.overruns, pacing.pace.shifts, pacing.pace.lost_s) == (8, 2, 0.75)
    assert pacing.pace.lateness_max == 0.25
    assert pacing.pace.real_time_factor == 2.0


def test_a_pause_is_not_made_up_for():
    run, pacing, wall = paced(lambda t: 0.03125)
    pacing.advance(0.5)
    pacing.pause()
    assert not pacing.running
    wall.now += 100.0
    pacing.advance(1.0)
    assert run.time == 1.0
    assert wall.now == pytest.approx(1000.0 + 0.375 + 0.03125 + 100.0 + 0.375 + 0.03125)
    assert pacing.pace.lateness_max == 0.0


@pytest.mark.parametrize("wrong", [{"speed": 0.0}, {"speed": float("nan")}, {"catch_up": -1.0}])
def test_pacing_refuses_what_is_no_speed_or_duration(wrong):
    with pytest.raises(CosimError, match=next(iter(wrong))):
        paced(lambda t: 0.0, **wrong)


def test_on_the_clock_of_the_system_half_a_second_takes_half_a_second():
    run = Execution(
        System("s", {"f": FunctionSlave(lambda t, h, u: [t], outputs=[Variable("t", "s")])}), GaussSeidel(0.01)
    )
    pacing = RealTime(run)
    begin = time.monotonic()
    pacing.advance(0.5)
    assert time.monotonic() - begin >= 0.49
    assert pacing.pace.macro_steps == 50
    assert pacing.pace.real_time_factor < 0.5


def test_a_run_that_is_paused_from_within_returns_and_goes_on_without_a_jump():
    run, pacing, wall = paced(lambda t: 0.03125)
    run.when(Above("f.t", 0.9), call=lambda r: r.pause())
    pacing.advance(2.0)
    # The slave gives the time at the beginning of its step.
    assert (run.time, pacing.running) == (1.125, False)
    wall.now += 60.0
    pacing.advance(2.0)
    assert (run.time, pacing.running) == (2.0, True)
    assert (pacing.pace.macro_steps, pacing.pace.shifts, pacing.pace.overruns) == (16, 0, 0)


def test_a_pause_asked_for_beforehand_is_a_pause_at_once():
    run, pacing, _ = paced(lambda t: 0.03125)
    run.pause()
    pacing.advance(2.0)
    assert (run.time, pacing.pace.macro_steps) == (0.0, 0)
    pacing.advance(0.25)
    assert run.time == 0.25
