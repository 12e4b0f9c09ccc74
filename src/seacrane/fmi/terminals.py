"""The power bonds of a model: pairs of an input and an output whose product is power."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

from seacrane.model.dae import Dae

_DOMAINS: Final = {
    ("Pa", "m3/s"): ("hydraulic", "p", "q"),
    ("m/s", "N"): ("translational", "v", "F"),
    ("rad/s", "N.m"): ("rotational", "w", "T"),
}
"""Domain, across and through variable by the units of an across and a through variable."""


@dataclass(frozen=True)
class Terminal:
    """A power bond: one of its variables is an input of the model, the other an output."""

    name: str
    domain: str
    across: str
    through: str
    across_variable: str
    through_variable: str


def power_terminals(dae: Dae) -> tuple[Terminal, ...]:
    """The terminals of a model in the order of their inputs.

    A bond is an input and an output under one name, `rod.v` and `rod.F`, in units that make power; a name with several
    such pairs is none.
    """
    found: dict[str, list[Terminal]] = {}
    for terminal in _pairs(dae):
        found.setdefault(terminal.name, []).append(terminal)
    return tuple(same[0] for same in found.values() if len(same) == 1)


def _pairs(dae: Dae) -> Iterator[Terminal]:
    for given in dae.inputs:
        stem = given.name.rpartition(".")[0]
        if not stem:
            continue
        for found in dae.outputs:
            if found.name.rpartition(".")[0] != stem:
                continue
            for across, through in ((given, found), (found, given)):
                if (across.unit, through.unit) in _DOMAINS:
                    names = _DOMAINS[across.unit, through.unit]
                    yield Terminal(stem, *names, across.name, through.name)
