"""Compiled models by name: setting, reading, saving, and what is said when something is wrong."""

import math
import os
import stat
from pathlib import Path

import casadi as ca
import pytest

from seacrane.errors import CompileError, ParameterError, SolveError, StructureError
from seacrane.model.codegen import value_references
from seacrane.model.dae import Dae, Variable, column
from seacrane.model.native import NativeModel, build


def spring(name: str = "spring", extra: tuple[Variable, ...] = ()) -> Dae:
    """A mass on a spring, with more parameters on demand."""
    t, x, u, none = ca.SX.sym("t"), ca.SX.sym("x", 2), ca.SX.sym("u"), ca.SX(0, 1)
    p = ca.SX.sym("p", 2 + len(extra))
    return Dae(
        name,
        (Variable("mass.x", "m", 0.1), Variable("mass.v", "m/s")),
        (),
        (Variable("force", "N"),),
        (Variable("mass.m", "kg", 2.0, minimum=0.1, maximum=100.0), Variable("k", "N/m", 50.0, minimum=0.0), *extra),
        (Variable("position", "m"),),
        (Variable("energy", "J"),),
        t, x, none, u, p,
        column(x[1], (u - p[1] * x[0]) / p[0]), none, column(x[0]), column(p[0] * x[1] ** 2 / 2 + p[1] * x[0] ** 2 / 2),
    )  # fmt: skip


@pytest.fixture(scope="module")
def model() -> NativeModel:
    return build(spring())


def test_values_are_set_and_read_by_name_or_by_value_reference(model: NativeModel) -> None:
    with model.instantiate() as run:
        run.set(["mass.m", "k"], [4.0, 100.0])
        run.set(model.value_reference("mass.x"), 0.2)
        run.initialize(0.0)
        assert run.get("der(mass.v)") == pytest.approx(-100 * 0.2 / 4)
        assert list(run.get(["position", "energy", "mass.m"])) == pytest.approx([0.2, 2.0, 4.0])


def test_more_variables_than_the_look_up_holds_are_read_and_set_in_order() -> None:
    extra = tuple(Variable(f"extra[{i}]", start=float(i)) for i in range(150))
    with build(spring("many", extra)).instantiate() as run:
        names = [v.name for v in extra]
        assert list(run.get(names)) == list(range(150))
        run.set(names[::-1], range(150))
        assert list(run.get(names)) == list(range(149, -1, -1))


def test_instances_do_not_share_anything(model: NativeModel) -> None:
    with model.instantiate() as first, model.instantiate() as second:
        first.set("k", 1.0)
        first.initialize(0.0)
        second.initialize(5.0)
        first.step(0.0, 1.0)
        assert (second.get("k"), second.get("mass.x"), second.time) == (50.0, 0.1, 5.0)


def test_a_restored_state_repeats_the_run_bit_for_bit(model: NativeModel) -> None:
    with model.instantiate() as run:
        run.initialize(0.0)
        run.step(0.0, 0.37)
        saved = run.save()
        run.set("force", 3.0)
        run.step(0.37, 0.5)
        first = run.save()
        run.restore(saved)
        assert run.time == 0.37
        run.set("force", 3.0)
        run.step(0.37, 0.5)
        assert run.save() == first
    with model.instantiate("another") as other:
        other.restore(saved)
        other.set("force", 3.0)
        other.step(0.37, 0.5)
        assert other.save() == first


def test_reset_makes_an_instance_as_new(model: NativeModel) -> None:
    with model.instantiate() as run:
        fresh = run.save()
        run.set("k", 7.0)
        run.initialize(0.0)
        run.step(0.0, 1.0)
        run.reset()
        assert run.save() == fresh


def test_a_state_of_another_model_or_a_broken_one_is_refused(model: NativeModel) -> None:
    stiffer = spring()
    changed = Dae(**{**vars(stiffer), "ode": stiffer.ode * 2})
    with model.instantiate() as run, build(changed).instantiate() as other:
        with pytest.raises(SolveError, match="belongs to another model, or to another version of this one"):
            other.restore(run.save())
        with pytest.raises(SolveError, match="3 bytes are not a state of this model"):
            run.restore(b"abc")
        with pytest.raises(SolveError, match="not the state of a model"):
            run.restore(bytes(len(run.save())))


def test_an_unknown_name_is_answered_with_the_nearest(model: NativeModel) -> None:
    with model.instantiate() as run:
        with pytest.raises(ParameterError, match=r"spring: has no variable 'mass.mm'. Did you mean 'mass.m'"):
            run.set("mass.mm", 1.0)
        with pytest.raises(ParameterError) as caught:
            run.get(["forse", "position", "enrgy"])
        assert len(caught.value.problems) == 2
        with pytest.raises(ParameterError, match="has no variable 'speed'"):
            model.value_reference("speed")


def test_a_value_out_of_bounds_names_range_and_unit_and_nothing_is_set(model: NativeModel) -> None:
    with model.instantiate() as run:
        with pytest.raises(ParameterError) as caught:
            run.set(["k", "mass.m"], [60.0, -3.0])
        assert str(caught.value) == "mass.m: cannot be -3 kg; allowed: 0.1 to 100 kg"
        assert run.get("k") == 50.0
        with pytest.raises(ParameterError, match=r"k: cannot be -1 N/m; allowed: at least 0 N/m"):
            run.set("k", -1.0)
        with pytest.raises(ParameterError, match=r"force: cannot be nan N; allowed: a finite number in N"):
            run.set("force", math.nan)
        with pytest.raises(ParameterError, match=r"solver.tolerance: cannot be 2; allowed: 1e-12 to 0.1"):
            run.set("solver.tolerance", 2.0)


def test_states_are_set_before_initialization_and_results_never(model: NativeModel) -> None:
    with model.instantiate() as run:
        with pytest.raises(ParameterError, match="position is a result and cannot be set"):
            run.set("position", 1.0)
        with pytest.raises(SolveError, match="not known before the model is initialized"):
            run.get("position")
        run.initialize(0.0)
        with pytest.raises(ParameterError, match=r"mass.x can only be set before or during initialization"):
            run.set("mass.x", 1.0)


def test_calls_out_of_order_are_refused(model: NativeModel) -> None:
    with model.instantiate() as run:
        with pytest.raises(SolveError, match="fmi2DoStep must not be called before initialization"):
            run.step(0.0, 0.1)
        run.initialize(0.0)
        with pytest.raises(SolveError, match="fmi2SetupExperiment must not be called in step mode"):
            run.initialize(0.0)
        with pytest.raises(SolveError, match=r"a step from t = 1 s was asked for, but the model is at t = 0 s"):
            run.step(1.0, 0.1)
        with pytest.raises(SolveError, match="step size -1 s is not a positive number"):
            run.step(0.0, -1.0)
    with pytest.raises(SolveError, match="spring: the instance is closed"):
        run.get("k")


def test_a_value_reference_depends_on_the_name_alone() -> None:
    few = value_references(["a.p", "b.p"])
    many = value_references(["z", "b.p", "c", "a.p"])
    assert {name: many[name] for name in few} == few
    assert value_references(["foobar"]) == {"foobar": 0xBF9CF968}  # as published for this hash


def test_names_with_the_same_hash_get_different_references_in_a_fixed_way() -> None:
    colliding = ["costarring", "liquid"]  # a known pair of the 32-bit FNV-1a hash
    references = value_references(colliding)
    assert len(set(references.values())) == 2
    assert references == value_references(colliding[::-1])
    assert references["costarring"] == value_references(["liquid"])["liquid"]


def test_start_values_that_are_not_numbers_are_refused() -> None:
    dae = spring(extra=(Variable("gap", "m", math.nan),))
    with pytest.raises(StructureError, match="gap: the start value is not a finite number"):
        build(dae)


def test_a_missing_compiler_is_named(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.delenv("CC", raising=False)
    with pytest.raises(CompileError, match="no C compiler was found; models are compiled on this machine") as caught:
        build(spring())
    assert "apt install gcc" in str(caught.value)
    monkeypatch.setenv("CC", "no-such-cc")
    with pytest.raises(CompileError, match="CC: the C compiler 'no-such-cc' was not found"):
        build(spring())


def test_a_compiler_that_fails_is_quoted_and_leaves_nothing(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    broken = tmp_path / "mycc"
    broken.write_text("#!/bin/sh\necho 'disk is full' >&2\nexit 1\n")
    broken.chmod(broken.stat().st_mode | stat.S_IXUSR)
    monkeypatch.setenv("CC", str(broken))
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    with pytest.raises(CompileError, match=r"(?s)the C compiler failed: .*mycc -std=c11 .*disk is full"):
        build(spring())
    assert not [f for _, _, files in os.walk(tmp_path / "cache") for f in files]


def test_the_same_model_is_compiled_once(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    path = build(spring("cached")).path
    assert path.is_relative_to(tmp_path)
    made = path.stat().st_mtime_ns
    assert build(spring("cached")).path.stat().st_mtime_ns == made
