"""Models: components joined to diagrams, compiled to equations, solved.

diagram = Diagram("filling")
...
dae = diagram.compile()
"""

from .component import REGISTRY, Component, initial, option, parameter, shared
from .dae import Dae, Variable
from .diagram import Diagram, Part, PortHandle
from .native import NativeInstance, NativeModel, build
from .ports import Hydraulic, Rotational, SignalIn, SignalOut, Translational
from .simulate import simulate
from .structure import BondGraph, Symbol

__all__ = [
    "REGISTRY",
    "BondGraph",
    "Component",
    "Dae",
    "Diagram",
    "Hydraulic",
    "NativeInstance",
    "NativeModel",
    "Part",
    "PortHandle",
    "Rotational",
    "SignalIn",
    "SignalOut",
    "Symbol",
    "Translational",
    "Variable",
    "build",
    "initial",
    "option",
    "parameter",
    "shared",
    "simulate",
]
