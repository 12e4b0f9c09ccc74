"""Runs of the split drive against the whole one, shared by table_4_5.py and coupling_sweep.py."""

from __future__ import annotations

import math
from dataclasses import dataclass

from boom import Boom, whole

from seacrane.cosim import Algorithm, Execution, System
from seacrane.errors import CosimError
from seacrane.model import simulate
from seacrane.results import Recording, Signal

EVERY = 0.02
"""The piston is compared each so many seconds: a multiple of all macro steps."""

PISTON = "cylinder.extension"

LOST = 0.05
"""A piston that is more than this [m] off (rms) has lost the solution."""


@dataclass(frozen=True)
class Run:
    """A run of the split drive; `rmse` [m] is that of the piston against the whole, infinite if the run failed."""

    rmse: float
    cpu: float
    piston: Recording
    failure: str = ""

    @property
    def stable(self) -> bool:
        return self.rmse < LOST


def reference(boom: Boom, until: float) -> Recording:
    """The piston of the whole drive, to a relative tolerance of 1e-9."""
    return simulate(whole(boom), until, every=EVERY, record=[PISTON], tolerance=1e-9)


def run(system: System, algorithm: Algorithm, exact: Recording, repeats: int = 1) -> Run:
    """The split drive to the end of the reference; its CPU time [s] is the least of the repeats."""
    least, until, failure = math.inf, float(exact.time[-1]), ""
    for _ in range(repeats):
        with Execution(system, algorithm, threads=1) as execution:
            recorder = execution.record([f"drive.{PISTON}"], every=EVERY)
            try:
                execution.run(until)
            except CosimError as error:
                execution.flush()
                failure = str(error.problems[0])
            least = min(least, execution.usage.cpu_s)
            found = recorder.recording()
    piston = Recording(found.time, {PISTON: Signal("m", "m", found[f"drive.{PISTON}"])})
    return Run(math.inf if failure else piston.rmse(exact, PISTON), least, piston, failure)
