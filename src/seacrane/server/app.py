"""The HTTP side: the page, the recording, the OpenRPC document, and the WebSocket."""

from __future__ import annotations

from pathlib import Path
from typing import Final

from starlette.applications import Starlette
from starlette.requests import Request
from starlette.responses import JSONResponse, PlainTextResponse, Response, StreamingResponse
from starlette.routing import BaseRoute, Mount, Route, WebSocketRoute
from starlette.staticfiles import StaticFiles
from starlette.types import ASGIApp
from starlette.websockets import WebSocket

import seacrane
from seacrane.errors import ServerError
from seacrane.server.guard import Guard
from seacrane.server.service import Service
from seacrane.server.websocket import WebSocketLink, messages

PAGE: Final = Path(__file__).parent / "page"
_NOT_BUILT: Final = (
    "The simulation is running, but the web page has not been built. "
    "Run `make setup` in the source folder, then start the server again.\n"
)


def create(service: Service, host: str, port: int, page: Path = PAGE) -> ASGIApp:
    """The application that serves one simulation at this address."""

    async def rpc(websocket: WebSocket) -> None:
        await websocket.accept()
        await service.converse(WebSocketLink(websocket), messages(websocket), authenticated=True)

    async def recording(request: Request) -> Response:
        given = request.query_params.get("variables")
        names = list(service.simulation.names) if given is None else [name.strip() for name in given.split(",")]
        try:
            service.columns(names, "variables")
        except ServerError as error:
            return PlainTextResponse(f"{error}\n", 400)
        return StreamingResponse(
            service.simulation.recording_csv(names),
            media_type="text/csv",
            headers={"content-disposition": 'attachment; filename="recording.csv"'},
        )

    async def openrpc(request: Request) -> Response:
        return JSONResponse(service.dispatcher.openrpc("seacrane", seacrane.__version__))

    async def not_built(request: Request) -> Response:
        return PlainTextResponse(_NOT_BUILT, 503)

    routes: list[BaseRoute] = [
        WebSocketRoute("/rpc", rpc),
        Route("/api/recording.csv", recording),
        Route("/api/openrpc.json", openrpc),
    ]
    if (page / "index.html").is_file():
        routes.append(Mount("/", StaticFiles(directory=page, html=True)))
    else:
        routes.append(Route("/", not_built))
    return Guard(Starlette(routes=routes), service, host, port)
