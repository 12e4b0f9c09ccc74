"""Who may speak to the server over HTTP and WebSocket: checked on every path, before anything else happens.

Any page in any browser can send requests to a port of its own machine. So a request must come from a page of this
server (Origin), must have been addressed to this server by a name that no stranger can point at it (Host), and must
carry the token.
"""

from __future__ import annotations

import ipaddress
import socket
from http.cookies import CookieError, SimpleCookie
from typing import Final, Protocol
from urllib.parse import parse_qs, urlencode, urlsplit

from starlette.datastructures import Headers, MutableHeaders
from starlette.responses import PlainTextResponse, RedirectResponse, Response
from starlette.types import ASGIApp, Message, Receive, Scope, Send
from starlette.websockets import WebSocket

UNAUTHENTICATED: Final = 4401
"""WebSocket close code: the token is missing or wrong."""

# Scripts and workers only from here; blob: for what the page makes itself (textures, downloads, workers).
_POLICY: Final = "; ".join(
    (
        "default-src 'self'",
        # and WebAssembly, which the load chart is computed in
        "script-src 'self' 'wasm-unsafe-eval'",
        "style-src 'self' 'unsafe-inline'",
        "img-src 'self' data: blob:",
        "font-src 'self' data:",
        "connect-src 'self' data: blob:",
        "worker-src 'self' blob:",
        "object-src 'none'",
        "base-uri 'none'",
        "form-action 'none'",
        "frame-ancestors 'none'",
    )
)
_HEADERS: Final = {
    "content-security-policy": _POLICY,
    "x-content-type-options": "nosniff",
    "referrer-policy": "no-referrer",
    "cross-origin-opener-policy": "same-origin",
    "cross-origin-resource-policy": "same-origin",
    "cache-control": "no-cache",
}
_LOOPBACK_NAMES: Final = frozenset({"localhost", "127.0.0.1", "::1"})
_NO_TOKEN: Final = (
    "The token is missing or wrong. Open the address that the server printed when it started: it carries the token.\n"
)


class Lock(Protocol):
    """What knows the token."""

    def accepts_token(self, token: str | None) -> bool:
        """Whether this is the token; takes the same time for every wrong one."""


def is_loopback(host: str) -> bool:
    """Whether this address can be reached from this machine only."""
    if host == "localhost":
        return True
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return False


class Guard:
    """ASGI middleware: Host, Origin, token; and security headers on every answer."""

    def __init__(self, app: ASGIApp, lock: Lock, host: str, port: int) -> None:
        self._app = app
        self._lock = lock
        self._cookie = f"seacrane-{port}"
        self._open = not is_loopback(host)
        self._names = _LOOPBACK_NAMES | {host} | ({socket.gethostname(), socket.getfqdn()} if self._open else set())

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Called by the server for each connection."""
        if scope["type"] == "lifespan":
            await self._app(scope, receive, send)
            return

        async def send_with_headers(message: Message) -> None:
            if message["type"] in ("http.response.start", "websocket.http.response.start"):
                headers = MutableHeaders(raw=message["headers"])
                for name, value in _HEADERS.items():
                    headers[name] = value
            await send(message)

        refusal = self._refusal(scope)
        if refusal is not None and scope["type"] == "websocket" and refusal.status_code == 401:
            # A page cannot see why a handshake failed, but it can see a close code.
            websocket = WebSocket(scope, receive, send)
            await websocket.receive()
            await websocket.accept()
            await websocket.close(UNAUTHENTICATED, "the token is missing or wrong")
        elif refusal is not None and scope["type"] == "websocket":
            await WebSocket(scope, receive, send_with_headers).send_denial_response(refusal)
        elif refusal is not None:
            await refusal(scope, receive, send_with_headers)
        else:
            await self._app(scope, receive, send_with_headers)

    def _refusal(self, scope: Scope) -> Response | None:
        """The answer to a request that may not pass; None if it may."""
        headers = Headers(scope=scope)
        host = headers.get("host", "")
        if not self._knows(host):
            return PlainTextResponse(f"This server does not answer to the name {host!r}.\n", 403)
        origin = headers.get("origin")
        if origin is not None and urlsplit(origin).netloc != host:
            return PlainTextResponse(f"Pages from {origin!r} may not use this server.\n", 403)
        query = parse_qs(scope["query_string"].decode("latin-1"), keep_blank_values=True)
        asked = query.get("token", [None])[0]
        if asked is not None and self._lock.accepts_token(asked):
            return self._welcome(scope, query)
        kind, _, bearer = headers.get("authorization", "").partition(" ")
        if kind.lower() == "bearer" and self._lock.accepts_token(bearer.strip()):
            return None
        if self._lock.accepts_token(self._cookie_of(headers)):
            return None
        return PlainTextResponse(_NO_TOKEN, 401, headers={"www-authenticate": "Bearer"})

    def _knows(self, host: str) -> bool:
        """Whether a Host header names this server. A stranger can make a name point here, but not an address."""
        try:
            name = urlsplit(f"//{host}").hostname
        except ValueError:
            return False
        if name is None:
            return False
        if name in self._names:
            return True
        try:
            ipaddress.ip_address(name)
        except ValueError:
            return False
        return self._open

    def _welcome(self, scope: Scope, query: dict[str, list[str]]) -> Response | None:
        """A page opened with the token keeps it in a cookie, out of the address bar and the history."""
        if scope["type"] != "http" or scope["path"] != "/" or scope["method"] not in ("GET", "HEAD"):
            return None
        token = query.pop("token")[0]
        rest = urlencode(query, doseq=True)
        response = RedirectResponse("/" + (f"?{rest}" if rest else ""), 303)
        response.set_cookie(self._cookie, token, httponly=True, samesite="strict", path="/")
        return response

    def _cookie_of(self, headers: Headers) -> str | None:
        cookies: SimpleCookie = SimpleCookie()
        try:
            cookies.load(headers.get("cookie", ""))
        except CookieError:
            return None
        morsel = cookies.get(self._cookie)
        return None if morsel is None else morsel.value
