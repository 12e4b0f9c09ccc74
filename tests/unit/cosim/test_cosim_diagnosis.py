"""Diagnosing a coupling: loop gains against their closed form, verdicts on weak and on stiff couplings."""

import json

import numpy as np
import oscillators
import pytest
from oscillators import dae, exact

from seacrane.cosim import Execution, FunctionSlave, GaussSeidel, ModelSlave, System, diagnose
from seacrane.errors import CosimError
from seacrane.model.dae import Variable
from seacrane.results import Recording, Signal

STEPS = [0.004, 0.008, 0.016, 0.032]
FORCE, VELOCITY = Variable("force", "N"), Variable("velocity", "m/s")


def mass_and_spring(stiffness: float, mass: float = 2.0) -> System:
    """A moving mass that a spring, cut from it, pulls back."""
    a = np.array([[0.0, 0.0], [1.0, 0.0]])
    moved = dae("mass", (a, np.array([[-1 / mass], [0.0]]), np.array([[1.0, 0.0]])), [0.5, 0.0], [FORCE], [VELOCITY])
    spring = dae("spring", (np.zeros((1, 1)), np.ones((1, 1)), np.array([[stiffness]])), [0.0], [VELOCITY], [FORCE])
    system = System("cut", {"mass": ModelSlave(moved), "spring": ModelSlave(spring)})
    system.bond("rod", effort=("spring.force", "mass.force"), flow=("mass.velocity", "spring.velocity"))
    return system


@pytest.mark.parametrize("step", [0.001, 0.01])
def test_the_loop_gain_of_a_mass_on_a_spring_is_minus_the_square_of_step_times_frequency(step):
    with Execution(mass_and_spring(800.0), GaussSeidel(0.01)) as run:
        run.start().step(3)
        before = run.values(["mass.velocity", "spring.force", "rod.energy"])
        gain = run.loop_gains(step, {"spring.force": 10.0, "mass.velocity": 0.5})["rod"]
        assert gain == pytest.approx(-800.0 / 2.0 * step**2, rel=1e-4)
        assert np.array_equal(run.values(["mass.velocity", "spring.force", "rod.energy"]), before)


def test_measuring_loop_gains_does_not_change_the_run():
    ends = []
    for measured in (False, True):
        with Execution(oscillators.system(oscillators.models()), GaussSeidel(0.01)) as run:
            run.start().step(20)
            if measured:
                run.loop_gains(0.02, {"two.force": 1.0, "one.velocity": 1.0})
            run.step(20)
            ends.append(run.values(["one.position", "two.force", "spring.energy_error"]))
    assert np.array_equal(*ends)


@pytest.fixture(scope="module")
def weak():
    return diagnose(oscillators.system(oscillators.models()), until=2.0, steps=STEPS)


def test_a_weak_coupling_is_not_called_stiff_and_orders_are_those_of_the_algorithms(weak):
    assert [b.stiff for b in weak.bonds] == [False]
    assert "It is not stiff" in str(weak)
    for name, order in (("jacobi", 1), ("gauss-seidel", 1), ("jacobi-linear", 2), ("newton", 2)):
        assert weak.order(name) == pytest.approx(order, abs=0.15)


def test_the_loop_gain_grows_with_the_square_of_the_step_for_masses_and_springs(weak):
    gains = weak.bonds[0].gains
    assert gains[0.032] / gains[0.016] == pytest.approx(4.0, rel=0.1)


def test_what_is_recommended_keeps_the_tolerance_and_nothing_that_keeps_it_is_much_cheaper(weak):
    best = weak.recommended
    assert best.error <= weak.tolerance
    kept = [t for t in weak.trials if t.error <= weak.tolerance]
    assert best.cpu_s <= 1.2 * min(t.cpu_s for t in kept)
    assert f"take {best.algorithm} with a macro step of {1e3 * best.step:g} ms" in " ".join(str(weak).split())


def test_errors_are_the_same_against_the_closed_form_given_as_a_recording(weak):
    times = np.arange(0.0, 2.1, 0.032)
    with Execution(oscillators.system(oscillators.models()), GaussSeidel(0.0001, extrapolation="linear")) as run:
        recorder = run.record(["one.position", "one.velocity", "two.force"], every=0.032)
        run.run(2.1)
        fine = recorder.recording()
    assert np.abs(fine["one.position"][: times.size] - exact(times)).max() < 1e-6
    given = diagnose(
        oscillators.system(oscillators.models()), until=2.0, steps=STEPS, algorithms=["jacobi"], reference=fine
    )
    for own, other in zip(weak.of("jacobi"), given.of("jacobi"), strict=True):
        assert other.error == pytest.approx(own.error, rel=0.02)


@pytest.fixture(scope="module")
def stiff():
    # A soft oscillation of 0.2 Hz, and at the cut a spring that makes 5 Hz of a light mass: order of the steps.
    a = np.array([[0.0, 1.0, 0.0], [-40.0 / 20.0, -2.0, 0.0], [0.0, 0.0, 0.0]])
    light = dae("light", (np.array([[-8.0]]), np.array([[1 / 0.5]]), np.ones((1, 1))), [0.0], [FORCE], [VELOCITY])
    b = np.array([[0.0], [0.0], [1.0]])
    base = dae("base", (a, b, np.array([[300.0, 0.0, -300.0]])), [0.5, 0.0, 0.5], [VELOCITY], [FORCE])
    system = System("stiff", {"light": ModelSlave(light), "base": ModelSlave(base)})
    system.bond("rod", effort=("base.force", "light.force"), flow=("light.velocity", "base.velocity"))
    return diagnose(system, until=3.0, steps=[0.01 * 2**i for i in range(4)], tolerance=0.05)


def test_a_stiff_coupling_is_named_with_the_step_at_which_its_gain_is_one(stiff):
    limiting = stiff.limiting
    assert limiting.name == "rod"
    assert limiting.stiff
    assert limiting.critical == pytest.approx(np.sqrt(0.5 / 300.0), rel=0.2)
    said = " ".join(str(stiff).split())
    assert "The bond rod limits the step" in said
    assert "It is stiff" in said
    assert "jacobi" in said
    assert "unstable at" in said


def test_a_run_that_has_left_all_bounds_is_ended_and_called_unstable():
    # Gauss-Seidel of a mass on a spring diverges above gain 4: here 16, and 1 with the shorter step.
    found = diagnose(mass_and_spring(800.0), until=40.0, steps=[0.05, 0.2], algorithms=["gauss-seidel"])
    held, lost = found.of("gauss-seidel")
    assert held.stable
    assert not lost.stable
    assert "times its range away from the reference" in lost.failure
    assert lost.sweeps < 0.2 * held.sweeps * 0.05 / 0.2


def test_without_an_iterated_run_nothing_is_said_of_stiffness():
    driven = diagnose(mass_and_spring(800.0), until=1.0, steps=[0.05, 0.1], algorithms=["gauss-seidel"])
    assert max(driven.bonds[0].gains.values()) > 1
    assert "Whether it is stiff was not measured" in " ".join(str(driven).split())


def test_all_that_was_measured_goes_to_json_and_the_picture_is_drawn(stiff, tmp_path):
    found = json.loads(json.dumps(stiff.as_dict(), allow_nan=False))
    assert found["limiting_bond"] == "rod"
    assert found["stiff"] == ["rod"]
    assert len(found["trials"]) == 24
    stiff.figure().savefig(tmp_path / "stiff.svg")
    assert (tmp_path / "stiff.svg").stat().st_size > 10_000


class Unsaved(FunctionSlave):
    def instantiate(self, name):
        instance = super().instantiate(name)

        def save():
            raise CosimError.at(name, "cannot be saved")

        instance.save = save
        return instance


def test_slaves_that_cannot_be_brought_back_are_diagnosed_without_what_needs_that():
    one, two = (Unsaved(s.function, s.inputs, s.outputs, s.state) for s in oscillators.functions())
    found = diagnose(oscillators.system((one, two)), until=1.0, steps=STEPS[:2], algorithms=["gauss-seidel", "newton"])
    assert list(found.left_out) == ["newton"]
    assert "cannot be saved" in found.left_out["newton"]
    assert "Gauss-Seidel" in found.reference
    assert any("loop gains were not measured" in note for note in found.notes)
    assert found.limiting.name == "spring"


def test_signals_without_bonds_are_compared_as_well():
    one, two = oscillators.models()
    system = System("signals", {"two": two, "one": one})
    system.connect("two.force", "one.force")
    system.connect("one.velocity", "two.velocity")
    found = diagnose(system, until=1.0, steps=STEPS[:2], algorithms=["gauss-seidel", "power-residual"])
    assert found.bonds == ()
    assert "power-residual" in found.left_out
    assert found.of("gauss-seidel")[0].error < found.of("gauss-seidel")[1].error


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        ({"steps": [0.01]}, "until: is not given, or not after the start"),
        ({"until": 1.0}, "steps: are not given, and the system does not say its macro step"),
        ({"until": 1.0, "steps": [0.01], "tolerance": 0.0}, "tolerance: must be positive"),
        ({"until": 1.0, "steps": [0.003, 0.004]}, "does not divide the longest step"),
        ({"until": 1.0, "steps": [0.01], "algorithms": ["jakobi"]}, "Did you mean 'jacobi"),
    ],
)
def test_what_cannot_be_diagnosed_is_refused_with_the_reason(arguments, says):
    with pytest.raises(CosimError, match=says):
        diagnose(oscillators.system(oscillators.models()), **arguments)


def test_a_system_at_rest_says_that_nothing_moves():
    mass = mass_and_spring(10.0)
    still = Recording(
        np.linspace(0.0, 2.0, 3),
        {n: Signal(u, u, np.zeros(3)) for n, u in (("spring.force", "N"), ("mass.velocity", "m/s"))},
    )
    with pytest.raises(CosimError, match="nothing moves at its couplings"):
        diagnose(mass, until=1.0, steps=[0.01], reference=still)
