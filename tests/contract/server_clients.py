"""Clients and a running server for the tests."""

from __future__ import annotations

import asyncio
import itertools
import json
import threading
from collections.abc import AsyncIterator, Coroutine, Iterator
from contextlib import asynccontextmanager, contextmanager
from pathlib import Path
from typing import Any

import httpx
from websockets.asyncio.client import ClientConnection, connect

from seacrane.server import Factory, Server

TOKEN = "a-token-for-tests"


def run(coroutine: Coroutine[Any, Any, None], timeout: float = 40.0) -> None:
    """Run a test's coroutine, but not for ever."""
    asyncio.run(asyncio.wait_for(coroutine, timeout))


@asynccontextmanager
async def running(
    target: str = "server_plant:build", page: Path | None = None, **arguments: Any
) -> AsyncIterator[Server]:
    """A server on free ports in this event loop."""
    options = {} if page is None else {"page": page}
    server = Server(Factory(target, arguments), port=0, tcp_port=0, token=TOKEN, **options)
    await server.start()
    try:
        yield server
    finally:
        await server.stop()


@contextmanager
def running_beside(page: Path | None = None) -> Iterator[Server]:
    """A server on free ports in an event loop of its own, for tests that leave it as they find it."""
    loop = asyncio.new_event_loop()
    thread = threading.Thread(target=loop.run_forever)
    thread.start()
    context = running(page=page)
    try:
        server = asyncio.run_coroutine_threadsafe(context.__aenter__(), loop).result(30)
        try:
            yield server
        finally:
            asyncio.run_coroutine_threadsafe(context.__aexit__(None, None, None), loop).result(30)
    finally:
        loop.call_soon_threadsafe(loop.stop)
        thread.join()
        loop.close()


class RpcError(Exception):
    """An error response."""

    def __init__(self, error: dict[str, Any]) -> None:
        super().__init__(error["message"])
        self.code, self.message, self.data = error["code"], error["message"], error.get("data")


class Client:
    """A JSON-RPC client over WebSocket that acknowledges each frame and keeps it."""

    def __init__(self, connection: ClientConnection, acknowledges: bool) -> None:
        self.connection = connection
        self.frames: list[dict[str, Any]] = []
        self.times: list[float] = []
        self._acknowledges = acknowledges
        self._ids = itertools.count(1)
        self._waiting: dict[int, asyncio.Future[Any]] = {}
        self._news = asyncio.Condition()
        self._reader = asyncio.create_task(self._read())

    async def call(self, method: str, **params: Any) -> Any:
        """The result of a method; `RpcError` if it refuses."""
        number = next(self._ids)
        future = self._waiting[number] = asyncio.get_running_loop().create_future()
        await self.connection.send(json.dumps({"jsonrpc": "2.0", "id": number, "method": method, "params": params}))
        response = await asyncio.wait_for(future, 10)
        if "error" in response:
            raise RpcError(response["error"])
        return response["result"]

    async def until(self, condition: Any, timeout: float = 10.0) -> None:
        """Wait until `condition()` holds, looking at each frame."""
        async with self._news:
            await asyncio.wait_for(self._news.wait_for(condition), timeout)

    async def close(self) -> None:
        """End the connection."""
        self._reader.cancel()
        await self.connection.close()

    async def _read(self) -> None:
        async for message in self.connection:
            content = json.loads(message)
            if content.get("method") == "stream.frame":
                frame = content["params"]
                self.frames.append(frame)
                self.times.append(asyncio.get_running_loop().time())
                if self._acknowledges:
                    ack = {"subscription": frame["subscription"], "seq": frame["seq"]}
                    await self.connection.send(json.dumps({"jsonrpc": "2.0", "method": "stream.ack", "params": ack}))
                async with self._news:
                    self._news.notify_all()
            else:
                self._waiting.pop(content["id"]).set_result(content)


@asynccontextmanager
async def client(server: Server, *, acknowledges: bool = True) -> AsyncIterator[Client]:
    """A client of this server over WebSocket."""
    address = server.address.replace("http", "ws") + "rpc"
    headers = {"Authorization": f"Bearer {TOKEN}"}
    async with connect(address, additional_headers=headers, compression=None) as connection:
        each = Client(connection, acknowledges)
        try:
            yield each
        finally:
            await each.close()


async def get(server: Server, path: str, **headers: str) -> httpx.Response:
    """An HTTP answer of this server, without following redirects."""
    async with httpx.AsyncClient(base_url=server.address, timeout=10) as http:
        return await http.get(path, headers=headers)


async def get_with_token(server: Server, path: str) -> httpx.Response:
    """An HTTP answer of this server to one that has the token."""
    return await get(server, path, Authorization=f"Bearer {TOKEN}")
