"""Manipulations between slaves and connections, triggers, and scenarios."""

import json
import math

import numpy as np
import oscillators
import pytest

from seacrane.cosim import (
    Above,
    Below,
    Event,
    Execution,
    Freeze,
    FunctionSlave,
    GaussSeidel,
    Jacobi,
    Offset,
    Override,
    Ramp,
    Release,
    Scale,
    Scenario,
    Set,
    Stop,
    System,
    scenario,
)
from seacrane.errors import CosimError
from seacrane.model.dae import Variable

LOOPS = pytest.mark.parametrize("loop", ["c", "python"])
STEP = 0.125


def clock_and_follower() -> System:
    """`clock.t` is the time, `follower.y` what it takes plus what it is set to."""
    system = System("pair")
    system.add("clock", FunctionSlave(lambda t, h, u: [t + h], outputs=[Variable("t", "s")]))
    inputs = [Variable("u", "s"), Variable("trim", "s", minimum=-1.0, maximum=1.0)]
    system.add("follower", FunctionSlave(lambda t, h, u: [u[0] + u[1]], inputs, [Variable("y", "s")]))
    system.connect("clock.t", "follower.u")
    return system


def run_of(loop="auto", algorithm=None) -> Execution:
    return Execution(clock_and_follower(), algorithm or GaussSeidel(STEP), loop=loop).start()


def series(run, until, *names):
    recorder = run.record(names)
    run.advance(until)
    run.flush()
    recording = recorder.recording()
    return np.column_stack([recording[name] for name in names]).tolist()


@LOOPS
def test_an_overridden_output_is_what_all_others_see_until_it_is_released(loop):
    run = run_of(loop)
    run.step(2)
    run.apply(Override("clock.t", 7.0))
    assert run.values(["clock.t"])[0] == 7.0
    assert run.manipulated == {"clock.t": 0.25}
    run.step(2)
    assert run.values(["clock.t", "follower.u", "follower.y"]).tolist() == [7.0, 7.0, 7.0]
    run.apply(Release("clock.t"))
    assert run.values(["clock.t"])[0] == 0.5
    assert run.manipulated == {}
    run.step()
    assert run.values(["clock.t", "follower.y"]).tolist() == [0.625, 0.625]


@LOOPS
def test_an_overridden_input_is_what_its_slave_alone_sees(loop):
    run = run_of(loop)
    run.apply(Override("follower.u", -3.0))
    run.step(2)
    assert run.values(["clock.t", "follower.u", "follower.y"]).tolist() == [0.25, -3.0, -3.0]
    run.apply(Release("follower.u"))
    run.step()
    assert run.values(["clock.t", "follower.y"]).tolist() == [0.375, 0.375]


@LOOPS
def test_offset_and_scale_follow_the_true_value_and_freeze_does_not(loop):
    run = run_of(loop)
    run.step(2)
    run.apply(Offset("clock.t", 10.0))
    assert series(run, 0.5, "clock.t") == [[10.25], [10.375], [10.5]]
    run.apply(Scale("clock.t", -2.0))
    assert series(run, 0.75, "clock.t") == [[-1.0], [-1.25], [-1.5]]
    run.apply(Freeze("clock.t"))
    assert series(run, 1.0, "clock.t") == [[-1.5]] * 3
    assert run.manipulated == {"clock.t": 1.0}


@LOOPS
@pytest.mark.parametrize("name", ["clock.t", "follower.u", "follower.trim"])
def test_a_ramp_leads_from_the_present_value_to_the_end_exactly_and_stays(loop, name):
    run = run_of(loop)
    run.step(4)
    start = run.values([name])[0]
    run.apply(Ramp(name, 0.3, over=0.5))
    values = [v for (v,) in series(run, 1.5, name)]
    # An input is what it was when its slave began its last step.
    ahead = 0.0 if name == "clock.t" else STEP
    expected = [start + (0.3 - start) * min(max(i * STEP - ahead, 0.0) / 0.5, 1.0) for i in range(9)]
    assert values == pytest.approx(expected, abs=1e-15)
    assert values[-1] == 0.3


@LOOPS
def test_an_input_that_nothing_drives_is_offset_once_and_set_beneath(loop):
    run = run_of(loop)
    run.set("follower.trim", 0.5)
    run.apply(Offset("follower.trim", 4.0))
    run.step(3)
    assert run.values(["follower.trim", "follower.y"]).tolist() == [4.5, 4.875]
    run.set("follower.trim", -0.5)
    run.step()
    assert run.values(["follower.trim"])[0] == 3.5
    run.apply(Release("follower.trim"))
    run.step()
    assert run.values(["follower.trim"])[0] == -0.5


@LOOPS
def test_a_stopped_slave_keeps_its_outputs_while_the_others_go_on(loop):
    run = run_of(loop)
    run.step(2)
    run.apply(Stop("clock"))
    run.step(4)
    assert (run.time, run.values(["clock.t", "follower.y"]).tolist()) == (0.75, [0.25, 0.25])
    assert run.stopped == ("clock",)


def test_an_action_that_does_not_fit_is_refused_with_the_reason():
    run = run_of()
    for action, message in (
        (Override("clock.tt", 1.0), r"clock\.tt: no such variable in the system\. Did you mean 'clock\.t'"),
        (Override("clock.t", float("nan")), r"clock\.t: 'to' is not a finite number \(got nan\)"),
        (
            Ramp("clock.t", 1.0, -1.0),
            r"the duration of the ramp must be positive \(got -1\.0\); allowed: more than 0 s",
        ),
        (Stop("clck"), r"clck: there is no such slave\. Did you mean 'clock'"),
    ):
        with pytest.raises(CosimError, match=message):
            run.apply(action)
    with pytest.raises(CosimError, match=r"follower\.u: is driven by 'clock\.t' and cannot be set\. Override it"):
        run.apply(Set("follower.u", 1.0))
    assert run.manipulated == {}


@LOOPS
@pytest.mark.parametrize("algorithm", [GaussSeidel(STEP), Jacobi(STEP)])
def test_a_manipulated_run_goes_on_from_a_saved_state_bit_by_bit(loop, algorithm):
    run = run_of(loop, algorithm)
    run.follow(
        Scenario(
            "all",
            (
                Event(0.25, Offset("follower.trim", 0.1)),
                Event(0.5, Ramp("clock.t", 0.3, 0.7)),
                Event(1.0, Scale("follower.u", 1.7)),
                Event(1.5, Release("clock.t")),
                Event(2.0, Stop("clock")),
            ),
        )
    )
    names = ["clock.t", "follower.u", "follower.trim", "follower.y"]
    for at in (0.125, 0.5, 0.75, 1.125, 2.5):
        run.advance(at)
        state = run.save()
        whole = series(run, 3.0, *names)
        run.restore(state)
        assert series(run, 3.0, *names) == whole
        run.restore(state)


# ---------------------------------------------------------------- triggers
@LOOPS
def test_a_trigger_fires_at_the_first_point_at_which_all_its_conditions_hold(loop):
    run = run_of(loop)
    fired = []
    run.when(Above("clock.t", 0.5), Above("follower.u", 0.7), call=lambda r: fired.append(r.time))
    run.when(Above("clock.t", 0.9), Below("clock.t", 0.95), call=lambda r: fired.append(-r.time))
    run.advance(2.0)
    assert fired == [0.75]


@LOOPS
def test_a_trigger_may_act_again_each_time_its_condition_comes_to_hold(loop):
    run = run_of(loop)
    fired = []
    saw = FunctionSlave(lambda t, h, u: [(t + h) % 1.0], outputs=[Variable("y")])
    run = Execution(System("s", {"saw": saw}), GaussSeidel(0.25), loop=loop)
    run.when(Above("saw.y", 0.4), call=lambda r: fired.append(r.time), once=False)
    run.when(Above("saw.y", 0.4), call=lambda r: fired.append(-r.time))
    run.advance(3.0)
    assert fired == [0.5, -0.5, 1.5, 2.5]


def test_a_trigger_that_holds_from_the_start_fires_there():
    run = Execution(clock_and_follower(), GaussSeidel(STEP))
    fired = []
    run.when(Below("clock.t", 1.0), call=lambda r: fired.append(r.time))
    run.advance(1.0)
    assert fired == [0.0]


def test_a_trigger_may_carry_out_an_action_or_pause_the_run():
    run = run_of()
    run.when(Above("clock.t", 0.6), call=Override("clock.t", -1.0))
    run.when(Below("clock.t", 0.0), call=lambda r: r.pause())
    recording = run.run(2.0)
    assert run.time == 0.75
    assert recording["clock.t"].tolist() == [0.0, 0.125, 0.25, 0.375, 0.5, 0.625, -1.0]
    run.advance(2.0)
    assert run.time == 2.0


def test_conditions_that_do_not_fit_are_told_together():
    with pytest.raises(CosimError) as caught:
        run_of().when(Above("clock.tt", 0.0), Below("clock.t", float("inf")), call=Stop("ghost"))
    assert [p.path for p in caught.value.problems] == ["clock.tt", "clock.t", "ghost"]


# ---------------------------------------------------------------- scenarios
def document(*events, **more):
    return json.dumps({"format": "seacrane-scenario/1", "name": "test", "events": list(events), **more})


@LOOPS
def test_events_take_effect_at_the_first_communication_point_that_is_not_before_them(loop):
    run = run_of(loop)
    events = (
        {"at": "250 ms", "do": "override", "variable": "clock.t", "to": "-2 min"},
        {"at": 0.3, "do": "release", "variable": "clock.t"},
        {"when": [{"variable": "clock.t", "above": "600 ms"}], "do": "set", "variable": "follower.trim", "to": "1 s"},
    )
    run.follow(scenario.loads(document(*events), run.variables))
    assert series(run, 1.0, "clock.t", "follower.y") == [
        [0.0, 0.0], [0.125, 0.125], [0.25, 0.25], [-120.0, -120.0], [0.5, 0.5],
        [0.625, 0.625], [0.75, 1.75], [0.875, 1.875], [1.0, 2.0],
    ]  # fmt: skip


def test_a_run_does_not_depend_on_how_it_is_cut_into_calls():
    events = scenario.loads(
        document(
            {"at": 0.5, "do": "ramp", "variable": "clock.t", "to": "3 s", "over": "700 ms"},
            {"at": 0.5, "do": "offset", "variable": "follower.u", "by": "10 ms"},
            {"at": 1.5, "do": "stop", "slave": "follower"},
        ),
        run_of().variables,
    )
    tables = []
    for cuts in ((2.0,), (0.125, 0.5, 0.625, 1.5, 2.0), tuple(i * STEP for i in range(17))):
        run = run_of()
        run.follow(events)
        recorder = run.record()
        for until in cuts:
            run.advance(until)
        run.flush()
        tables.append(np.column_stack([recorder.recording()[n] for n in recorder.recording()]))
    assert all(np.array_equal(tables[0], table) for table in tables)


def test_all_that_is_wrong_in_a_scenario_file_is_told_at_once():
    variables = run_of().variables
    text = document(
        {"at": "2 bar", "do": "override", "variable": "clock.t", "to": "1 s"},
        {"at": 1.0, "do": "overide", "variable": "clock.t"},
        {"at": 1.0, "when": [], "do": "freeze", "variable": "clck.t"},
        {"at": 1.0, "do": "ramp", "variable": "clock.t", "to": "1 s"},
        {"when": [{"variable": "clock.t", "over": 1}], "do": "scale", "variable": "clock.t", "by": "2 s"},
        {"at": 1.0, "do": "stop", "slave": "clock", "to": 0},
        "nothing",
        seed=1,
    )
    with pytest.raises(CosimError) as caught:
        scenario.loads(text, variables, "fault.json")
    assert [p.path for p in caught.value.problems] == [
        f"fault.json: {path}"
        for path in (
            "seed", "events[0].at", "events[1].do", "events[2]", "events[2].variable", "events[3].over",
            "events[4].when[0]", "events[4].by", "events[5].to", "events[6]",
        )
    ]  # fmt: skip
    assert "Did you mean 'override'" in str(caught.value)
    assert "Did you mean 'clock.t'" in str(caught.value)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("[]", "does not hold a scenario"),
        ("{", "is not JSON"),
        ('{"events": []}', "names no format"),
        ('{"format": "seacrane-scenario/2"}', "is of a format that this version cannot read"),
    ],
)
def test_what_is_no_scenario_file_is_refused(text, message):
    with pytest.raises(CosimError, match=message):
        scenario.loads(text, {})


def test_a_scenario_that_does_not_fit_the_system_is_refused_as_a_whole():
    run = run_of()
    run.step(4)
    wrong = Scenario("s", (Event(1.0, Freeze("ghost.y")), Event(0.25, Stop("clock")), Event(math.nan, Stop("ghost"))))
    with pytest.raises(CosimError) as caught:
        run.follow(wrong)
    assert [str(p) for p in caught.value.problems] == [
        "s: events[0]: ghost.y: no such variable in the system. Known: clock.t, follower.trim, follower.u, follower.y.",
        "s: events[2]: ghost: there is no such slave. Known: clock, follower.",
        "s: events[2]: at: is not a finite number (got nan)",
        "s: events[1]: is due before the present time 0.5 s (got 0.25)",
    ]
    run.follow(Scenario("right", (Event(1, Stop("clock")), Event(Above("clock.t", 0.7), Freeze("clock.t")))))
    run.advance(1.0)
    assert list(run.manipulated) == ["clock.t"]
    with pytest.raises(CosimError, match="right: cannot be followed: the run follows a scenario already"):
        run.follow(Scenario("right", ()))


@LOOPS
def test_a_trigger_may_look_at_what_is_inside_a_model(loop):
    one, two = oscillators.models()
    run = Execution(oscillators.system((one, two)), GaussSeidel(0.01), loop=loop)
    fired = []
    run.when(Below("one.sum", -0.5), call=lambda r: fired.append((r.time, r.values(["one.sum"])[0])))
    recorder = run.record(["one.sum"])
    run.advance(2.0)
    run.flush()
    recording = recorder.recording()
    first = int(np.argmax(recording["one.sum"] < -0.5))
    assert first > 1
    assert fired == [(recording.time[first], recording["one.sum"][first])]
