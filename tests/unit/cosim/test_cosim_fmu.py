import os
import zipfile

import numpy as np
import pytest
from oscillators import FORCE, ONE, POSITION, START_ONE, START_TWO, TWO, VELOCITY, dae, exact, models, system

from seacrane import fmi
from seacrane.cosim import (
    Adaptive,
    Execution,
    FmuSlave,
    GaussSeidel,
    Iterative,
    Jacobi,
    Newton,
    StepDoubling,
    System,
)
from seacrane.errors import CosimError, FmuError, ParameterError


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    folder = tmp_path_factory.mktemp("fmus")
    one = dae("one", ONE, START_ONE, [FORCE], [VELOCITY, POSITION])
    two = dae("two", TWO, START_TWO, [VELOCITY], [FORCE])
    return tuple(fmi.export(d, folder / f"{d.name}.fmu") for d in (one, two))


@pytest.fixture(scope="module")
def exported(files, tmp_path_factory):
    folder = tmp_path_factory.mktemp("fmi3")
    one = dae("one", ONE, START_ONE, [FORCE], [VELOCITY, POSITION])
    two = dae("two", TWO, START_TWO, [VELOCITY], [FORCE])
    newer = tuple(fmi.export(d, folder / f"{d.name}.fmu", version="3.0") for d in (one, two))
    return {"2.0": files, "3.0": newer}


def slaves(files):
    return tuple(FmuSlave(file, {"solver.tolerance": 1e-10}) for file in files)


@pytest.mark.parametrize("algorithm", [GaussSeidel(0.003), Jacobi(0.003)])
def test_fmus_give_the_same_bits_in_both_loops_and_as_the_models_they_were_exported_from(files, algorithm):
    tables = []
    for joined, loop in (
        (system(slaves(files)), "c"),
        (system(slaves(files)), "python"),
        (system(models()), "c"),
    ):
        with Execution(joined, algorithm, loop=loop) as run:
            recording = run.run(2.0)
            tables.append(np.column_stack([recording[name] for name in recording]))
    assert np.array_equal(tables[0], tables[1])
    assert np.array_equal(tables[0], tables[2])


@pytest.mark.parametrize(
    "algorithm",
    [
        GaussSeidel(0.01, "derived", extrapolation="quadratic"),
        Iterative(GaussSeidel(0.01, extrapolation="linear"), Newton(), tolerance=1e-9),
        Adaptive(Jacobi(0.02), StepDoubling(1e-2)),
    ],
    ids=["extrapolated", "newton", "doubling"],
)
@pytest.mark.parametrize(("version", "kind"), [("2.0", "co-simulation"), ("2.0", "model-exchange"), ("3.0", None)])
def test_fmus_of_all_kinds_can_be_extrapolated_to_and_brought_back(exported, version, kind, algorithm):
    tables = []
    for loop in ("c", "python"):
        joined = system(tuple(FmuSlave(file, kind=kind, tolerance=1e-9) for file in exported[version]))
        with Execution(joined, algorithm, loop=loop) as run:
            recording = run.run(0.4)
            tables.append(recording["one.position"])
    assert np.array_equal(*tables)
    assert np.abs(tables[0] - exact(recording.time)).max() < 3e-3


def test_an_fmu_is_read_with_units_start_values_and_internal_variables(files):
    slave = FmuSlave(files[0], {"x0": 0.25})
    assert [(v.name, v.unit) for v in slave.interface.outputs] == [("velocity", "m/s"), ("position", "m")]
    assert slave.left_out == ()
    with Execution(System("s", {"one": slave}), GaussSeidel(0.01)) as run:
        run.record(["one.position", "one.sum", "one.x0"])
        recording = run.run(0.1)
    assert recording["one.position"][0] == 0.25
    assert np.array_equal(recording["one.x0"], recording["one.position"])
    assert recording["one.sum"][-1] != recording["one.x0"][-1]


def test_a_run_of_fmus_is_restored_exactly(files):
    with Execution(system(slaves(files)), GaussSeidel(0.01)) as run:
        run.advance(0.5)
        state = run.save()
        whole = run.run(1.0)
        run.restore(state)
        again = run.run(1.0)
    for name in whole:
        assert np.array_equal(again[name], whole[name])


def test_wrong_parameters_of_an_fmu_are_told_at_once(files):
    with pytest.raises(ParameterError) as caught:
        FmuSlave(files[0], {"solver.tolerance": 1.0, "stiffness": 2.0})
    assert [str(problem).split(":")[0] for problem in caught.value.problems] == [
        "one.fmu.solver.tolerance",
        "one.fmu.stiffness",
    ]


def test_a_state_is_no_parameter_of_a_running_fmu(files):
    with Execution(System("s", {"one": FmuSlave(files[0])}), GaussSeidel(0.01)) as run:
        run.step()
        run.set("one.solver.tolerance", 1e-6)
        with pytest.raises(CosimError, match=r"one\.x0: is a watchable variable and cannot be set"):
            run.set("one.x0", 1.0)


def test_an_fmu_that_diverges_names_itself_with_the_reason(files, tmp_path):
    unstable = dae("unstable", (np.array([[5000.0]]), np.array([[1.0]]), np.array([[1.0]])), [1.0], [FORCE], [POSITION])
    slave = FmuSlave(fmi.export(unstable, tmp_path / "unstable.fmu"))
    run = Execution(System("s", {"u": slave}), GaussSeidel(0.1))
    with pytest.raises(CosimError, match=r"u: failed with status '\w+' when stepping in the step from t = .* s: .+"):
        run.advance(10.0)
    run.close()


def test_the_private_folder_is_gone_with_the_last_run(files):
    slave = FmuSlave(files[0])
    lone = System("s", {"one": slave})
    first, second = Execution(lone, GaussSeidel(0.01)), Execution(lone, GaussSeidel(0.01))
    folder = first._plan.parts[0].instance.inner.fmu.folder
    first.step()
    first.close()
    second.step()
    assert folder.exists()
    second.close()
    assert not folder.exists()
    with Execution(lone, GaussSeidel(0.01)) as third:
        third.step()
        assert third.values(["one.position"])[0] != START_ONE[0]


def test_loading_and_freeing_again_and_again_keeps_the_memory(files):
    def cycle():
        with Execution(system(slaves(files)), GaussSeidel(0.01)) as run:
            run.step()

    def resident() -> int:
        with open("/proc/self/statm") as file:
            return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE")

    for _ in range(20):
        cycle()
    before = resident()
    for _ in range(100):
        cycle()
    # A library that stays loaded costs 0.1 MB a cycle.
    assert resident() - before < 4_000_000


def test_a_unit_of_another_name_is_known_by_its_definition_and_an_unknown_one_leaves_the_variable_out(files, tmp_path):
    path = tmp_path / "foreign.fmu"
    with zipfile.ZipFile(files[0]) as ours, zipfile.ZipFile(path, "w") as foreign:
        for info in ours.infolist():
            text = ours.read(info)
            if info.filename == "modelDescription.xml":
                text = text.replace(b'"m/s"', b'"Meter.Sec-1"').replace(b'name="N"', b'name="degC"')
                text = text.replace(b'unit="N"', b'unit="degC"').replace(
                    b'kg="1" m="1" s="-2"', b'K="1" offset="273.15"'
                )
            foreign.writestr(info, text)
    slave = FmuSlave(path)
    assert [(v.name, v.unit) for v in slave.interface.outputs] == [("velocity", "m/s"), ("position", "m")]
    assert slave.left_out == ("force",)


def test_a_file_that_is_no_fmu_is_refused(tmp_path):
    (tmp_path / "x.fmu").write_text("no archive")
    with pytest.raises(FmuError, match=r"x\.fmu"):
        FmuSlave(tmp_path / "x.fmu")
