import numpy as np
import pytest

from seacrane.cosim import (
    Bond,
    Connection,
    Connector,
    Execution,
    FunctionSlave,
    GaussSeidel,
    Jacobi,
    System,
    Transformation,
)
from seacrane.errors import CosimError
from seacrane.model.dae import Variable


def reals(*names: str, unit: str = "N") -> list[Variable]:
    return [Variable(name, unit) for name in names]


def ramps(t, h, u):
    return [t + h, 10 * (t + h), 100 * (t + h)]


def copy(t, h, u):
    return u


SOURCE = FunctionSlave(ramps, outputs=reals("fx", "fy", "fz"))
SINK = FunctionSlave(copy, reals("fx", "fy", "fz"), reals("gx", "gy", "gz"))
FELT = ["sink.gx", "sink.gy", "sink.gz"]


def messages(error) -> list[str]:
    return [str(problem) for problem in error.value.problems]


def values(system, names, algorithm=None, steps=1, loop="auto"):
    with Execution(system, algorithm or GaussSeidel(1.0), loop=loop) as run:
        run.step(steps)
        return run.values(names).tolist()


@pytest.mark.parametrize("loop", ["c", "python"])
@pytest.mark.parametrize("algorithm", [GaussSeidel(1.0), Jacobi(1.0)])
def test_a_transformation_is_a_matrix_of_signals_in_both_loops(loop, algorithm):
    matrix = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.5], [0.0, 0.0, 0.0]])
    system = System("frames", {"source": SOURCE, "sink": SINK})
    system.transform(
        ["source.fx", "source.fy", "source.fz"], ["sink.fx", "sink.fy", "sink.fz"], matrix, bias=[1.0, 2.0, 3.0]
    )
    time = 3.0 if isinstance(algorithm, GaussSeidel) else 2.0
    expected = matrix @ np.array([time, 10 * time, 100 * time]) + [1.0, 2.0, 3.0]
    assert values(system, FELT, algorithm, 3, loop) == pytest.approx(expected)


def test_a_sum_converts_the_unit_of_each_of_its_signals():
    strong = FunctionSlave(lambda t, h, u: [1.0], outputs=reals("f", unit="kN"))
    system = System("sum", {"source": SOURCE, "strong": strong, "sink": SINK})
    system.transform(["source.fy", "strong.f"], ["sink.fx"], [[1.0, -2.0]])
    assert values(system, FELT[:1]) == [10.0 - 2000.0]


def test_a_moment_about_another_point_takes_a_force_times_an_arm_as_the_numbers_stand():
    arm = FunctionSlave(copy, [Variable("m", "N.m")], [Variable("felt", "N.m")])
    system = System("moment", {"source": SOURCE, "arm": arm})
    with pytest.raises(CosimError, match=r"arm.m: is in 'N.m' and cannot take 'source.fx', which is in 'N'"):
        system.transform(["source.fx"], ["arm.m"], [[3.0]])
    system.transform(["source.fx"], ["arm.m"], [[3.0]], convert=False)
    assert values(system, ["arm.felt"]) == [3.0]


def test_a_transformation_whose_matrix_does_not_fit_its_signals_is_refused():
    with pytest.raises(CosimError) as caught:
        System("wrong", {"source": SOURCE, "sink": SINK}).transform(["source.fx"], ["sink.fx"], [[1.0, 2.0]], [1, 2])
    assert messages(caught) == [
        "sink.fx: the matrix has another shape than its signals (got (1, 2)); "
        "allowed: (1, 1): a row for each target, a column for each source",
        "sink.fx: the bias has another shape than the targets (got (2,))",
    ]


def test_an_input_that_a_transformation_drives_has_no_other_source():
    system = System("twice", {"source": SOURCE, "sink": SINK})
    system.transform(["source.fx", "source.fy"], ["sink.fx"], [[1.0, 1.0]])
    with pytest.raises(CosimError, match=r"sink.fx: is driven by 'source.fx' already"):
        system.connect("source.fz", "sink.fx")


# ---------------------------------------------------------------- sub-systems
def inner() -> System:
    system = System("inner", {"first": SINK, "second": SINK})
    system.expose("pull", "first.fx", "second.fx")
    system.connect("first.gx", "second.fy", gain=2.0)
    system.expose("sum", "second.gy")
    return system


def nested() -> System:
    system = System("outer", {"source": SOURCE, "sub": inner()})
    system.connect("source.fx", "sub.pull", gain=-3.0, bias=1.0)
    return system


def test_a_sub_system_is_a_part_with_connectors_and_its_variables_keep_their_path():
    system = nested()
    assert list(system.slaves) == ["source", "sub.first", "sub.second"]
    assert system.connections == (
        Connection("source.fx", "sub.first.fx", -3.0, 1.0),
        Connection("source.fx", "sub.second.fx", -3.0, 1.0),
        Connection("sub.first.gx", "sub.second.fy", 2.0),
    )
    assert values(system, ["sub.first.gx", "sub.second.gx", "sub.second.gy"], steps=2) == [-5.0, -5.0, -10.0]
    assert system.split("sub.second.gy") == ("sub.second", "gy")


def test_a_system_that_was_added_is_taken_as_it_stood_then() -> None:
    part = inner()
    whole = System("whole", {"sub": part})
    part.connect("first.gz", "second.fz")
    taken = whole.level.parts["sub"]
    assert isinstance(taken, System)
    assert "sub.second.fz" in whole.open_inputs
    assert "second.fz" in taken.open_inputs
    assert "second.fz" not in part.open_inputs


def test_systems_nest_to_any_depth():
    whole = System("whole", {"deep": nested(), "sink": SINK})
    whole.connect("deep.sub.sum", "sink.fx")
    whole.connect("deep.sub.first.gy", "sink.fy")
    assert whole.source_of("sink.fx") == "deep.sub.second.gy"
    assert values(whole, ["sink.gx"], steps=2) == [-10.0]
    assert [name for name in whole.open_inputs if name.startswith("sink")] == ["sink.fz"]


def test_gains_biases_and_units_in_a_row_of_connections_multiply_as_they_would_one_by_one():
    system = System("in a row", {"sink": SINK}, connectors=[Connector("pull", "input", "kN")])
    system.connect("pull", "sink.fx", gain=2.0, bias=5.0)
    whole = System("whole", {"source": SOURCE, "sub": system})
    whole.connect("source.fy", "sub.pull", gain=3.0, bias=0.25)
    # 10 N = 0.01 kN; 3 * 0.01 + 0.25 = 0.28 kN; 2 * 280 + 5 = 565 N
    assert values(whole, ["sub.sink.gx"]) == pytest.approx([565.0])


def test_numbers_taken_as_they_stand_stay_so_through_a_connector():
    system = System("raw", {"sink": SINK}, connectors=[Connector("pull", "input", "kN")])
    system.connect("pull", "sink.fx", convert=False)
    whole = System("whole", {"source": SOURCE, "sub": system})
    whole.connect("source.fy", "sub.pull")
    assert values(whole, ["sub.sink.gx"]) == pytest.approx([0.01])


def test_a_signal_is_driven_once_and_read_by_many():
    system = System("bus", {"source": SOURCE, "sink": SINK}, connectors=[Connector("bus", "signal")])
    system.connect("source.fz", "bus")
    system.connect("bus", "sink.fx", "sink.fy")
    assert values(system, FELT[:2]) == [100.0, 100.0]
    with pytest.raises(CosimError, match=r"bus: is driven by 'source.fz' already"):
        system.connect("source.fx", "bus")


def test_connectors_do_not_drive_themselves():
    loop = System("loop", connectors=[Connector("a", "signal"), Connector("b", "signal")])
    loop.connect("a", "b")
    with pytest.raises(CosimError, match="a: drives itself"):
        loop.connect("b", "a")


def test_what_is_wrong_with_a_sub_systems_names_is_told_with_the_nearest():
    system = nested()
    with pytest.raises(CosimError) as caught:
        system.connect("sub.second.hx", "sub.pul", "sub.sum")
    assert messages(caught) == [
        "sub.second.hx: 'sub.second' has no such variable. "
        "Did you mean 'sub.second.gx' or 'sub.second.gz' or 'sub.second.gy'?",
        "sub.pul: 'sub' has no such variable. Did you mean 'sub.pull'?",
        "sub.sum: is an output variable; a connection must end at an input. Did you mean 'sub.pull' "
        "or 'sub.first.fz' or 'sub.first.fy' or 'sub.first.fx' or 'sub.second.fz'?",
    ]
    with pytest.raises(CosimError, match=r"sub.first.fx: is driven by 'sub.pull' already"):
        system.connect("source.fy", "sub.first.fx")


def test_an_output_of_a_system_is_connected_to_from_within_and_not_from():
    system = inner()
    with pytest.raises(CosimError, match="sum: is an output of the system itself; a connection must start at an outp"):
        system.connect("sum", "first.fz")
    with pytest.raises(CosimError, match="pull: cannot expose these"):
        inner().expose("pull", "first.fx", "first.gx")


# ---------------------------------------------------------------- bonds
def spring(t, h, x, u):
    stretch = x + h * u
    return stretch, 4.0 * stretch


def mass(t, h, x, u):
    speed = x + h * u
    return speed, speed


SPRING = FunctionSlave(spring, [Variable("v", "m/s")], [Variable("F", "N")], state=[0.0])
MASS = FunctionSlave(mass, [Variable("F", "N")], [Variable("v", "m/s")], state=[1.0])


def test_the_sign_of_a_bond_holds_for_both_directions_and_keeps_the_power():
    ends = {"effort": ("spring.F", "mass.F"), "flow": ("mass.v", "spring.v")}
    runs = []
    for sign in (1.0, -1.0):
        system = System("oscillator", {"spring": SPRING, "mass": MASS})
        system.bond("rod", **ends, gain=sign)
        assert [c.gain for c in system.connections] == [sign, sign]
        with Execution(system, GaussSeidel(0.001)) as run:
            run.step(100)
            runs.append((run.values(["mass.v"])[0], run.bonds["rod"]))
    assert runs[0][0] == pytest.approx(runs[1][0])
    assert runs[0][1].power == pytest.approx(runs[1][1].power)


def test_a_bond_leads_through_connectors_to_the_slaves():
    half = System("half", {"mass": MASS})
    half.expose("F", "mass.F")
    half.expose("v", "mass.v")
    system = System("oscillator", {"spring": SPRING, "half": half})
    system.bond("rod", effort=("spring.F", "half.F"), flow=("half.v", "spring.v"), gain=-1.0)
    assert system.bonds["rod"] == Bond("rod", ("spring.F", "half.mass.F"), ("half.mass.v", "spring.v"), -1.0)
    outer = System("outer", {"sub": system})
    with Execution(outer, GaussSeidel(0.001)) as run:
        run.step(10)
        assert run.bonds["sub.rod"].energy_moved > 0


def test_a_bond_to_a_connector_of_two_slaves_has_no_power_of_its_own():
    pair = System("pair", {"one": MASS, "two": MASS})
    pair.expose("F", "one.F", "two.F")
    pair.expose("v", "one.v")
    system = System("wrong", {"spring": SPRING, "pair": pair})
    with pytest.raises(CosimError, match=r"rod: connector 'pair.F' must lead to one slave for a bond to end there"):
        system.bond("rod", effort=("spring.F", "pair.F"), flow=("pair.v", "spring.v"))
    assert system.connections == ()


def test_a_nested_system_given_as_a_whole_tells_everything_that_is_wrong_at_once():
    with pytest.raises(CosimError) as caught:
        System(
            "wrong",
            {"source": SOURCE, "sub": inner()},
            [
                Connection("source.fx", "sub.pull"),
                Transformation.of(["source.fx", "source.fw"], ["sub.pull"], [[1.0, 1.0]]),
                Connection("sub.sum", "source.fx"),
            ],
            connectors=[Connector("source.fx", "input"), Connector("x", "input", "kgg")],
        )
    assert messages(caught) == [
        "source.fx: there is something of this name already, so it cannot be a connector",
        "x: has an unknown unit (got 'kgg'). Did you mean 'kg' or 'kg/m' or 'kg/m3' or 'kg.m2'?",
        "source.fw: slave 'source' has no such variable. Did you mean 'source.fz' or 'source.fy' or 'source.fx'?",
        "sub.pull: is driven by 'source.fx' already (got 'source.fx')",
        "source.fx: is an output variable; a connection must end at an input. There is none here.",
    ]
