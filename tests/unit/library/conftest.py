"""One component alone on a bench: its ports given, its law read off."""

import casadi as ca
import numpy as np
import pytest

from seacrane.library import hydraulics as hyd
from seacrane.library import mechanics as mec
from seacrane.model import Diagram
from seacrane.model.ports import Hydraulic, PowerPort, Rotational, Translational

_GIVING = {Hydraulic: (hyd.FlowInput, "set"), Translational: (mec.ForceInput, "F"), Rotational: (mec.TorqueInput, "T")}


def _law(component, given=None, states=None, *, through=(), t=0.0):
    """All numbers of `component` by name ("a.q", "force", "der(extension)"); what is not given is zero, states start.

    A power port is given its across variable ("a.p"), one named in `through` its through variable ("a.q"), positive
    into the component.
    """
    diagram = Diagram("bench")
    part = diagram.add("part", component)
    renamed = {}
    for name, port in component.interface().items():
        handle = getattr(part, name)
        if not isinstance(port, PowerPort):
            diagram.expose(**{f"signal_{name}": handle})
            renamed[name] = f"signal_{name}"
        elif name in through:
            source_class, signal = _GIVING[type(port)]
            source = diagram.add(f"source_{name}", source_class())
            (end,) = [h for h in source if isinstance(h.port, PowerPort)]
            diagram.connect(handle, end)
            diagram.expose(**{f"through_{name}": getattr(source, signal)})
            renamed[f"{name}.{port.through}"] = f"through_{name}"
        else:
            diagram.expose(**{name: handle})
    dae = diagram.compile()
    assert not dae.algebraics
    wanted = {renamed.get(k, k): v for k, v in (given or {}).items()}
    starts = {f"part.{k}": v for k, v in (states or {}).items()}
    assert set(wanted) <= {v.name for v in dae.inputs}, wanted
    assert set(starts) <= {v.name for v in dae.states}, starts
    u = [wanted.get(v.name, 0.0) for v in dae.inputs]
    x = [starts.get(v.name, v.start) for v in dae.states]
    p = [v.start for v in dae.parameters]
    function = ca.Function("law", [dae.t, dae.x, dae.u, dae.p], [ca.vertcat(dae.ode, dae.out, dae.obs)])
    names = [f"der({v.name.removeprefix('part.')})" for v in dae.states]
    names += [v.name for v in (*dae.outputs, *dae.observables)]
    values = dict(zip(names, np.asarray(function(t, x, u, p)).ravel().tolist(), strict=True))
    signals = {k.removeprefix("signal_"): v for k, v in values.items() if k.startswith("signal_")}
    return {k.removeprefix("part."): v for k, v in values.items()} | signals


@pytest.fixture(scope="session")
def law():
    return _law
