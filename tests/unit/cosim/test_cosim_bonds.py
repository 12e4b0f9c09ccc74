import math

import pytest
from oscillators import functions, system

from seacrane.cosim import Execution, FunctionSlave, GaussSeidel, Jacobi, System
from seacrane.model.dae import Variable

RATE, STEP, UNTIL = 3.0, 0.01, 2.0


def given_motions(force_unit="N", velocity_unit="m/s") -> System:
    """A force cos(w t) and a velocity sin(w t), both prescribed: what a bond sees is known in closed form."""
    system = System("prescribed")
    force, velocity = Variable("force", "N"), Variable("velocity", "m/s")
    system.add("drive", FunctionSlave(lambda t, h, u: [math.cos(RATE * (t + h))], [velocity], [force]))
    system.add(
        "load",
        FunctionSlave(
            lambda t, h, u: [math.sin(RATE * (t + h))],
            [Variable("force", force_unit)],
            [Variable("velocity", velocity_unit)],
        ),
    )
    system.bond("rod", effort=("drive.force", "load.force"), flow=("load.velocity", "drive.velocity"))
    return system


@pytest.mark.parametrize("loop", ["c", "python"])
def test_the_residual_power_of_jacobi_is_that_of_the_closed_form(loop):
    # (f_k e_k+1 - e_k f_k+1) / 2 with e = cos, f = sin is -sin(w h) / 2 in each step.
    with Execution(given_motions(), Jacobi(STEP), loop=loop) as run:
        recording = run.run(UNTIL)
        bond = run.bonds["rod"]
    expected = -0.5 * math.sin(RATE * STEP)
    assert recording["rod.residual"][1:] == pytest.approx(expected, rel=1e-12)
    assert bond.peak_residual == pytest.approx(abs(expected), rel=1e-12)
    assert bond.energy_error == pytest.approx(expected * UNTIL, rel=1e-12)
    assert bond.energy_moved == pytest.approx(UNTIL / math.pi, rel=0.08)
    assert bond.relative_error == pytest.approx(abs(bond.energy_error) / bond.energy_moved)


@pytest.mark.parametrize("loop", ["c", "python"])
def test_the_energy_error_of_gauss_seidel_telescopes_to_the_ends(loop):
    # (e_k f_k - e_k+1 f_k+1) / 2 in each step: only the first and the last product remain.
    with Execution(given_motions(), GaussSeidel(STEP), loop=loop) as run:
        run.advance(UNTIL)
        bond = run.bonds["rod"]
    last = math.cos(RATE * UNTIL) * math.sin(RATE * UNTIL)
    assert bond.energy_error == pytest.approx(-0.5 * STEP * last, rel=1e-10)


def test_the_account_is_in_watt_whatever_the_units_of_either_side():
    system = given_motions("kN", "mm/s")
    with Execution(system, Jacobi(STEP)) as run:
        run.advance(UNTIL)
        bond = run.bonds["rod"]
    # The velocity is sin(w t) mm/s now, so all powers are a thousandth of those in m/s.
    assert bond.energy_error == pytest.approx(-0.5e-3 * math.sin(RATE * STEP) * UNTIL, rel=1e-10)


def test_the_energy_that_jacobi_creates_shrinks_with_the_step():
    def relative(step):
        with Execution(system(functions()), Jacobi(step)) as run:
            run.advance(4.0)
            return run.bonds["spring"].relative_error

    assert relative(0.002) == pytest.approx(0.5 * relative(0.004), rel=0.05)


def test_bonds_can_be_recorded_beside_the_variables():
    with Execution(system(functions()), GaussSeidel(0.01)) as run:
        run.record(["spring.energy_error", "spring.power", "one.velocity"])
        recording = run.run(0.5)
        assert recording.signal("spring.power").unit == "W"
        assert recording["spring.energy_error"][-1] == run.bonds["spring"].energy_error
