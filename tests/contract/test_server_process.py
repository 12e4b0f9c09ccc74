"""The processes: how they start, and that nothing is left however they end."""

import gc
import json
import os
import re
import signal
import socket
import subprocess
import sys
import tempfile
import time
from contextlib import contextmanager
from pathlib import Path

import httpx
import pytest
from server_clients import TOKEN, run, running

from seacrane.errors import ServerError

HERE = Path(__file__).parent


@contextmanager
def serving(target="server_plant:build", arguments=None, port=0):
    """A server in a process of its own."""
    program = (
        f"import sys; sys.path.insert(0, {str(HERE)!r})\n"
        "from seacrane.server import serve\n"
        f"serve({target!r}, arguments={arguments or {}!r}, port={port}, tcp_port=None, token={TOKEN!r})\n"
    )
    process = subprocess.Popen(
        [sys.executable, "-c", program], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    try:
        yield process
    finally:
        if process.poll() is None:
            process.kill()
        process.communicate(timeout=10)


def address_of(process):
    """The address that the server prints."""
    return re.search(r"http://\S+/", process.stdout.readline())[0]


def children_of(pid):
    return [int(child) for child in Path(f"/proc/{pid}/task/{pid}/children").read_text().split()]


def gone(pid):
    """Whether no such process runs any more."""
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] == "Z"
    except FileNotFoundError:
        return True


def wait_until(condition, timeout):
    end = time.monotonic() + timeout
    while not condition():
        assert time.monotonic() < end, f"not within {timeout} s"
        time.sleep(0.02)


def test_the_simulation_ends_when_its_server_is_killed():
    with serving() as server:
        address_of(server)
        (child,) = children_of(server.pid)
        server.send_signal(signal.SIGKILL)
        wait_until(lambda: gone(child), 2.0)


def test_a_simulation_that_hangs_ends_when_its_server_is_killed():
    with serving(arguments={"hang_at": 0.2}) as server:
        address_of(server)
        (child,) = children_of(server.pid)
        time.sleep(1.0)
        server.send_signal(signal.SIGKILL)
        wait_until(lambda: gone(child), 2.0)


def test_a_simulation_that_is_being_built_ends_when_its_server_is_killed():
    with serving("server_plant:slow") as server:
        wait_until(lambda: children_of(server.pid), 10.0)
        (child,) = children_of(server.pid)
        time.sleep(1.0)
        server.send_signal(signal.SIGKILL)
        wait_until(lambda: gone(child), 2.0)


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_an_interrupt_ends_everything_with_exit_code_zero(number):
    with serving() as server:
        address_of(server)
        (child,) = children_of(server.pid)
        server.send_signal(number)
        assert server.wait(timeout=5) == 0
        assert gone(child)
        assert server.stderr.read() == ""


def test_an_interrupt_while_building_ends_everything():
    with serving("server_plant:slow") as server:
        wait_until(lambda: children_of(server.pid), 10.0)
        (child,) = children_of(server.pid)
        time.sleep(1.0)
        server.send_signal(signal.SIGINT)
        assert server.wait(timeout=6) == 0
        assert gone(child)


def test_an_interrupt_ends_a_simulation_that_hangs():
    with serving(arguments={"hang_at": 0.2}) as server:
        address_of(server)
        (child,) = children_of(server.pid)
        time.sleep(1.0)
        server.send_signal(signal.SIGTERM)
        assert server.wait(timeout=6) == 0
        assert gone(child)


def test_a_client_that_takes_nothing_does_not_hold_up_the_end():
    with serving(arguments={"extra": 500}) as server:
        host, port = httpx.URL(address_of(server)).netloc.decode().split(":")
        names = [f"pendulum.extra{index}" for index in range(500)]
        with socket.socket() as silent:
            silent.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 8192)
            silent.connect((host, int(port)))
            silent.sendall(
                f"GET /rpc?token={TOKEN} HTTP/1.1\r\nHost: {host}:{port}\r\n"
                "Upgrade: websocket\r\nConnection: Upgrade\r\n"
                "Sec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\nSec-WebSocket-Version: 13\r\n\r\n".encode()
            )
            for number, (method, params) in enumerate(
                [
                    ("stream.subscribe", {"variables": names, "rate": 60}),
                    *[("model.describe", {})] * 20,
                ]
            ):
                body = json.dumps({"jsonrpc": "2.0", "id": number, "method": method, "params": params}).encode()
                silent.sendall(bytes([0x81, 0x80 | 126]) + len(body).to_bytes(2, "big") + bytes(4) + body)
            time.sleep(1.0)
            begin = time.monotonic()
            server.send_signal(signal.SIGTERM)
            assert server.wait(timeout=10) == 0
            assert time.monotonic() - begin < 4


def test_a_port_in_use_is_refused_at_once_with_what_to_do():
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        port = taken.getsockname()[1]
        with serving("server_plant:slow", port=port) as server:
            begin = time.monotonic()
            assert server.wait(timeout=10) != 0
            assert time.monotonic() - begin < 5, "before the simulation is built"
            error = server.stderr.read()
            assert f"ServerError: port {port}: is used by another program" in error
            assert "choose another port" in error


@pytest.mark.parametrize(
    ("target", "message"),
    [
        ("server_plant:refuse", r"boom\.mass: must be positive \(got -3\.0\); allowed: > 0 kg\njib: is missing"),
        ("server_plant:biuld", r"has no function 'biuld'\. Did you mean 'build'"),
        ("server_plan:build", r"there is no module 'server_plan'"),
        ("server_plant", r"is not the name of a function.*allowed: module:function"),
        ("os:abort", r"the simulation process was ended by SIGABRT"),
    ],
)
def test_a_simulation_that_cannot_be_built_says_why(target, message, capfd):
    async def scenario():
        with pytest.raises(ServerError, match=message):
            async with running(target):
                pass

    run(scenario())


def test_nothing_is_left_in_memory_or_on_disk(tmp_path, monkeypatch):
    monkeypatch.setenv("TMPDIR", str(tmp_path))  # other programs write into the one of the machine
    monkeypatch.setattr(tempfile, "tempdir", None)

    async def scenario():
        async with running():
            pass

    def held():
        gc.collect()
        return len(os.listdir("/proc/self/fd")), os.listdir(tempfile.gettempdir())

    def shared():
        return set(os.listdir("/dev/shm"))

    run(scenario())
    before, shared_before = held(), shared()
    run(scenario())
    assert held() == before == (before[0], [])
    wait_until(lambda: shared() <= shared_before, 5.0)  # what other programs have there for a moment goes again
