"""The same methods over TCP: one line of JSON is one message, and the first call is `authenticate {token}`."""

from __future__ import annotations

import asyncio
import socket
from collections.abc import AsyncIterator

from seacrane.server import limits, rpc
from seacrane.server.service import Service
from seacrane.server.websocket import bound


class TcpLink:
    """A way to one client over a TCP connection."""

    def __init__(self, writer: asyncio.StreamWriter) -> None:
        self._writer = writer

    async def send(self, message: bytes) -> None:
        """Send one line; returns when there is room for the next."""
        self._writer.write(message + b"\n")
        await self._writer.drain()

    def abort(self) -> None:
        """Cut the connection at once, with whatever is unsent."""
        self._writer.transport.abort()


async def listen(service: Service, listener: socket.socket) -> asyncio.Server:
    """Serve clients that connect to this listening socket."""
    connections: set[asyncio.Task[None]] = set()

    async def serve_one(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        task = asyncio.current_task()
        assert task is not None
        connections.add(task)
        task.add_done_callback(connections.discard)
        bound(writer.transport)
        link = TcpLink(writer)
        try:
            await service.converse(link, _lines(reader, link), authenticated=False)
        except (ConnectionError, asyncio.CancelledError):
            link.abort()
        finally:
            writer.close()

    return await asyncio.start_server(serve_one, sock=listener, limit=limits.MESSAGE_BYTES)


async def _lines(reader: asyncio.StreamReader, link: TcpLink) -> AsyncIterator[bytes]:
    while True:
        try:
            line = await reader.readuntil()
        except asyncio.LimitOverrunError:
            await link.send(rpc.refusal(rpc.INVALID_REQUEST, f"a line holds at most {limits.MESSAGE_BYTES} bytes"))
            return
        except (asyncio.IncompleteReadError, ConnectionError):
            return
        if line.strip():
            yield line
