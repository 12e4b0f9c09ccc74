"""The designer's side of the server: shipped designs, checks, export and import, and the step into a simulation.

    GET  api/designs            names and descriptions of the designs that come with the package
    GET  api/designs/NAME       one of them, in SI
    GET  api/design/opened      the design that the command was given, if it was given one
    POST api/design/check       a design -> its problems
    POST api/design/export      a design -> ZIP (see `design.archive`)
    POST api/design/import      a ZIP -> the design in it
    POST api/design/mesh?name=  a mesh of another program (STL, glTF; &unit= of an STL) -> the part that it is
    POST api/design/simulate    a design, perhaps posture [rad or m], load [kg] and hs [m] of the sea -> the address of
                                its operation page
    POST api/design/change      a design, changes {path: m} -> the design with these sizes (see `design.changes`)
    POST api/design/optimise    a design, variables, goals, generations, population -> the search begins
    GET  api/design/optimise    {running, generations, front, stands, hindered, problems}: the front so far (see
                                `studies`), what the crane that the search began with reaches in each goal, and if no
                                candidate can be built, why the one that misses least cannot
    POST api/design/optimise/stop
    POST api/design/optimise/open     a saved front -> takes the place of the search, to go on from
    POST api/design/optimise/resume   generations in all -> the search goes on from its front

A request that is wrong gets 422 with all problems; each as path, message, value, allowed, hint.
"""

from __future__ import annotations

import asyncio
import hmac
import json
import math
import secrets
import signal
import tempfile
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import Any, Final, TypeGuard

import msgspec
from starlette.applications import Starlette
from starlette.requests import Request
from starlette.responses import JSONResponse, PlainTextResponse, RedirectResponse, Response
from starlette.routing import BaseRoute, Mount, Route
from starlette.staticfiles import StaticFiles
from starlette.types import ASGIApp

from seacrane import design, studies
from seacrane.design import Crane, archive, imported
from seacrane.errors import DesignError, ParameterError, SeacraneError
from seacrane.server import app
from seacrane.server.guard import Guard
from seacrane.server.serve import PORT, Listener, Server
from seacrane.server.simulation import Factory
from seacrane.studies import Front, plain

LARGEST_DESIGN: Final = 16 * 2**20
"""Largest design, as JSON, that is taken [bytes]."""


class Desk:
    """The designers' server in the running event loop: `await start()`, `await stop()`.

    `factory` names the function that builds a simulation from `crane` (path of a design file), `posture`, `load` and
    `hs`. At most one simulation runs at a time: the next takes the place of the last.
    """

    def __init__(
        self,
        factory: str,
        *,
        opened: Crane | None = None,
        host: str = "127.0.0.1",
        port: int = PORT,
        allow_remote: bool = False,
        page: Path = app.PAGE,
    ) -> None:
        self._factory = factory
        self._opened = opened
        self._listener = Listener(host, port, allow_remote=allow_remote)
        self._token = secrets.token_urlsafe(24)
        self._allow_remote = allow_remote
        self._page = page
        self._simulation: Server | None = None
        self._starting = asyncio.Lock()
        self._search = _Search(iter(()), 0)
        self._folder = tempfile.TemporaryDirectory(prefix="seacrane-designer-")

    def accepts_token(self, token: str | None) -> bool:
        """Whether this is the server's token."""
        return token is not None and hmac.compare_digest(token.encode(), self._token.encode())

    async def start(self) -> None:
        """Take the port and serve; `ServerError` if it cannot be had."""
        self._listener.listen()
        await self._listener.serve(self._application())

    @property
    def address_with_token(self) -> str:
        """Where the designer is, with the key to it."""
        return f"{self._listener.address}?token={self._token}"

    async def stop(self) -> None:
        """End the simulation, the search and the server. Harmless if they have ended."""
        self._search.stop()
        if self._simulation is not None:
            await self._simulation.stop()
        await self._listener.stop()
        self._folder.cleanup()

    # ---------------------------------------------------------------- HTTP
    def _application(self) -> ASGIApp:
        routes: list[BaseRoute] = [
            Route("/", self._front),
            Route("/api/designs", self._designs),
            Route("/api/designs/{name}", self._shipped),
            Route("/api/design/opened", self._given),
            Route("/api/design/check", _told(self._check), methods=["POST"]),
            Route("/api/design/export", _told(self._export), methods=["POST"]),
            Route("/api/design/import", _told(self._import), methods=["POST"]),
            Route("/api/design/mesh", _told(self._mesh), methods=["POST"]),
            Route("/api/design/simulate", _told(self._simulate), methods=["POST"]),
            Route("/api/design/change", _told(self._change), methods=["POST"]),
            Route("/api/design/optimise", _told(self._optimise), methods=["POST"]),
            Route("/api/design/optimise", self._front_so_far),
            Route("/api/design/optimise/stop", self._stop_search, methods=["POST"]),
            Route("/api/design/optimise/open", _told(self._open_front), methods=["POST"]),
            Route("/api/design/optimise/resume", _told(self._resume), methods=["POST"]),
        ]
        if (self._page / "designer.html").is_file():
            routes.append(Mount("/", StaticFiles(directory=self._page, html=True)))
        return Guard(Starlette(routes=routes), self, self._listener.host, self._listener.port)

    async def _front(self, request: Request) -> Response:
        if not (self._page / "designer.html").is_file():
            return PlainTextResponse("The page has not been built: run `make setup` in the source folder.\n", 503)
        return RedirectResponse("./designer.html")

    async def _designs(self, request: Request) -> Response:
        found = [design.load(name) for name in design.names()]
        return JSONResponse({"designs": [{"name": crane.name, "about": crane.about} for crane in found]})

    async def _shipped(self, request: Request) -> Response:
        name = request.path_params["name"]
        if name not in design.names():
            return JSONResponse({"problems": _problems(DesignError.at(name, "is no design of the package"))}, 404)
        return _design(design.load(name))

    async def _given(self, request: Request) -> Response:
        return Response(status_code=204) if self._opened is None else _design(self._opened)

    async def _check(self, request: Request) -> Response:
        content = await _body(request, LARGEST_DESIGN)
        try:
            design.loads(content)
        except DesignError as error:
            return JSONResponse({"problems": _problems(error)})
        return JSONResponse({"problems": []})

    async def _export(self, request: Request) -> Response:
        crane = design.loads(await _body(request, LARGEST_DESIGN))
        content = await asyncio.to_thread(archive.packed, crane)
        named = {"content-disposition": f'attachment; filename="{_plain(crane.name)}.zip"'}
        return Response(content, media_type="application/zip", headers=named)

    async def _import(self, request: Request) -> Response:
        content = await _body(request, archive.LARGEST)
        return _design(await asyncio.to_thread(archive.unpacked, content, "the archive"))

    async def _mesh(self, request: Request) -> Response:
        content = await _body(request, imported.LARGEST)
        asked = request.query_params
        part = await asyncio.to_thread(
            imported.part, content, asked.get("name", "mesh.stl"), unit=asked.get("unit", "m")
        )
        return JSONResponse(msgspec.to_builtins(part))

    async def _simulate(self, request: Request) -> Response:
        asked = _object(await _body(request, LARGEST_DESIGN))
        crane = design.loads(json.dumps(asked.get("design")))
        given = {name: asked[name] for name in ("posture", "load", "hs") if asked.get(name) is not None}
        posture = given.get("posture", {})
        numbers = (given.get("load", 0), given.get("hs", 0))
        if not isinstance(posture, dict) or not all(_number(q) for q in (*posture.values(), *numbers)):
            raise DesignError.at("posture, load, hs", "must be numbers: rad (or m) by joint, kg and m")
        async with self._starting:
            path = Path(self._folder.name) / f"{secrets.token_hex(8)}.json"
            design.save(crane, path)
            if self._simulation is not None:
                await self._simulation.stop()
                self._simulation = None
            simulation = Server(
                Factory(self._factory, {"crane": str(path), **given}),
                host=self._listener.host,
                port=0,
                tcp_port=None,
                allow_remote=self._allow_remote,
                page=self._page,
            )
            await simulation.start()
            self._simulation = simulation
        return JSONResponse({"address": simulation.address_with_token})

    async def _change(self, request: Request) -> Response:
        asked = _object(await _body(request, LARGEST_DESIGN))
        crane = design.loads(json.dumps(asked.get("design")))
        changes = asked.get("changes")
        if not isinstance(changes, dict) or not all(_number(size) and math.isfinite(size) for size in changes.values()):
            raise DesignError.at("changes", "must be numbers in m, by path", allowed=design.changes.PATHS)
        return _design(design.changes.changed(crane, changes))

    async def _optimise(self, request: Request) -> Response:
        asked = _object(await _body(request, LARGEST_DESIGN))
        crane = design.loads(json.dumps(asked.get("design")))
        variables, goals = studies.specification(asked, crane)
        generations, population = asked.get("generations", 50), asked.get("population", 40)
        if not (_count(generations) and _count(population)):
            raise ParameterError.at("generations, population", "must be whole numbers", allowed="1 to 1000")
        search = studies.optimise(crane, variables, goals, population=population, generations=generations)
        await self._begin(search, generations)
        return await self._front_so_far(request)

    async def _open_front(self, request: Request) -> Response:
        front = studies.loads(await _body(request, LARGEST_DESIGN))
        search = studies.optimise(front.crane, (), (), generations=front.generation, state=front)
        await self._begin(search, front.generation)
        return await self._front_so_far(request)

    async def _resume(self, request: Request) -> Response:
        generations = _object(await _body(request, LARGEST_DESIGN)).get("generations")
        front = self._search.front
        if front is None:
            raise ParameterError.at("optimisation", "no search has been begun that could go on")
        if not _count(generations) or generations <= front.generation:
            allowed = f"{front.generation + 1} to 1000"
            raise ParameterError.at("generations", "must be more than there are", value=generations, allowed=allowed)
        search = studies.optimise(front.crane, (), (), generations=generations, state=front)
        await self._begin(search, generations)
        return await self._front_so_far(request)

    async def _begin(self, fronts: Iterator[Front], generations: int) -> None:
        """Let a search take the place of the one before, unless it is refused."""
        search = _Search(fronts, generations)
        await asyncio.to_thread(search.judge)
        self._search.stop()
        self._search = search
        search.go_on()

    async def _front_so_far(self, request: Request) -> Response:
        search = self._search
        return JSONResponse(
            {
                "running": search.running,
                "generations": search.generations,
                "front": None if search.front is None else plain(search.front),
                "stands": search.stands,
                "hindered": search.hindered,
                "problems": [] if search.error is None else _problems(search.error),
            }
        )

    async def _stop_search(self, request: Request) -> Response:
        self._search.stop()
        return await self._front_so_far(request)


class _Search:
    """A search in a thread of its own: its front so far, or what ended it."""

    def __init__(self, fronts: Iterator[Front], generations: int) -> None:
        self.generations = generations
        self.front: Front | None = None
        self.stands: list[float] | None = None
        self.error: SeacraneError | None = None
        self.running = False
        self._fronts = fronts
        self._stopped = threading.Event()

    @property
    def hindered(self) -> list[str]:
        """Why no candidate can be built so far; empty if one can."""
        if self.front is None or self.front.best.any():
            return []
        return studies.why_not(self.front.design(self.front.nearest))

    def judge(self) -> None:
        """Judge the first candidates, so that what cannot be searched is refused here."""
        self.front = next(self._fronts)
        self.stands = studies.judged(self.front.crane, self.front.wanted)

    def go_on(self) -> None:
        """Search in a thread."""
        self.running = True
        threading.Thread(target=self._run, name="design search", daemon=True).start()

    def stop(self) -> None:
        """End after the generation that is being judged."""
        self._stopped.set()
        self.running = False

    def _run(self) -> None:
        try:
            for front in self._fronts:
                if self._stopped.is_set():
                    return
                self.front = front
        except SeacraneError as error:
            self.error = error
        finally:
            self.running = False


def serve_designer(
    factory: str,
    *,
    opened: Crane | None = None,
    host: str = "127.0.0.1",
    port: int = PORT,
    allow_remote: bool = False,
) -> None:
    """Serve the designer until interrupted (SIGINT, SIGTERM); its address with the token is printed.

    `factory` as in `Desk`; `opened`: the design that the page shows first.
    """
    asyncio.run(_until_interrupted(factory, opened, host, port, allow_remote))


async def _until_interrupted(factory: str, opened: Crane | None, host: str, port: int, allow_remote: bool) -> None:
    desk = Desk(factory, opened=opened, host=host, port=port, allow_remote=allow_remote)
    interrupted = asyncio.Event()
    for number in (signal.SIGINT, signal.SIGTERM):
        asyncio.get_running_loop().add_signal_handler(number, interrupted.set)
    try:
        await desk.start()
        print(f"Open {desk.address_with_token}", flush=True)
        await interrupted.wait()
    finally:
        await desk.stop()


def _told(answer: Any) -> Any:
    """The handler, whose errors the page is told."""

    async def handler(request: Request) -> Response:
        try:
            response: Response = await answer(request)
        except SeacraneError as error:
            return JSONResponse({"problems": _problems(error)}, 422)
        return response

    return handler


async def _body(request: Request, most: int) -> bytes:
    content = bytearray()
    async for chunk in request.stream():
        content += chunk
        if len(content) > most:
            raise DesignError.at("request", f"is larger than {most // 2**20} MiB")
    return bytes(content)


def _object(content: bytes) -> dict[str, Any]:
    try:
        value = json.loads(content)
    except (ValueError, RecursionError):
        value = None
    if not isinstance(value, dict):
        raise DesignError.at("request", "must be a JSON object with design, posture and load")
    return value


def _number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def _count(value: object) -> TypeGuard[int]:
    return isinstance(value, int) and not isinstance(value, bool) and 1 <= value <= 1000


def _design(crane: Crane) -> Response:
    return Response(design.to_json(crane), media_type="application/json")


def _problems(error: SeacraneError) -> list[dict[str, Any]]:
    return [
        {"path": p.path, "message": p.message, "value": _shown(p.value), "allowed": p.allowed, "hint": p.hint}
        for p in error.problems
    ]


def _shown(value: object) -> str | None:
    return None if value is None else str(value)


def _plain(name: str) -> str:
    return "".join(c if c.isascii() and (c.isalnum() or c in "-_.") else "_" for c in name) or "crane"
