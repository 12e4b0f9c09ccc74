"""The dispatcher against JSON-RPC 2.0, and against everything that is no JSON-RPC."""

import asyncio
import json
from typing import Annotated

import msgspec
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from seacrane.errors import ParameterError, Problem
from seacrane.server import rpc


class Move(rpc.Params, frozen=True):
    """Parameters of the test method."""

    crane: str
    axes: list[float]
    hold: bool = False
    rate: Annotated[float, msgspec.Meta(ge=0, le=1)] = 1.0


class Moved(msgspec.Struct, frozen=True):
    """Result of the test method."""

    count: int
    by: str


def make():
    methods = rpc.Dispatcher()

    @methods.method("crane.move")
    def move(caller: str, params: Move) -> Moved:
        """Move the crane.

        More about it.
        """
        return Moved(len(params.axes), caller)

    @methods.method("crane.wait")
    async def wait(caller: str, params: rpc.NoParams) -> float:
        """Wait a little."""
        await asyncio.sleep(0)
        return 0.5

    @methods.method("crane.overload")
    def overload(caller: str, params: rpc.NoParams) -> None:
        """Always too much."""
        raise ParameterError([Problem("load", "is too heavy", 120e3, "<= 100 t", "Use a shorter radius.")])

    @methods.method("crane.collapse")
    def collapse(caller: str, params: rpc.NoParams) -> None:
        """A defect."""
        raise ZeroDivisionError("secret detail")

    return methods


METHODS = make()


def handle(message):
    return asyncio.run(METHODS.handle("me", message))


def ask(message):
    answer = handle(message if isinstance(message, str | bytes) else json.dumps(message))
    return None if answer is None else json.loads(answer)


def request(method, params=None, id=1):
    return {"jsonrpc": "2.0", "id": id, "method": method, **({} if params is None else {"params": params})}


GOOD = {"crane": "a", "axes": [0.1, 2]}


def test_a_call_is_answered_with_its_result_and_id():
    assert ask(request("crane.move", GOOD, "seven")) == {
        "jsonrpc": "2.0",
        "id": "seven",
        "result": {"count": 2, "by": "me"},
    }
    assert ask(request("crane.wait"))["result"] == 0.5


@pytest.mark.parametrize(
    ("params", "path", "message"),
    [
        ({"crane": "a", "axes": ["0.1"]}, "axes[0]", "Expected `float`, got `str`"),
        ({"crane": "a", "axes": [True]}, "axes[0]", "Expected `float`, got `bool`"),
        ({"crane": "a", "axes": [None]}, "axes[0]", "Expected `float`, got `null`"),
        ({"crane": 5, "axes": []}, "crane", "Expected `str`, got `int`"),
        ({"crane": "a", "axes": [], "hold": 1}, "hold", "Expected `bool`, got `int`"),
        ({"crane": "a", "axes": [], "rate": 2}, "rate", "Expected `float` <= 1.0"),
        ({"axes": []}, "", "missing required field `crane`"),
        ([0.1], "", "Expected `object`, got `array`"),
        ("a", "", "Expected `object`, got `str`"),
    ],
)
def test_parameters_of_another_type_are_refused_with_their_place(params, path, message):
    error = ask(request("crane.move", params))["error"]
    assert error["code"] == rpc.INVALID_PARAMS
    assert message in error["message"]
    assert error["data"]["problems"][0]["path"] == path


def test_an_unknown_parameter_is_refused_with_the_nearest():
    error = ask(request("crane.move", {**GOOD, "hodl": True}))["error"]
    assert error["code"] == rpc.INVALID_PARAMS
    assert error["message"] == "invalid params: hodl: unknown parameter. Did you mean 'hold'?"


def test_an_unknown_method_is_answered_with_the_nearest():
    error = ask(request("crane.mvoe"))["error"]
    assert error["code"] == rpc.METHOD_NOT_FOUND
    assert error["message"].startswith("no method 'crane.mvoe'. Did you mean 'crane.move'")


def test_an_error_of_the_package_keeps_its_code_and_problems():
    error = ask(request("crane.overload"))["error"]
    assert error["code"] == rpc.SEACRANE_ERROR
    assert error["data"] == {
        "code": "parameter",
        "problems": [
            {
                "path": "load",
                "message": "is too heavy",
                "value": 120e3,
                "allowed": "<= 100 t",
                "hint": "Use a shorter radius.",
            }
        ],
    }


def test_a_defect_is_an_internal_error_without_its_details():
    error = ask(request("crane.collapse"))["error"]
    assert error["code"] == rpc.INTERNAL_ERROR
    assert "secret" not in json.dumps(error)


@pytest.mark.parametrize(
    "text", ["", "{", "nonsense", '{"jsonrpc":"2.0"', b"\xff\xfe", "[1,2", '{"a":1}x', "[" * 100_000]
)
def test_what_is_no_json_is_a_parse_error(text):
    answer = ask(text)
    assert (answer["error"]["code"], answer["id"]) == (rpc.PARSE_ERROR, None)


@pytest.mark.parametrize(
    ("message", "id"),
    [
        ("1", None),
        ('"text"', None),
        ("null", None),
        ("{}", None),
        ("[]", None),
        ('{"jsonrpc":"2.0","id":4}', 4),
        ('{"jsonrpc":"1.0","id":4,"method":"crane.wait"}', 4),
        ('{"id":"x","method":"crane.wait"}', "x"),
        ('{"jsonrpc":"2.0","id":4,"method":7}', 4),
        ('{"jsonrpc":"2.0","id":{},"method":"crane.wait"}', None),
        ('{"jsonrpc":"2.0","id":[1],"method":"crane.wait"}', None),
    ],
)
def test_what_is_no_request_is_an_invalid_request(message, id):
    answer = ask(message)
    assert (answer["error"]["code"], answer["id"]) == (rpc.INVALID_REQUEST, id)


def test_a_notification_is_carried_out_and_not_answered():
    assert handle('{"jsonrpc":"2.0","method":"crane.wait"}') is None
    assert handle('{"jsonrpc":"2.0","method":"none"}') is None
    assert handle('{"jsonrpc":"2.0","method":"crane.collapse"}') is None


def test_an_id_of_null_is_no_notification():
    assert ask('{"jsonrpc":"2.0","id":null,"method":"crane.wait"}') == {"jsonrpc": "2.0", "id": None, "result": 0.5}


def test_a_batch_is_answered_in_order_without_its_notifications():
    answers = ask(
        [
            request("crane.wait", id=1),
            {"jsonrpc": "2.0", "method": "crane.wait"},
            1,
            request("crane.move", {}, id=2),
            request("crane.move", GOOD, id=3),
        ]
    )
    assert [(each["id"], each.get("error", {}).get("code")) for each in answers] == [
        (1, None),
        (None, rpc.INVALID_REQUEST),
        (2, rpc.INVALID_PARAMS),
        (3, None),
    ]


def test_a_batch_of_notifications_is_not_answered():
    assert handle(json.dumps([{"jsonrpc": "2.0", "method": "crane.wait"}] * 2)) is None


def test_a_batch_beyond_the_limit_is_refused_whole():
    assert ask([request("crane.wait")] * (rpc.BATCH_LIMIT + 1))["error"]["code"] == rpc.INVALID_REQUEST


CODES = {rpc.PARSE_ERROR, rpc.INVALID_REQUEST, rpc.METHOD_NOT_FOUND, rpc.INVALID_PARAMS}
JSON = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False, allow_infinity=False) | st.text(),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text(max_size=8), inner, max_size=4),
    max_leaves=12,
)
REQUEST_LIKE = st.fixed_dictionaries(
    {},
    optional={
        "jsonrpc": st.just("2.0") | JSON,
        "id": JSON,
        "method": st.sampled_from(["crane.move", "crane.wait"]) | JSON,
        "params": st.fixed_dictionaries({}, optional=dict.fromkeys(("crane", "axes", "hold", "rate"), JSON)) | JSON,
    },
)


def check(answer):
    for each in answer if isinstance(answer, list) else [answer]:
        assert each["jsonrpc"] == "2.0"
        assert "id" in each
        assert ("result" in each) != ("error" in each)
        if "error" in each:
            assert each["error"]["code"] in CODES


@settings(deadline=None)
@given(st.binary(max_size=200))
def test_any_bytes_get_a_proper_answer(data):
    answer = ask(data)
    if answer is not None:
        check(answer)


@settings(deadline=None)
@given(JSON | REQUEST_LIKE | st.lists(REQUEST_LIKE, max_size=3))
def test_any_json_gets_a_proper_answer(value):
    answer = ask(value)
    if answer is not None:
        check(answer)


@settings(deadline=None)
@given(st.data())
def test_a_damaged_request_gets_a_proper_answer(data):
    text = json.dumps(request("crane.move", GOOD))
    begin = data.draw(st.integers(0, len(text)))
    end = data.draw(st.integers(begin, len(text)))
    answer = ask(text[:begin] + data.draw(st.text(max_size=3)) + text[end:])
    if answer is not None:
        check(answer)


def test_the_openrpc_document_says_what_each_method_takes_and_gives():
    document = METHODS.openrpc("test", "1.2.3")
    assert document["info"] == {"title": "test", "version": "1.2.3"}
    methods = {method["name"]: method for method in document["methods"]}
    assert set(methods) == set(METHODS.methods)
    move = methods["crane.move"]
    assert move["summary"] == "Move the crane."
    assert {param["name"]: param["required"] for param in move["params"]} == {
        "crane": True,
        "axes": True,
        "hold": False,
        "rate": False,
    }
    assert move["params"][3]["schema"]["maximum"] == 1
    assert move["result"]["schema"] == {"$ref": "#/components/schemas/Moved"}
    assert set(document["components"]["schemas"]) == {"Moved"}
    json.dumps(document)


def test_a_method_without_typed_parameters_cannot_be_registered():
    with pytest.raises(TypeError, match="needs one Params parameter and a docstring"):

        @rpc.Dispatcher().method("crane.move")
        def move(caller: str, crane: str) -> None:
            """Not typed as it must be."""
