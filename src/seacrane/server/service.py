"""The methods of the server: what a client can ask, whatever way it came."""

from __future__ import annotations

import asyncio
import hmac
import itertools
import logging
from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Annotated, Any, Final

import msgspec

import seacrane
from seacrane.errors import Problem, ServerError, nearest
from seacrane.server import lease, limits, rpc, stream
from seacrane.server.pacing import TICK
from seacrane.server.process import SimulationProcess

PROTOCOL: Final = 1
"""Version of the protocol; it changes when a client written for the one before would no longer work."""
_HOUSEKEEPING: Final = 0.1
_log = logging.getLogger(__name__)

Names = Annotated[tuple[str, ...], msgspec.Meta(min_length=1, max_length=5000)]
Deflection = Annotated[float, msgspec.Meta(ge=-1.0, le=1.0)]


# ---------------------------------------------------------------- parameters and results
class ServerInfo(msgspec.Struct, frozen=True):
    """Who is serving."""

    name: str
    version: str
    protocol: int


class Status(msgspec.Struct, frozen=True):
    """State of the simulation and of this client's part in it."""

    time: float
    running: bool
    finished: bool
    error: str | None
    real_time_factor: float
    macro_step: float
    overruns: int
    late_ms_p99: float
    recorded: float
    clients: int
    driver: int | None
    you: int


class Read(rpc.Params, frozen=True):
    """Variables to read."""

    names: Names


class Values(msgspec.Struct, frozen=True):
    """Values at one simulated time, in the order asked for; null is not a number."""

    time: float
    values: list[float | None]


class Subscribe(rpc.Params, frozen=True):
    """Variables to stream, and how often [Hz]."""

    variables: Names
    rate: Annotated[float, msgspec.Meta(ge=0.1, le=1000.0)] = 60.0


class Subscribed(msgspec.Struct, frozen=True):
    """A new subscription and its actual rate [Hz]."""

    subscription: int
    rate: float


class SubscriptionId(rpc.Params, frozen=True):
    """One of this client's subscriptions."""

    subscription: int


class Acknowledge(rpc.Params, frozen=True):
    """Frames of a subscription that have been taken, up to `seq`."""

    subscription: int
    seq: int


class Acquire(rpc.Params, frozen=True):
    """Whether the stick may be taken from another driver."""

    take_over: bool = False


class Acquired(msgspec.Struct, frozen=True):
    """The driver now, and how long the stick is kept after a command [s]."""

    driver: int
    lease: float


class Released(msgspec.Struct, frozen=True):
    """Whether the stick was held."""

    released: bool


class Command(rpc.Params, frozen=True):
    """Where the axes stand; axes not named stand at zero."""

    axes: dict[str, Deflection]
    deadman: bool


class Accepted(msgspec.Struct, frozen=True):
    """The command is on its way."""

    accepted: bool


class Authenticate(rpc.Params, frozen=True):
    """The server's token."""

    token: str


class Authenticated(msgspec.Struct, frozen=True):
    """This client's number."""

    you: int


class Done(msgspec.Struct, frozen=True):
    """It is done."""

    done: bool = True


# ---------------------------------------------------------------- clients
@dataclass
class Client:
    """One connection."""

    number: int
    outbox: stream.Outbox
    rate: limits.CallRate
    authenticated: bool
    subscriptions: itertools.count[int] = field(default_factory=lambda: itertools.count(1))


class Service:
    """One simulation and all its clients."""

    def __init__(self, simulation: SimulationProcess, token: str) -> None:
        self.simulation = simulation
        self.dispatcher = _methods(self)
        self._token = token.encode()
        self._clients: dict[int, Client] = {}
        self._numbers = itertools.count(1)
        self._lease = lease.ControlLease()
        simulation.watch(self._tick)

    def accepts_token(self, token: str | None) -> bool:
        """Whether this is the server's token; takes the same time for every wrong one."""
        return token is not None and hmac.compare_digest(token.encode(), self._token)

    # ---------------------------------------------------------------- connections
    async def converse(self, link: stream.Link, messages: Any, *, authenticated: bool) -> None:
        """Serve one connection: answer each of its messages (an async iterator of bytes) until they end."""
        if len(self._clients) >= limits.CLIENTS:
            link.abort()
            return
        now = asyncio.get_running_loop().time
        client = Client(next(self._numbers), stream.Outbox(link), limits.CallRate(now()), authenticated)
        self._clients[client.number] = client
        sender = asyncio.create_task(client.outbox.run())
        sender.add_done_callback(lambda task: _lost(task, link))
        try:
            async for message in messages:
                if not client.rate.allows(now(), len(message)):
                    _log.warning("client %d asks too often and is cut off", client.number)
                    link.abort()
                    return
                answer = await self.dispatcher.handle(client, message)
                if not client.authenticated:
                    await link.send(answer or b"")
                    return
                if answer is not None:
                    client.outbox.answer(answer)
        finally:
            sender.cancel()
            del self._clients[client.number]
            if self._lease.release(client.number):
                self._let_go()

    async def housekeeping(self) -> None:
        """Watch over silent drivers and stalled clients until cancelled."""
        now = asyncio.get_running_loop().time
        while True:
            await asyncio.sleep(_HOUSEKEEPING)
            if self._lease.expire(now()):
                self._let_go()
            for client in tuple(self._clients.values()):
                if client.outbox.stalled(now()):
                    _log.warning("client %d takes nothing and is cut off", client.number)
                    client.outbox.link.abort()

    def links(self) -> list[stream.Link]:
        """The ways to all clients."""
        return [client.outbox.link for client in self._clients.values()]

    def _tick(self) -> None:
        stream.publish(self.simulation.latest(), (client.outbox for client in self._clients.values()))

    def _let_go(self) -> None:
        """Nobody drives: all axes to zero now."""
        self.simulation.command(dict.fromkeys(self.simulation.description.axes, 0.0), False)

    # ---------------------------------------------------------------- what the methods do
    def status(self, client: Client) -> Status:
        """State of the simulation as this client sees it."""
        simulation = self.simulation
        frame = simulation.latest()
        return Status(
            time=frame.time,
            running=frame.running and simulation.alive,
            finished=frame.failed or not simulation.alive,
            error=simulation.error,
            real_time_factor=frame.load,
            macro_step=frame.macro_step,
            overruns=frame.overruns,
            late_ms_p99=frame.late_p99 * 1e3,
            recorded=simulation.recorded_until(),
            clients=len(self._clients),
            driver=self._lease.driver,
            you=client.number,
        )

    def columns(self, names: Iterable[str], path: str) -> tuple[int, ...]:
        """Where these variables are in a frame; `ServerError` naming every unknown one and its nearest."""
        index = self.simulation.index
        problems = [
            Problem(f"{path}[{place}]", f"no variable {name!r}", hint=nearest(name, index))
            for place, name in enumerate(names)
            if name not in index
        ]
        if problems:
            raise ServerError(problems)
        return tuple(index[name] for name in names)

    def subscribe(self, client: Client, variables: tuple[str, ...], rate: float) -> Subscribed:
        """Begin to stream; the current frame is offered at once."""
        columns = self.columns(variables, "variables")
        subscriptions = client.outbox.subscriptions
        if len(subscriptions) >= limits.SUBSCRIPTIONS:
            raise ServerError.at(
                "subscription", f"a client has at most {limits.SUBSCRIPTIONS}", hint="Call stream.unsubscribe."
            )
        actual = min(rate, 1 / TICK)
        subscription = stream.Subscription(next(client.subscriptions), columns, actual)
        subscriptions[subscription.id] = subscription
        return Subscribed(subscription.id, actual)

    def acquire(self, client: Client, take_over: bool) -> Acquired:
        """Give the stick to this client; one taken from another is at zero."""
        if self._lease.acquire(client.number, asyncio.get_running_loop().time(), take_over):
            self._let_go()
        return Acquired(client.number, lease.LEASE)

    def release(self, client: Client) -> Released:
        """Give the stick back with all axes at zero."""
        held = self._lease.release(client.number)
        if held:
            self._let_go()
        return Released(held)

    def command(self, client: Client, axes: dict[str, float], deadman: bool) -> Accepted:
        """Pass the driver's command on."""
        known = self.simulation.description.axes
        problems = [
            Problem(f"axes.{name}", "no such axis", hint=nearest(name, known)) for name in axes if name not in known
        ]
        if problems:
            raise ServerError(problems)
        self._lease.renew(client.number, asyncio.get_running_loop().time())
        self.simulation.command(axes, deadman)
        return Accepted(True)


def _lost(task: asyncio.Task[None], link: stream.Link) -> None:
    """A sender that failed has lost its client; end the connection so that the reading side ends too."""
    if not task.cancelled() and task.exception() is not None:
        link.abort()


class _Guarded(rpc.Dispatcher[Client]):
    """Refuses everything but `authenticate` to a client that has not shown the token."""

    async def handle(self, caller: Client, message: bytes | str) -> bytes | None:
        if caller.authenticated:
            return await super().handle(caller, message)
        return await self.entrance.handle(caller, message)

    def __init__(self, entrance: rpc.Dispatcher[Client]) -> None:
        super().__init__()
        self.entrance = entrance


def _methods(service: Service) -> rpc.Dispatcher[Client]:
    """All methods, each a thin typed shell."""
    entrance: rpc.Dispatcher[Client] = rpc.Dispatcher()
    methods = _Guarded(entrance)
    simulation = service.simulation

    def authenticate(client: Client, params: Authenticate) -> Authenticated:
        """Show the token of the server; the first call of a TCP client, which is cut off if it is wrong."""
        if not service.accepts_token(params.token):
            raise ServerError.at("token", "is wrong", hint="The server prints it when it starts.")
        client.authenticated = True
        return Authenticated(client.number)

    entrance.method("authenticate")(authenticate)
    methods.method("authenticate")(authenticate)

    @methods.method("server.info")
    def info(client: Client, params: rpc.NoParams) -> ServerInfo:
        """Name and version of the server, and version of the protocol."""
        return ServerInfo("seacrane", seacrane.__version__, PROTOCOL)

    @methods.method("simulation.status")
    def status(client: Client, params: rpc.NoParams) -> Status:
        """State of the simulation.

        `real_time_factor` is computing time per simulated time over the last second: below one, real time is held.
        `overruns` counts ticks (60 per second) whose work ended after the next was due, `late_ms_p99` says how late.
        `recorded` is the time to which the recording reaches. `finished` means that an error ended the simulation.
        """
        return service.status(client)

    @methods.method("simulation.pause")
    async def pause(client: Client, params: rpc.NoParams) -> Status:
        """Let simulated time stand still."""
        await simulation.pause()
        return service.status(client)

    @methods.method("simulation.resume")
    async def resume(client: Client, params: rpc.NoParams) -> Status:
        """Let simulated time run on."""
        await simulation.resume()
        return service.status(client)

    @methods.method("simulation.reset")
    async def reset(client: Client, params: rpc.NoParams) -> Status:
        """Start again at time zero with a new recording; also after an error."""
        await simulation.reset()
        return service.status(client)

    @methods.method("model.describe")
    def describe(client: Client, params: rpc.NoParams) -> dict[str, Any]:
        """What is simulated: crane, load, ship, sea, slaves, variables with units, command axes."""
        return simulation.raw_description  # type: ignore[return-value]  # JSON already

    @methods.method("variables.read")
    def read(client: Client, params: Read) -> Values:
        """The latest values of some variables."""
        columns = service.columns(params.names, "names")
        frame = simulation.latest()
        return Values(frame.time, frame.values[list(columns)].tolist())

    @methods.method("stream.subscribe")
    def subscribe(client: Client, params: Subscribe) -> Subscribed:
        """Stream some variables: `stream.frame {subscription, seq, time, values}` at a rate, up to 60 Hz.

        Each frame must be acknowledged by the notification `stream.ack`; with four outstanding no more are sent.
        """
        return service.subscribe(client, params.variables, params.rate)

    @methods.method("stream.unsubscribe")
    def unsubscribe(client: Client, params: SubscriptionId) -> Done:
        """End a subscription."""
        if client.outbox.subscriptions.pop(params.subscription, None) is None:
            raise ServerError.at("subscription", "is not one of yours", value=params.subscription)
        return Done()

    @methods.method("stream.ack")
    def acknowledge(client: Client, params: Acknowledge) -> Done:
        """Acknowledge all frames of a subscription up to `seq`. Sent as a notification."""
        subscription = client.outbox.subscriptions.get(params.subscription)
        if subscription is not None:
            subscription.acknowledge(params.seq)
            if subscription.slot is not None:
                client.outbox.wake()
        return Done()

    @methods.method("control.acquire")
    def acquire(client: Client, params: Acquire) -> Acquired:
        """Take the stick; from another driver only with `take_over`."""
        return service.acquire(client, params.take_over)

    @methods.method("control.release")
    def release(client: Client, params: rpc.NoParams) -> Released:
        """Give the stick back, with all axes at zero."""
        return service.release(client)

    @methods.method("control.command")
    def command(client: Client, params: Command) -> Accepted:
        """Where the axes stand, in [-1, 1]. Lapses to zero after 0.5 s; repeat it while the stick is held."""
        return service.command(client, params.axes, params.deadman)

    return methods
