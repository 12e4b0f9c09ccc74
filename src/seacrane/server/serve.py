"""Start everything, say where it is, end everything."""

from __future__ import annotations

import asyncio
import errno
import logging
import secrets
import signal
import socket
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any, Final

import uvicorn

from seacrane.errors import ServerError
from seacrane.server import app, limits, tcp
from seacrane.server.guard import is_loopback
from seacrane.server.process import SimulationProcess
from seacrane.server.service import Service
from seacrane.server.simulation import Factory
from seacrane.server.websocket import BoundedProtocol

PORT: Final = 8470
TCP_PORT: Final = 8471
_GRACE: Final = 1
_log = logging.getLogger(__name__)


class Listener:
    """The HTTP side of a server in the running event loop: a port, and the application that answers there."""

    def __init__(self, host: str, port: int, *, allow_remote: bool = False) -> None:
        """`ServerError` for an address that other machines can reach, unless that is allowed. Port 0: any free one."""
        if not is_loopback(host) and not allow_remote:
            raise ServerError.at(
                "host",
                f"{host!r} can be reached from other machines, and the connection is not encrypted",
                allowed="127.0.0.1, ::1, localhost",
                hint="Allow it (--allow-remote) if everyone on that network may see the token.",
            )
        self.host, self.port = host, port
        self._socket: socket.socket | None = None
        self._http: _Uvicorn | None = None
        self._task: asyncio.Task[None] | None = None

    def listen(self) -> None:
        """Take the port for good; who connects now is served once `serve` has been called."""
        self._socket = listen(self.host, self.port)
        self.port = self._socket.getsockname()[1]

    async def serve(self, application: object) -> None:
        """Answer with the application from now on."""
        self._http = _Uvicorn(_config(application))
        self._task = asyncio.create_task(self._http.serve([self._socket] if self._socket else None))
        while not self._http.started:
            await asyncio.sleep(0.005)

    @property
    def address(self) -> str:
        """Where the page is."""
        host = f"[{self.host}]" if ":" in self.host else self.host
        return f"http://{host}:{self.port}/"

    async def stop(self) -> None:
        """End all connections and give the port back. Harmless if that has happened."""
        if self._http is not None and self._task is not None:
            self._http.should_exit = True
            await asyncio.wait([self._task], timeout=3 * _GRACE)
            self._task.cancel()
            await asyncio.gather(self._task, return_exceptions=True)
            self._http = self._task = None
        if self._socket is not None:
            self._socket.close()


def listen(host: str, port: int) -> socket.socket:
    """A socket that listens at this address; `ServerError` with the reason if it cannot be had."""
    listener = socket.socket(socket.AF_INET6 if ":" in host else socket.AF_INET, socket.SOCK_STREAM)
    listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    try:
        listener.bind((host, port))
        listener.listen(128)
    except OSError as error:
        listener.close()
        message, hint = _why(error)
        raise ServerError.at(f"port {port}", message, hint=hint) from None
    listener.setblocking(False)
    return listener


class Server:
    """A simulation and its server in the running event loop: `await start()`, `await stop()`.

    `port` and `tcp_port` may be 0 for any free one; `tcp_port` None leaves TCP out. Without `token` a new one is made.
    """

    def __init__(
        self,
        factory: Factory,
        *,
        host: str = "127.0.0.1",
        port: int = PORT,
        tcp_port: int | None = TCP_PORT,
        token: str | None = None,
        allow_remote: bool = False,
        page: Path = app.PAGE,
    ) -> None:
        self._listener = Listener(host, port, allow_remote=allow_remote)
        self.host = host
        self.token = token or secrets.token_urlsafe(24)
        self.simulation = SimulationProcess(factory)
        self.service = Service(self.simulation, self.token)
        self.tcp_port = tcp_port
        self._page = page
        self._housekeeping: asyncio.Task[None] | None = None
        self._tcp_socket: socket.socket | None = None
        self._tcp: asyncio.Server | None = None

    async def start(self) -> None:
        """Take the ports, build the simulation, serve; `ServerError` with nothing left running if any of it fails."""
        try:
            self._listener.listen()
            if self.tcp_port is not None:
                self._tcp_socket = listen(self.host, self.tcp_port)
                self.tcp_port = self._tcp_socket.getsockname()[1]
            await self.simulation.start()
            self._housekeeping = asyncio.create_task(self.service.housekeeping())
            if self._tcp_socket is not None:
                self._tcp = await tcp.listen(self.service, self._tcp_socket)
            await self._listener.serve(app.create(self.service, self.host, self.port, self._page))
        except BaseException:
            await self.stop()
            raise

    @property
    def address(self) -> str:
        """Where the page is."""
        return self._listener.address

    @property
    def port(self) -> int:
        """Of the page."""
        return self._listener.port

    @property
    def address_with_token(self) -> str:
        """Where the page is, with the key to it."""
        return f"{self.address}?token={self.token}"

    async def stop(self) -> None:
        """End all connections, the simulation process and the server. Harmless if they have ended."""
        for client in self.service.links():
            client.abort()
        if self._tcp is not None:
            self._tcp.close()
        await self._listener.stop()
        if self._housekeeping is not None:
            self._housekeeping.cancel()
            await asyncio.gather(self._housekeeping, return_exceptions=True)
            self._housekeeping = None
        if self._tcp_socket is not None:
            self._tcp_socket.close()
        await self.simulation.stop()


def serve(
    target: str,
    *,
    arguments: Mapping[str, Any] | None = None,
    host: str = "127.0.0.1",
    port: int = PORT,
    tcp_port: int | None = TCP_PORT,
    token: str | None = None,
    allow_remote: bool = False,
) -> None:
    """Run the simulation that `target(**arguments)` builds, and serve it until interrupted (SIGINT, SIGTERM).

    `target` is `package.module:function`, and the arguments are of plain JSON types, for the function is called in
    another process; it returns a `Simulation`. The address with its token is printed.

    Raises `ServerError` if it cannot start: a port in use, an address that is not this machine's, a simulation that
    cannot be built.
    """
    factory = Factory(target, dict(arguments or {}))
    server = Server(factory, host=host, port=port, tcp_port=tcp_port, token=token, allow_remote=allow_remote)
    asyncio.run(_until_interrupted(server))


async def _until_interrupted(server: Server) -> None:
    interrupted = asyncio.Event()
    loop = asyncio.get_running_loop()
    for number in (signal.SIGINT, signal.SIGTERM):
        loop.add_signal_handler(number, interrupted.set)
    waiting = asyncio.create_task(interrupted.wait())
    starting = asyncio.create_task(server.start())
    try:
        await asyncio.wait({waiting, starting}, return_when=asyncio.FIRST_COMPLETED)
        if not starting.done():
            starting.cancel()
            with suppress(asyncio.CancelledError):
                await starting
            return
        starting.result()
        if not is_loopback(server.host):
            print(
                "Warning: anyone on this network can read the token, for the connection is not encrypted.", flush=True
            )
        print(f"Open {server.address_with_token}", flush=True)
        if server.tcp_port is not None:
            print(f"JSON-RPC over TCP: {server.host} port {server.tcp_port}, first call authenticate", flush=True)
        await waiting
    finally:
        waiting.cancel()
        await server.stop()


class _Uvicorn(uvicorn.Server):
    """Uvicorn, ended by `should_exit` only: signals belong to `serve`."""

    @contextmanager
    def capture_signals(self) -> Iterator[None]:
        yield


def _config(application: object) -> uvicorn.Config:
    return uvicorn.Config(
        application,  # type: ignore[arg-type]
        lifespan="off",
        ws=BoundedProtocol,
        ws_max_size=limits.MESSAGE_BYTES,
        # Compression of frames costs far more time than their bytes do on any link that can show a crane.
        ws_per_message_deflate=False,
        proxy_headers=False,
        server_header=False,
        access_log=False,
        log_config=None,
        timeout_graceful_shutdown=_GRACE,
    )


def _why(error: OSError) -> tuple[str, str]:
    if error.errno == errno.EADDRINUSE:
        return "is used by another program", "End that program or choose another port; 0 takes any free one."
    if error.errno == errno.EACCES:
        return "may be used by the system only", "Choose a port above 1023; 0 takes any free one."
    return f"cannot be used: {error.strerror}", "Choose an address of this machine, such as 127.0.0.1."
