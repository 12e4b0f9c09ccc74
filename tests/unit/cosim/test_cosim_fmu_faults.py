"""What an FMU may do to a run: an FMU in C, against the headers of the standard, that does what it is told."""

import subprocess
import zipfile
from contextlib import nullcontext
from pathlib import Path

import fmpy
import numpy as np
import pytest

from seacrane.cosim import (
    Adaptive,
    Execution,
    FmuSlave,
    FunctionSlave,
    GaussSeidel,
    Jacobi,
    PowerResidual,
    StepDoubling,
    System,
)
from seacrane.errors import CosimError
from seacrane.fmi.logs import kept_back
from seacrane.model.dae import Variable
from seacrane.native import compiler
from seacrane.results import Recording

VARIABLES = ["y", "status", "when", "value", "work", "longest"]
LOOPS = pytest.mark.parametrize("loop", ["c", "python"])


CONTROLS = pytest.mark.parametrize("control", [StepDoubling(), PowerResidual(10.0)], ids=["doubling", "residual"])


@pytest.fixture(scope="module")
def fmu(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return make_fmu(tmp_path_factory.mktemp("faulty"), saves=True)


@pytest.fixture(scope="module")
def forgetful(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The same, but that its state cannot be saved."""
    return make_fmu(tmp_path_factory.mktemp("forgetful"), saves=False)


def make_fmu(folder: Path, saves: bool) -> Path:
    saved = 'canGetAndSetFMUstate="true" canSerializeFMUstate="true"' if saves else ""
    scalars = "".join(
        f'<ScalarVariable name="{name}" valueReference="{i}" '
        + ('causality="output"><Real/>' if name == "y" else 'causality="parameter" variability="tunable">')
        + ("" if name == "y" else '<Real start="1e9"/>' if name in ("when", "longest") else '<Real start="0"/>')
        + "</ScalarVariable>"
        for i, name in enumerate(VARIABLES)
    )
    (folder / "modelDescription.xml").write_text(
        '<?xml version="1.0" encoding="UTF-8"?>'
        '<fmiModelDescription fmiVersion="2.0" modelName="faulty" guid="{1}" numberOfEventIndicators="0">'
        '<CoSimulation modelIdentifier="faulty" canHandleVariableCommunicationStepSize="true" '
        f"{saved}/>"
        f"<ModelVariables>{scalars}</ModelVariables>"
        '<ModelStructure><Outputs><Unknown index="1"/></Outputs>'
        '<InitialUnknowns><Unknown index="1"/></InitialUnknowns></ModelStructure></fmiModelDescription>'
    )
    headers = Path(fmpy.__file__).parent / "c-code"
    source = Path(__file__).with_name("faulty.c")
    command = [*compiler(), "-O1", "-Wall", "-Wextra", "-shared", "-fPIC", f"-I{headers}", str(source)]
    subprocess.run([*command, "-o", str(folder / "faulty.so"), "-lm"], check=True)
    with zipfile.ZipFile(folder / "faulty.fmu", "w") as archive:
        archive.write(folder / "modelDescription.xml", "modelDescription.xml")
        archive.write(folder / "faulty.so", "binaries/linux64/faulty.so")
    return folder / "faulty.fmu"


def system(fmu: Path, **parameters: float) -> System:
    clock = FunctionSlave(lambda t, h, u: [t + h], outputs=[Variable("t", "s")])
    return System("s", {"clock": clock, "pump": FmuSlave(fmu, parameters)})


@LOOPS
@pytest.mark.parametrize(
    ("fault", "message"),
    [
        ({"status": 2}, "pump: failed with status 'discard' when stepping {}: the pump has no oil"),
        ({"status": 3}, "pump: failed with status 'error' when stepping {}: the pump has no oil"),
        ({"status": 4}, "pump: failed with status 'fatal' when stepping {}: the pump has no oil"),
        ({"value": 1.0}, "pump.y: is not finite {} (got nan)"),
    ],
)
def test_a_fault_of_an_fmu_ends_the_run_with_its_words_and_keeps_what_was_recorded(fmu, tmp_path, loop, fault, message):
    with Execution(system(fmu, when=0.7, **fault), GaussSeidel(0.125), loop=loop) as run:
        run.record_file(tmp_path / "run.arrow")
        with pytest.raises(CosimError) as caught:
            run.advance(2.0)
        recording = Recording.read(tmp_path / "run.arrow")
    assert str(caught.value) == message.format("in the step from t = 0.625 to 0.75 s")
    assert recording.time.tolist() == recording["pump.y"].tolist() == [0.125 * i for i in range(6)]
    assert run.error is caught.value


@LOOPS
@pytest.mark.parametrize("fault", [{"status": 2}, {"value": 1.0}])
def test_a_run_goes_on_from_an_earlier_state_once_the_fault_is_mended(fmu, loop, fault):
    with Execution(system(fmu, when=0.7, **fault), GaussSeidel(0.125), loop=loop) as run:
        run.advance(0.5)
        state = run.save()
        with pytest.raises(CosimError):
            run.advance(2.0)
        run.restore(state)
        run.set("pump.when", 1e9)
        run.advance(2.0)
        assert (run.error, run.values(["pump.y"])[0]) == (None, 2.0)


@pytest.mark.parametrize("silent", [False, True])
def test_what_an_fmu_says_can_be_kept_out_of_the_log_and_is_in_the_error_all_the_same(fmu, caplog, silent):
    with (
        Execution(system(fmu, when=0.7, status=2), GaussSeidel(0.125)) as run,
        kept_back() if silent else nullcontext(),
        pytest.raises(CosimError, match="the pump has no oil"),
    ):
        run.advance(2.0)
    assert [r.getMessage() for r in caplog.records] == (
        [] if silent else ["pump: the pump has no oil [logStatusError]"]
    )


def test_an_fmu_that_is_held_stays_loaded_from_run_to_run(fmu):
    slave = FmuSlave(fmu)
    with slave.held():
        folders = set()
        for _ in range(2):
            with Execution(System("s", {"pump": slave}), GaussSeidel(0.125)) as run:
                folders.add(run._plan.parts[0].instance.inner.fmu.folder)
                run.advance(1.0)
                assert run.values(["pump.y"])[0] == 1.0
    assert len(folders) == 1
    assert not folders.pop().exists()


@LOOPS
def test_an_fmu_that_takes_too_long_is_named(fmu, loop, caplog):
    with (
        Execution(system(fmu, when=0.7, work=1.0), GaussSeidel(0.125), loop=loop, time_limit=0.4) as run,
        pytest.raises(CosimError, match=r"pump: took too long in the step from t = 0\.625 to 0\.75 s"),
    ):
        run.advance(2.0)
    assert caplog.messages[0].startswith("pump: has been at work for ")


def with_bond(fmu: Path, **parameters: float) -> System:
    """With a coupling beside the FMU whose residual power steps can follow."""
    given = system(fmu, **parameters)
    force, velocity = Variable("force", "N"), Variable("velocity", "m/s")
    given.add("drive", FunctionSlave(lambda t, h, u: [np.sin(9.0 * (t + h))], [velocity], [force]))
    given.add("load", FunctionSlave(lambda t, h, u: [1.0], [force], [velocity]))
    given.bond("rod", effort=("drive.force", "load.force"), flow=("load.velocity", "drive.velocity"))
    return given


@CONTROLS
@LOOPS
def test_a_step_that_an_fmu_discards_is_done_again_with_a_smaller_size_where_it_may(fmu, loop, control):
    adaptive = Adaptive(GaussSeidel(0.125), control, smallest=1e-3)
    with Execution(with_bond(fmu, longest=0.02), adaptive, loop=loop) as run:
        run.record(["pump.y", "rejected", "macro_step"])
        recording = run.run(1.0)
    assert recording["pump.y"] == pytest.approx(recording.time, abs=1e-12)
    assert recording["rejected"][-1] > 0
    assert recording["macro_step"].max() <= 0.04  # whole steps of step doubling are given up if halves are kept
    with (
        Execution(with_bond(fmu, longest=0.02), GaussSeidel(0.125), loop=loop) as run,
        pytest.raises(CosimError, match=r"pump: failed with status 'discard' when stepping .*: the step is too long"),
    ):
        run.advance(1.0)


@CONTROLS
def test_repeated_steps_give_the_same_bits_in_both_loops(fmu, control):
    tables = []
    for loop in ("c", "python"):
        algorithm = Adaptive(Jacobi(0.125, extrapolation="linear"), control, smallest=1e-3)
        with Execution(with_bond(fmu, longest=0.02), algorithm, loop=loop) as run:
            run.record([*run.variables.keys() & {"pump.y", "drive.force"}, "rejected", "macro_step", "coupling_error"])
            recording = run.run(1.0)
        assert recording["rejected"][-1] > 0
        tables.append(np.column_stack([recording[name] for name in sorted(recording)]))
    assert np.array_equal(*tables)


@LOOPS
def test_a_discarded_step_ends_the_run_where_a_slave_cannot_be_brought_back(fmu, forgetful, loop):
    given = with_bond(fmu, longest=0.02, when=0.7)
    given.add("other", FmuSlave(forgetful))
    with Execution(given, Adaptive(GaussSeidel(0.125), PowerResidual(10.0), smallest=1e-3), loop=loop) as run:
        recorder = run.record(["pump.y"])
        with pytest.raises(
            CosimError, match=r"pump: failed with status 'discard' when stepping in the step from t = 0 "
        ):
            run.advance(1.0)
        assert recorder.recording().time.tolist() == [0.0]
    with (
        Execution(given, Adaptive(GaussSeidel(0.125), StepDoubling()), loop=loop) as run,
        pytest.raises(CosimError, match="other: cannot be saved and restored, which Adaptive needs"),
    ):
        run.start()


@CONTROLS
@LOOPS
def test_a_step_that_is_discarded_at_any_size_ends_the_run(fmu, loop, control):
    adaptive = Adaptive(GaussSeidel(0.125), control, smallest=1e-3)
    with Execution(with_bond(fmu, status=2, when=0.7), adaptive, loop=loop) as run:
        recorder = run.record()
        with pytest.raises(
            CosimError, match=r"pump: failed with status 'discard' when stepping in the step from t = 0.625"
        ):
            run.advance(1.0)
        assert recorder.recording().time.tolist() == [0.125 * i for i in range(6)]
