"""Saved states: everything that a run needs to go on, in memory or in a file.

A file is a line with its format, the SHA-256 of what follows, and a MessagePack map with what made it (version,
fingerprints of the slaves, connections, bonds, algorithm and scenario) and the state. It holds no code: nothing in it
is executed when it is read. What a slave's own bytes hold is up to the slave: for compiled models and FMUs the block
that their C code gives, for Python functions their state vector.
"""

from __future__ import annotations

import hashlib
import os
import tempfile
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import msgspec
import numpy as np

from seacrane import __version__
from seacrane.cosim.plan import CHANGE, TRIGGER, Plan
from seacrane.errors import CosimError, Problem, SeacraneError

FORMAT: Final = b"seacrane-state/1\n"
_DIGEST: Final = 32


@dataclass(frozen=True)
class State:
    """The whole state of a run at a communication point, as `Execution.save` gives it."""

    done: int
    values: bytes
    slaves: Mapping[str, bytes]
    stopped: tuple[str, ...]
    changes: bytes
    conditions: bytes
    triggers: bytes
    events: int


def taken(plan: Plan, stopped: tuple[str, ...], events: int) -> State:
    """The state of a plan, of which these slaves are stopped and so many events have passed.

    `CosimError` naming each slave that cannot be saved.
    """
    slaves, problems = {}, []
    for part in plan.parts:
        try:
            slaves[part.name] = part.instance.save()
        except SeacraneError as error:
            problems += [Problem(part.name, f"cannot be saved: {p.message}") for p in error.problems]
    if problems:
        raise CosimError(problems)
    return State(
        plan.done,
        plan.values.tobytes(),
        slaves,
        stopped,
        plan.changes.tobytes(),
        plan.conditions.tobytes(),
        plan.triggers.tobytes(),
        events,
    )


def check(plan: Plan, state: State) -> None:
    """`CosimError` if the state is not one of this plan."""
    if set(state.slaves) != {part.name for part in plan.parts} or len(state.values) != plan.values.nbytes:
        raise CosimError.at("state", "is that of another system")
    if state.conditions != plan.conditions.tobytes() or len(state.triggers) != plan.triggers.nbytes:
        raise CosimError.at("state", "is that of a run with other triggers")


def put_back(plan: Plan, state: State) -> None:
    """Bring a plan and its slaves to the state."""
    for part in plan.parts:
        part.instance.restore(state.slaves[part.name])
        part.stopped = part.name in state.stopped
    plan.values[:] = np.frombuffer(state.values)
    plan.done = state.done
    plan.triggers[:] = np.frombuffer(state.triggers, TRIGGER)
    plan.put_changes(np.frombuffer(state.changes, CHANGE))
    plan.calls[:] = 0
    plan.stop[0] = 0


class _Content(msgspec.Struct, frozen=True, kw_only=True):
    version: str
    time: float
    made_of: dict[str, str]
    state: State


def write(path: str | Path, state: State, time: float, made_of: Mapping[str, str]) -> None:
    """Write beside, to the disk, and rename: an existing file is replaced only once the new one is complete.

    `CosimError` if it cannot be written.
    """
    target = Path(path)
    content = _Content(version=__version__, time=time, made_of=dict(made_of), state=state)
    payload = msgspec.msgpack.encode(content)
    try:
        handle, beside = tempfile.mkstemp(prefix=f".{target.name}.", dir=target.parent)
        try:
            with os.fdopen(handle, "wb") as file:
                file.write(FORMAT + hashlib.sha256(payload).digest() + payload)
                file.flush()
                os.fsync(file.fileno())
            os.replace(beside, target)
        except BaseException:
            Path(beside).unlink(missing_ok=True)
            raise
    except OSError as error:
        raise CosimError.at(os.fspath(path), f"cannot be written: {error.strerror}") from error


def read(path: str | Path, made_of: Mapping[str, str]) -> State:
    """The state in a file, which must be that of a run made of the same; `CosimError` says what is different."""
    name = os.fspath(path)
    try:
        data = Path(path).read_bytes()
    except OSError as error:
        raise CosimError.at(name, f"cannot be read: {error.strerror}") from error
    if not data.startswith(FORMAT):
        first = data[:40].partition(b"\n")[0].decode("ascii", "replace")
        if first.startswith("seacrane-state/"):
            what = "is a saved state of a format that this version cannot read"
            raise CosimError.at(name, what, value=first, allowed=FORMAT.decode().strip())
        raise CosimError.at(name, "is not a saved state")
    digest, payload = data[len(FORMAT) : len(FORMAT) + _DIGEST], data[len(FORMAT) + _DIGEST :]
    if hashlib.sha256(payload).digest() != digest:
        raise CosimError.at(name, "is damaged or not complete: its checksum is wrong")
    try:
        content = msgspec.msgpack.decode(payload, type=_Content)
    except msgspec.MsgspecError as error:
        raise CosimError.at(name, f"holds no state: {error}") from None
    then, problems = content.made_of, []
    for what in dict.fromkeys((*then, *made_of)):
        if what not in made_of:
            problems.append(Problem(name, f"{what}: is in the saved run, but not in this one"))
        elif what not in then:
            problems.append(Problem(name, f"{what}: is in this run, but not in the saved one"))
        elif then[what] != made_of[what]:
            problems.append(Problem(name, f"{what}: is not the same as in the saved run"))
    if problems:
        raise CosimError(problems)
    return content.state


def fingerprint(*parts: object) -> str:
    """A hash of the `repr` of things that are plain data."""
    return hashlib.sha256(repr(parts).encode()).hexdigest()
