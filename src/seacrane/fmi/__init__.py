"""Functional mock-up units of FMI 2.0: export our models, read, check and run anybody's."""

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
from seacrane.fmi.export import export
from seacrane.fmi.fmu import Fmu, FmuInstance, read

__all__ = [
    "CoSimulation",
    "Dimension",
    "Experiment",
    "Fmu",
    "FmuError",
    "FmuInstance",
    "ModelDescription",
    "ModelExchange",
    "Terminal",
    "UnitDefinition",
    "Unknown",
    "Variable",
    "check",
    "export",
    "read",
]
