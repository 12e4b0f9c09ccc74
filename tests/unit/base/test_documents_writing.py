"""Files appear whole or not at all; what is no file is written to."""

import errno
import os
import threading
from pathlib import Path

import pytest

from seacrane import documents


def test_a_file_is_replaced_only_by_a_whole_one_and_nothing_is_left_beside_it(tmp_path: Path) -> None:
    target = tmp_path / "chart.csv"
    target.write_text("old")
    with pytest.raises(ZeroDivisionError), documents.whole(target) as part:
        part.write_text(f"half a file, then {1 / 0}")
    assert target.read_text() == "old"
    documents.write("new", target)
    assert target.read_text() == "new"
    assert [file.name for file in tmp_path.iterdir()] == ["chart.csv"]


def test_a_link_stays_a_link_to_the_new_file(tmp_path: Path) -> None:
    (tmp_path / "real.csv").write_text("old")
    link = tmp_path / "link.csv"
    link.symlink_to("real.csv")
    documents.write("new", link)
    assert link.is_symlink()
    assert (tmp_path / "real.csv").read_text() == "new"


def test_a_pipe_is_written_to_and_stays_a_pipe(tmp_path: Path) -> None:
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    read: list[str] = []
    reader = threading.Thread(target=lambda: read.append(pipe.read_text()))
    reader.start()
    documents.write("radius_m,swl_t\n", pipe)
    reader.join(30)
    assert read == ["radius_m,swl_t\n"]
    assert pipe.is_fifo()


def test_a_file_that_cannot_be_written_is_named_as_it_was_given(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError) as caught:
        documents.write("text", tmp_path / "nowhere" / "chart.csv")
    assert caught.value.filename == str(tmp_path / "nowhere" / "chart.csv")


def test_a_failure_to_read_another_file_keeps_its_name(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError) as caught, documents.whole(tmp_path / "copy.csv"):
        (tmp_path / "source.csv").read_bytes()
    assert caught.value.filename == str(tmp_path / "source.csv")


@pytest.mark.skipif(not Path("/dev/full").is_char_device(), reason="there is no full device")
def test_a_full_disk_is_told_with_the_name_of_the_file() -> None:
    with pytest.raises(OSError, match="No space") as caught:
        documents.write("text", "/dev/full")
    assert (caught.value.errno, caught.value.filename) == (errno.ENOSPC, "/dev/full")
    assert Path("/dev/full").is_char_device()
