"""Simulation state in memory shared by two processes: one writes, one reads, neither waits.

The memory is an anonymous file that both hold open, so it is gone with the last of them, however they end. It holds
a header, two slots of one frame each, and the description of the model. The writer fills the slot that is not
current and then makes it current by advancing a sequence number; a reader that finds the number changed while it
copied reads again (a sequence lock over a double buffer).
"""

from __future__ import annotations

import mmap
import os
from dataclasses import dataclass
from enum import IntEnum
from typing import Any, Final

import msgspec
import numpy as np
import numpy.typing as npt

from seacrane.errors import Problem, SeacraneError, ServerError

_HEADER_BYTES: Final = 16384
_ERROR_AT: Final = 4096
_ERROR_BYTES: Final = _HEADER_BYTES - _ERROR_AT


class State(IntEnum):
    """How far the simulation process is."""

    BUILDING = 0
    READY = 1
    REFUSED = 2


class Failure(msgspec.Struct, frozen=True):
    """An error as it crosses the process boundary."""

    code: str
    problems: list[dict[str, Any]]

    @classmethod
    def of(cls, error: BaseException) -> Failure:
        """The failure that says what this exception says."""
        if isinstance(error, SeacraneError):
            return cls(error.code, [problem_json(problem) for problem in error.problems])
        return cls("internal", [problem_json(Problem("", f"{type(error).__name__}: {error}"))])

    def text(self) -> str:
        """All problems, a line each."""
        return "\n".join(str(Problem(**problem)) for problem in self.problems)

    def error(self) -> ServerError:
        """The failure as an exception of this process."""
        return ServerError(Problem(**problem) for problem in self.problems)


def problem_json(problem: Problem) -> dict[str, Any]:
    """A problem in plain JSON types; a value of any other type is given by its text."""
    value = problem.value
    if not isinstance(value, str | int | float | bool | None):
        value = repr(value)
    return {
        "path": problem.path,
        "message": problem.message,
        "value": value,
        "allowed": problem.allowed,
        "hint": problem.hint,
    }


@dataclass(frozen=True)
class Frame:
    """Everything known at the end of one tick."""

    seq: int
    time: float
    running: bool
    failed: bool
    acknowledged: int
    """Number of the last order (pause, resume, reset) that was carried out."""
    overruns: int
    late_p99: float
    """99th percentile of the lateness of recent ticks [s]."""
    load: float
    """Computing time per simulated time [1] over recent ticks."""
    rows: int
    """Rows of the recording."""
    recording: int
    """Number of the recording; a reset begins a new one."""
    macro_step: float
    """Length of a macro step [s]."""
    values: npt.NDArray[np.float64]


def _slot_type(count: int) -> np.dtype[Any]:
    return np.dtype(
        [
            ("time", "f8"),
            ("running", "i8"),
            ("failed", "i8"),
            ("acknowledged", "i8"),
            ("overruns", "i8"),
            ("late_p99", "f8"),
            ("load", "f8"),
            ("rows", "i8"),
            ("recording", "i8"),
            ("macro_step", "f8"),
            ("values", "f8", (count,)),
        ]
    )


def create() -> int:
    """A new shared memory; its file descriptor, to be inherited by the writer."""
    descriptor = os.memfd_create("seacrane-simulation")
    os.ftruncate(descriptor, _HEADER_BYTES)
    return descriptor


class _Header:
    """The first page: state, sequence number, sizes, error."""

    def __init__(self, memory: mmap.mmap) -> None:
        self._memory = memory
        self._numbers = np.frombuffer(memory, dtype=np.int64, count=5)

    @property
    def state(self) -> State:
        return State(int(self._numbers[0]))

    @state.setter
    def state(self, state: State) -> None:
        self._numbers[0] = state

    @property
    def published(self) -> int:
        return int(self._numbers[1])

    @published.setter
    def published(self, seq: int) -> None:
        self._numbers[1] = seq

    @property
    def sizes(self) -> tuple[int, int]:
        """Number of variables, bytes of the description."""
        return int(self._numbers[2]), int(self._numbers[3])

    @sizes.setter
    def sizes(self, sizes: tuple[int, int]) -> None:
        self._numbers[2:4] = sizes

    @property
    def failure(self) -> Failure | None:
        length = int(self._numbers[4])
        if length == 0:
            return None
        return msgspec.json.decode(self._memory[_ERROR_AT : _ERROR_AT + length], type=Failure)

    @failure.setter
    def failure(self, failure: Failure | None) -> None:
        data = b"" if failure is None else msgspec.json.encode(failure)
        if failure is not None and len(data) > _ERROR_BYTES:
            first = dict(failure.problems[0])
            first.update(value=None, allowed=None, hint=None, message=str(first["message"])[:1000])
            data = msgspec.json.encode(Failure(failure.code, [first]))
        self._memory[_ERROR_AT : _ERROR_AT + len(data)] = data
        self._numbers[4] = len(data)


class Writer:
    """The simulation's side of the shared memory."""

    def __init__(self, descriptor: int) -> None:
        self._descriptor = descriptor
        self._header = _Header(mmap.mmap(descriptor, _HEADER_BYTES))

    def refuse(self, failure: Failure) -> None:
        """The simulation cannot be built."""
        self._header.failure = failure
        self._header.state = State.REFUSED

    def open(self, count: int, description: bytes) -> None:
        """Make room for `count` values and hand over the description."""
        slot_type = _slot_type(count)
        slots_end = _HEADER_BYTES + 2 * slot_type.itemsize
        os.ftruncate(self._descriptor, slots_end + len(description))
        memory = mmap.mmap(self._descriptor, slots_end + len(description))
        memory[slots_end:] = description
        self._slots = np.frombuffer(memory, dtype=slot_type, count=2, offset=_HEADER_BYTES)
        self._header.sizes = (count, len(description))

    @property
    def failure(self) -> Failure | None:
        """What went wrong; to be said, or taken back, before the next frame is published."""
        return self._header.failure

    @failure.setter
    def failure(self, failure: Failure | None) -> None:
        self._header.failure = failure

    def publish(
        self, values: npt.NDArray[np.float64], status: tuple[float, int, int, int, int, float, float, int, int, float]
    ) -> None:
        """Make a frame current; `status` is time, running, failed ... macro_step in the order of `Frame`."""
        seq = self._header.published + 1
        self._slots[seq % 2] = (*status, values)
        self._header.published = seq
        self._header.state = State.READY


class Reader:
    """The server's side of the shared memory."""

    def __init__(self, descriptor: int) -> None:
        self._descriptor = descriptor
        self._header = _Header(mmap.mmap(descriptor, _HEADER_BYTES, prot=mmap.PROT_READ))
        self._slots: npt.NDArray[Any] | None = None

    @property
    def state(self) -> State:
        """How far the simulation process is."""
        return self._header.state

    @property
    def failure(self) -> Failure | None:
        """What went wrong in the simulation process, if anything did."""
        return self._header.failure

    def open(self) -> bytes:
        """Map the frames, once the state is READY; the description of the model."""
        count, length = self._header.sizes
        slot_type = _slot_type(count)
        slots_end = _HEADER_BYTES + 2 * slot_type.itemsize
        memory = mmap.mmap(self._descriptor, slots_end + length, prot=mmap.PROT_READ)
        self._slots = np.frombuffer(memory, dtype=slot_type, count=2, offset=_HEADER_BYTES)
        return memory[slots_end:]

    def latest(self) -> Frame:
        """The current frame."""
        if self._slots is None:
            raise RuntimeError("the simulation is not built yet")
        while True:
            seq = self._header.published
            slot = self._slots[seq % 2].copy()
            if self._header.published == seq:
                break
        return Frame(
            seq=seq,
            time=float(slot["time"]),
            running=bool(slot["running"]),
            failed=bool(slot["failed"]),
            acknowledged=int(slot["acknowledged"]),
            overruns=int(slot["overruns"]),
            late_p99=float(slot["late_p99"]),
            load=float(slot["load"]),
            rows=int(slot["rows"]),
            recording=int(slot["recording"]),
            macro_step=float(slot["macro_step"]),
            values=slot["values"],
        )
