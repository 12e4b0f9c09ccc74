"""Functional mock-up units: export our models, read, check and run anybody's."""

from seacrane.errors import FmuError
from seacrane.fmi.check import check
from seacrane.fmi.description import (
    CoSimulation,
    Dimension,
    Experiment,
    ModelDescription,
    ModelExchange,
    Terminal,
    UnitDefinition,
    Unknown,
    Variable,
)
from seacrane.fmi.export import cached, export
from seacrane.fmi.fmu import Fmu, Kind, icons, read
from seacrane.fmi.instance import FmuInstance
from seacrane.fmi.simulate import Deviation, compare, parse, run
from seacrane.fmi.symbols import known_units, unit_symbol
from seacrane.fmi.typed import Exchange, bounds, exchanges_all_types
from seacrane.fmi.values import element_of
from seacrane.fmi.wasm import export_wasm

__all__ = [
    "CoSimulation",
    "Deviation",
    "Dimension",
    "Exchange",
    "Experiment",
    "Fmu",
    "FmuError",
    "FmuInstance",
    "Kind",
    "ModelDescription",
    "ModelExchange",
    "Terminal",
    "UnitDefinition",
    "Unknown",
    "Variable",
    "bounds",
    "cached",
    "check",
    "compare",
    "element_of",
    "exchanges_all_types",
    "export",
    "export_wasm",
    "icons",
    "known_units",
    "parse",
    "read",
    "run",
    "unit_symbol",
]
