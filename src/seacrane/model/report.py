"""What the compiler found in a diagram, in words: states, what is tied rigidly, and what is solved together."""

from __future__ import annotations

from dataclasses import dataclass

from seacrane.errors import Problem

from .compile import Compiled, Loop, compile_diagram
from .diagram import Diagram
from .reduce import Tie
from .singular import start_point, undetermined_at


@dataclass(frozen=True)
class Report:
    """`ties`: states that follow others (derivative causality). `loops`: equations solved together.

    `undetermined`: unknowns that lose their equation at the start values (a closed valve without leakage); a run cannot
    start there. As text: str().
    """

    name: str
    states: tuple[str, ...]
    algebraics: tuple[str, ...]
    ties: tuple[Tie, ...]
    loops: tuple[Loop, ...]
    undetermined: tuple[Problem, ...] = ()

    def __str__(self) -> str:
        lines = [f"{self.name}: {_count(self.states, 'state')}, {_count(self.algebraics, 'algebraic unknown')}"]
        for tie in self.ties:
            follows = "follow" if len(tie.demoted) > 1 else "follows"
            lines.append(
                f"  {' and '.join(tie.demoted)} {follows} {' and '.join(tie.kept)}, tied rigidly at {tie.where}"
                " (derivative causality): one store as heavy as all of them. Put a hose, orifice, spring or shaft"
                " between them if they can move apart."
            )
        for loop in self.loops:
            what = ", ".join(loop.unknowns[:6]) + (", ..." if len(loop.unknowns) > 6 else "")
            how = (
                f"the solver iterates on {', '.join(loop.torn)}. A small volume at such a node opens the loop"
                if loop.torn
                else "linear, solved in closed form"
            )
            lines.append(f"  algebraic loop through {loop.where} ({what}): {how}.")
        lines += [f"  {problem}" for problem in self.undetermined]
        return "\n".join(lines)


def _count(names: tuple[str, ...], what: str) -> str:
    return f"{len(names)} {what}{'s' if len(names) != 1 else ''}"


def report(diagram: Diagram) -> Report:
    """See `Diagram.report`."""
    compiled: Compiled = compile_diagram(diagram)
    dae = compiled.dae
    states, algebraics = tuple(v.name for v in dae.states), tuple(v.name for v in dae.algebraics)
    lost = tuple(undetermined_at(dae, start_point(dae), "the start values"))
    return Report(diagram.name, states, algebraics, compiled.ties, compiled.loops, lost)
