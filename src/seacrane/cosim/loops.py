"""The two master loops: C, and plain Python where there is no compiler. Both give the same bits.

They do the same operations on the same `Plan` in the same order. `native_loop` runs the C sources `master.c`,
`exchange.c`, `iterate.c` and `pool.c` of `seacrane.native`; `python_loop`, `python_slave` and
`python_iteration` have functions of the same names.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass

from seacrane.cosim.plan import Plan, Rows

DONE, ROWS_FULL, FAULT, STOPPED = range(4)
STAGES = ("set", "step", "get", "finite", "watch", "save", "restore", "converge", "derive")


@dataclass(frozen=True)
class Fault:
    """Where a loop stopped: the slave, the stage of its exchange, the FMI status, and the output that is not finite.

    An iteration that does not converge is the fault of no slave (-1), and `variables` are the outputs that do not.
    """

    slave: int
    stage: str
    status: int
    variable: int
    variables: Sequence[int] = ()


class Failed(Exception):
    """Ends a macro step of the loop in Python."""

    def __init__(self, fault: Fault) -> None:
        super().__init__(fault)
        self.fault = fault


class Loop(ABC):
    """Runs macro steps of a plan. `refresh` is called after watched variables or recorders have changed."""

    name: str
    fault: Fault | None = None

    @abstractmethod
    def refresh(self) -> None: ...

    @abstractmethod
    def run(self, steps: int) -> int:
        """Do `steps` macro steps or fewer; `plan.done` counts those done.

        The result is DONE, ROWS_FULL, FAULT, or STOPPED when a trigger has fired or `plan.stop` is set.
        """

    @abstractmethod
    def watch(self) -> int:
        """Read the watched internal variables into the values: DONE or FAULT."""

    @abstractmethod
    def close(self) -> None:
        """Free what the loop holds; before the slaves are closed."""


def append(rows: Rows, t: float, plan: Plan) -> None:
    """Write the next row of a recorder."""
    row = rows.table[rows.count]
    row[0] = t
    row[1:] = plan.values[rows.indices]
    rows.count += 1
