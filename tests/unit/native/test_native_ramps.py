"""Inputs that a master lets run on within a communication step, along lines and parabolas."""

import ctypes
import math
from pathlib import Path

import casadi as ca
import fmpy
import pytest

from seacrane import fmi
from seacrane.errors import ParameterError
from seacrane.model.dae import Dae, Event, Variable, column
from seacrane.model.native import build

LEVEL, SLOPE, CURVATURE, STEP = 1.0, 2.0, 3.0, 0.5
END = LEVEL + SLOPE * STEP + CURVATURE * STEP**2 / 2
INTEGRAL = LEVEL * STEP + SLOPE * STEP**2 / 2 + CURVATURE * STEP**3 / 6
DOUBLE = LEVEL * STEP**2 / 2 + SLOPE * STEP**3 / 6 + CURVATURE * STEP**4 / 24


def integrators() -> Dae:
    """x'' = u twice integrated, and y = u through an algebraic unknown."""
    t, x, z, u, none = ca.SX.sym("t"), ca.SX.sym("x", 2), ca.SX.sym("z"), ca.SX.sym("u", 2), ca.SX(0, 1)
    return Dae(
        "integrators", (Variable("x"), Variable("v")), (Variable("z"),), (Variable("u"), Variable("w")), (),
        (Variable("y"),), (), t, x, z, u, none, column(x[1], z), z + z**3 - u[0] - u[0] ** 3 + 0 * u[1], z, none,
    )  # fmt: skip


def ramped(run) -> None:
    run.set(["u", "w"], [LEVEL, 7.0])
    run.set_derivatives("u", SLOPE)
    run.set_derivatives("u", CURVATURE, order=2)


def values(run) -> list[float]:
    return [run.get(name) for name in ("u", "v", "x", "y", "w")]


AFTER_ONE = pytest.approx([END, INTEGRAL, DOUBLE, END, 7.0], rel=1e-9)
AFTER_TWO = pytest.approx(
    [END, INTEGRAL + END * STEP, DOUBLE + INTEGRAL * STEP + END * STEP**2 / 2, END, 7.0], rel=1e-9
)


@pytest.mark.parametrize("explicit", [False, True], ids=["rodas4", "runge-kutta"])
def test_a_parabola_is_integrated_exactly_and_ends_with_its_step(explicit: bool) -> None:
    with build(integrators()).instantiate() as run:
        run.set("solver.tolerance", 1e-10)
        if explicit:
            run.step_explicitly(4, 0.01)
        run.initialize(0.0)
        ramped(run)
        run.step(0.0, STEP)
        assert values(run) == AFTER_ONE
        run.step(STEP, STEP)
        assert values(run) == AFTER_TWO


def test_a_ramp_is_part_of_a_saved_state() -> None:
    with build(integrators()).instantiate() as run:
        run.initialize(0.0)
        ramped(run)
        saved = run.save()
        run.step(0.0, STEP)
        first = values(run)
        run.restore(saved)
        run.step(0.0, STEP)
        assert values(run) == first
        run.restore(saved)
        run.set("u", LEVEL + 1.0)  # a value set later moves the ramp, and does not end it
        run.step(0.0, STEP)
        assert run.get("u") == pytest.approx(END + 1.0)


def test_a_master_in_c_gives_derivatives_through_the_address_it_is_given() -> None:
    native = build(integrators())
    derive = ctypes.CFUNCTYPE(
        ctypes.c_int, ctypes.c_void_p, ctypes.c_void_p, ctypes.c_size_t, ctypes.c_void_p, ctypes.c_void_p
    )(native.calls.derive)
    with native.instantiate() as run:
        run.set("solver.tolerance", 1e-10)
        run.initialize(0.0)
        run.set(["u", "w"], [LEVEL, 7.0])
        reference = native.value_reference("u")
        references, orders = (ctypes.c_uint32 * 2)(reference, reference), (ctypes.c_int * 2)(1, 2)
        assert derive(run.handle, references, 2, orders, (ctypes.c_double * 2)(SLOPE, CURVATURE)) == 0
        run.step(0.0, STEP)
        assert values(run) == AFTER_ONE


def test_what_is_no_derivative_of_an_input_is_refused_with_the_reason() -> None:
    with build(integrators()).instantiate() as run:
        run.initialize(0.0)
        for name, value, order, told in (
            ("u", 1.0, 3, r"inputs have derivatives of order 1 and 2; u was given one of order 3"),
            ("x", 1.0, 1, r"x is no input and has no input derivative"),
            ("u", math.nan, 1, r"the time derivative of u is not a finite number"),
        ):
            with pytest.raises(ParameterError, match=told):
                run.set_derivatives(name, value, order)
        run.step(0.0, STEP)
        assert run.get("u") == 0.0


@pytest.fixture(scope="module")
def fmu(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return fmi.export(integrators(), tmp_path_factory.mktemp("ramps") / "integrators.fmu")


def test_an_exported_fmu_takes_ramps_from_another_importer_and_tells_how_fast_its_output_moves(fmu: Path) -> None:
    description = fmpy.read_model_description(str(fmu))
    assert description.coSimulation.canInterpolateInputs
    assert description.coSimulation.maxOutputDerivativeOrder == 1
    references = {v.name: v.valueReference for v in description.modelVariables}
    slave = fmpy.instantiate_fmu(fmpy.extract(str(fmu)), description, "CoSimulation")
    slave.setupExperiment(startTime=0.0, tolerance=1e-10)
    slave.enterInitializationMode()
    slave.exitInitializationMode()
    slave.setReal([references["u"], references["w"]], [LEVEL, 7.0])
    slave.setRealInputDerivatives([references["u"]] * 2, [1, 2], [SLOPE, CURVATURE])
    slave.doStep(0.0, STEP)
    watched = [references[name] for name in ("u", "v", "x", "y", "w")]
    assert list(slave.getReal(watched)) == AFTER_ONE
    rate = slave.getRealOutputDerivatives([references["y"]], [1])
    assert list(rate) == pytest.approx([SLOPE + CURVATURE * STEP])
    slave.doStep(STEP, STEP)
    assert list(slave.getReal(watched)) == AFTER_TWO
    assert list(slave.getRealOutputDerivatives([references["y"]], [1])) == pytest.approx([0.0], abs=1e-12)
    slave.terminate()
    slave.freeInstance()


def test_an_event_within_a_ramped_step_is_where_the_parabola_passes() -> None:
    t, u, p, none = ca.SX.sym("t"), ca.SX.sym("u"), ca.SX.sym("p"), ca.SX(0, 1)
    dae = Dae(
        "watch", (), (), (Variable("u"),), (), (), (), t, none, none, u, p, none, none, none, none,
        modes=(Variable("at"),), events=(Event("passes", u - 2.0, {"at": t}),),
    )  # fmt: skip
    with build(dae).instantiate() as run:
        run.initialize(0.0)
        run.set("u", LEVEL)
        run.set_derivatives("u", SLOPE)
        run.set_derivatives("u", CURVATURE, order=2)
        run.step(0.0, STEP)
        exact = (-SLOPE + math.sqrt(SLOPE**2 + 2 * CURVATURE)) / CURVATURE
        assert run.get("at") == pytest.approx(exact, abs=1e-11)
