"""Frames to clients: each tick is encoded once per list of variables, and no client waits for another.

A client has one slot per subscription that holds the latest frame only; what it cannot take in time is overwritten.
It may leave `CREDIT` frames unacknowledged, then it gets no more until it acknowledges. Answers to its calls are
queued and never dropped; a client that lets them pile up, or takes nothing for `limits.STALL`, is cut off.
"""

from __future__ import annotations

import asyncio
from collections import deque
from collections.abc import Iterable
from typing import Final, Protocol

import msgspec
import numpy as np
import numpy.typing as npt

from seacrane.server import limits
from seacrane.server.pacing import TICK
from seacrane.server.shared import Frame

CREDIT: Final = 4
"""Frames a client may leave unacknowledged."""
_encode = msgspec.json.Encoder().encode


class Link(Protocol):
    """A way to one client."""

    async def send(self, message: bytes) -> None:
        """Send one message; returns when there is room for the next."""

    def abort(self) -> None:
        """Cut the connection at once, with whatever is unsent."""


class _Body(msgspec.Struct, frozen=True):
    seq: int
    time: float
    values: list[float]


class Subscription:
    """Some variables at a rate for one client."""

    def __init__(self, id: int, columns: tuple[int, ...], rate: float) -> None:
        self.id = id
        self.columns = columns
        self.index: npt.NDArray[np.intp] = np.array(columns, dtype=np.intp)
        self.slot: tuple[int, bytes] | None = None
        self._head = b'{"jsonrpc":"2.0","method":"stream.frame","params":{"subscription":' + str(id).encode() + b","
        self._per_tick = min(1.0, rate * TICK)
        self._due = 1.0
        self._seen = 0
        self._shown: tuple[float, int] | None = None
        self._sent: deque[int] = deque()
        self.spent_since: float | None = None

    def wants(self, frame: Frame) -> bool:
        """Whether this frame is due; counts the ticks since the last one. Time that stands still is shown once."""
        # After a reset in a new process, frames count from the start again.
        passed = frame.seq - self._seen if frame.seq >= self._seen else 1
        self._seen = frame.seq
        self._due = min(self._due + passed * self._per_tick, 1.0 + self._per_tick)
        instant = (frame.time, frame.recording)
        if self._due < 1.0 - 1e-9 or instant == self._shown:
            return False
        self._due -= 1.0
        self._shown = instant
        return True

    def offer(self, seq: int, body: bytes) -> None:
        """Put the latest frame into the slot."""
        self.slot = (seq, self._head + body)

    def take(self, now: float) -> bytes | None:
        """The frame to send next, if there is one and the client has credit."""
        if self.slot is None:
            return None
        if len(self._sent) >= CREDIT:
            if self.spent_since is None:
                self.spent_since = now
            return None
        seq, message = self.slot
        self.slot = None
        self._sent.append(seq)
        return message

    def acknowledge(self, seq: int) -> None:
        """The client has taken all frames up to this one."""
        while self._sent and self._sent[0] <= seq:
            self._sent.popleft()
            self.spent_since = None


class Outbox:
    """All that is on its way to one client."""

    def __init__(self, link: Link) -> None:
        self.link = link
        self.subscriptions: dict[int, Subscription] = {}
        self._answers: deque[bytes] = deque()
        self._queued = 0
        self._something = asyncio.Event()
        self._sending_since: float | None = None

    def answer(self, message: bytes) -> None:
        """Queue an answer; a client that lets too much pile up is cut off."""
        self._queued += len(message)
        if self._queued > limits.QUEUE_BYTES and self._answers:
            self.link.abort()
            return
        self._answers.append(message)
        self._something.set()

    def wake(self) -> None:
        """There may be something new to send."""
        self._something.set()

    async def run(self) -> None:
        """Send until cancelled: answers before frames, subscriptions in turn."""
        loop = asyncio.get_running_loop()
        while True:
            message = self._next(loop.time())
            if message is None:
                self._something.clear()
                await self._something.wait()
                continue
            self._sending_since = loop.time()
            await self.link.send(message)
            self._sending_since = None

    def stalled(self, now: float) -> bool:
        """Whether the client has taken, or acknowledged, nothing for too long."""
        since = [self._sending_since, *(each.spent_since for each in self.subscriptions.values())]
        return any(start is not None and now - start > limits.STALL for start in since)

    def _next(self, now: float) -> bytes | None:
        if self._answers:
            message = self._answers.popleft()
            self._queued -= len(message)
            return message
        for subscription in self.subscriptions.values():
            frame = subscription.take(now)
            if frame is not None:
                return frame
        return None


def publish(frame: Frame, outboxes: Iterable[Outbox]) -> None:
    """Offer a frame to every client that is due one, encoding once per list of variables."""
    bodies: dict[tuple[int, ...], bytes] = {}
    for outbox in outboxes:
        for subscription in outbox.subscriptions.values():
            if not subscription.wants(frame):
                continue
            body = bodies.get(subscription.columns)
            if body is None:
                values = frame.values[subscription.index].tolist()
                body = bodies[subscription.columns] = _encode(_Body(frame.seq, frame.time, values))[1:] + b"}"
            subscription.offer(frame.seq, body)
            outbox.wake()
