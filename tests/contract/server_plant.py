"""A small simulation for the tests of the server: real slaves, a real execution, no crane."""

from __future__ import annotations

import ctypes
import math
import time
from collections.abc import Mapping
from typing import Any

import numpy as np

from seacrane.cosim import Execution, FunctionSlave, GaussSeidel, System
from seacrane.cosim.function import FunctionInstance
from seacrane.cosim.slave import Instance
from seacrane.errors import CosimError
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


class Forgetful(FunctionSlave):
    """A slave whose state cannot be saved."""

    def instantiate(self, name: str) -> Instance:
        """An instance that refuses to be saved."""
        return ForgetfulInstance(name, self.function, np.array(self.state))


class ForgetfulInstance(FunctionInstance):
    """Refuses to be saved."""

    def save(self) -> bytes:
        """Not possible."""
        raise CosimError.at("winch", "keeps state of its own")


def build(fail_at: float = math.inf, hang_at: float = math.inf, extra: int = 0, saves: bool = True) -> Winch:
    """The simulation; it can be made to raise, or to hang in a native call, at a simulated time [s]."""

    def winch(t: float, h: float, x: Any, u: Any) -> Any:
        if t >= fail_at:
            raise RuntimeError("the drum has come off")
        if t >= hang_at:
            ctypes.CDLL(None).pause()
        turned = x[0] + h * u[0]
        return [turned], [turned, u[0]]

    def pendulum(t: float, h: float, u: Any) -> Any:
        return [math.sin(t + h), *(math.sin(index + t + h) for index in range(extra))]

    system = System("winch")
    system.add(
        "winch",
        (FunctionSlave if saves else Forgetful)(
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
