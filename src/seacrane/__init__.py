"""seacrane: marine cranes designed, modelled, simulated and operated before steel is cut."""

__version__ = "0.1.0"
