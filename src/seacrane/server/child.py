"""The simulation process: `main([factory as JSON, socket, memory, recording])`, the last three inherited descriptors.

It paces the simulation, publishes a frame at every tick, records, and obeys the orders of the server that started it.
It trusts nobody to stay alive: commands lapse here, whatever the server does, and when the server is gone, which the
end of their socket pair tells, the process ends, even if a step hangs.
"""

from __future__ import annotations

import contextlib
import gc
import os
import socket
import threading
import time
import traceback
from collections import deque
from collections.abc import Callable
from typing import Final

import msgspec
import numpy as np

from seacrane.cosim.saved import State
from seacrane.errors import Problem, SeacraneError, ServerError
from seacrane.server import orders, recording
from seacrane.server.pacing import TICK, Pacer
from seacrane.server.shared import Failure, Writer, problem_json
from seacrane.server.simulation import Description, Factory

COMMAND_LIFE: Final = 0.5
"""A command that is not renewed for this long lapses to zero [s]."""
_GRACE: Final = 0.5
"""Time to end by itself after the server has gone [s]."""


class Inbox:
    """Receives orders on a thread of its own, so that the sender never waits and its end is noticed at once."""

    def __init__(self, link: socket.socket) -> None:
        self._link = link
        self._orders: deque[tuple[float, orders.Order]] = deque(maxlen=1000)
        self.closed = False
        threading.Thread(target=self._receive, daemon=True).start()

    def _receive(self) -> None:
        while True:
            try:
                data = self._link.recv(orders.DATAGRAM)
            except OSError:
                data = b""
            if not data:
                break
            self._orders.append((time.monotonic(), orders.decode(data)))
        self.closed = True
        time.sleep(_GRACE)
        os._exit(1)

    def take(self) -> list[tuple[float, orders.Order]]:
        """All orders since the last call, each with the monotonic time at which it came [s]."""
        taken = []
        while self._orders:
            taken.append(self._orders.popleft())
        return taken


class Runner:
    """One simulation, paced. All its state is used by one thread."""

    def __init__(self, factory: Factory, inbox: Inbox, bell: Callable[[], None], writer: Writer, tape: int) -> None:
        self._factory, self._inbox, self._bell, self._writer = factory, inbox, bell, writer
        self._tape_descriptor = tape
        self._running, self._failed = True, False
        self._acknowledged, self._recording = 0, 1
        description = self._build()
        writer.open(len(self._names), description)
        self._begin()

    def _build(self) -> bytes:
        """Build and start the simulation; its description."""
        self._simulation = self._factory.build()
        self._execution = self._simulation.execution
        raw = msgspec.json.encode(self._simulation.describe())
        description = msgspec.json.decode(raw, type=Description)
        self._axes = dict.fromkeys(description.axes, 0.0)
        self._names = [variable.name for variable in description.variables]
        self._read = self._execution.reader(self._names)
        self._values = np.empty(len(self._names))
        self._tape = recording.Tape(self._tape_descriptor)
        step = self._execution.macro_step
        self._execution.observe(self._tape, self._names, every=step * max(1, round(recording.PERIOD / step)))
        self._execution.start()
        self._simulation.command(self._axes, False)
        try:
            self._origin: State | None = self._execution.save()
        except SeacraneError:
            self._origin = None
        # What was built lives as long as the simulation; the collector need not look through it at every pass.
        gc.collect()
        gc.freeze()
        return raw

    def _begin(self) -> None:
        """Everything that starts anew with the simulation at its origin."""
        self._pacer = Pacer(self._execution.macro_step)
        self._renewed: float | None = None
        self._read(self._values)
        self._pacer.begin(time.monotonic(), self._execution.time)

    def run(self) -> None:
        """Tick until told to stop or left alone."""
        deadline = time.monotonic()
        while not self._inbox.closed:
            if not self._obey():
                break
            deadline += TICK
            if self._running and not self._failed:
                now = time.monotonic()
                steps = self._pacer.due(now, self._execution.time)
                self._advance(steps)
                done = time.monotonic()
                self._pacer.worked(done - now, steps, done - deadline)
            self._publish()
            rest = deadline - time.monotonic()
            if rest > 0:
                time.sleep(rest)
            elif rest < -TICK:
                deadline = time.monotonic()
        self._execution.close()

    def _obey(self) -> bool:
        """Carry out what came in and let a stale command lapse; False to stop."""
        for came, order in self._inbox.take():
            match order:
                case orders.Command(axes, deadman):
                    self._command({**self._axes, **axes}, deadman)
                    self._renewed = came
                case orders.Pause(number):
                    self._running = False
                    self._acknowledged = number
                case orders.Resume(number):
                    if not self._running:
                        self._running = True
                        self._pacer.begin(time.monotonic(), self._execution.time)
                    self._acknowledged = number
                case orders.Reset(number):
                    self._reset()
                    self._acknowledged = number
                case orders.Stop():
                    return False
        if self._renewed is not None and time.monotonic() - self._renewed > COMMAND_LIFE:
            self._renewed = None
            self._command(self._axes, False)
        return True

    def _command(self, axes: dict[str, float], deadman: bool) -> None:
        if not self._failed:
            try:
                self._simulation.command(axes, deadman)
            except Exception as error:
                self._fail(error)

    def _advance(self, steps: int) -> None:
        """Make these steps and read everything, with all rows recorded on the way handed over."""
        try:
            self._execution.step(steps)
            self._execution.flush()
            self._read(self._values)
        except Exception as error:
            self._fail(error)
            return
        if self._tape.stopped is not None and self._writer.failure is None:
            hint = "Download what there is, then reset."
            problem = Problem("recording", f"stopped: {self._tape.stopped}", hint=hint)
            self._writer.failure = Failure("server", [problem_json(problem)])

    def _fail(self, error: Exception) -> None:
        _report(error)
        self._failed = True
        self._writer.failure = Failure.of(error)

    def _reset(self) -> None:
        """Back to the origin as it was saved, or by building anew where a slave cannot be saved or is beyond repair."""
        try:
            if not self._restored():
                names = self._names
                self._execution.close()
                gc.unfreeze()
                self._build()
                if self._names != names:
                    raise ServerError.at("simulation", "has other variables than before", hint="Start the server anew.")
        except Exception as error:
            self._fail(error)
            return
        self._failed = False
        self._writer.failure = None
        self._recording += 1
        self._begin()

    def _restored(self) -> bool:
        if self._origin is None:
            return False
        try:
            self._execution.restore(self._origin)
            self._simulation.command(self._axes, False)
        except SeacraneError:
            return False
        return True

    def _publish(self) -> None:
        pacer = self._pacer
        self._writer.publish(
            self._values,
            (
                self._execution.time,
                int(self._running and not self._failed),
                int(self._failed),
                self._acknowledged,
                pacer.overruns,
                pacer.late_p99,
                pacer.load,
                self._tape.rows,
                self._recording,
                self._execution.macro_step,
            ),
        )
        self._bell()


def _report(error: Exception) -> None:
    """Errors of the package say all to the user by way of the server; of any other the traceback is wanted."""
    if not isinstance(error, SeacraneError):
        traceback.print_exception(error)


def main(arguments: list[str]) -> int:
    """Build and run the simulation; the exit code."""
    factory = msgspec.json.decode(arguments[0], type=Factory)
    link, memory, tape = (int(argument) for argument in arguments[1:])
    channel = socket.socket(fileno=link)
    writer = Writer(memory)
    inbox = Inbox(channel)

    def ring() -> None:
        """Tell the server that there is a new frame; one that does not listen misses nothing but the bell."""
        with contextlib.suppress(OSError):
            channel.send(b"\n", socket.MSG_DONTWAIT)

    try:
        runner = Runner(factory, inbox, ring, writer, tape)
    except Exception as error:
        _report(error)
        writer.refuse(Failure.of(error))
        return 1
    runner.run()
    return 0
