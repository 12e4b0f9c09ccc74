"""Arrow streams that are written live, what is left of them after a crash, and what they are turned into."""

import os
import resource
import signal
import subprocess
import sys
import textwrap
from contextlib import suppress

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from seacrane.errors import ParameterError
from seacrane.results import Recording, StreamWriter, convert

SIGNALS = {"pump.p": ("Pa", "bar"), "cylinder.x": ("m", "mm")}


def rows(first: int, count: int) -> np.ndarray:
    t = 0.01 * np.arange(first, first + count)
    return np.column_stack([t, 1e5 * np.sin(t), t**2])


def written(path, batches=8, per_batch=50):
    writer = StreamWriter(path, SIGNALS)
    for i in range(batches):
        writer.write(rows(i * per_batch, per_batch))
        writer.flush()
    writer.close()
    return rows(0, batches * per_batch)


def table_of(recording: Recording) -> np.ndarray:
    return np.column_stack([recording.time, *(recording[name] for name in recording)])


def test_a_stream_reads_back_exactly_with_its_units(tmp_path):
    table = written(tmp_path / "run.arrow")
    recording = Recording.read(tmp_path / "run.arrow")
    assert np.array_equal(table_of(recording), table)
    signals = recording.signals
    assert {n: (s.unit, s.display) for n, s in signals.items()} == SIGNALS


@pytest.mark.parametrize("suffix", [".parquet", ".csv"])
def test_a_stream_is_converted_exactly(tmp_path, suffix):
    table = written(tmp_path / "run.arrow")
    done = convert(tmp_path / "run.arrow", tmp_path / f"run{suffix}")
    assert (done.rows, done.signals, done.complete) == (400, 2, True)
    recording = Recording.read(tmp_path / f"run{suffix}")
    assert np.array_equal(table_of(recording), table)
    assert [s.unit for s in recording.signals.values()] == ["Pa", "m"]
    assert sorted(p.name for p in tmp_path.iterdir()) == ["run.arrow", f"run{suffix}"]


def test_pandas_and_others_find_units_in_the_parquet_file(tmp_path):
    written(tmp_path / "run.arrow")
    convert(tmp_path / "run.arrow", tmp_path / "run.parquet")
    schema = pq.read_schema(tmp_path / "run.parquet")
    assert schema.field("pump.p").metadata[b"unit"] == b"Pa"
    assert schema.field("pump.p").metadata[b"display"] == b"bar"
    assert schema.metadata[b"format"] == b"seacrane-recording/1"


def test_a_stream_cut_off_anywhere_gives_all_its_complete_batches(tmp_path):
    whole = tmp_path / "run.arrow"
    table = written(whole, batches=4)
    data, cut = whole.read_bytes(), tmp_path / "cut.arrow"
    lengths, sizes = set(), range(0, len(data), 7)
    readable = []
    for size in sizes:
        cut.write_bytes(data[:size])
        with suppress(ParameterError):
            recording = Recording.read(cut)
            readable.append(size)
            assert np.array_equal(table_of(recording), table[: len(recording)])
            lengths.add(len(recording))
    assert readable == [size for size in sizes if size >= readable[0]]
    assert lengths == {0, 50, 100, 150, 200}
    done = convert(cut, tmp_path / "cut.parquet")
    assert (done.complete, done.rows) == (False, 200)


def test_rows_later_than_a_time_are_taken_out_of_the_file(tmp_path):
    writer = StreamWriter(tmp_path / "run.arrow", SIGNALS)
    for i in range(4):
        writer.write(rows(50 * i, 50))
        writer.flush()
    writer.forget_after(1.2)
    writer.write(rows(300, 10))
    writer.flush()
    time = Recording.read(tmp_path / "run.arrow").time
    assert time.tolist() == [*rows(0, 121)[:, 0], *rows(300, 10)[:, 0]]
    writer.forget_after(-1.0)
    writer.write(rows(7, 1))
    writer.close()
    assert np.array_equal(table_of(Recording.read(tmp_path / "run.arrow")), rows(7, 1))


def test_a_process_that_is_killed_leaves_what_it_has_handed_over(tmp_path):
    path = tmp_path / "run.arrow"
    program = textwrap.dedent(
        f"""
        import time
        import numpy as np
        from seacrane.results import StreamWriter
        writer = StreamWriter({str(path)!r}, {{f"s.y{{i}}": ("Pa", "bar") for i in range(100)}})
        begun, done = time.monotonic(), 0
        while True:
            time.sleep(0.01)
            now = int((time.monotonic() - begun) * 1000)
            table = np.repeat(np.arange(done, now)[:, None] * 1e-3, 101, axis=1)
            done = now
            if len(table):
                writer.write(table)
            print(now * 1e-3, flush=True)
        """
    )
    with subprocess.Popen([sys.executable, "-c", program], stdout=subprocess.PIPE, text=True) as process:
        reached = 0.0
        while reached < 1.5:
            reached = float(process.stdout.readline())
        process.send_signal(signal.SIGKILL)
        last = max([reached, *map(float, process.stdout.read().split())])
        process.wait()
    recording = Recording.read(path)
    assert recording.time[-1] > last - 1.0
    assert np.array_equal(recording.time, np.arange(len(recording)) * 1e-3)
    assert np.array_equal(recording["s.y99"], recording.time)
    done = convert(path, tmp_path / "run.parquet")
    assert (done.complete, done.rows, done.signals) == (False, len(recording), 100)


def test_a_disk_that_fills_up_is_told_and_what_fitted_is_kept(tmp_path):
    """A limit on the size of files stands for the disk: writing beyond it fails in the middle of a batch."""
    path = tmp_path / "run.arrow"
    program = textwrap.dedent(
        f"""
        import resource, signal
        import numpy as np
        from seacrane.results import StreamWriter
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        resource.setrlimit(resource.RLIMIT_FSIZE, (100_000, 100_000))
        writer = StreamWriter({str(path)!r}, {{"s.y": ("Pa", "bar")}})
        random = np.random.default_rng(1)
        for i in range(100):
            table = random.normal(size=(500, 2))
            table[:, 0] = np.arange(500 * i, 500 * (i + 1))
            try:
                writer.write(table)
                writer.flush()
            except OSError as error:
                print(i, error.strerror)
                break
        try:
            writer.close()
        except OSError as error:
            print(error.strerror)
        """
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    count, *reason = done.stdout.split(maxsplit=1)
    assert "File too large" in reason[0]
    assert 5 < int(count) < 100
    assert Recording.read(path).time.tolist() == [float(i) for i in range(500 * int(count))]


def test_a_conversion_that_fails_leaves_the_old_file(tmp_path, monkeypatch):
    written(tmp_path / "run.arrow", batches=1, per_batch=20_000)
    target = tmp_path / "run.parquet"
    target.write_bytes(b"old")
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    before = signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (10_000, hard))
    try:
        with pytest.raises(ParameterError, match=r"run\.parquet: cannot be written"):
            convert(tmp_path / "run.arrow", target)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
        signal.signal(signal.SIGXFSZ, before)
    assert target.read_bytes() == b"old"
    assert sorted(p.name for p in tmp_path.iterdir()) == ["run.arrow", "run.parquet"]


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="needs a device that is always full")
def test_a_file_that_cannot_be_begun_is_told_at_once():
    with pytest.raises(OSError, match="No space left"):
        StreamWriter("/dev/full", SIGNALS)


def test_files_of_others_are_read_if_they_say_their_units(tmp_path):
    table = pa.table({"time [s]": [0, 1, 2], "pressure [bar]": pa.array([1.0, 2.0, 3.0], pa.float32())})
    pq.write_table(table, tmp_path / "theirs.parquet")
    with pa.ipc.new_file(tmp_path / "theirs.arrow", table.schema) as writer:
        writer.write_table(table)
    for name in ("theirs.parquet", "theirs.arrow"):
        recording = Recording.read(tmp_path / name)
        assert recording.time.tolist() == [0.0, 1.0, 2.0]
        assert (recording.signal("pressure").unit, recording["pressure"].tolist()) == ("bar", [1.0, 2.0, 3.0])


def test_all_columns_that_are_wrong_are_told_at_once(tmp_path):
    table = pa.table({"t": [0.0], "a": [1.0], "b [bra]": [1.0], "c [m]": ["x"], "d [m]": [1.0], "d": [1.0]})
    pq.write_table(table, tmp_path / "wrong.parquet")
    with pytest.raises(ParameterError) as caught:
        Recording.read(tmp_path / "wrong.parquet")
    messages = [p.message for p in caught.value.problems]
    assert messages == [
        "the first column is not the time",
        "a column has no unit",
        "column 'b' has an unknown unit",
        "column 'c [m]' does not hold numbers",
        "a column has no unit",
    ]


@pytest.mark.parametrize(
    "content", [b"", b"\xff\xff\xff\xff\x10", b"PAR1 but no more", b"ARROW1\0\0", b"\x89PNG\r\n\xfa"]
)
def test_what_is_no_recording_is_refused(tmp_path, content):
    (tmp_path / "file").write_bytes(content)
    with pytest.raises(ParameterError, match=r"is not a recording|has no complete header"):
        Recording.read(tmp_path / "file")
    with pytest.raises(ParameterError, match="cannot be read: No such file"):
        Recording.read(tmp_path / "nothing")


def test_a_target_that_makes_no_sense_is_refused(tmp_path):
    written(tmp_path / "run.arrow")
    with pytest.raises(ParameterError, match=r"is of no kind to convert to; allowed: a name in \.parquet or \.csv"):
        convert(tmp_path / "run.arrow", tmp_path / "run.xls")
    convert(tmp_path / "run.arrow", tmp_path / "run.csv")
    with pytest.raises(ParameterError, match="is the file to be converted"):
        convert(tmp_path / "run.csv", tmp_path / "run.csv")
    with pytest.raises(ParameterError, match=r"run\.csv: cannot be written: No such file or directory"):
        convert(tmp_path / "run.arrow", tmp_path / "nowhere" / "run.csv")
