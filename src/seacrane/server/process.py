"""The server's handle on its simulation process."""

from __future__ import annotations

import asyncio
import contextlib
import json
import os
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from typing import Final

import msgspec

from seacrane.errors import ServerError
from seacrane.results import csv_file
from seacrane.server import orders, recording, shared
from seacrane.server.simulation import Description, Factory

_STOP_GRACE: Final = 2.0
_ORDER_TIMEOUT: Final = 120.0
# The new process finds modules where this one does.
_PROGRAM: Final = (
    "import json, sys; sys.path[:] = json.loads(sys.argv[1]); "
    "from seacrane.server.child import main; sys.exit(main(sys.argv[2:]))"
)


class SimulationProcess:
    """Starts, watches, orders about and ends the process that simulates. Used by one event loop."""

    def __init__(self, factory: Factory) -> None:
        self._factory = factory
        self._process: subprocess.Popen[bytes] | None = None
        self._watchers: list[Callable[[], None]] = []
        self._number = 0
        self._exit: str | None = None

    async def start(self) -> None:
        """Build the simulation in a new process and wait until it runs; `ServerError` with its reasons if it cannot."""
        self._memory, self._tape = shared.create(), recording.create()
        self._reader = shared.Reader(self._memory)
        self._exit = None
        self._built = False
        self._number = 0
        here, there = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        with there:
            descriptors = (there.fileno(), self._memory, self._tape)
            # A session of its own: an interrupt typed at the terminal is for the server, which then ends this process.
            self._process = subprocess.Popen(
                [
                    *(sys.executable, "-c", _PROGRAM, json.dumps([entry or os.getcwd() for entry in sys.path])),
                    *(orders.encode(self._factory).decode(), *map(str, descriptors)),
                ],
                pass_fds=descriptors,
                stdin=subprocess.DEVNULL,
                start_new_session=True,
            )
        here.setblocking(False)
        self._link = here
        asyncio.get_running_loop().add_reader(here, self._heard)
        try:
            while self._reader.state is shared.State.BUILDING:
                if self._exit is not None:
                    raise ServerError.at("simulation", self._exit)
                await asyncio.sleep(0.02)
            if self._reader.state is shared.State.REFUSED:
                failure = self._reader.failure
                assert failure is not None
                raise failure.error()
        except BaseException:
            await self.stop()
            raise
        self.raw_description = msgspec.Raw(self._reader.open())
        self.description = msgspec.json.decode(self.raw_description, type=Description)
        self.names = tuple(variable.name for variable in self.description.variables)
        self.index = {name: index for index, name in enumerate(self.names)}
        self._built = True

    @property
    def pid(self) -> int:
        """Process id of the simulation."""
        assert self._process is not None
        return self._process.pid

    @property
    def alive(self) -> bool:
        """Whether the process runs."""
        return self._process is not None and self._exit is None

    @property
    def error(self) -> str | None:
        """What went wrong, if anything did."""
        if self._exit is not None:
            return self._exit
        failure = self._reader.failure
        return None if failure is None else failure.text()

    def latest(self) -> shared.Frame:
        """The current frame; the last one if the process has ended."""
        return self._reader.latest()

    def watch(self, watcher: Callable[[], None]) -> None:
        """Call this at every new frame, and once when the process ends."""
        self._watchers.append(watcher)

    def command(self, axes: dict[str, float], deadman: bool) -> None:
        """Where the axes stand now; lapses in the process itself."""
        self._send(orders.Command(axes, deadman))

    async def pause(self) -> None:
        """Let simulated time stand still."""
        await self._carry_out(orders.Pause)

    async def resume(self) -> None:
        """Let simulated time run."""
        await self._carry_out(orders.Resume)

    async def reset(self) -> None:
        """Start again at time zero; a process that has ended is started anew."""
        if self.alive:
            await self._carry_out(orders.Reset)
        else:
            await self.stop()
            await self.start()

    async def stop(self) -> None:
        """End the process, at first kindly, and free what it used. Harmless if it has ended."""
        if self._process is None:
            return
        self._send(orders.Stop())
        process, deadline = self._process, time.monotonic() + _STOP_GRACE
        while process.poll() is None and time.monotonic() < deadline:
            await asyncio.sleep(0.01)
        self.kill()

    def kill(self) -> None:
        """End the process at once and free what it used."""
        if self._process is None:
            return
        if self._process.poll() is None:
            self._process.kill()
        self._process.wait()
        self._process = None
        self._close_link()
        os.close(self._memory)
        os.close(self._tape)
        if self._exit is None:
            self._exit = "the simulation process has been stopped"

    def recorded_until(self) -> float:
        """Simulated time to which the recording reaches [s]."""
        return recording.last_time(self._tape, self.latest().rows, len(self.names))

    def recording_csv(self, names: list[str]) -> Iterator[bytes]:
        """The recording of these variables as CSV, piece by piece; it ends with what there is now."""
        frame = self.latest()
        columns = [self.index[name] for name in names]
        header = csv_file.header({name: self.description.variables[self.index[name]].unit for name in names})
        tape = os.dup(self._tape)
        try:
            yield from recording.csv_lines(
                tape, frame.rows, len(self.names), columns, header, lambda: self.latest().recording == frame.recording
            )
        finally:
            os.close(tape)

    async def _carry_out(self, kind: type[orders.Pause] | type[orders.Resume] | type[orders.Reset]) -> None:
        self._number += 1
        number = self._number
        self._send(kind(number))
        deadline = time.monotonic() + _ORDER_TIMEOUT
        while self.alive and self.latest().acknowledged < number:
            if time.monotonic() > deadline:
                raise ServerError.at("simulation", "does not answer", hint="Stop the server and start it again.")
            await asyncio.sleep(0.005)
        if not self.alive:
            raise ServerError.at(
                "simulation", self.error or "has ended", hint="Call simulation.reset to start it anew."
            )

    def _send(self, order: orders.Order) -> None:
        """Hand over an order. One that cannot be taken is dropped: commands are renewed, all others are awaited."""
        with contextlib.suppress(OSError):
            self._link.send(orders.encode(order))

    def _heard(self) -> None:
        """The bell rang: there is a new frame, or the process has ended."""
        try:
            while self._link.recv(16):
                pass
            ended = True
        except BlockingIOError:
            ended = False
        except OSError:
            ended = True
        if ended:
            self._close_link()
            asyncio.get_running_loop().call_soon(self._reap, time.monotonic() + 1.0)
        else:
            self._notify()

    def _reap(self, deadline: float) -> None:
        process = self._process
        if process is None or self._exit is not None:
            return
        code = process.poll()
        if code is None and time.monotonic() < deadline:
            asyncio.get_running_loop().call_later(0.01, self._reap, deadline)
            return
        if code is not None and code < 0:
            self._exit = f"the simulation process was ended by {signal.Signals(-code).name}"
        else:
            self._exit = f"the simulation process has ended with exit code {code}"
        self._notify()

    def _close_link(self) -> None:
        if self._link.fileno() >= 0:
            asyncio.get_running_loop().remove_reader(self._link)
            self._link.close()

    def _notify(self) -> None:
        if self._built:
            for watcher in self._watchers:
                watcher()
