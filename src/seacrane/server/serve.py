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
        if not is_loopback(host) and not allow_remote:
            raise ServerError.at(
                "host",
                f"{host!r} can be reached from other machines, and the connection is not encrypted",
                allowed="127.0.0.1, ::1, localhost",
                hint="Allow it (--allow-remote) if everyone on that network may see the token.",
            )
        self.host = host
        self.token = token or secrets.token_urlsafe(24)
        self.simulation = SimulationProcess(factory)
        self.service = Service(self.simulation, self.token)
        self._ports = (port, tcp_port)
        self._page = page
        self._listeners: list[socket.socket] = []
        self._tasks: list[asyncio.Task[None]] = []
        self._http: _Uvicorn | None = None
        self._tcp: asyncio.Server | None = None

    async def start(self) -> None:
        """Take the ports, build the simulation, serve; `ServerError` with nothing left running if any of it fails."""
        try:
            port, tcp_port = self._ports
            http_listener = self._listen(port)
            tcp_listener = None if tcp_port is None else self._listen(tcp_port)
            self.port: int = http_listener.getsockname()[1]
            self.tcp_port: int | None = None if tcp_listener is None else tcp_listener.getsockname()[1]
            await self.simulation.start()
            self._http = _Uvicorn(_config(app.create(self.service, self.host, self.port, self._page)))
            self._tasks.append(asyncio.create_task(self._http.serve([http_listener])))
            self._tasks.append(asyncio.create_task(self.service.housekeeping()))
            if tcp_listener is not None:
                self._tcp = await tcp.listen(self.service, tcp_listener)
            while not self._http.started:
                await asyncio.sleep(0.005)
        except BaseException:
            await self.stop()
            raise

    @property
    def address(self) -> str:
        """Where the page is."""
        host = f"[{self.host}]" if ":" in self.host else self.host
        return f"http://{host}:{self.port}/"

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
        if self._http is not None:
            self._http.should_exit = True
            await asyncio.wait(self._tasks[:1], timeout=3 * _GRACE)
        for task in self._tasks:
            task.cancel()
        await asyncio.gather(*self._tasks, return_exceptions=True)
        self._tasks.clear()
        for listener in self._listeners:
            listener.close()
        await self.simulation.stop()

    def _listen(self, port: int) -> socket.socket:
        family = socket.AF_INET6 if ":" in self.host else socket.AF_INET
        listener = socket.socket(family, socket.SOCK_STREAM)
        self._listeners.append(listener)
        listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            listener.bind((self.host, port))
            # Listening takes the port for good; clients that connect now are served once the simulation is built.
            listener.listen(128)
        except OSError as error:
            message, hint = _why(error)
            raise ServerError.at(f"port {port}", message, hint=hint) from None
        listener.setblocking(False)
        return listener


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
