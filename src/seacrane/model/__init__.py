"""Models: components joined to diagrams, compiled to equations, solved.

diagram = Diagram("filling")
...
dae = diagram.compile()
"""

from .component import REGISTRY, Component, initial, option, parameter, shared
from .dae import Dae, Variable
from .diagram import Diagram, Part, PortHandle
from .ports import Hydraulic, Rotational, SignalIn, SignalOut, Translational

__all__ = [
    "REGISTRY",
    "Component",
    "Dae",
    "Diagram",
    "Hydraulic",
    "Part",
    "PortHandle",
    "Rotational",
    "SignalIn",
    "SignalOut",
    "Translational",
    "Variable",
    "initial",
    "option",
    "parameter",
    "shared",
]
