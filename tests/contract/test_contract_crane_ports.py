"""Ship, crane and control fit together by name and unit, so that a plant can connect them without a table."""

import pytest

from seacrane import cosim, design, multibody, vessel
from seacrane.control import Joystick


@pytest.fixture(scope="module")
def crane():
    return design.load("offshore-100t")


@pytest.fixture(scope="module")
def mechanics(crane):
    return multibody.crane_mechanics(crane)


def units(variables, prefix=""):
    return {v.name.removeprefix(prefix): v.unit for v in variables if v.name.startswith(prefix)}


def test_the_foot_of_the_ship_is_the_base_of_the_crane(mechanics):
    for ship in (vessel.Fixed(), vessel.Harmonic()):
        assert units(ship.model((0.0, 0.0, 0.0)).outputs, "foot.") == units(mechanics.inputs, "base.")


def test_the_wrench_of_the_crane_goes_into_the_ship(mechanics):
    assert units(mechanics.outputs, "wrench.") == units(vessel.INPUTS, "wrench.")


def test_what_the_control_measures_the_crane_gives(crane, mechanics):
    given = units(mechanics.outputs)
    inputs = Joystick.of(crane, rope=(38.0, 300.0)).inputs
    measured = units(v for v in inputs if v.name != "deadman" and not v.name.startswith("axis."))
    assert measured.items() <= given.items()


def test_the_control_runs_as_a_slave_and_can_be_started_again(crane):
    joystick = Joystick.of(crane, rope=(38.0, 300.0))
    system = cosim.System("control")
    system.add("joystick", cosim.FunctionSlave(joystick, joystick.inputs, joystick.outputs, state=joystick.start))
    run = cosim.Execution(system, cosim.GaussSeidel(step=0.01))
    try:
        run.start()
        run.set("joystick.axis.slew", -1.0)
        run.set("joystick.deadman", 1.0)
        run.step(20)
        assert run.values(["joystick.spool.slew"])[0] == pytest.approx(-0.5 * 0.2)
        run.set("joystick.deadman", 0.0)
        run.step(20)
        assert run.values(["joystick.spool.slew"])[0] == 0.0
    finally:
        run.close()
