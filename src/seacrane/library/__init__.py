"""Components for building drives: `hydraulics`, `mechanics` and `signals`.

from seacrane.library import hydraulics as hyd, mechanics, signals

Every component is an interface (ports, parameters) with one law, or with levels behind it; see `seacrane.model`. The
sign convention is one for all: efforts and flows at a port are positive *into* the component.
"""
