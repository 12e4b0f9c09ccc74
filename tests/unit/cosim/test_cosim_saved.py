"""Saved states in files: what goes on in another process does so bit by bit, and what does not fit is refused."""

import hashlib
import subprocess
import sys
from pathlib import Path

import numpy as np
import oscillators
import pytest

from seacrane import fmi
from seacrane.cosim import (
    Above,
    Adaptive,
    Event,
    Execution,
    FmuSlave,
    Freeze,
    FunctionSlave,
    GaussSeidel,
    Jacobi,
    ModelSlave,
    Offset,
    Scenario,
    StepDoubling,
    System,
)
from seacrane.errors import CosimError
from seacrane.model.dae import Variable

PROGRAM = """
import sys
import numpy as np
sys.path.insert(0, {tests!r})
import test_cosim_saved as here
from seacrane.cosim import Execution

with Execution(here.mixed({folder!r}), here.ALGORITHMS[{algorithm!r}], loop={loop!r}) as run:
    run.follow(here.SCENARIO)
    run.restore_file({state!r})
    recorder = run.record()
    run.advance(2.0)
    run.flush()
    recording = recorder.recording()
    np.save({result!r}, np.column_stack([recording.time, *(recording[n] for n in recording)]))
"""

ALGORITHMS = {
    "explicit": GaussSeidel(0.01),
    "extrapolating": Jacobi(0.01, extrapolation="quadratic", conserve=True),
    "adaptive": Adaptive(GaussSeidel(0.01, extrapolation="linear"), StepDoubling(1e-5)),
}
SCENARIO = Scenario("s", (Event(0.5, Offset("one.force", 0.25)), Event(1.5, Freeze("filter.y"))))


def integral(t, h, x, u):
    following = x + h * (u - 0.1 * x)
    return following, following


def mixed(folder) -> System:
    """A native model and an FMU that swing against each other, and a Python function that integrates."""
    force, velocity = oscillators.FORCE, oscillators.VELOCITY
    one = oscillators.dae("one", oscillators.ONE, oscillators.START_ONE, [force], [velocity, oscillators.POSITION])
    two = oscillators.dae("two", oscillators.TWO, oscillators.START_TWO, [velocity], [force])
    path = f"{folder}/two.fmu"
    fmi.export(two, path)
    system = oscillators.system((ModelSlave(one), FmuSlave(path)))
    system.add("filter", FunctionSlave(integral, [Variable("u", "m")], [Variable("y", "m")], [0.0]))
    system.connect("one.position", "filter.u")
    return system


@pytest.mark.parametrize(
    ("algorithm", "loop"),
    [("explicit", "c"), ("explicit", "python"), ("extrapolating", "c"), ("adaptive", "c")],
)
def test_a_run_goes_on_from_a_file_in_a_new_process_bit_by_bit(tmp_path, algorithm, loop):
    state, result = tmp_path / "run.state", tmp_path / "result.npy"
    with Execution(mixed(tmp_path), ALGORITHMS[algorithm], loop=loop) as run:
        run.follow(SCENARIO)
        run.advance(1.0)
        run.save_file(state)
        recorder = run.record()
        run.advance(2.0)
        run.flush()
        recording = recorder.recording()
        whole = np.column_stack([recording.time, *(recording[n] for n in recording)])
    folder = str(Path(__file__).parent)
    names = {"tests": folder, "folder": str(tmp_path), "state": str(state), "result": str(result)}
    program = PROGRAM.format(**names, loop=loop, algorithm=algorithm)
    subprocess.run([sys.executable, "-c", program], check=True)
    assert whole.shape == (101, 12)
    assert np.array_equal(np.load(result), whole)


def system(gain=1.0, start=0.0) -> System:
    made = System("s")
    made.add("a", FunctionSlave(integral, [Variable("u")], [Variable("y")], [start]))
    made.add("b", FunctionSlave(integral, [Variable("u")], [Variable("y")], [0.0]))
    made.connect("a.y", "b.u", gain=gain)
    return made


@pytest.fixture
def saved(tmp_path):
    with Execution(system(), GaussSeidel(0.1)) as run:
        run.start()
        run.save_file(tmp_path / "run.state")
    return tmp_path / "run.state"


def test_a_state_of_something_else_is_refused_with_all_that_is_different(saved):
    other = system(gain=2.0, start=1.0)
    other.add("c", FunctionSlave(integral, [Variable("u")], [Variable("y")], [0.0]))
    with Execution(other, Jacobi(0.1)) as run, pytest.raises(CosimError) as caught:
        run.restore_file(saved)
    assert [p.message for p in caught.value.problems] == [
        "slave 'a': is not the same as in the saved run",
        "the connections: is not the same as in the saved run",
        "the algorithm: is not the same as in the saved run",
        "slave 'c': is in this run, but not in the saved one",
    ]


def test_another_scenario_or_another_function_of_the_same_name_is_noticed(saved):
    def integral(t, h, x, u):
        following = x + h * (u - 0.2 * x)
        return following, following

    other = System("s", {"a": FunctionSlave(integral, [Variable("u")], [Variable("y")], [0.0])})
    assert other.slaves["a"].fingerprint != system().slaves["a"].fingerprint
    with Execution(system(), GaussSeidel(0.1)) as run:
        run.follow(Scenario("late", (Event(5.0, Freeze("a.y")),)))
        with pytest.raises(CosimError, match=r"run\.state: the scenario: is not the same"):
            run.restore_file(saved)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda d: d[:-1], "is damaged or not complete: its checksum is wrong"),
        (lambda d: d[:40], "is damaged or not complete"),
        (lambda d: d[:100] + bytes([d[100] ^ 1]) + d[101:], "is damaged or not complete"),
        (lambda d: d.replace(b"seacrane-state/1", b"seacrane-state/9", 1), "is a saved state of a format that this"),
        (lambda d: b"\x89PNG\r\n", "is not a saved state"),
        (lambda d: b"", "is not a saved state"),
        (lambda d: b"seacrane-state/1\n" + hashlib.sha256(b"\x80").digest() + b"\x80", "holds no state"),
    ],
)
def test_a_damaged_or_foreign_file_is_refused_with_the_reason(saved, change, message):
    saved.write_bytes(change(saved.read_bytes()))
    with Execution(system(), GaussSeidel(0.1)) as run, pytest.raises(CosimError, match=message):
        run.restore_file(saved)


def test_files_that_cannot_be_read_or_written_are_told(tmp_path):
    with Execution(system(), GaussSeidel(0.1)) as run:
        run.start()
        with pytest.raises(CosimError, match=r"run\.state: cannot be written: No such file or directory"):
            run.save_file(tmp_path / "nowhere" / "run.state")
        with pytest.raises(CosimError, match=r"run\.state: cannot be read: No such file or directory"):
            run.restore_file(tmp_path / "run.state")


def test_a_state_of_a_run_with_other_triggers_is_refused():
    with Execution(system(), GaussSeidel(0.1)) as run:
        state = run.start().save()
        run.when(Above("a.y", 1.0), call=Freeze("a.y"))
        with pytest.raises(CosimError, match="is that of a run with other triggers"):
            run.restore(state)


def test_saving_replaces_a_file_as_a_whole(tmp_path, saved):
    with Execution(system(), GaussSeidel(0.1)) as run:
        run.step(5)
        run.save_file(saved)
    assert [p.name for p in tmp_path.iterdir()] == ["run.state"]
    with Execution(system(), GaussSeidel(0.1)) as run:
        run.restore_file(saved)
        assert run.time == 0.5
