import os
import signal
import subprocess
import sys
import textwrap
import time

import numpy as np
import pytest

from seacrane.cosim import Above, Execution, FunctionSlave, GaussSeidel, System
from seacrane.errors import CosimError
from seacrane.model.dae import Variable
from seacrane.results import Recording


def clock() -> System:
    return System("clock", {"clock": FunctionSlave(lambda t, h, u: [t + h], outputs=[Variable("t", "s")])})


@pytest.mark.parametrize("loop", ["c", "python"])
def test_rows_come_at_the_chosen_rate_beyond_the_room_of_the_loop(loop):
    with Execution(clock(), GaussSeidel(0.001), loop=loop) as run:
        coarse = run.record(every=0.25)
        fine = run.record(["clock.t"])
        run.run(10.0)
    assert coarse.recording().time.tolist() == [0.25 * i for i in range(41)]
    recording = fine.recording()
    assert len(recording) == 10_001
    assert recording["clock.t"] == pytest.approx(recording.time, rel=1e-12)


@pytest.mark.parametrize(
    ("every", "allowed"),
    [
        (0.015, "0.01 or 0.02 s"),
        (0.005, "0.01 s"),
        (0.0101, "0.01 or 0.02 s"),
        (1e-9, "0.01 s"),
        (7.123, "7.12 or 7.13 s"),
    ],
)
def test_a_rate_that_is_no_multiple_of_the_macro_step_is_refused_with_the_nearest(tmp_path, every, allowed):
    with Execution(clock(), GaussSeidel(0.01)) as run:
        for record in (run.record, lambda **how: run.record_file(tmp_path / "x.csv", **how)):
            with pytest.raises(CosimError) as caught:
                record(every=every)
            assert f"is no multiple of the macro step of 0.01 s (got {every})" in str(caught.value)
            assert f"allowed: {allowed}, for example" in str(caught.value)


@pytest.mark.parametrize(("step", "every", "rows"), [(0.1, 0.3, 11), (1e-3 / 3, 1e-3, 1001), (0.007, 0.7, 2)])
def test_a_multiple_is_one_whatever_the_rounding_of_the_step(step, every, rows):
    with Execution(clock(), GaussSeidel(step)) as run:
        recorder = run.record(every=every)
        run.run(every * (rows - 1) - step / 10)
        assert len(recorder.recording()) == rows


def test_a_recorder_may_keep_only_the_last_seconds():
    with Execution(clock(), GaussSeidel(0.001)) as run:
        recorder = run.record(keep=0.5)
        run.run(20.0)
        assert sum(len(chunk) for chunk in recorder._chunks) < 6000
    assert recorder.recording().time[[0, -1]].tolist() == [19.5, 20.0]


def test_a_recorder_made_in_the_middle_begins_there():
    with Execution(clock(), GaussSeidel(0.1)) as run:
        run.advance(1.0)
        recorder = run.record()
        run.advance(1.5)
        run.flush()
    assert recorder.recording().time.tolist() == [1.0, 1.1, 1.2, 1.3, 1.4, 1.5]


def test_the_csv_file_holds_exactly_what_memory_holds(tmp_path):
    with Execution(clock(), GaussSeidel(0.003)) as run:
        recorder = run.record()
        run.record_csv(tmp_path / "run.csv")
        run.advance(5.0)
    ours, file = recorder.recording(), Recording.read_csv(tmp_path / "run.csv")
    assert np.array_equal(ours.time, file.time)
    assert np.array_equal(ours["clock.t"], file["clock.t"])
    assert len(file) == 1668


def test_the_rows_before_a_failure_are_in_the_file(tmp_path):
    def fails(t, h, u):
        return [1 / (0.5 - t) if t != 0.5 else float("inf")]

    run = Execution(System("s", {"f": FunctionSlave(fails, outputs=[Variable("y")])}), GaussSeidel(0.125))
    run.record_csv(tmp_path / "run.csv")
    with pytest.raises(CosimError):
        run.advance(2.0)
    assert Recording.read_csv(tmp_path / "run.csv").time.tolist() == [0.0, 0.125, 0.25, 0.375, 0.5]


def test_a_file_that_cannot_be_written_is_told_at_once(tmp_path):
    run = Execution(clock(), GaussSeidel(0.1))
    with pytest.raises(CosimError, match=r"nowhere.run\.csv: cannot be written: No such file or directory"):
        run.record_csv(tmp_path / "nowhere" / "run.csv")


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="needs a device that is always full")
def test_a_full_disk_is_told_and_the_run_may_go_on():
    with Execution(clock(), GaussSeidel(0.1)) as run:
        with pytest.raises(CosimError, match="/dev/full: cannot be written: No space left on device"):
            run.record_csv("/dev/full")
        run.step()
        assert run.time == 0.1


# A writer on a thread of its own may have to wait for the machine, hence the margin.
@pytest.mark.parametrize(("name", "lost"), [("run.csv", 0.25), ("run.arrow", 0.5), ("run.parquet", 0.5)])
def test_a_killed_run_leaves_a_readable_file_that_lacks_a_quarter_of_a_second_at_most(tmp_path, name, lost):
    path = tmp_path / name
    program = textwrap.dedent(
        f"""
        from seacrane.cosim import Execution, FunctionSlave, GaussSeidel, RealTime, System
        from seacrane.model.dae import Variable
        slave = FunctionSlave(lambda t, h, u: [t + h] * 50, outputs=[Variable(f"y{{i}}", "s") for i in range(50)])
        run = Execution(System("s", {{"f": slave}}), GaussSeidel(0.002))
        run.record_file({str(path)!r})
        pacing = RealTime(run)
        while True:
            pacing.advance(run.time + 0.02)
            print(run.time, flush=True)
        """
    )
    with subprocess.Popen([sys.executable, "-c", program], stdout=subprocess.PIPE, text=True) as process:
        reached = 0.0
        while reached < 1.0:
            reached = float(process.stdout.readline())
        process.send_signal(signal.SIGKILL)
        killed = time.monotonic()
        last = max([reached, *map(float, process.stdout.read().split())])
        process.wait()
    assert time.monotonic() - killed < 5
    recording = Recording.read(f"{path}.arrow" if name == "run.parquet" else path)
    assert recording.time[-1] >= last - lost
    assert len(recording.names) == 50
    assert recording["f.y49"] == pytest.approx(recording.time, rel=1e-12)


# ---------------------------------------------------------------- files in columns, and recording on conditions
@pytest.mark.parametrize("name", ["run.arrow", "run.parquet", "run.csv"])
def test_a_file_holds_exactly_what_memory_holds_whatever_its_kind(tmp_path, name):
    with Execution(clock(), GaussSeidel(0.003)) as run:
        recorder = run.record()
        run.record_file(tmp_path / name)
        run.advance(5.0)
    ours, file = recorder.recording(), Recording.read(tmp_path / name)
    assert np.array_equal(ours.time, file.time)
    assert np.array_equal(ours["clock.t"], file["clock.t"])
    assert [path.name for path in tmp_path.iterdir()] == [name]


def test_a_run_that_went_back_has_only_what_happened_in_its_arrow_file(tmp_path):
    with Execution(clock(), GaussSeidel(0.125)) as run:
        run.record_file(tmp_path / "run.arrow")
        run.advance(1.0)
        state = run.save()
        run.advance(3.0)
        run.restore(state)
        run.advance(2.0)
    assert Recording.read(tmp_path / "run.arrow").time.tolist() == [0.125 * i for i in range(17)]


def test_all_rows_before_a_failure_can_be_read_at_once_from_an_arrow_file(tmp_path):
    def fails(t, h, u):
        return [0.0 if t < 0.5 else float("nan")]

    run = Execution(System("s", {"f": FunctionSlave(fails, outputs=[Variable("y")])}), GaussSeidel(0.125))
    run.record_file(tmp_path / "run.arrow")
    with pytest.raises(CosimError, match=r"f\.y: is not finite in the step from t = 0\.5 to 0\.625 s"):
        run.advance(2.0)
    assert Recording.read(tmp_path / "run.arrow").time.tolist() == [0.0, 0.125, 0.25, 0.375, 0.5]


def test_a_file_of_no_known_kind_is_refused(tmp_path):
    with pytest.raises(CosimError, match=r"run\.xls: is of no kind of file to record into; allowed: a name that ends"):
        Execution(clock(), GaussSeidel(0.1)).record_file(tmp_path / "run.xls")
    with pytest.raises(CosimError, match=r"run\.arrow: cannot be written: No such file or directory"):
        Execution(clock(), GaussSeidel(0.1)).record_file(tmp_path / "nowhere" / "run.arrow")


@pytest.mark.parametrize("loop", ["c", "python"])
def test_recording_begins_and_ends_when_conditions_come_to_hold(loop):
    saw = FunctionSlave(lambda t, h, u: [(t + h) % 1.0], outputs=[Variable("y")])
    with Execution(System("s", {"saw": saw}), GaussSeidel(0.125), loop=loop) as run:
        recorder = run.record(begin=Above("saw.y", 0.3), end=Above("saw.y", 0.7))
        run.advance(2.25)
        run.flush()
    assert recorder.recording().time.tolist() == [0.375, 0.5, 0.625, 0.75, 1.375, 1.5, 1.625, 1.75]


def test_a_recording_that_holds_to_its_end_lasts_from_the_start():
    with Execution(clock(), GaussSeidel(0.25)) as run:
        recorder = run.record(end=Above("clock.t", 0.6))
        run.advance(2.0)
    assert recorder.recording().time.tolist() == [0.0, 0.25, 0.5, 0.75]


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="needs a device that is always full")
def test_a_recorder_that_fails_keeps_nothing_from_the_others_and_hides_no_fault(tmp_path):
    """The file is opened, and a full device put in its place afterwards."""

    def fails(t, h, u):
        return [0.0 if t < 0.5 else float("nan")]

    run = Execution(System("s", {"f": FunctionSlave(fails, outputs=[Variable("y")])}), GaussSeidel(0.125))
    broken = run.record_file(tmp_path / "run.csv")
    memory = run.record()
    full = os.open("/dev/full", os.O_WRONLY)
    os.dup2(full, broken._descriptor)
    os.close(full)
    with pytest.raises(CosimError) as caught:
        run.advance(2.0)
    assert [str(p) for p in caught.value.problems] == [
        "f.y: is not finite in the step from t = 0.5 to 0.625 s (got nan)",
        f"{tmp_path / 'run.csv'}: cannot be written: No space left on device",
    ]
    assert run.error is caught.value
    assert memory.recording().time.tolist() == [0.0, 0.125, 0.25, 0.375, 0.5]


def test_a_pause_in_the_last_step_does_not_hold_up_the_next_call():
    with Execution(clock(), GaussSeidel(0.25)) as run:
        run.when(Above("clock.t", 0.9), call=lambda r: r.pause())
        run.run(1.0)
        run.run(2.0)
        assert run.time == 2.0
