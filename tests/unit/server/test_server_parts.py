"""The parts of the server that need no process: pacing, lease, shared memory, recording, limits."""

import os
import subprocess
import sys
import time

import numpy as np
import pytest

from seacrane.errors import DesignError, Problem, ServerError
from seacrane.server import limits, pacing, recording, shared
from seacrane.server.lease import LEASE, ControlLease


# ---------------------------------------------------------------- pacing
def test_simulated_time_follows_the_wall_clock_by_whole_steps():
    pacer, time = pacing.Pacer(0.002), 0.0
    pacer.begin(100.0, 0.0)
    for tick in range(1, 601):
        time += 0.002 * pacer.due(100.0 + tick * pacing.TICK, time)
        assert 0 <= tick * pacing.TICK - time + 1e-8 < 0.002 + 1e-8


def test_a_short_lag_is_caught_up_at_a_bounded_rate():
    pacer = pacing.Pacer(0.001)
    pacer.begin(0.0, 0.0)
    first = pacer.due(0.2, 0.0)
    assert first == pytest.approx(pacing.CATCH_UP * pacing.TICK / 0.001, abs=1)
    assert pacer.due(0.2, 0.18) == 20


def test_a_long_lag_is_given_up():
    pacer = pacing.Pacer(0.001)
    pacer.begin(0.0, 0.0)
    assert pacer.due(10.0, 0.0) == pytest.approx(pacing.TICK / 0.001, abs=1)
    assert pacer.due(10.0 + pacing.TICK, pacing.TICK) == pytest.approx(pacing.TICK / 0.001, abs=1)


def test_a_step_longer_than_a_tick_is_made_when_it_is_due():
    pacer, time, made = pacing.Pacer(0.05), 0.0, []
    pacer.begin(0.0, 0.0)
    for tick in range(1, 61):
        steps = pacer.due(tick * pacing.TICK, time)
        time += 0.05 * steps
        made.append(steps)
    assert sum(made) == 20
    assert max(made) == 1


def test_ticks_that_end_late_are_counted_and_their_lateness_ranked():
    pacer = pacing.Pacer(0.002)
    for _ in range(98):
        pacer.worked(0.004, 8, -0.01)
    pacer.worked(0.004, 8, 0.003)
    pacer.worked(0.004, 8, 0.005)
    assert pacer.overruns == 2
    assert pacer.late_p99 == 0.003
    assert pacer.load == pytest.approx(0.25)


# ---------------------------------------------------------------- lease
def test_only_one_client_drives():
    lease = ControlLease()
    assert lease.acquire(1, 0.0, take_over=False) is False
    with pytest.raises(ServerError, match="client 1 is driving"):
        lease.acquire(2, 1.0, take_over=False)
    assert lease.driver == 1
    assert lease.acquire(2, 1.0, take_over=True) is True
    assert lease.driver == 2


def test_a_lease_lasts_from_the_last_command():
    lease = ControlLease()
    lease.acquire(1, 0.0, take_over=False)
    lease.renew(1, 4.0)
    assert not lease.expire(4.0 + LEASE - 0.01)
    assert lease.expire(4.0 + LEASE)
    assert not lease.expire(4.0 + LEASE)
    assert lease.driver is None
    with pytest.raises(ServerError, match="nobody is driving"):
        lease.renew(1, 10.0)


def test_only_the_driver_gives_the_stick_back():
    lease = ControlLease()
    lease.acquire(1, 0.0, take_over=False)
    assert not lease.release(2)
    assert lease.driver == 1
    assert lease.release(1)


# ---------------------------------------------------------------- shared memory
@pytest.fixture
def descriptor():
    memory = shared.create()
    yield memory
    os.close(memory)


def status(time):
    return time, 1, 0, 3, 2, 0.001, 0.25, 7, 1, 0.002


def test_a_frame_is_read_as_it_was_published(descriptor):
    writer, reader = shared.Writer(descriptor), shared.Reader(descriptor)
    assert reader.state is shared.State.BUILDING
    writer.open(3, b'{"axes":[]}')
    writer.publish(np.array([1.0, -0.0, np.nan]), status(0.5))
    assert reader.state is shared.State.READY
    assert reader.open() == b'{"axes":[]}'
    frame = reader.latest()
    assert (frame.seq, frame.time, frame.running, frame.failed, frame.acknowledged) == (1, 0.5, True, False, 3)
    assert (frame.overruns, frame.late_p99, frame.load, frame.rows, frame.recording) == (2, 0.001, 0.25, 7, 1)
    assert frame.values.tobytes() == np.array([1.0, -0.0, np.nan]).tobytes()


WRITE = """
import sys, time
import numpy as np
from seacrane.server import shared
writer = shared.Writer(int(sys.argv[1]))
writer.open(2000, b"{}")
end, number = time.monotonic() + 10, 0.0
while time.monotonic() < end:
    number += 1.0
    writer.publish(np.full(2000, number), (number, 1, 0, 3, 2, 0.001, 0.25, 7, 1, 0.002))
"""


def test_no_reader_ever_sees_half_a_frame(descriptor):
    reader = shared.Reader(descriptor)
    with subprocess.Popen([sys.executable, "-c", WRITE, str(descriptor)], pass_fds=[descriptor]) as writer:
        try:
            while reader.state is shared.State.BUILDING:
                assert writer.poll() is None
            reader.open()
            frames: list[shared.Frame] = []
            deadline = time.monotonic() + 8
            while len({frame.seq for frame in frames}) < 100:
                assert time.monotonic() < deadline
                frames += [reader.latest() for _ in range(200)]
        finally:
            writer.kill()
    assert all(frame.values.min() == frame.values.max() == frame.time for frame in frames)
    sequence = [frame.seq for frame in frames]
    assert sequence == sorted(sequence)


def test_an_error_crosses_with_all_its_problems(descriptor):
    error = DesignError([Problem("boom.mass", "must be positive", -3.0, "> 0 kg"), Problem("jib", "is missing", {1})])
    shared.Writer(descriptor).refuse(shared.Failure.of(error))
    reader = shared.Reader(descriptor)
    assert reader.state is shared.State.REFUSED
    failure = reader.failure
    assert failure.code == "design"
    assert str(failure.error()) == str(error).replace("{1}", "'{1}'")


def test_an_error_too_long_for_the_memory_is_cut(descriptor):
    writer, reader = shared.Writer(descriptor), shared.Reader(descriptor)
    writer.failure = shared.Failure.of(ServerError(Problem(f"part{index}", "x" * 500) for index in range(100)))
    assert reader.failure.problems[0]["path"] == "part0"
    writer.failure = None
    assert reader.failure is None


# ---------------------------------------------------------------- recording
@pytest.fixture
def tape():
    descriptor = recording.create()
    yield recording.Tape(descriptor), descriptor
    os.close(descriptor)


def lines(descriptor, tape, columns, current=lambda: True):
    return b"".join(recording.csv_lines(descriptor, tape.rows, 2, columns, "head\n", current)).decode().splitlines()


def test_the_csv_holds_the_chosen_columns_exactly(tape):
    tape, descriptor = tape
    tape.open({"a": ("m", "m"), "b": ("m", "m")})
    table = np.column_stack([np.arange(1000) * 0.02, np.random.default_rng(1).normal(size=(1000, 2)) * 1e7])
    for part in np.array_split(table, 7):
        tape.write(part)
    text = lines(descriptor, tape, [1])
    assert text[0] == "head"
    assert (
        np.array([[float(cell) for cell in line.split(",")] for line in text[1:]]).tolist() == table[:, [0, 2]].tolist()
    )
    assert recording.last_time(descriptor, tape.rows, 2) == table[-1, 0]


def test_what_is_not_finite_is_nan_in_the_csv(tape):
    tape, descriptor = tape
    tape.open({"a": ("m", "m"), "b": ("m", "m")})
    tape.write(np.array([[0.0, np.nan, 1.0]]))
    assert lines(descriptor, tape, [0, 1]) == ["head", "0.0,nan,1.0"]


def test_a_run_that_goes_back_drops_what_came_later(tape):
    tape, descriptor = tape
    tape.open({"a": ("m", "m"), "b": ("m", "m")})
    tape.write(np.column_stack([np.arange(10.0), np.zeros((10, 2))]))
    tape.forget_after(3.0)
    tape.write(np.array([[4.0, 1.0, 1.0]]))
    assert [line.split(",")[0] for line in lines(descriptor, tape, [0])[1:]] == ["0.0", "1.0", "2.0", "3.0", "4.0"]


def test_a_download_ends_when_the_recording_is_dropped(tape):
    tape, descriptor = tape
    tape.open({"a": ("m", "m"), "b": ("m", "m")})
    tape.write(np.zeros((2000, 3)))
    assert len(lines(descriptor, tape, [0], current=lambda: False)) == 1


def test_a_full_recording_stops_and_keeps_what_it_has(tape, monkeypatch):
    tape, descriptor = tape
    monkeypatch.setattr(recording, "LIMIT", 100)
    tape.open({"a": ("m", "m"), "b": ("m", "m")})
    tape.write(np.ones((4, 3)))
    tape.write(np.ones((1, 3)))
    assert tape.stopped.startswith("it has reached its limit")
    assert tape.rows == 4
    assert len(lines(descriptor, tape, [0])) == 5


# ---------------------------------------------------------------- limits
def test_a_burst_is_served_and_a_flood_is_not():
    rate = limits.CallRate(0.0)
    served = sum(rate.allows(0.0, 0) for _ in range(5000))
    assert served == limits.CALL_BURST


def test_a_steady_client_is_always_served():
    rate = limits.CallRate(0.0)
    assert all(rate.allows(index / 400.0, 120) for index in range(20_000))


def test_large_requests_count_for_more():
    rate = limits.CallRate(0.0)
    assert sum(rate.allows(0.0, limits.MESSAGE_BYTES) for _ in range(100)) == 1
