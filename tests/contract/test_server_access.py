"""Who may speak to the server: token, Origin and Host, on every path and every transport."""

import asyncio
import json
import re
from contextlib import suppress

import pytest
from server_clients import TOKEN, client, get, get_with_token, run, running, running_beside
from websockets.asyncio.client import connect
from websockets.exceptions import ConnectionClosed, InvalidStatus

from seacrane.errors import ServerError
from seacrane.server import Factory, Server

PATHS = ["/", "/index.html", "/assets/page.js", "/api/recording.csv", "/api/openrpc.json", "/none", "/rpc"]
GOOD = {"Authorization": f"Bearer {TOKEN}"}


@pytest.fixture(scope="module")
def server(tmp_path_factory):
    """A server with a built page, and a file beside the page."""
    page = tmp_path_factory.mktemp("site") / "page"
    (page / "assets").mkdir(parents=True)
    (page / "index.html").write_text("<!doctype html><title>crane</title>")
    (page / "assets" / "page.js").write_text("console.log('crane')")
    (page.parent / "secret.txt").write_text("secret")
    with running_beside(page) as server:
        yield server


def test_every_path_asks_for_the_token(server):
    async def scenario():
        for path in PATHS:
            for headers in ({}, {"Authorization": "Bearer wrong"}, {"Cookie": f"seacrane-{server.port}=wrong"}):
                answer = await get(server, path, **headers)
                assert answer.status_code == 401, path
                assert "Open the address that the server printed" in answer.text
            assert (await get(server, path + "?token=wrong")).status_code == 401, path
            assert (await get(server, path + "?token=%C3%A9")).status_code == 401, path

    run(scenario())


def test_every_path_refuses_strange_names_and_strange_pages_even_with_the_token(server):
    async def scenario():
        own = f"127.0.0.1:{server.port}"
        for path in PATHS:
            for strange in (
                {"Host": "crane.example"},
                {"Host": f"127.0.0.1.crane.example:{server.port}"},
                {"Host": "[::1"},
                {"Origin": "http://crane.example"},
                {"Origin": "http://127.0.0.1:1"},
                {"Origin": f"http://localhost:{server.port}"},
                {"Origin": "null"},
                {"Origin": f"http://{own}.crane.example"},
            ):
                answer = await get(server, path, **GOOD, **strange)
                assert answer.status_code == 403, (path, strange)
        for known in ({"Host": f"localhost:{server.port}"}, {"Origin": f"http://{own}"}, {"Host": "[::1]:80"}):
            assert (await get(server, "/", **GOOD, **known)).status_code == 200, known

    run(scenario())


def test_the_address_with_the_token_leaves_a_cookie_that_opens_the_page(server):
    async def scenario():
        answer = await get(server, f"/?token={TOKEN}&model=a")
        assert answer.status_code == 303
        assert answer.headers["location"] == "/?model=a"
        cookie = answer.headers["set-cookie"]
        assert "HttpOnly" in cookie
        assert "samesite=strict" in cookie.lower()
        opened = await get(server, "/", Cookie=cookie.partition(";")[0])
        assert opened.status_code == 200
        assert "<title>crane</title>" in opened.text
        script = await get(server, "/assets/page.js", Cookie=cookie.partition(";")[0])
        assert script.headers["x-content-type-options"] == "nosniff"
        policy = [rule.split() for rule in script.headers["content-security-policy"].split(";")]
        # scripts of the server only, none in the page and none made of text; WebAssembly is the load chart's
        assert ["script-src", "'self'", "'wasm-unsafe-eval'"] in policy
        assert ["default-src", "'self'"] in policy

    run(scenario())


def test_without_a_built_page_the_server_says_how_to_build_it(tmp_path):
    async def scenario():
        async with running(page=tmp_path) as server:
            answer = await get_with_token(server, "/")
            assert answer.status_code == 503
            assert "make setup" in answer.text

    run(scenario())


def test_a_path_outside_the_page_is_not_served(server):
    async def scenario():
        for path in ("/../secret.txt", "/%2e%2e/secret.txt", "/assets/..%2f..%2fsecret.txt"):
            answer = await get_with_token(server, path)
            assert answer.status_code == 404
            assert "secret" not in answer.text

    run(scenario())


def test_the_openrpc_document_lists_every_method(server):
    async def scenario():
        document = (await get_with_token(server, "/api/openrpc.json")).json()
        assert {method["name"] for method in document["methods"]} == {
            "authenticate",
            "server.info",
            "simulation.status",
            "simulation.pause",
            "simulation.resume",
            "simulation.reset",
            "model.describe",
            "variables.read",
            "stream.subscribe",
            "stream.unsubscribe",
            "stream.ack",
            "control.acquire",
            "control.release",
            "control.command",
        }
        references = set(re.findall(r"#/components/schemas/(\w+)", json.dumps(document)))
        assert references == set(document["components"]["schemas"])

    run(scenario())


# ---------------------------------------------------------------- WebSocket
async def handshake(server, **headers):
    return await connect(server.address.replace("http", "ws") + "rpc", additional_headers=headers, compression=None)


@pytest.mark.parametrize("headers", [{}, {"Authorization": "Bearer wrong"}])
def test_a_websocket_without_the_token_is_closed_with_4401(server, headers):
    async def scenario():
        connection = await handshake(server, **headers)
        with pytest.raises(ConnectionClosed) as caught:
            await connection.recv()
        assert caught.value.rcvd.code == 4401

    run(scenario())


@pytest.mark.parametrize("strange", [{"Origin": "http://crane.example"}, {"Origin": "null"}])
def test_a_websocket_from_a_strange_page_is_refused_even_with_the_token(server, strange):
    async def scenario():
        with pytest.raises(InvalidStatus) as caught:
            await handshake(server, **GOOD, **strange)
        assert caught.value.response.status_code == 403

    run(scenario())


def test_a_websocket_opens_with_cookie_or_query(server):
    async def scenario():
        own = f"http://127.0.0.1:{server.port}"
        address = server.address.replace("http", "ws") + "rpc"
        for path, headers in (
            (address, {"Cookie": f"other=1; seacrane-{server.port}={TOKEN}", "Origin": own}),
            (f"{address}?token={TOKEN}", {}),
        ):
            async with connect(path, additional_headers=headers, compression=None) as connection:
                await connection.send('{"jsonrpc":"2.0","id":1,"method":"server.info"}')
                assert json.loads(await connection.recv())["result"]["name"] == "seacrane"

    run(scenario())


def test_a_message_above_the_limit_ends_that_connection_only(server):
    async def scenario():
        async with client(server) as other:
            connection = await handshake(server, **GOOD)
            await connection.send("x" * 300_000)
            with pytest.raises(ConnectionClosed) as caught:
                await connection.recv()
            assert caught.value.rcvd.code == 1009
            assert (await other.call("simulation.status"))["running"]

    run(scenario())


def test_a_flood_of_calls_ends_that_connection_only(server):
    async def scenario():
        async with client(server) as other:
            connection = await handshake(server, **GOOD)
            with suppress(ConnectionClosed):
                for _ in range(5_000):
                    await connection.send('{"jsonrpc":"2.0","method":"server.info"}')
            await asyncio.wait_for(connection.wait_closed(), 10)
            assert connection.close_code != 1000
            assert (await other.call("simulation.status"))["running"]

    run(scenario())


# ---------------------------------------------------------------- TCP
async def ask(server, *lines):
    """Send lines over TCP; all that comes back until the server ends the connection or has answered all."""
    reader, writer = await asyncio.open_connection("127.0.0.1", server.tcp_port, limit=2**20)
    answers = []
    try:
        for line in lines:
            writer.write(line.encode() + b"\n")
            answer = await asyncio.wait_for(reader.readline(), 5)
            if not answer:
                return answers, True
            answers.append(json.loads(answer))
        return answers, False
    except ConnectionError:
        return answers, True
    finally:
        writer.close()


def call(method, number=1, **params):
    return json.dumps({"jsonrpc": "2.0", "id": number, "method": method, "params": params})


def test_the_same_methods_answer_over_tcp_after_authentication(server):
    async def scenario():
        answers, ended = await ask(
            server,
            call("authenticate", token=TOKEN),
            call("server.info", 2),
            call("variables.read", 3, names=["winch.angle"]),
            "[" + call("server.info", 4) + "," + call("none", 5) + "]",
        )
        assert not ended
        assert answers[0]["result"]["you"] >= 1
        assert answers[1]["result"]["protocol"] == 1
        assert answers[2]["result"]["values"] == [0.0]
        assert [each["id"] for each in answers[3]] == [4, 5]

    run(scenario())


@pytest.mark.parametrize(
    ("line", "message"),
    [
        (call("authenticate", token="wrong"), "token: is wrong"),
        (call("simulation.status"), "no method 'simulation.status'"),
        ("GET / HTTP/1.1", "not valid JSON"),
    ],
)
def test_a_tcp_client_without_the_token_is_told_and_cut_off(server, line, message):
    async def scenario():
        answers, ended = await ask(server, line, call("server.info", 2))
        assert len(answers) == 1
        assert message in answers[0]["error"]["message"]
        assert ended

    run(scenario())


def test_a_line_above_the_limit_is_refused_over_tcp(server):
    async def scenario():
        answers, ended = await ask(server, call("authenticate", token=TOKEN), "x" * 600_000, call("server.info"))
        assert answers[0]["result"]
        assert ended
        assert all("error" in answer for answer in answers[1:])

    run(scenario())


# ---------------------------------------------------------------- addresses
@pytest.mark.parametrize("host", ["0.0.0.0", "::", "192.0.2.1", "crane.example"])
def test_another_address_than_loopback_must_be_asked_for(host):
    with pytest.raises(ServerError, match=r"can be reached from other machines.*allowed: 127\.0\.0\.1") as caught:
        Server(Factory("server_plant:build"), host=host)
    assert caught.value.problems[0].path == "host"
