"""A small simulation for the tests of the server: real slaves, a real execution, no crane."""

from __future__ import annotations

import ctypes
import math
import os
import time
from collections.abc import Mapping
from typing import Any

from seacrane.cosim import Execution, FunctionSlave, GaussSeidel, System
from seacrane.model.dae import Variable

STEP = 0.002


class Winch:
    """A drum whose rate follows the command axis `hoist`, and a pendulum that swings by itself."""

    def __init__(self, execution: Execution) -> None:
        self.execution = execution

    def describe(self) -> dict[str, Any]:
        """Variables and axes."""
        variables = [
            {"name": name, "unit": variable.unit, "shown": variable.display_unit}
            for name, variable in self.execution.variables.items()
        ]
        return {"slaves": ["winch", "pendulum"], "variables": variables, "axes": ["hoist", "slew"]}

    def command(self, axes: Mapping[str, float], deadman: bool) -> None:
        """The hoist moves only while the dead man's switch is held."""
        self.execution.set("winch.command", axes["hoist"] if deadman else 0.0)


def build(fail_at: float = math.inf, hang_at: float = math.inf, crash_at: float = math.inf, extra: int = 0) -> Winch:
    """The simulation; it can be made to raise, to hang in a native call, or to crash at a simulated time [s]."""

    def winch(t: float, h: float, x: Any, u: Any) -> Any:
        if t >= fail_at:
            raise RuntimeError("the drum has come off")
        if t >= hang_at:
            ctypes.CDLL(None).pause()
        if t >= crash_at:
            os.abort()
        turned = x[0] + h * u[0]
        return [turned], [turned, u[0]]

    def pendulum(t: float, h: float, u: Any) -> Any:
        return [math.sin(t + h), *(math.sin(index + t + h) for index in range(extra))]

    system = System("winch")
    system.add(
        "winch",
        FunctionSlave(
            winch,
            inputs=[Variable("command")],
            outputs=[Variable("angle", "rad"), Variable("rate", "rad/s")],
            state=[0.0],
        ),
    )
    outputs = [Variable("swing", "rad"), *(Variable(f"extra{index}", "rad") for index in range(extra))]
    system.add("pendulum", FunctionSlave(pendulum, outputs=outputs))
    return Winch(Execution(system, GaussSeidel(step=STEP)))


def refuse() -> Winch:
    """A simulation that cannot be built."""
    from seacrane.errors import DesignError, Problem

    raise DesignError([Problem("boom.mass", "must be positive", -3.0, "> 0 kg"), Problem("jib", "is missing")])


def slow() -> Winch:
    """A simulation that takes long to build."""
    time.sleep(30)
    return build()
