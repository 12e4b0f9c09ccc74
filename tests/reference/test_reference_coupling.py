"""Coupling algorithms against whole solutions: two oscillators in closed form, a cylinder drive cut at the rod, and a
load that runs against an end stop, where the macro step has to follow the motion.

Orders and factors are those measured; the page on algorithms quotes them.
"""

import importlib
import sys
from pathlib import Path

import casadi as ca
import numpy as np
import pytest
from scipy.integrate import solve_ivp

from seacrane.cosim import (
    Adaptive,
    Execution,
    GaussSeidel,
    Iterative,
    Jacobi,
    ModelSlave,
    Newton,
    PowerResidual,
    System,
)
from seacrane.library import mechanics as mech
from seacrane.library import signals as sig
from seacrane.model import Diagram, simulate
from seacrane.model.dae import Dae, Variable
from seacrane.units import GRAVITY

ROOT = Path(__file__).parents[2]


def borrowed(folder: Path, name: str):
    sys.path.insert(0, str(folder))
    try:
        return importlib.import_module(name)
    finally:
        sys.path.remove(str(folder))


oscillators = borrowed(ROOT / "tests" / "unit" / "cosim", "oscillators")
cylinder = borrowed(ROOT / "examples" / "dissertation", "cylinder")


def orders(errors):
    return np.log2(np.divide(errors[:-1], errors[1:]))


def rms(values) -> float:
    return float(np.sqrt(np.mean(np.square(values))))


ALGORITHMS = {
    "jacobi": (Jacobi, 1),
    "gauss-seidel": (GaussSeidel, 1),
    "jacobi-linear": (lambda h: Jacobi(h, extrapolation="linear"), 2),
    "gauss-seidel-linear": (lambda h: GaussSeidel(h, extrapolation="linear"), 2),
    "implicit": (lambda h: Iterative(GaussSeidel(h), tolerance=1e-9), 1),
    "implicit-linear": (lambda h: Iterative(GaussSeidel(h, extrapolation="linear"), Newton(), tolerance=1e-9), 2),
}
ORDER = pytest.mark.parametrize(("algorithm", "order"), ALGORITHMS.values(), ids=ALGORITHMS)


# ---------------------------------------------------------------- two oscillators
def oscillation_error(algorithm, until=4.0) -> float:
    with Execution(oscillators.system(oscillators.models()), algorithm) as run:
        run.record(["one.position"], every=0.16)
        recording = run.run(until)
    return rms(recording["one.position"] - oscillators.exact(recording.time))


@ORDER
def test_oscillators_converge_to_the_closed_form_with_the_order_of_the_algorithm(algorithm, order):
    errors = [oscillation_error(algorithm(step)) for step in (0.008, 0.004, 0.002)]
    assert orders(errors) == pytest.approx(order, abs=0.1)


@pytest.mark.parametrize("base", [Jacobi, GaussSeidel])
def test_conserving_what_a_bond_exchanges_raises_the_order_to_two(base):
    errors = [oscillation_error(base(step, conserve=True)) for step in (0.008, 0.004, 0.002)]
    assert orders(errors) == pytest.approx(2.0, abs=0.1)


def test_a_parabola_between_iterated_points_is_of_third_order():
    errors = [
        oscillation_error(Iterative(GaussSeidel(h, extrapolation="quadratic"), Newton(), tolerance=1e-11))
        for h in (0.016, 0.008, 0.004)
    ]
    assert orders(errors) == pytest.approx(3.0, abs=0.1)


# ---------------------------------------------------------------- a cylinder drive, whole and cut at the rod
DRIVE = cylinder.Drive()


def circuit(name: str):
    """Pump, valve, lines and cylinder, with the spool moved as a sine."""
    drive = Diagram(name, bulk_modulus=1e9)
    valve, part = cylinder.add_circuit(drive, DRIVE)
    command = drive.add("command", sig.Sine(amplitude=0.4, period=2.0, unit="1"))
    drive.connect(command.y, valve.x)
    return drive, part


def whole_drive() -> Diagram:
    drive, part = circuit("whole")
    mass = drive.add("mass", mech.Mass(mass=DRIVE.load, gravity=GRAVITY))
    drive.connect(part.rod, mass.flange)
    return drive


def cut_drive() -> System:
    """The same as two slaves: the mass takes the force of the rod and gives its velocity."""
    drive, part = circuit("drive")
    partner = drive.add("partner", mech.MotionInput(position=DRIVE.start, correction=0.0))
    drive.connect(partner.flange, part.rod)
    drive.expose(velocity=partner.v, position=partner.x, force=partner.F)
    load = Diagram("load")
    mass = load.add("mass", mech.Mass(mass=DRIVE.load, gravity=GRAVITY))
    push = load.add("push", mech.ForceInput(position=DRIVE.start))
    load.connect(mass.flange, push.flange)
    load.expose(force=push.F, velocity=push.v, position=push.x)
    system = System("cut")
    for name, diagram in (("drive", drive), ("load", load)):
        system.add(name, ModelSlave(diagram, {"solver.tolerance": 1e-9}))
    system.connect("load.position", "drive.position")
    system.bond("rod", effort=("drive.force", "load.force"), flow=("load.velocity", "drive.velocity"))
    return system


@pytest.fixture(scope="module")
def drives():
    monolithic = simulate(whole_drive(), 2.0, every=0.02, record=["cylinder.extension"], tolerance=1e-10)
    return cut_drive(), monolithic["cylinder.extension"]


def drive_error(drives, algorithm) -> float:
    system, monolithic = drives
    with Execution(system, algorithm) as run:
        run.record(["load.position"], every=0.02)
        return rms(run.run(2.0)["load.position"] - monolithic)


@ORDER
def test_a_drive_cut_at_the_rod_converges_to_the_monolithic_solution(drives, algorithm, order):
    errors = [drive_error(drives, algorithm(step)) for step in (0.001, 0.0005)]
    assert orders(errors) == pytest.approx(order, abs=0.15)
    assert errors[-1] < (1e-4 if order == 1 else 1e-6)


def test_an_iterated_drive_is_as_close_as_its_tolerance(drives):
    errors = [
        drive_error(drives, Iterative(GaussSeidel(0.001, extrapolation="quadratic"), Newton(), tolerance=tolerance))
        for tolerance in (1e-3, 1e-6)
    ]
    assert errors[1] < errors[0]
    assert errors[1] < 1e-7


# ---------------------------------------------------------------- an end stop
MASS, STOP, SPRING, DAMPER = 2000.0, 4e8, 8e3, 500.0  # kg, N/m^1.5, N/m, N s/m
GAP, START, UNTIL = 0.1, -0.3, 10.0
"""The load starts 0.4 m from the stop, which it meets three times for some 20 ms each."""


class FinelyStepped(ModelSlave):
    """Runge-Kutta 4 at 0.1 ms inside, so that the macro step alone makes the error."""

    def instantiate(self, name):
        instance = super().instantiate(name)
        instance.inner.step_explicitly(4, 1e-4)
        return instance


def against_a_stop() -> System:
    none = ca.SX(0, 1)
    x, force, t = ca.SX.sym("x", 2), ca.SX.sym("force"), ca.SX.sym("t")
    outputs = (Variable("velocity", "m/s"), Variable("position", "m"))
    load = Dae(
        "load", (Variable("x", start=START), Variable("v")), (), (Variable("force", "N"),), (), outputs, (), t, x, none,
        force, none, ca.vertcat(x[1], (-force - SPRING * x[0] - DAMPER * x[1]) / MASS), none, ca.vertcat(x[1], x[0]),
        none,
    )  # fmt: skip
    y, velocity, s = ca.SX.sym("y"), ca.SX.sym("velocity"), ca.SX.sym("s")
    stop = Dae(
        "stop", (Variable("y", start=START),), (), (Variable("velocity", "m/s"),), (), (Variable("force", "N"),), (), s,
        y, none, velocity, none, +velocity, none, STOP * ca.fmax(y - GAP, 0) ** 1.5, none,
    )  # fmt: skip
    system = System("stop", {"load": FinelyStepped(load), "stop": FinelyStepped(stop)})
    system.bond("contact", effort=("stop.force", "load.force"), flow=("load.velocity", "stop.velocity"))
    return system


@pytest.fixture(scope="module")
def stopped():
    def motion(t, y):
        return [y[1], (-STOP * max(y[0] - GAP, 0.0) ** 1.5 - SPRING * y[0] - DAMPER * y[1]) / MASS]

    times = np.arange(501) * 0.02
    options = {"method": "DOP853", "rtol": 1e-11, "atol": 1e-13, "max_step": 1e-3, "t_eval": times}
    return against_a_stop(), solve_ivp(motion, (0.0, UNTIL), [START, 0.0], **options).y[0]


def stop_error(stopped, algorithm) -> tuple[float, int]:
    system, exact = stopped
    with Execution(system, algorithm) as run:
        run.record(["load.position"], every=0.02)
        recording = run.run(UNTIL)
        return rms(recording["load.position"] - exact), run.usage.sweeps


def test_control_by_residual_power_beats_fixed_steps_of_equal_cost_where_stiffness_changes(stopped):
    adaptive, cost = stop_error(stopped, Adaptive(Jacobi(0.005), PowerResidual(1e-3), smallest=1e-5))
    assert cost < 2500
    # 13 mm in 2340 sweeps; a fixed step of twice the sweeps gives 0.25 m, and of forty times the sweeps 7 mm.
    fixed, sweeps = stop_error(stopped, Jacobi(0.002))
    assert sweeps > 2 * cost
    assert fixed > 10 * adaptive
    close, sweeps = stop_error(stopped, Jacobi(0.0001))
    assert sweeps > 40 * cost
    assert close > adaptive / 3


def test_a_fixed_gauss_seidel_step_is_the_better_choice_where_it_is_symplectic(stopped):
    # With a constant step the errors of an undamped swing cancel over its period; a step that varies gives that up.
    adaptive, cost = stop_error(stopped, Adaptive(GaussSeidel(0.005), PowerResidual(1e-4), smallest=1e-5))
    fixed, sweeps = stop_error(stopped, GaussSeidel(0.0025))
    assert sweeps < 2 * cost
    assert fixed < adaptive / 10
