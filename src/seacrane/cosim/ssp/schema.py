"""Names of the standard that reading and writing share (SSP 1.0.1 and 2.0; both have the same name spaces)."""

from __future__ import annotations

from typing import Final

MAIN: Final = "SystemStructure.ssd"
"""The system structure description in an archive."""

SPACES: Final = {
    "ssc": "http://ssp-standard.org/SSP1/SystemStructureCommon",
    "ssd": "http://ssp-standard.org/SSP1/SystemStructureDescription",
    "ssv": "http://ssp-standard.org/SSP1/SystemStructureParameterValues",
    "ssm": "http://ssp-standard.org/SSP1/SystemStructureParameterMapping",
    "ssb": "http://ssp-standard.org/SSP1/SystemStructureSignalDictionary",
}

VERSIONS: Final = ("1.0", "2.0")

FMU: Final = "application/x-fmu-sharedlibrary"
DEFINITION: Final = "application/x-ssp-definition"
PACKAGE: Final = "application/x-ssp-package"

REALS: Final = ("Real", "Float64", "Float32")
INTEGERS: Final = ("Integer", "Int8", "UInt8", "Int16", "UInt16", "Int32", "UInt32", "Int64", "UInt64")
NUMBERS: Final = ("Real", "Integer", "Boolean")
"""What connectors hold that a system connects, whatever the width of the type."""

KINDS: Final = (
    "input", "output", "parameter", "calculatedParameter", "inout",
    "structuralParameter", "constant", "local", "unspecified",
)  # fmt: skip
"""Of connectors; the last four came with 2.0."""

IMPLEMENTATIONS: Final = {"CoSimulation": "co-simulation", "ModelExchange": "model-exchange"}
"""Our word for each implementation of an FMU that a component can ask for."""

BUS: Final = "signals"
"""The signal dictionary for signals that are in no dictionary of a file."""
