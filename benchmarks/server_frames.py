"""Frames at 60 Hz to several clients on loopback: do all of them get them, how evenly, and at what cost?

The server and its simulation run in processes of their own, the clients in this one. Each client subscribes to the same
variables and acknowledges every frame. CPU shares are of one core, from the processes' own clocks.

    python benchmarks/server_frames.py [--clients 5] [--seconds 5] [--variables 60] [--demo] [--json FILE]
"""

from __future__ import annotations

import argparse
import asyncio
import json
import math
import os
import re
import signal
import statistics
import subprocess
import sys
import time
from collections.abc import Mapping
from functools import partial
from itertools import pairwise
from pathlib import Path
from typing import Any

from websockets.asyncio.client import ClientConnection, connect

from seacrane.cosim import Execution, FunctionSlave, GaussSeidel, System
from seacrane.model.dae import Variable

TOKEN = "benchmark"
RATE = 60.0
PER_SLAVE = 100


def sines(count: int, t: float, h: float, u: Any) -> list[float]:
    """As many equal values of the sine of time."""
    return [math.sin(t + h)] * count


class Waves:
    """Sine waves, a hundred to a slave."""

    def __init__(self, variables: int) -> None:
        system = System("waves")
        for first in range(0, variables, PER_SLAVE):
            count = min(PER_SLAVE, variables - first)
            outputs = [Variable(f"y{index}") for index in range(count)]
            system.add(f"s{first // PER_SLAVE}", FunctionSlave(partial(sines, count), outputs=outputs))
        self.execution = Execution(system, GaussSeidel(step=0.002))

    def describe(self) -> dict[str, Any]:
        """Variables and no axes."""
        variables = [{"name": name, "unit": each.unit} for name, each in self.execution.variables.items()]
        return {"variables": variables, "axes": []}

    def command(self, axes: Mapping[str, float], deadman: bool) -> None:
        """Nothing is driven."""


def start(target: str, arguments: dict[str, Any]) -> tuple[subprocess.Popen[str], str]:
    """A server in a process of its own, and its address for WebSockets."""
    program = (
        f"import sys; sys.path.insert(0, {str(Path(__file__).parent)!r})\n"
        "from seacrane.server import serve\n"
        f"serve({target!r}, arguments={arguments!r}, port=0, tcp_port=None, token={TOKEN!r})\n"
    )
    server = subprocess.Popen([sys.executable, "-c", program], stdout=subprocess.PIPE, text=True)
    assert server.stdout is not None
    found = re.search(r"http://(\S+?)/", server.stdout.readline())
    if found is None:
        raise RuntimeError("the server did not start")
    return server, f"ws://{found[1]}/rpc"


def cpu_seconds(pid: int) -> float:
    """User and system time of a process [s]."""
    fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


async def call(connection: ClientConnection, method: str, **params: Any) -> Any:
    """The result of a method, on a connection without a subscription."""
    await connection.send(json.dumps({"jsonrpc": "2.0", "id": 1, "method": method, "params": params}))
    return json.loads(await connection.recv())["result"]


async def watch(address: str, names: list[str], until: float) -> tuple[list[float], list[float]]:
    """Arrival times [s] and simulated times [s] of the frames of one client."""
    arrived, simulated = [], []
    headers = {"Authorization": f"Bearer {TOKEN}"}
    async with connect(address, additional_headers=headers, compression=None) as connection:
        await call(connection, "stream.subscribe", variables=names, rate=RATE)
        while time.monotonic() < until:
            frame = json.loads(await connection.recv())["params"]
            arrived.append(time.monotonic())
            simulated.append(frame["time"])
            ack = {"subscription": frame["subscription"], "seq": frame["seq"]}
            await connection.send(json.dumps({"jsonrpc": "2.0", "method": "stream.ack", "params": ack}))
    return arrived, simulated


async def measure(address: str, server: int, clients: int, seconds: float, variables: int) -> dict[str, Any]:
    """Run the clients and report."""
    headers = {"Authorization": f"Bearer {TOKEN}"}
    (simulation,) = map(int, Path(f"/proc/{server}/task/{server}/children").read_text().split())
    async with connect(address, additional_headers=headers, compression=None) as control:
        described = await call(control, "model.describe")
        names = [variable["name"] for variable in described["variables"]][:variables]
        before = {pid: cpu_seconds(pid) for pid in (server, simulation)}
        begin = time.monotonic()
        results = await asyncio.gather(*(watch(address, names, begin + seconds) for _ in range(clients)))
        elapsed = time.monotonic() - begin
        used = {pid: cpu_seconds(pid) - before[pid] for pid in before}
        status = await call(control, "simulation.status")
    rates = [(len(arrived) - 1) / (arrived[-1] - arrived[0]) for arrived, _ in results]
    gaps = sorted(1e3 * (b - a) for arrived, _ in results for a, b in pairwise(arrived))
    return {
        "clients": clients,
        "variables": len(names),
        "seconds": round(elapsed, 2),
        "rate_hz": [round(rate, 2) for rate in rates],
        "interval_ms_median": round(statistics.median(gaps), 2),
        "interval_ms_p99": round(gaps[math.ceil(0.99 * len(gaps)) - 1], 2),
        "server_cpu_percent": round(100 * used[server] / elapsed, 1),
        "simulation_cpu_percent": round(100 * used[simulation] / elapsed, 1),
        "real_time_factor": round(status["real_time_factor"], 4),
        "overruns": status["overruns"],
        "late_ms_p99": round(status["late_ms_p99"], 3),
        "load_average": round(os.getloadavg()[0], 1),
    }


def main() -> None:
    """Measure once and print, and write if asked."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--clients", type=int, default=5)
    parser.add_argument("--seconds", type=float, default=5.0)
    parser.add_argument("--variables", type=int, default=60, help="in each frame")
    parser.add_argument("--demo", action="store_true", help="simulate the crane of the demo, not sine waves")
    parser.add_argument("--json", type=Path)
    options = parser.parse_args()
    if options.demo:
        from seacrane.operation import demo

        target, arguments = demo.FACTORY, {}
    else:
        target, arguments = "server_frames:Waves", {"variables": options.variables}
    server, address = start(target, arguments)
    try:
        report = asyncio.run(measure(address, server.pid, options.clients, options.seconds, options.variables))
    finally:
        server.send_signal(signal.SIGTERM)
        server.communicate(timeout=10)
    print(json.dumps(report, indent=2))
    if options.json is not None:
        options.json.write_text(json.dumps(report, indent=2) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
