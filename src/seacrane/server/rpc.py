"""JSON-RPC 2.0 on msgspec: methods are functions with typed parameters, and types are meant strictly.

A method is registered with `Dispatcher.method(name)` on a function `(caller, params) -> result`, plain or async, whose
annotations say everything: `params` is a frozen `Params` struct, the result a struct or a plain JSON type. From the
same annotations comes the OpenRPC document. No text passes for a number, no unknown parameter is ignored.

Source: JSON-RPC 2.0 Specification (2013), sections 4 to 6; OpenRPC Specification 1.3.
"""

from __future__ import annotations

import inspect
import logging
import typing
from collections.abc import Awaitable, Callable
from dataclasses import dataclass
from typing import Any, Final, Generic, Literal, TypeVar

import msgspec

from seacrane.errors import Problem, SeacraneError, nearest
from seacrane.server.shared import problem_json

PARSE_ERROR: Final = -32700
INVALID_REQUEST: Final = -32600
METHOD_NOT_FOUND: Final = -32601
INVALID_PARAMS: Final = -32602
INTERNAL_ERROR: Final = -32603
SEACRANE_ERROR: Final = -32000

BATCH_LIMIT: Final = 100
"""Most calls in one batch."""

_log = logging.getLogger(__name__)
_MALFORMED = (msgspec.DecodeError, UnicodeDecodeError, RecursionError)

Id = str | int | float | None


class Params(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Base of the parameters of a method, given by name."""


class NoParams(Params, frozen=True):
    """A method without parameters."""


class ErrorObject(msgspec.Struct, frozen=True, omit_defaults=True):
    """The `error` member of a response."""

    code: int
    message: str
    data: dict[str, Any] | None = None


class _Request(msgspec.Struct, frozen=True):
    jsonrpc: Literal["2.0"]
    method: str
    params: msgspec.Raw = msgspec.Raw(b"{}")
    id: Id | msgspec.UnsetType = msgspec.UNSET


class _IdOnly(msgspec.Struct, frozen=True):
    id: Id = None


class _Success(msgspec.Struct, frozen=True):
    result: Any
    id: Id
    jsonrpc: str = "2.0"


class _Refusal(msgspec.Struct, frozen=True):
    error: ErrorObject
    id: Id
    jsonrpc: str = "2.0"


class _Notification(msgspec.Struct, frozen=True):
    method: str
    params: Any
    jsonrpc: str = "2.0"


Caller = TypeVar("Caller")
_decode_request = msgspec.json.Decoder(_Request).decode
_decode_id = msgspec.json.Decoder(_IdOnly).decode
_decode_batch = msgspec.json.Decoder(list[msgspec.Raw]).decode
_encode = msgspec.json.Encoder().encode


@dataclass(frozen=True)
class Method(Generic[Caller]):
    """A registered method."""

    name: str
    about: str
    params: type[Params]
    result: Any
    function: Callable[[Caller, Any], Any]
    decode: Callable[[bytes | msgspec.Raw], Any]


def notification(method: str, params: Any) -> bytes:
    """A message to the other side that asks for no answer."""
    return _encode(_Notification(method, params))


def refusal(code: int, message: str, id: Id = None, data: dict[str, Any] | None = None) -> bytes:
    """An error response."""
    return _encode(_Refusal(ErrorObject(code, message, data), id))


class Dispatcher(Generic[Caller]):
    """Decodes requests, calls methods, encodes responses. `Caller` is what a method is told about who calls."""

    def __init__(self) -> None:
        self.methods: dict[str, Method[Caller]] = {}

    def method(self, name: str) -> Callable[[Callable[..., Any]], Callable[..., Any]]:
        """Register a function as the method of this name."""

        def register(function: Callable[..., Any]) -> Callable[..., Any]:
            hints = typing.get_type_hints(function, include_extras=True)
            result = hints.pop("return", type(None))
            parameters = [hint for key, hint in hints.items() if isinstance(hint, type) and issubclass(hint, Params)]
            if len(parameters) != 1 or not inspect.getdoc(function):
                raise TypeError(f"method {name!r} needs one Params parameter and a docstring")
            decode = msgspec.json.Decoder(parameters[0]).decode
            self.methods[name] = Method(name, inspect.getdoc(function) or "", parameters[0], result, function, decode)
            return function

        return register

    async def handle(self, caller: Caller, message: bytes | str) -> bytes | None:
        """The response to a message, a single request or a batch; None if it asks for none. Raises nothing."""
        data = message.encode() if isinstance(message, str) else message
        if data.lstrip()[:1] != b"[":
            return await self._single(caller, data)
        try:
            batch = _decode_batch(data)
        except _MALFORMED as error:
            return refusal(PARSE_ERROR, f"not valid JSON: {error}")
        if not batch:
            return refusal(INVALID_REQUEST, "an empty batch asks for nothing")
        if len(batch) > BATCH_LIMIT:
            return refusal(INVALID_REQUEST, f"a batch holds at most {BATCH_LIMIT} calls")
        responses = [await self._single(caller, bytes(request)) for request in batch]
        answers = [response for response in responses if response is not None]
        return b"[" + b",".join(answers) + b"]" if answers else None

    async def _single(self, caller: Caller, data: bytes) -> bytes | None:
        try:
            request = _decode_request(data)
        except msgspec.ValidationError as error:
            return _refuse_request(data, error)
        except _MALFORMED as error:
            return refusal(PARSE_ERROR, f"not valid JSON: {error}")
        wants_answer = not isinstance(request.id, msgspec.UnsetType)
        id = None if isinstance(request.id, msgspec.UnsetType) else request.id
        try:
            result = await self._call(caller, request)
            response = _encode(_Success(result, id)) if wants_answer else b""
        except _Refused as refused:
            response = _encode(_Refusal(refused.error, id))
        except SeacraneError as error:
            response = refusal(SEACRANE_ERROR, str(error), id, _problems(error.code, error.problems))
        except Exception:
            _log.exception("method %r failed", request.method)
            response = refusal(INTERNAL_ERROR, "internal error; the server's log says more", id)
        return response if wants_answer else None

    async def _call(self, caller: Caller, request: _Request) -> Any:
        method = self.methods.get(request.method)
        if method is None:
            hint = nearest(request.method, self.methods)
            raise _Refused(ErrorObject(METHOD_NOT_FOUND, f"no method {request.method!r}. {hint}"))
        try:
            params = method.decode(request.params)
        except _MALFORMED as error:
            raise _Refused(_invalid_params(method.params, error)) from None
        result = method.function(caller, params)
        return await result if isinstance(result, Awaitable) else result

    def openrpc(self, title: str, version: str) -> dict[str, Any]:
        """The OpenRPC document of all methods."""
        types = {method.name: (method.params, method.result) for method in self.methods.values()}
        results = [result for _, result in types.values()]
        schemas, components = msgspec.json.schema_components(
            [*(params for params, _ in types.values()), *results], ref_template="#/components/schemas/{name}"
        )
        methods = []
        for method, result in zip(self.methods.values(), schemas[len(types) :], strict=True):
            own = components[method.params.__name__]
            required = set(own.get("required", ()))
            methods.append(
                {
                    "name": method.name,
                    "summary": method.about.partition("\n")[0],
                    "description": method.about,
                    "paramStructure": "by-name",
                    "params": [
                        {"name": name, "required": name in required, "schema": schema}
                        for name, schema in own["properties"].items()
                    ],
                    "result": {"name": "result", "schema": result},
                }
            )
        given = {method.params.__name__ for method in self.methods.values()}
        return {
            "openrpc": "1.3.2",
            "info": {"title": title, "version": version},
            "methods": methods,
            "components": {"schemas": {name: schema for name, schema in components.items() if name not in given}},
        }


class _Refused(Exception):
    def __init__(self, error: ErrorObject) -> None:
        self.error = error


def _refuse_request(data: bytes, error: Exception) -> bytes:
    """The refusal of what is no request, with its id where it has a proper one."""
    id: Id = None
    try:
        id = _decode_id(data).id
    except msgspec.ValidationError:
        pass
    except _MALFORMED as malformed:
        return refusal(PARSE_ERROR, f"not valid JSON: {malformed}")
    return refusal(INVALID_REQUEST, f"not a JSON-RPC 2.0 request: {error}", id)


def _problems(code: str, problems: tuple[Problem, ...]) -> dict[str, Any]:
    return {"code": code, "problems": [problem_json(problem) for problem in problems]}


def _invalid_params(params: type[Params], error: Exception) -> ErrorObject:
    """What msgspec found, with the place as a path and, for an unknown parameter, the nearest known ones."""
    message, _, place = str(error).partition(" - at `")
    path = place.rstrip("`").removeprefix("$").removeprefix(".")
    hint = None
    if message.startswith("Object contains unknown field `") and not path:
        unknown = message.split("`")[1]
        message, path = "unknown parameter", unknown
        hint = nearest(unknown, params.__struct_fields__)
    problem = Problem(path, message, hint=hint)
    return ErrorObject(INVALID_PARAMS, f"invalid params: {problem}", _problems("parameters", (problem,)))
