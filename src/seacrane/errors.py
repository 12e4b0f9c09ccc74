"""What goes wrong, said so that the user can mend it.

Every error of the package is a `SeacraneError` that carries one or more `Problem`s. A validator collects all problems
before it raises, so that a user mends a file once. The `code` of an error is stable and travels unchanged over
JSON-RPC; its text may improve.
"""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, Self


@dataclass(frozen=True)
class Problem:
    """One thing that is wrong: where, what, the offending value, what is allowed, and what to try."""

    path: str
    message: str
    value: Any = None
    allowed: str | None = None
    hint: str | None = None

    def __str__(self) -> str:
        text = f"{self.path}: {self.message}" if self.path else self.message
        if self.value is not None:
            text += f" (got {self.value!r})"
        if self.allowed is not None:
            text += f"; allowed: {self.allowed}"
        if self.hint is not None:
            text += f". {self.hint}"
        return text


class SeacraneError(Exception):
    """Base of all errors of this package; `problems` lists everything that was found."""

    code: ClassVar[str] = "seacrane"

    def __init__(self, problems: Problem | Iterable[Problem]) -> None:
        self.problems: tuple[Problem, ...] = (problems,) if isinstance(problems, Problem) else tuple(problems)
        super().__init__("\n".join(str(problem) for problem in self.problems))

    @classmethod
    def at(
        cls, path: str, message: str, *, value: Any = None, allowed: str | None = None, hint: str | None = None
    ) -> Self:
        """The error for a single problem."""
        return cls(Problem(path, message, value, allowed, hint))


class UnitError(SeacraneError):
    """A quantity has an unknown unit, or one of another dimension than is needed."""

    code = "unit"


class ParameterError(SeacraneError):
    """A parameter is missing, unknown or out of its bounds."""

    code = "parameter"


class DesignError(SeacraneError):
    """A design file does not describe a crane."""

    code = "design"


class StructureError(SeacraneError):
    """A diagram cannot be turned into equations that have one solution."""

    code = "structure"


class ModelFileError(SeacraneError):
    """A model file does not describe a diagram."""

    code = "model-file"


class CompileError(SeacraneError):
    """The C compiler is missing or refused the generated code."""

    code = "compile"


class SolveError(SeacraneError):
    """An integration or an equation solve failed; `results` is what was computed before: of `simulate`, a recording."""

    code = "solve"
    results: Any = None


class FmuError(SeacraneError):
    """An FMU cannot be read, loaded or run; a failed call of the standard leaves its `function` and FMI `status`."""

    code = "fmu"
    function: str | None = None
    status: int | None = None


class CosimError(SeacraneError):
    """A system of slaves is put together wrongly, or a slave failed while it ran."""

    code = "cosim"


class ServerError(SeacraneError):
    """The server cannot start, or a client asked for something it may not have."""

    code = "server"


def nearest(name: str, known: Iterable[str], limit: int = 5) -> str:
    """A hint that names what was probably meant: close matches of `name`, or else all that is known."""
    names: Sequence[str] = sorted(set(known))
    if not names:
        return "There is none here."
    close = difflib.get_close_matches(name, names, n=limit, cutoff=0.5)
    if close:
        return "Did you mean " + " or ".join(repr(c) for c in close) + "?"
    shown = ", ".join(names[:20]) + (", ..." if len(names) > 20 else "")
    return f"Known: {shown}."
