"""Models: components joined to diagrams, compiled to equations, solved.

diagram = Diagram("filling")
...
dae = diagram.compile()
"""

from .classical import BDF, LSODA, Adams, Radau
from .compare import Comparison, compare
from .component import REGISTRY, Component, initial, option, parameter, shared
from .dae import Dae, PowerBond, Variable
from .diagram import Diagram, Part, PortHandle
from .files import check, load, save
from .linear import Linearised, Mode, linearise
from .native import Happening, NativeInstance, NativeModel, build
from .ports import Hydraulic, Rotational, SignalIn, SignalOut, Translational
from .simulate import SOLVERS, Run, simulate
from .solvers import RODAS4, ExplicitEuler, ImplicitEuler, RungeKutta4, RunStatistics
from .structure import BondGraph, Symbol
from .sweep import Sweep, sweep
from .trim import Trim, trim
from .values import settings

__all__ = [
    "BDF",
    "LSODA",
    "REGISTRY",
    "RODAS4",
    "SOLVERS",
    "Adams",
    "BondGraph",
    "Comparison",
    "Component",
    "Dae",
    "Diagram",
    "ExplicitEuler",
    "Happening",
    "Hydraulic",
    "ImplicitEuler",
    "Linearised",
    "Mode",
    "NativeInstance",
    "NativeModel",
    "Part",
    "PortHandle",
    "PowerBond",
    "Radau",
    "Rotational",
    "Run",
    "RunStatistics",
    "RungeKutta4",
    "SignalIn",
    "SignalOut",
    "Sweep",
    "Symbol",
    "Translational",
    "Trim",
    "Variable",
    "build",
    "check",
    "compare",
    "initial",
    "linearise",
    "load",
    "option",
    "parameter",
    "save",
    "settings",
    "shared",
    "simulate",
    "sweep",
    "trim",
]
