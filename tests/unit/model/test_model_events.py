"""Events of a model: where they happen, what they set, and what is said when they cannot."""

import itertools
import math

import casadi as ca
import numpy as np
import pytest

from seacrane.errors import SolveError, StructureError
from seacrane.model import (
    Component,
    Diagram,
    ImplicitEuler,
    RungeKutta4,
    SignalIn,
    SignalOut,
    parameter,
    simulate,
    trim,
)
from seacrane.model.dae import Dae, Event, Variable, column
from seacrane.model.native import build
from seacrane.units import Acceleration, Ratio

GRAVITY = 9.81


class Ball(Component):
    """A ball that falls from 1 m and bounces until it is too slow to leave the floor."""

    restitution: Ratio = parameter("speed after over speed before", default=0.5, least=0, most=1)
    gravity: Acceleration = parameter("gravity", default=GRAVITY, above=0)
    ports = {"y": SignalOut("m")}

    def equations(self, m):
        h = m.state("height", unit="m", start=1.0)
        v = m.state("speed", unit="m/s")
        lost = m.state("lost", unit="J", about="energy per mass lost at impacts")
        flying = m.mode("flying", start=1, about="0 when it lies on the floor")
        yield m.der(h), flying * v
        yield m.der(v), -flying * self.gravity
        yield m.der(lost), 0
        yield m.y, h
        e = self.restitution
        slow = ca.fabs(v) < 1e-2
        m.when(
            "meets the floor", -flying * h,
            (h, 0), (v, ca.if_else(slow, 0, -e * v)), (flying, ca.if_else(slow, 0, 1)),
            (lost, lost + v**2 / 2 * ca.if_else(slow, 1, 1 - e**2)),
        )  # fmt: skip
        m.observe("energy", self.gravity * h + v**2 / 2 + lost, "J")


def alone(component, **exposed):
    diagram = Diagram("alone")
    part = diagram.add("part", component)
    diagram.expose(**{name: getattr(part, port) for name, port in exposed.items()})
    return diagram


def bounces(e=0.5):
    """Times of impact until the ball stays down."""
    speed = math.sqrt(2 * GRAVITY)
    time = speed / GRAVITY
    while True:
        yield time
        if speed < 1e-2:
            return
        speed *= e
        time += 2 * speed / GRAVITY


@pytest.mark.parametrize("solver", ["rodas4", RungeKutta4(step=1e-3)], ids=["rodas4", "runge-kutta"])
def test_a_ball_bounces_at_the_times_of_the_closed_form_until_it_lies(solver):
    run = simulate(alone(Ball(), h="y"), 5.0, every=0.05, solver=solver)
    assert [e.time for e in run.events] == pytest.approx(list(bounces()), abs=1e-9)
    assert run["part.energy"] == pytest.approx(np.full(run.time.size, GRAVITY), rel=1e-10)
    assert (run["part.height"][-1], run["part.speed"][-1], run["part.flying"][-1]) == (0.0, 0.0, 0.0)


def test_the_located_time_converges_with_the_order_of_the_method():
    exact = next(bounces())
    errors = [
        abs(simulate(alone(Ball(), h="y"), 0.6, every=0.6, solver=ImplicitEuler(step=h)).events[0].time - exact)
        for h in (0.04, 0.02, 0.01)
    ]
    assert [a / b for a, b in itertools.pairwise(errors)] == pytest.approx([2, 2], abs=0.2)


def test_steps_called_by_a_master_and_a_rollback_see_the_same_events():
    native = build(alone(Ball(), h="y").compile())
    names = ["part.height", "part.speed", "part.flying", "part.lost"]
    with native.instantiate() as run:
        run.initialize(0.0)
        for k in range(100):
            if k == 44:
                saved = run.save()
            run.step(k * 0.01, 0.01)
        count, events = run.events()
        first = list(run.get(names))
        assert count == len(events) == sum(t < 1.0 for t in bounces())
        assert [e.time for e in events] == pytest.approx(list(bounces())[:count], abs=1e-9)
        run.restore(saved)
        for k in range(44, 100):
            run.step(k * 0.01, 0.01)
        assert list(run.get(names)) == first


class Switch(Component):
    """x' = 1 or -1, turned round at two limits that may be too close to each other."""

    gap: Ratio = parameter("distance of the limits", default=0.5)
    ports = {"y": SignalOut()}

    def equations(self, m):
        x = m.state("x", unit="1")
        up = m.mode("up", start=1)
        yield m.der(x), 2 * up - 1
        yield m.y, x
        m.when("turns_down", up * (x - 1), (up, 0))
        m.when("turns_up", (1 - up) * (1 - self.gap - x), (up, 1))


def test_a_hysteresis_gives_a_saw_tooth_and_none_is_told_as_chattering():
    run = simulate(alone(Switch(), y="y"), 6.0, every=6.0)
    assert [e.time for e in run.events] == pytest.approx(np.arange(1.0, 6.0, 0.5), abs=1e-9)
    with pytest.raises(SolveError, match=r"part.turns_(up|down) chatters: .* at t = 1 s; it needs a hysteresis"):
        simulate(alone(Switch(gap=0.0), y="y"), 6.0)


def test_events_that_call_each_other_without_end_are_named():
    class Quarrel(Component):
        ports = {"y": SignalOut()}

        def equations(self, m):
            a = m.mode("a")
            yield m.y, a
            m.when("sets", 0.5 - a, (a, 1))
            m.when("unsets", a - 0.5, (a, 0))

    with pytest.raises(SolveError, match=r"events at t = 0 s do not come to an end: part.\w+ brings itself about"):
        simulate(alone(Quarrel(), y="y"), 1.0)


class Cascade(Component):
    """One event brings about the next at the same instant, through an algebraic unknown."""

    ports = {"u": SignalIn(), "y": SignalOut()}

    def equations(self, m):
        first, second = m.mode("first"), m.mode("second")
        z = m.unknown("z")
        yield z**3 + z, 10 * first
        yield m.y, second
        m.when("starts", (1 - first) * (m.u - 1), (first, 1))
        m.when("follows", (1 - second) * (z - 1.5), (second, m.time))


def test_unknowns_are_solved_anew_between_events_of_one_instant():
    series = (np.array([0.0, 4.0]), np.array([0.0, 4.0]))
    run = simulate(alone(Cascade(), u="u", y="y"), 2.0, inputs={"u": series}, linear=True)
    assert [e.name for e in run.events] == ["part.starts", "part.follows"]
    assert run.events[0].time == run.events[1].time == pytest.approx(1.0, abs=1e-11)
    assert run["y"][-1] == pytest.approx(1.0, abs=1e-11)
    assert run["part.z"][-1] == pytest.approx(2.0)


def test_an_event_over_within_a_step_is_not_missed():
    t, none, p = ca.SX.sym("t"), ca.SX(0, 1), ca.SX.sym("p")
    pulse = ca.exp(-(((t - 50.3) / 0.05) ** 2)) - 0.5
    course = ca.sin(2 * np.pi * t) - 0.99
    for indicator, expected in ((course, 100), (pulse, 1)):
        dae = Dae(
            "seen", (), (), (), (), (), (), t, none, none, none, p, none, none, none, none,
            modes=(Variable("n"),), events=(Event("e", indicator, {"n": p + 1}),),
        )  # fmt: skip
        every = 100.0 if expected > 1 else 0.1
        assert simulate(dae, 100.0, every=every)["n"][-1] == expected


def test_an_event_is_told_to_set_only_what_is_its_own():
    class Meddler(Component):
        ports = {"u": SignalIn(), "y": SignalOut()}

        def equations(self, m):
            yield m.y, m.u
            m.when("meddles", m.u, (m.u, 1))

    with pytest.raises(StructureError, match=r"part.meddles: sets u, but an event sets states and modes of its own"):
        alone(Meddler(), u="u", y="y").compile()
    t, x, none = ca.SX.sym("t"), ca.SX.sym("x"), ca.SX(0, 1)
    with pytest.raises(StructureError, match=r"jump: sets 'y', which is no state and no mode"):
        Dae(
            "d", (Variable("x"),), (), (), (), (), (), t, x, none, none, none, x, none, none, none,
            events=(Event("jump", x, {"y": ca.SX(0)}),),
        )  # fmt: skip


def test_solvers_of_other_libraries_refuse_a_model_with_events():
    for solver in ("bdf", "lsoda"):
        with pytest.raises(SolveError, match=r"has events \(part.meets the floor\), which solvers of other libraries"):
            simulate(alone(Ball(), h="y"), 1.0, solver=solver)


def test_a_mode_is_given_a_start_value_like_a_state_and_is_no_parameter_of_a_running_model():
    native = build(alone(Ball(), h="y").compile())
    run = simulate(native, 1.0, parameters={"part.flying": 0.0})
    assert set(run["part.height"]) == {1.0}
    with native.instantiate() as instance:
        instance.initialize(0.0)
        with pytest.raises(Exception, match=r"part.flying can only be set before or during initialization"):
            instance.set("part.flying", 0.0)


def test_a_trimmed_model_stays_in_the_mode_that_it_starts_in_and_says_if_an_event_would_end_that():
    class Heater(Component):
        ports = {"y": SignalOut()}
        limit: Ratio = parameter("limit", default=20.0)

        def equations(self, m):
            x = m.state("x", unit="1")
            on = m.mode("on", start=1)
            yield m.der(x), 10 * on - x
            yield m.y, x
            m.when("off", on * (x - self.limit) / 10, (on, 0))

    assert trim(alone(Heater(), y="y")).start["part.x"] == pytest.approx(10.0)
    with pytest.raises(SolveError, match=r"part.off: has happened before the model comes to rest"):
        trim(alone(Heater(limit=5.0), y="y"))


def test_derivatives_and_matrices_are_those_of_the_mode():
    state = column(ca.SX.sym("x"))
    t, none, p = ca.SX.sym("t"), ca.SX(0, 1), ca.SX.sym("p")
    dae = Dae(
        "d", (Variable("x", start=1.0),), (), (), (), (Variable("y"),), (), t, state, none, none, p,
        p * state, none, state, none, modes=(Variable("m", start=-2.0),),
    )  # fmt: skip
    with build(dae).instantiate() as run:
        run.initialize(0.0)
        assert run.get("der(x)") == -2.0
