"""JSON-RPC over WebSocket: one message each way is one WebSocket text message."""

from __future__ import annotations

import asyncio
import socket
from collections.abc import AsyncIterator, Callable
from typing import Any, Final

from starlette.websockets import WebSocket, WebSocketDisconnect
from uvicorn.protocols.websockets.websockets_sansio_impl import WebSocketsSansIOProtocol

SEND_BUFFER: Final = 128 * 1024
"""Bytes on the way to a client, in the kernel and above it each, beyond which it counts as slow."""
_ABORT: Final = "seacrane.abort"


def bound(transport: asyncio.BaseTransport) -> None:
    """Keep what is on the way to a client small, so that a slow one is noticed and never holds old frames."""
    raw = transport.get_extra_info("socket")
    if raw is not None and raw.family in (socket.AF_INET, socket.AF_INET6):
        raw.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, SEND_BUFFER)
        raw.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
    if isinstance(transport, asyncio.WriteTransport):
        transport.set_write_buffer_limits(high=SEND_BUFFER)


class BoundedProtocol(WebSocketsSansIOProtocol):
    """Uvicorn's WebSocket protocol with bounded buffers, whose application can cut a connection that takes nothing."""

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """Called by the event loop."""
        super().connection_made(transport)
        bound(transport)

    async def run_asgi(self) -> None:
        """Called by the protocol for each connection."""
        extensions: dict[str, Any] = self.scope["extensions"]
        extensions[_ABORT] = self.transport.abort
        await super().run_asgi()


class WebSocketLink:
    """A way to one client over an accepted WebSocket."""

    def __init__(self, websocket: WebSocket) -> None:
        self._websocket = websocket
        self._abort: Callable[[], None] = websocket.scope["extensions"][_ABORT]

    async def send(self, message: bytes) -> None:
        """Send one message; returns when there is room for the next."""
        await self._websocket.send({"type": "websocket.send", "text": message.decode()})

    def abort(self) -> None:
        """Cut the connection at once, with whatever is unsent."""
        self._abort()


async def messages(websocket: WebSocket) -> AsyncIterator[bytes]:
    """All messages of a client until it disconnects."""
    while True:
        try:
            event = await websocket.receive()
        except WebSocketDisconnect:
            return
        if event["type"] == "websocket.disconnect":
            return
        text = event.get("text")
        yield text.encode() if text is not None else event["bytes"]
