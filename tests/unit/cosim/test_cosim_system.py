import pytest

from seacrane.cosim import Bond, Connection, Execution, FunctionSlave, GaussSeidel, System
from seacrane.errors import CosimError
from seacrane.model.dae import Variable


def ramp(t, h, u):
    return [t + h]


def copy(t, h, u):
    return u


SOURCE = FunctionSlave(ramp, outputs=[Variable("force", "kN")])
SINK = FunctionSlave(copy, [Variable("force", "N")], [Variable("felt", "N")])
PIPE = FunctionSlave(copy, [Variable("p", "Pa")], [Variable("q", "m3/s")])


def parts(**more) -> System:
    return System("parts", {"source": SOURCE, "sink": SINK, "other": SINK, "pipe": PIPE, **more})


def messages(error) -> list[str]:
    return [str(problem) for problem in error.value.problems]


def test_one_output_drives_any_number_of_inputs_with_units_converted():
    system = parts()
    system.connect("source.force", "sink.force")
    system.connect("source.force", "other.force", gain=-2.0, bias=5.0)
    with Execution(system, GaussSeidel(0.5)) as run:
        run.step()
        assert run.values(["source.force", "sink.felt", "other.felt"]).tolist() == [0.5, 500.0, -995.0]


def test_several_targets_are_connected_in_one_call_or_not_at_all():
    system = parts()
    with pytest.raises(CosimError, match="slave 'other' has no such variable"):
        system.connect("source.force", "sink.force", "other.froce")
    assert system.connections == ()
    system.connect("source.force", "sink.force", "other.force")
    assert system.source_of("other.force") == "source.force"


def test_a_name_of_nothing_is_answered_with_the_nearest():
    with pytest.raises(CosimError) as caught:
        parts().connect("sorce.force", "sink.forse")
    assert messages(caught) == [
        "sorce.force: there is no slave 'sorce'. Did you mean 'source'?",
        "sink.forse: slave 'sink' has no such variable. Did you mean 'sink.force'?",
    ]


def test_an_input_has_one_source():
    system = parts()
    system.connect("source.force", "sink.force")
    with pytest.raises(CosimError) as caught:
        system.connect("other.felt", "sink.force")
    assert messages(caught) == ["sink.force: is driven by 'source.force' already (got 'other.felt')"]


def test_a_connection_leads_from_an_output_to_an_input():
    with pytest.raises(CosimError) as caught:
        parts().connect("sink.force", "source.force")
    assert messages(caught) == [
        "sink.force: is an input variable; a connection must start at an output. Did you mean 'sink.felt'?",
        "source.force: is an output variable; a connection must end at an input. There is none here.",
    ]


def test_units_of_different_dimensions_do_not_connect():
    with pytest.raises(CosimError) as caught:
        parts().connect("source.force", "pipe.p")
    assert messages(caught) == ["pipe.p: is in 'Pa' and cannot take 'source.force', which is in 'kN'"]


def test_a_bond_carries_power_between_two_slaves():
    force, position = Variable("F", "N"), Variable("x", "m")
    system = System(
        "wrong", {"a": FunctionSlave(copy, [position], [force]), "b": FunctionSlave(copy, [force], [position])}
    )
    with pytest.raises(CosimError) as caught:
        system.bond("rod", effort=("a.F", "b.F"), flow=("b.x", "a.x"))
    assert messages(caught) == [
        "rod: the product of 'a.F' and 'a.x' is not power (got 'N * m'); "
        "allowed: effort * flow in W, such as N * m/s or Pa * m3/s",
        "rod: the product of 'b.F' and 'b.x' is not power (got 'N * m'); "
        "allowed: effort * flow in W, such as N * m/s or Pa * m3/s",
    ]
    assert system.connections == ()
    assert system.bonds == {}


def test_a_rotational_bond_counts_the_radian_as_a_number():
    torque, speed = Variable("T", "kN.m"), Variable("w", "rpm")
    system = System("shaft", {"a": FunctionSlave(copy, [speed], [torque]), "b": FunctionSlave(copy, [torque], [speed])})
    system.bond("shaft", effort=("a.T", "b.T"), flow=("b.w", "a.w"))
    assert len(system.connections) == 2


def test_a_system_given_as_a_whole_tells_everything_that_is_wrong_at_once():
    with pytest.raises(CosimError) as caught:
        System(
            "wrong",
            {"1st": SOURCE, "source": SOURCE, "sink": SINK, "odd": FunctionSlave(copy, [Variable("x", "bbar")])},
            [
                Connection("source.force", "sink.force"),
                Connection("source.force", "sink.force"),
                Connection("sink.felt", "sink.force", gain=float("nan")),
            ],
            [Bond("sink", ("source.force", "sink.force"), ("sink.felt", "nobody.v"))],
        )
    assert messages(caught) == [
        "1st: is no name for a slave; allowed: letters, digits, _ and -, not beginning with a digit",
        "odd.x: has an unknown unit (got 'bbar'). Did you mean 'bar'?",
        "sink.force: is driven by 'source.force' already (got 'source.force')",
        "sink.force: is driven by 'source.force' already (got 'sink.felt')",
        "sink.force: the gain and the bias of its connection must be finite (got (nan, 0.0))",
        "sink: there is a slave of this name already",
        "sink.force: is driven by 'source.force' already (got 'source.force')",
        "nobody.v: there is no slave 'nobody'. Known: sink, source.",
    ]


def test_a_system_without_slaves_does_not_run():
    with pytest.raises(CosimError, match="empty: has no slaves"):
        Execution(System("empty"), GaussSeidel(0.1))


def test_one_structure_serves_many_runs():
    system = parts()
    system.connect("source.force", "sink.force")
    first, second = (Execution(system, GaussSeidel(0.5)) for _ in range(2))
    with first, second:
        first.step(4)
        second.step(1)
        assert first.values(["sink.felt"])[0] == 4 * second.values(["sink.felt"])[0]
