"""The power bonds of a model as terminals: what belongs together is found together by whoever connects the FMU."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

from seacrane.model.dae import Dae, PowerBond

_DOMAINS: Final = {
    ("Pa", "m3/s"): ("hydraulic", "p", "q"),
    ("m/s", "N"): ("translational", "v", "F"),
    ("rad/s", "N.m"): ("rotational", "w", "T"),
}
"""Domain, and what its across and through variable are called, by their units."""


@dataclass(frozen=True)
class Terminal:
    """A power bond with its domain, and the names of its two variables in every terminal of that domain."""

    bond: PowerBond
    domain: str
    across: str
    through: str


def power_terminals(dae: Dae) -> tuple[Terminal, ...]:
    """The terminals of a model: one for each of its power bonds in a domain that has a name."""
    units = {v.name: v.unit for v in dae.inputs + dae.outputs}
    domains = ((b, _DOMAINS.get((units[b.across], units[b.through]))) for b in dae.bonds)
    return tuple(Terminal(bond, *domain) for bond, domain in domains if domain is not None)
